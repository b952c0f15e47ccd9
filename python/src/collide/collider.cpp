// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Colliders: a body, or spheres, placed in the world.
#include <cstdint>
#include <memory>
#include <morula/morula.hpp>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

#include "docstrings.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {
namespace {

/// Locks the side without the GIL: a thread that moves the collider may wait for the GIL.
template <class F>
auto read(const Side& side, const F& f) {
  return without_gil([&] {
    const std::shared_lock lock(side.posed->mutex);
    return f();
  });
}

}  // namespace

void bind_collider(nb::module_& m) {
  nb::class_<Side>(m, "Collider", collected<Side>(), doc::Collider)
      .def(
          "__init__",
          [](Side* self, ColliderGiven body) {
            const std::shared_ptr<Side> made = side_of(body, "body");
            if (nb::isinstance<Side>(body.object)) throw nb::type_error("body: a Collider already");
            new (self) Side(std::move(*made));
          },
          nb::arg("body"), nb::sig("def __init__(self, body: Body | RebuiltBody | PosedSpheres) -> None"),
          doc::Collider_Collider)
      .def(
          "__init__",
          [](Side* self, MeshGiven given, std::shared_ptr<CoveredTree> model, std::shared_ptr<PosedRows> spheres) {
            Side side;
            side.mesh = kept_mesh_of(given);
            side.model = model;
            side.collider = std::make_unique<Collider>(*side.mesh, model->cover, spheres->sphere_state());
            side.posed = std::move(spheres);
            new (self) Side(std::move(side));
          },
          nb::arg("mesh"), nb::arg("model"), nb::arg("spheres"),
          nb::sig(
              "def __init__(self, mesh: morula.typing.MeshLike, model: CoveredTree, spheres: PosedSpheres) -> None"),
          doc::Collider_Collider_2)
      .def(
          "set_transform",
          [](Side& self, TransformGiven given) {
            const RigidTransform transform = transform_of(given);
            without_gil([&] {
              const std::unique_lock lock(self.posed->mutex);
              self.collider->set_transform(transform);
            });
          },
          nb::arg("transform"),
          with_arguments(doc::Collider_set_transform,
                         {{"transform",
                           "a RigidTransform, a matrix (4, 4) or (3, 4) that acts on columns, or a translation alone "
                           "(x, y, z), mesh units"}})
              .c_str())
      .def_prop_ro("transform", [](const Side& self) { return read(self, [&] { return self.collider->transform(); }); })
      .def(
          "set_positions",
          [](Side& self, PositionsGiven given) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            {
              const nb::gil_scoped_release released;
              const std::unique_lock lock(self.posed->mutex);
              self.collider->set_positions(positions[0].view());
              std::swap(self.given, positions);
            }
          },
          nb::arg("positions"), doc::Collider_set_positions)
      .def_prop_ro(
          "has_current_positions",
          [](const Side& self) { return read(self, [&] { return self.current().has_current_positions(); }); },
          doc::Collider_has_current_positions)
      .def_prop_ro(
          "has_surface", [](const Side& self) { return self.collider->has_surface(); }, doc::Collider_has_surface)
      .def(
          "vertices",
          [](const Side& self) {
            return own_points(read(self, [&] {
              const Collider& collider = self.current();
              if (!collider.has_current_positions())
                throw std::invalid_argument("the positions of the present frame are not known: set_positions()");
              std::vector<Vec3> all(collider.vertex_count());
              for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = collider.vertex(v);
              return all;
            }));
          },
          (std::string("(vertices, 3) float64: a copy of all positions. ") + doc::Collider_vertex).c_str())
      .def(
          "facets",
          [](const Side& self, std::uint32_t node) {
            if (node >= self.current().tree().node_count()) throw nb::index_error("node");
            const auto facets = self.collider->facets(node);
            return own_indices({facets.begin(), facets.end()});
          },
          nb::arg("node"), doc::Collider_facets)
      .def("__repr__", [](const Side& self) {
        return std::string("<morula.Collider: ") + std::to_string(self.collider->tree().node_count()) + " nodes" +
               (self.collider->has_surface() ? ">" : ", spheres alone>");
      });
}

}  // namespace morula::python
