// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Questions about a mesh as it stands: distances, insides, volumes of balls, medial balls.
#include <morula/medial/medial_balls.hpp>
#include <morula/morula.hpp>

#include "choices.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "parallel/interruption.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// One number per point, shared out among workers.
template <class F>
Copy<double, -1> each(ArrayGiven given, const char* name, Threads* workers, const F& f) {
  const std::vector<Vec3> points = points_of(given.object, name);
  return own_numbers(without_gil([&] {
    std::vector<double> values;
    detail::resize_interruptibly(values, points.size());
    CallWorkers call(workers);
    parallel_for(static_cast<Workers&>(call), points.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values[i] = f(points[i]);
    });
    return values;
  }));
}

struct ClosestPoints {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> facets;
  std::vector<double> distances;
  std::vector<Vec3> barycentric;
};

ClosestPoints closest(const TriangleBvh& bvh, const std::vector<Vec3>& points, Workers& workers) {
  ClosestPoints found;
  detail::resize_interruptibly(found.points, points.size());
  detail::resize_interruptibly(found.facets, points.size());
  detail::resize_interruptibly(found.distances, points.size());
  detail::resize_interruptibly(found.barycentric, points.size());
  parallel_for(workers, points.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto nearest = bvh.closest_point(points[i]);
      if (!nearest) {
        found.facets[i] = no_node;
        found.distances[i] = std::numeric_limits<double>::quiet_NaN();
        continue;
      }
      found.points[i] = nearest->point;
      found.facets[i] = nearest->facet;
      found.distances[i] = std::sqrt(nearest->squared_distance);
      found.barycentric[i] = {nearest->barycentric[0], nearest->barycentric[1], nearest->barycentric[2]};
    }
  });
  return found;
}

}  // namespace

