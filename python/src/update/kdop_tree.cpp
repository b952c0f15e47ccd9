// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of k-DOPs, which follow their vertices as bodies do.
#include <memory>
#include <morula/morula.hpp>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <utility>

#include "docstrings.hpp"
#include "holders.hpp"
#include "module.hpp"

namespace morula::python {

namespace {

struct HeldDops {
  KDopTree tree;
  mutable std::shared_mutex mutex;

  std::size_t vertex_count;

  HeldDops(KDopTree&& made, std::size_t vertices) : tree(std::move(made)), vertex_count(vertices) {}

  /// (nodes, k / 2): a copy.
  Copy<float, -1, -1> bounds(std::span<const float> (KDopTree::*side)(std::uint32_t) const) const {
    auto [values, owner] = kept(without_gil([&] {
      const std::shared_lock lock(mutex);
      std::vector<float> all;
      for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
        const std::span<const float> own = (tree.*side)(node);
        all.insert(all.end(), own.begin(), own.end());
      }
      return all;
    }));
    return Copy<float, -1, -1>(values->data(), {tree.node_count(), static_cast<std::size_t>(tree.k() / 2)}, owner);
  }
};

}  // namespace

void bind_kdop_tree(nb::module_& m) {
  nb::class_<HeldDops>(m, "KDopTree", doc::KDopTree)
      .def(
          "__init__",
          [](HeldDops* self, MeshGiven given, const CoveredTree& model, int k, Threads* workers) {
            const auto mesh = mesh_of(given);
            new (self) HeldDops(without_gil([&] { return KDopTree(*mesh, model, k, CallWorkers(workers)); }),
                                mesh->vertex_count());
          },
          nb::arg("mesh"), nb::arg("model"), nb::arg("k"), nb::arg("workers") = nb::none(), doc::KDopTree_KDopTree)
      .def(
          "update",
          [](HeldDops& self, PositionsGiven given, Threads* workers) {
            const Positions positions(given.object, "positions");
            require_rows(positions.view().size(), self.vertex_count, "positions", 3, "the mesh's vertices");
            const UpdateStatus status = without_gil([&] {
              CallWorkers call(workers);
              const std::unique_lock lock(self.mutex);
              return self.tree.update(positions.view(), call);
            });
            require(status);
            return status;
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::KDopTree_update)
      .def(
          "posed",
          [](const HeldDops& self) {
            auto spheres = std::make_shared<PosedRows>();
            spheres->owned = without_gil([&] {
              const std::unique_lock lock(self.mutex);  // it works in memory of its own
              return std::make_unique<PosedSpheres>(self.tree.posed());
            });
            return spheres;
          },
          doc::KDopTree_posed)
      .def(
          "pose",
          [](const HeldDops& self, PosedRows& spheres) {
            if (spheres.owned->sphere_state().spheres.size() != self.tree.node_count())
              throw std::invalid_argument("spheres: those of another tree; posed() makes some");
            without_gil([&] {
              const std::unique_lock lock(self.mutex);  // it works in memory of its own
              const std::unique_lock writing(spheres.mutex);
              self.tree.pose(*spheres.owned);
            });
          },
          nb::arg("spheres"), doc::KDopTree_pose)
      .def_prop_ro("k", [](const HeldDops& self) { return self.tree.k(); })
      .def_prop_ro("node_count", [](const HeldDops& self) { return self.tree.node_count(); })
      .def_prop_ro(
          "directions",
          [](const HeldDops& self) {
            return own_points({self.tree.directions().begin(), self.tree.directions().end()});
          },
          nb::rv_policy::automatic, doc::KDopTree_directions)
      .def_prop_ro(
          "lower", [](const HeldDops& self) { return self.bounds(&KDopTree::lower); }, nb::rv_policy::automatic,
          doc::KDopTree_lower)
      .def_prop_ro(
          "upper", [](const HeldDops& self) { return self.bounds(&KDopTree::upper); }, nb::rv_policy::automatic,
          doc::KDopTree_lower)
      .def_prop_ro("origin", [](const HeldDops& self) { return self.tree.origin(); })
      .def(
          "hash", [](const HeldDops& self) { return self.tree.hash(); }, doc::KDopTree_hash);
}

}  // namespace morula::python
