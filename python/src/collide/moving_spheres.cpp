// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres between two frames.
#include <cmath>
#include <morula/collide/moving_spheres.hpp>
#include <utility>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {
namespace {

struct HeldMotion {
  MovingSpheres spheres;
  std::mutex mutex;
};

/// Calls `read` with the spheres, of which none is written meanwhile.
template <class Read>
auto with(HeldMotion& self, const Read& read) {
  return without_gil([&] {
    const std::lock_guard lock(self.mutex);
    return read(self.spheres);
  });
}

void set_end_of_step(HeldMotion& self, const ColliderGiven& given, Status (MovingSpheres::*set)(const Collider&)) {
  const auto body = side_of(given, "body");
  require(with(self, [&](MovingSpheres& spheres) {
    const Reading reading({body.get()});
    return (spheres.*set)(body->current());
  }));
}

/// One for each node: sphere_of(spheres, node).
template <class SphereOf>
Copy<double, -1, 4> all_spheres(HeldMotion& self, const SphereOf& sphere_of) {
  return own_spheres(with(self, [&](const MovingSpheres& spheres) {
    std::vector<Sphere> all;
    all.reserve(spheres.size());
    for (std::uint32_t node = 0; node < spheres.size(); ++node) all.push_back(sphere_of(spheres, node));
    return all;
  }));
}

Copy<double, -1, 2, 3> all_boxes(HeldMotion& self) {
  std::vector<Vec3> corners = with(self, [](const MovingSpheres& spheres) {
    std::vector<Vec3> all;
    all.reserve(2 * spheres.size());
    for (std::uint32_t node = 0; node < spheres.size(); ++node) {
      const Box box = spheres.swept_box(node);
      all.insert(all.end(), {box.lower, box.upper});
    }
    return all;
  });
  const std::size_t count = corners.size() / 2;
  auto [values, owner] = kept(std::move(corners));
  return {reinterpret_cast<double*>(values->data()), {count, 2, 3}, owner};
}

EarliestTouch earliest(HeldMotion& a, HeldMotion& b, double distance, const BudgetGiven& given) {
  const EarliestTouchOptions options{distance, budget_of(given)};
  EarliestTouch touch = without_gil([&] {
    // The same object twice is locked once.
    std::unique_lock first(a.mutex, std::defer_lock), second(b.mutex, std::defer_lock);
    if (&a == &b)
      first.lock();
    else
      std::lock(first, second);
    return EarliestTouchQuery().run(a.spheres, b.spheres, options);
  });
  require(touch.status);
  return touch;
}

}  // namespace

void bind_moving_spheres(nb::module_& m) {
  nb::class_<HeldMotion>(m, "MovingSpheres", doc::MovingSpheres)
      .def(nb::init<>())
      .def(
          "set_start",
          [](HeldMotion& self, ColliderGiven body) { set_end_of_step(self, body, &MovingSpheres::set_start); },
          nb::arg("body"), doc::MovingSpheres_set_start)
      .def(
          "set_end", [](HeldMotion& self, ColliderGiven body) { set_end_of_step(self, body, &MovingSpheres::set_end); },
          nb::arg("body"), doc::MovingSpheres_set_end)
      .def(
          "advance", [](HeldMotion& self) { with(self, [](MovingSpheres& spheres) { spheres.advance(); }); },
          doc::MovingSpheres_advance)
      .def(
          "widen",
          [](HeldMotion& self, double length) { with(self, [&](MovingSpheres& spheres) { spheres.widen(length); }); },
          nb::arg("length"), doc::MovingSpheres_widen)
      .def_prop_ro(
          "covers", [](HeldMotion& self) { return with(self, [](const MovingSpheres& s) { return s.covers(); }); },
          doc::MovingSpheres_covers)
      .def("__len__",
           [](HeldMotion& self) { return with(self, [](const MovingSpheres& spheres) { return spheres.size(); }); })
      .def(
          "spheres",
          [](HeldMotion& self, double t) {
            if (std::isnan(t)) throw std::invalid_argument("t is not a number: it is a time from 0 to 1");
            return all_spheres(self, [&](const MovingSpheres& s, std::uint32_t node) { return s.sphere(node, t); });
          },
          nb::arg("t"),
          "All spheres at a time, in world coordinates.\n\nArgs:\n    t: 0 to 1; others count as the nearer of "
          "these.\n\n"
          "Returns:\n    An array of shape (nodes, 4): center and radius, the root first.")
      .def(
          "swept_spheres",
          [](HeldMotion& self) {
            return all_spheres(self, [](const MovingSpheres& s, std::uint32_t node) { return s.swept_sphere(node); });
          },
          "A sphere for each node that contains the node's sphere at all times: shape (nodes, 4).")
      .def("swept_boxes", &all_boxes,
           "A box for each node that contains the node's sphere at all times: shape (nodes, 2, 3), the lower corner "
           "first.");
  Record<EarliestTouch>(m, "EarliestTouch", "The earliest time at which leaf spheres of two bodies can touch.")
      .field("time", &EarliestTouch::time, doc::EarliestTouch_time)
      .field("apart", &EarliestTouch::apart, doc::EarliestTouch_apart)
      .field("certified", &EarliestTouch::certified, doc::EarliestTouch_certified)
      .field("complete", &EarliestTouch::complete, doc::EarliestTouch_complete)
      .property(
          "nodes", [](const EarliestTouch& touch) { return std::pair(touch.nodes.a, touch.nodes.b); },
          doc::EarliestTouch_nodes)
      .field("sphere_tests", &EarliestTouch::sphere_tests);
  m.def("earliest_touch", &earliest, nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("distance") = 0.0,
        nb::arg("budget") = nb::none(),
        with_arguments(doc::EarliestTouchQuery,
                       {{"distance", doc::EarliestTouchOptions_distance}, {"budget", doc::EarliestTouchOptions_budget}})
            .c_str());
  m.def(
      "arc_deviation",
      [](nb::handle angles, nb::handle reaches) {
        std::vector<std::size_t> shape;
        const std::vector<double> a = numbers_of(angles, "angles", {-1}, shape);
        const std::vector<double> r = numbers_of(reaches, "reaches", {-1}, shape);
        return arc_deviation(a, r);
      },
      nb::arg("angles"), nb::arg("reaches"), doc::arc_deviation);
}

}  // namespace morula::python