void bind_shapes(nb::module_& m) {
  Record<ClosestPoints>(m, "ClosestPoints", "The nearest points of a surface, one per given point.")
      .property(
          "points", [](nb::handle self) { return points(nb::cast<ClosestPoints&>(self).points, self); },
          "(n, 3) float64.")
      .property(
          "facets", [](nb::handle self) { return indices(nb::cast<ClosestPoints&>(self).facets, self); },
          "(n,) uint32.")
      .property(
          "distances", [](nb::handle self) { return numbers(nb::cast<ClosestPoints&>(self).distances, self); },
          "(n,) float64, mesh units.")
      .property(
          "barycentric", [](nb::handle self) { return points(nb::cast<ClosestPoints&>(self).barycentric, self); },
          "(n, 3) float64, exactly 0 on edges and vertices.")
      .table([](const ClosestPoints& self) { return self.facets.size(); });

  nb::class_<TriangleBvh>(m, "TriangleBvh", "A wide bounding volume hierarchy over facets.")
      .def(
          "__init__",
          [](TriangleBvh* self, MeshGiven given, Threads* workers) {
            const auto mesh = mesh_of(given);
            auto made = without_gil([&] { return TriangleBvh(*mesh, CallWorkers(workers)); });
            new (self) TriangleBvh(std::move(made));
          },
          nb::arg("mesh"), nb::arg("workers") = nb::none(), doc::TriangleBvh_TriangleBvh)
      .def_prop_ro("facet_count", &TriangleBvh::facet_count)
      .def_prop_ro(
          "bounding_box",
          [](const TriangleBvh& self) {
            const Box box = self.bounding_box();
            return std::make_tuple(box.lower, box.upper);
          },
          "Lower and upper corner.")
      .def(
          "closest_points",
          [](const TriangleBvh& self, ArrayGiven given, Threads* workers) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            return without_gil([&] { return closest(self, points, CallWorkers(workers)); });
          },
          nb::arg("points"), nb::arg("workers") = nb::none(), doc::TriangleBvh_closest_point)
      .def(
          "facets_touching",
          [](const TriangleBvh& self, Sphere ball) {
            std::vector<std::uint32_t> facets;
            self.facets_touching(ball, facets);
            return own_indices(std::move(facets));
          },
          nb::arg("ball"), doc::TriangleBvh_facets_touching)
      .def(
          "winding_numbers",
          [](const TriangleBvh& self, ArrayGiven given, double accuracy, Threads* workers) {
            return each(given, "points", workers, [&](const Vec3& p) { return self.winding_number(p, accuracy); });
          },
          nb::arg("points"), nb::arg("accuracy") = 2.0, nb::arg("workers") = nb::none(),
          doc::TriangleBvh_winding_number);

  nb::class_<SignedDistance>(m, "SignedDistance", "Signed distance to a mesh at rest: negative inside.")
      .def(
          "__init__",
          [](SignedDistance* self, MeshGiven given, std::optional<SignMethodName> method, Threads* workers) {
            const auto mesh = mesh_of(given);
            std::optional<SignMethod> sign;
            if (method) sign = choice<SignMethod>(*method, "method", sign_method_choices);
            auto made = without_gil([&] {
              CallWorkers call(workers);
              return sign ? SignedDistance(*mesh, *sign, call) : SignedDistance(*mesh, static_cast<Workers&>(call));
            });
            new (self) SignedDistance(std::move(made));
          },
          nb::arg("mesh"), nb::arg("method") = nb::none(), nb::arg("workers") = nb::none(),
          doc::SignedDistance_SignedDistance)
      .def(
          "__call__",
          [](const SignedDistance& self, ArrayGiven given, Threads* workers) {
            return each(given, "points", workers, self);
          },
          nb::arg("points"), nb::arg("workers") = nb::none(),
          (std::string("(n,) float64, mesh units, negative inside. points: (n, 3). ") + doc::SignedDistance_call)
              .c_str())
      .def(
          "is_inside",
          [](const SignedDistance& self, ArrayGiven given, Threads* workers) {
            const std::vector<Vec3> points = points_of(given.object, "points");
            auto [inside, owner] = kept(without_gil([&] {
              std::vector<std::uint8_t> flags;
              detail::resize_interruptibly(flags, points.size());
              CallWorkers call(workers);
              parallel_for(static_cast<Workers&>(call), points.size(), 256, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) flags[i] = self.is_inside(points[i]);
              });
              return flags;
            }));
            return Copy<bool, -1>(reinterpret_cast<bool*>(inside->data()), {inside->size()}, owner);
          },
          nb::arg("points"), nb::arg("workers") = nb::none(),
          "(n,) bool: True if the distance is negative. points: (n, 3).")
      .def(
          "protrusion_bound", [](const SignedDistance& self, Sphere ball) { return self.protrusion_bound(ball); },
          nb::arg("ball"), doc::SignedDistance_protrusion_bound)
      .def(
          "inside_volume", [](const SignedDistance& self, Sphere ball) { return inside_volume(self, ball); },
          nb::arg("ball"), doc::inside_volume)
      .def(
          "outside_volume", [](const SignedDistance& self, Sphere ball) { return outside_volume(self, ball); },
          nb::arg("ball"), doc::outside_volume)
      .def_prop_ro("method",
                   [](const SignedDistance& self) {
                     return self.method() == SignMethod::pseudo_normal ? "pseudo_normal" : "winding_number";
                   })
      .def_prop_ro("has_volume", &SignedDistance::has_volume, doc::SignedDistance_has_volume)
      .def_prop_ro("orientation", &SignedDistance::orientation, doc::SignedDistance_orientation);

  Record<MedialBalls>(m, "MedialBalls", doc::MedialBalls)
      .property(
          "balls", [](nb::handle self) { return sphere_rows(nb::cast<MedialBalls&>(self).balls, self); },
          "(n, 4) float64.")
      .property(
          "neighbor_begin", [](nb::handle self) { return indices(nb::cast<MedialBalls&>(self).neighbor_begin, self); },
          doc::MedialBalls_neighbor_begin)
      .property("neighbors", [](nb::handle self) { return indices(nb::cast<MedialBalls&>(self).neighbors, self); })
      .python()
      .def("__len__", [](const MedialBalls& self) { return self.balls.size(); });
  m.def(
      "shrinking_balls",
      [](const SignedDistance& shape, ArrayGiven p, ArrayGiven n, Threads* workers) {
        const std::vector<Vec3> points = points_of(p.object, "points"), normals = points_of(n.object, "normals");
        require_rows(normals.size(), points.size(), "normals", 3, "the points");
        return without_gil([&] { return shrinking_balls(shape, points, normals, CallWorkers(workers)); });
      },
      nb::arg("shape"), nb::arg("points"), nb::arg("normals"), nb::arg("workers") = nb::none(), doc::shrinking_balls);
  m.def(
      "inner_ball_candidates",
      [](MeshGiven given, const SignedDistance& object, std::size_t candidates, double margin, double min_radius,
         std::optional<double> max_radius, std::uint64_t seed, Threads* workers) {
        const auto mesh = mesh_of(given);
        const InnerBallOptions options{candidates, margin, min_radius, max_radius, seed};
        return own_spheres(
            without_gil([&] { return inner_ball_candidates(*mesh, object, options, CallWorkers(workers)); }));
      },
      nb::arg("mesh"), nb::arg("object"), nb::kw_only(), nb::arg("candidates") = 2000, nb::arg("margin") = 0.0,
      nb::arg("min_radius") = 0.0, nb::arg("max_radius") = nb::none(), nb::arg("seed") = 1,
      nb::arg("workers") = nb::none(),
      with_arguments(doc::inner_ball_candidates, {{"candidates", doc::InnerBallOptions_candidates},
                                                  {"margin", doc::InnerBallOptions_margin},
                                                  {"min_radius", doc::InnerBallOptions_min_radius},
                                                  {"max_radius", doc::InnerBallOptions_max_radius}})
          .c_str());
  m.def(
      "fullest_balls",
      [](ArrayGiven given, std::size_t count) {
        const std::vector<Sphere> balls = spheres_of(given.object, "balls");
        return own_spheres(without_gil([&] { return fullest_balls(balls, count); }));
      },
      nb::arg("balls"), nb::arg("count"), doc::fullest_balls);
  m.def(
      "voronoi_balls",
      [](const SignedDistance& shape, ArrayGiven given) {
        const std::vector<Vec3> samples = points_of(given.object, "samples");
        return without_gil([&] { return voronoi_balls(shape, samples); });
      },
      nb::arg("shape"), nb::arg("samples"), doc::voronoi_balls);
}

}  // namespace morula::python
