// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points and balls inside a body.
#include <morula/morula.hpp>
#include <mutex>
#include <vector>

#include "held_query.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

using HeldInside = HeldQuery<InsideQuery, SeenSides>;

}  // namespace

void bind_inside(nb::module_& m) {
  Record<PointLocation>(m, "PointLocation", "The location of a point.")
      .field("inside", &PointLocation::inside, doc::PointLocation_inside)
      .field("on_surface", &PointLocation::on_surface, doc::PointLocation_on_surface)
      .field("winding", &PointLocation::winding, doc::PointLocation_winding)
      .field("certified", &PointLocation::certified, doc::PointLocation_certified)
      .field("sphere_tests", &PointLocation::sphere_tests)
      .field("facet_tests", &PointLocation::facet_tests);
  Record<Probe>(m, "Probe", doc::Probe)
      .field("inside", &Probe::inside, doc::Probe_inside)
      .field("touches", &Probe::touches, doc::Probe_touches)
      .field("distance", &Probe::distance, doc::Probe_distance)
      .field("depth", &Probe::depth, doc::Probe_depth)
      .field("nearest", &Probe::nearest, doc::Probe_nearest)
      .field("normal", &Probe::normal, doc::Probe_normal);
  nb::class_<HeldInside>(m, "InsideQuery", collected<HeldInside>(), doc::InsideQuery)
      .def(
          "__init__",
          [](HeldInside* self, ColliderGiven body) {
            auto side = kept_side_of(body, "body");
            InsideQuery query = without_gil([&] {
              const Reading reading({side.get()});
              return InsideQuery(side->current());
            });
            new (self) HeldInside(std::move(query), {{std::move(side)}});
          },
          nb::arg("body"), doc::InsideQuery_InsideQuery)
      .def(
          "locate",
          [](HeldInside& self, Vec3 point) {
            const PointLocation location = self.call([&](InsideQuery& query) { return query.locate(point); });
            require(location.status);
            return location;
          },
          nb::arg("point"), doc::InsideQuery_locate)
      .def(
          "inside",
          [](HeldInside& self, ArrayGiven given) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            auto [values, owner] = kept(self.call([&](InsideQuery& query) {
              std::vector<std::uint8_t> inside;
              SignalCheck check;
              for (const Vec3& p : points) {
                // A look at the clock takes as long as a few steps of the search.
                if (inside.size() % 16 == 0) check();
                const PointLocation location = query.locate(p);
                require(location.status);
                inside.push_back(location.inside);
              }
              return inside;
            }));
            return Copy<bool, -1>(reinterpret_cast<bool*>(values->data()), {values->size()}, owner);
          },
          nb::arg("points"),
          "True for each point inside the solid or on its surface. points: (n, 3); returns (n,) bool.")
      .def(
          "probe",
          [](HeldInside& self, Sphere ball) {
            const Probe probe = self.call([&](InsideQuery& query) { return query.probe(ball); });
            require(probe.status);
            return probe;
          },
          nb::arg("ball"), doc::InsideQuery_probe)
      .def(
          "components_inside",
          [](HeldInside& self, ColliderGiven given, ArrayGiven numbers) {
            const auto other = side_of(given, "other");
            const std::vector<std::uint32_t> vertices = indices_of(numbers.object, "vertices");
            Containment found;
            without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              std::vector<const Side*> sides = self.seen.all();
              sides.push_back(other.get());
              const Reading reading(sides);
              self.seen.sides.front()->current();
              const Collider& other_collider = other->current();
              for (const std::uint32_t vertex : vertices)
                if (vertex >= other_collider.vertex_count()) throw nb::index_error("vertices: there is no such vertex");
              self.query.components_inside(other_collider, vertices, found);
            });
            require(found.status);
            return found;
          },
          nb::arg("other"), nb::arg("vertices"), doc::InsideQuery_components_inside)
      .def_prop_ro("is_oriented", [](const HeldInside& self) { return self.query.is_oriented(); });
  m.def(
      "component_vertices", [](MeshGiven given) { return own_indices(component_vertices(*mesh_of(given))); },
      nb::arg("mesh"), doc::component_vertices);
}

}  // namespace morula::python
