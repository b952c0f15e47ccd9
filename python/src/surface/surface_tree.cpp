// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of deforming surfaces.
#include <memory>
#include <morula/morula.hpp>
#include <morula/surface/surface_tree.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"
#include "surfaces.hpp"

namespace morula::python {

void bind_surface_tree(nb::module_& m) {
  nb::enum_<PairKind>(m, "PairKind", nb::is_arithmetic(), doc::PairKind)
      .value("vertex_facet", PairKind::vertex_facet, doc::PairKind_vertex_facet)
      .value("facet_vertex", PairKind::facet_vertex)
      .value("edge_edge", PairKind::edge_edge)
      .value("facet_facet", PairKind::facet_facet, doc::PairKind_facet_facet);

  nb::class_<HeldSurface>(m, "SurfaceTree", collected<HeldSurface>(), doc::SurfaceTree)
      .def(
          "__init__",
          [](HeldSurface* self, MeshGiven given) {
            const auto mesh = mesh_of(given, "rest");
            new (self) HeldSurface(without_gil([&] { return SurfaceTree(*mesh); }));
          },
          nb::arg("rest"), doc::SurfaceTree_SurfaceTree)
      .def(
          "update",
          [](HeldSurface& self, PositionsGiven from, nb::handle to, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(from.object, "positions");
            if (!to.is_none()) positions.emplace_back(to, "to");
            for (std::size_t i = 0; i < positions.size(); ++i)
              require_rows(positions[i].view().size(), self.tree.vertex_count(), i == 0 ? "positions" : "to", 3,
                           "the surface's vertices");
            std::shared_ptr<Side> before;
            Status status;
            {
              const Exchanging::Call exchanging(self);
              const nb::gil_scoped_release released;
              CallWorkers call(workers);
              const std::unique_lock lock(self.mutex);
              status = positions.size() == 1 ? self.tree.update(positions[0].view(), call)
                                             : self.tree.update(positions[0].view(), positions[1].view(), call);
              if (status) {
                std::swap(self.positions, positions);
                std::swap(self.followed, before);
              }
            }
            require(status);
          },
          nb::arg("positions"), nb::arg("to") = nb::none(), nb::arg("workers") = nb::none(),
          nb::sig("def update(self, positions: morula.typing.FloatArray, to: morula.typing.FloatArray | None = None, "
                  "workers: Workers | None = None) -> None"),
          (std::string(doc::SurfaceTree_update) + "\n\nto: positions at the end of a step. " +
           doc::SurfaceTree_update_2)
              .c_str())
      .def(
          "follow",
          [](HeldSurface& self, ColliderGiven given) {
            std::shared_ptr<Side> side = kept_side_of(given, "body");
            std::vector<Positions> positions;
            Status status;
            {
              const Exchanging::Call exchanging(self);
              const nb::gil_scoped_release released;
              const std::unique_lock lock(self.mutex);
              const std::shared_lock of_body(side->posed->mutex);
              status = self.tree.follow(side->current());
              if (status) {
                for (const Positions& kept : side->given) positions.emplace_back(kept, 0);
                for (const Positions& kept : side->posed->borrowed()) positions.emplace_back(kept, 0);
                std::swap(self.positions, positions);
                self.followed.swap(side);
              }
            }
            require(status);
          },
          nb::arg("body"), nb::sig("def follow(self, body: morula.typing.ColliderLike) -> None"),
          doc::SurfaceTree_follow)
      .def_prop_ro("is_following", [](const HeldSurface& self) { return self.tree.is_following(); })
      .def_prop_ro("is_step", [](const HeldSurface& self) { return self.tree.is_step(); })
      .def_prop_ro("vertex_count", [](const HeldSurface& self) { return self.tree.vertex_count(); })
      .def_prop_ro(
          "facets", [](nb::handle self) { return triples(nb::cast<HeldSurface&>(self).tree.facets(), self); },
          "(facets, 3) uint32; no copy.")
      .def_prop_ro(
          "edges",
          [](nb::handle self) {
            const auto edges = nb::cast<HeldSurface&>(self).tree.edges();
            return IndexPairs(reinterpret_cast<const std::uint32_t*>(edges.data()), {edges.size(), 2}, self);
          },
          doc::SurfaceTree_edges)
      .def_prop_ro(
          "duplicate_vertices", [](const HeldSurface& self) { return self.tree.duplicate_vertices(); },
          doc::SurfaceTree_duplicate_vertices)
      .def(
          "hash",
          [](const HeldSurface& self) {
            return without_gil([&] {
              const SurfaceReading reading(&self);
              return self.tree.hash();
            });
          },
          doc::SurfaceTree_hash)
      .def("__repr__", [](const HeldSurface& self) {
        return "<morula.SurfaceTree: " + std::to_string(self.tree.facets().size()) + " facets, " +
               std::to_string(self.tree.edges().size()) + " edges>";
      });
}

}  // namespace morula::python
