// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body and rays.
#include <limits>
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// Hits as columns.
struct RayHits {
  std::vector<double> t;
  std::vector<std::uint32_t> facet;
  std::vector<Vec3> point, normal;
};

RayHits hit_rows(const std::vector<RayPoint>& points) {
  RayHits hits;
  for (const RayPoint& hit : points) {
    hits.t.push_back(hit.t);
    hits.facet.push_back(hit.point.facet);
    hits.point.push_back(hit.point.point);
    hits.normal.push_back(hit.normal);
  }
  return hits;
}

}  // namespace

void bind_rays(nb::module_& m) {
  Record<RayPoint>(m, "RayPoint", doc::RayPoint)
      .field("t", &RayPoint::t, doc::RayPoint_t)
      .field("point", &RayPoint::point, doc::RayPoint_point)
      .field("normal", &RayPoint::normal, doc::RayPoint_normal);
  Record<RayHit>(m, "RayHit", "What first_hit() found.")
      .field("first", &RayHit::first, doc::RayHit_first)
      .field("certified", &RayHit::certified, doc::RayHit_certified)
      .field("sphere_tests", &RayHit::sphere_tests)
      .field("facet_tests", &RayHit::facet_tests)
      .python()
      .def("__bool__", [](const RayHit& h) { return h.first.has_value(); });
  Record<RayHits>(m, "RayHits",
                  "All hits of one ray, or first hits of many rays: t is infinite and facet morula.no_node if a ray "
                  "misses.")
      .property(
          "t", [](nb::handle self) { return numbers(nb::cast<RayHits&>(self).t, self); }, doc::RayPoint_t)
      .property(
          "facet", [](nb::handle self) { return indices(nb::cast<RayHits&>(self).facet, self); }, "(n,) uint32.")
      .property(
          "point", [](nb::handle self) { return points(nb::cast<RayHits&>(self).point, self); }, "(n, 3) float64.")
      .property(
          "normal", [](nb::handle self) { return points(nb::cast<RayHits&>(self).normal, self); }, doc::RayPoint_normal)
      .table([](const RayHits& self) { return self.t.size(); });
  m.def(
      "first_hit",
      [](ColliderGiven given, Vec3 origin, Vec3 direction, double t_end) {
        const auto side = side_of(given, "body");
        return without_gil([&] {
          const Reading reading({side.get()});
          return first_hit(side->current(), Ray{origin, direction, t_end});
        });
      },
      nb::arg("body"), nb::arg("origin"), nb::arg("direction"),
      nb::arg("t_end") = std::numeric_limits<double>::infinity(), doc::RayQuery);
  m.def(
      "all_hits",
      [](ColliderGiven given, Vec3 origin, Vec3 direction, double t_end) {
        const auto side = side_of(given, "body");
        return without_gil([&] {
          const Reading reading({side.get()});
          return hit_rows(all_hits(side->current(), Ray{origin, direction, t_end}));
        });
      },
      nb::arg("body"), nb::arg("origin"), nb::arg("direction"),
      nb::arg("t_end") = std::numeric_limits<double>::infinity(), doc::RayQuery_run_all);
  m.def(
      "first_hits",
      [](ColliderGiven given, ArrayGiven from, ArrayGiven along, double t_end) {
        const auto side = side_of(given, "body");
        const std::vector<Vec3> origins = points_of(from.object, "origins"),
                                directions = points_of(along.object, "directions");
        require_rows(directions.size(), origins.size(), "directions", 3, "the origins");
        return without_gil([&] {
          const Reading reading({side.get()});
          RayHits hits;
          hits.t.reserve(origins.size());
          hits.facet.reserve(origins.size());
          hits.point.reserve(origins.size());
          hits.normal.reserve(origins.size());
          const RayQuery query;
          SignalCheck check;
          for (std::size_t i = 0; i < origins.size(); ++i) {
            const RayHit hit = query.run(side->current(), {origins[i], directions[i], t_end});
            if (!hit.status) throw std::invalid_argument("ray " + std::to_string(i) + ": " + message(hit.status));
            hits.t.push_back(hit.first ? hit.first->t : std::numeric_limits<double>::infinity());
            hits.facet.push_back(hit.first ? hit.first->point.facet : no_node);
            hits.point.push_back(hit.first ? hit.first->point.point : Vec3{});
            hits.normal.push_back(hit.first ? hit.first->normal : Vec3{});
            if (i % 1024 == 1023) check();
          }
          return hits;
        });
      },
      nb::arg("body"), nb::arg("origins"), nb::arg("directions"),
      nb::arg("t_end") = std::numeric_limits<double>::infinity(),
      "First hits of many rays. origins, directions: (n, 3).");
}

}  // namespace morula::python
