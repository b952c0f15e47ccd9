// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Distances of bodies.
#include <initializer_list>
#include <limits>
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

void bind_distance(nb::module_& m) {
  Record<DistanceBounds>(m, "DistanceBounds",
                         "Guaranteed bounds of a distance, with the points that attain the upper one.")
      .field("lower", &DistanceBounds::lower, doc::DistanceBounds_lower)
      .field("upper", &DistanceBounds::upper)
      .field("a", &DistanceBounds::a, doc::DistanceBounds_a)
      .field("b", &DistanceBounds::b)
      .field("crossing", &DistanceBounds::crossing, doc::DistanceBounds_crossing)
      .field("farther", &DistanceBounds::farther, doc::DistanceBounds_farther)
      .field("complete", &DistanceBounds::complete, doc::DistanceBounds_complete)
      .field("certified", &DistanceBounds::certified, doc::DistanceBounds_certified)
      .field("sphere_tests", &DistanceBounds::sphere_tests)
      .field("facet_tests", &DistanceBounds::facet_tests);
  struct HeldDistance {
    DistanceQuery query;
    std::mutex mutex;
  };
  const auto run = [](DistanceQuery& query, ColliderGiven ga, ColliderGiven gb, bool to_facets, double tolerance,
                      const BudgetGiven& budget, double stop_above, double stop_below, bool warm_start) {
    const DistanceOptions options{to_facets, tolerance, budget_of(budget), stop_above, stop_below, warm_start, {}};
    const auto a = side_of(ga, "a"), b = side_of(gb, "b");
    const DistanceBounds bounds = without_gil([&] {
      const Reading reading({a.get(), b.get()});
      return query.run(a->current(), b->current(), options);
    });
    require(bounds.status);
    return bounds;
  };
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::initializer_list<std::pair<const char*, const char*>> arguments{
      {"to_facets", doc::DistanceOptions_to_facets},
      {"tolerance", doc::DistanceOptions_tolerance},
      {"budget", doc::DistanceOptions_budget},
      {"stop_above", doc::DistanceOptions_stop_above},
      {"stop_below", doc::DistanceOptions_stop_below}};
  nb::class_<HeldDistance>(m, "DistanceQuery", doc::DistanceQuery)
      .def(nb::init<>())
      .def(
          "run",
          [run](HeldDistance& self, ColliderGiven a, ColliderGiven b, bool to_facets, double tolerance,
                BudgetGiven budget, double stop_above, double stop_below, bool warm_start) {
            std::unique_lock<std::mutex> lock(self.mutex, std::defer_lock);
            without_gil([&] { lock.lock(); });
            return run(self.query, a, b, to_facets, tolerance, budget, stop_above, stop_below, warm_start);
          },
          nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("to_facets") = true, nb::arg("tolerance") = 0.0,
          nb::arg("budget") = nb::none(), nb::arg("stop_above") = infinity, nb::arg("stop_below") = 0.0,
          nb::arg("warm_start") = true, with_arguments(doc::DistanceQuery_run, arguments).c_str());
  m.def(
      "distance",
      [run](ColliderGiven a, ColliderGiven b, bool to_facets, double tolerance, BudgetGiven budget, double stop_above,
            double stop_below) {
        DistanceQuery query;
        return run(query, a, b, to_facets, tolerance, budget, stop_above, stop_below, true);
      },
      nb::arg("a"), nb::arg("b"), nb::kw_only(), nb::arg("to_facets") = true, nb::arg("tolerance") = 0.0,
      nb::arg("budget") = nb::none(), nb::arg("stop_above") = infinity, nb::arg("stop_below") = 0.0,
      with_arguments("Distance of two bodies' surfaces: guaranteed bounds, with the points that attain the upper one.",
                     arguments)
          .c_str());
}

}  // namespace morula::python
