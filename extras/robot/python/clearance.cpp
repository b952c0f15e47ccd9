// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clearances of many configurations.
#include <limits>
#include <morula/morula.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "planning.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// One entry per configuration.
struct Clearances {
  Copy<double, -1> distance, lower, upper;
  Copy<std::int64_t, -1> link, other_link, obstacle;
  std::optional<Copy<double, -1, -1>> gradients;
};

Clearances clearances_of(const GuardedQuery& held, const ArrayGiven& given, const GuardedWorld& world,
                         const robot::ClearanceOptions& options, bool gradients, Threads* workers) {
  const robot::ConfigurationQuery query = held.copy();
  const robot::World obstacles = world.copy();
  std::size_t count = 0;
  const std::vector<double> values = configurations_of(given, "configurations", query, count);
  std::vector<robot::Clearance> found(count);
  std::vector<double> rows(gradients ? values.size() : 0);
  without_gil([&] { query.clearance(values, obstacles, found, rows, options, CallWorkers(workers)); });
  Clearances result{column_of<double>(found, [](const auto& c) { return c.distance; }),
                    column_of<double>(found, [](const auto& c) { return c.lower; }),
                    column_of<double>(found, [](const auto& c) { return c.upper; }),
                    column_of<std::int64_t>(found, [](const auto& c) { return number_or_less(c.link); }),
                    column_of<std::int64_t>(found, [](const auto& c) { return number_or_less(c.other_link); }),
                    column_of<std::int64_t>(found, [](const auto& c) { return number_or_less(c.obstacle); }),
                    std::nullopt};
  if (gradients) {
    auto* kept = new std::vector<double>(std::move(rows));
    const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    result.gradients = Copy<double, -1, -1>(kept->data(), {count, query.coordinates()}, owner);
  }
  return result;
}

}  // namespace

void bind_robot_clearance(nb::module_& m, nb::class_<GuardedQuery>& query) {
  Record<Clearances>(m, "Clearances", "Arrays of one entry per configuration, from ConfigurationQuery.clearance().")
      .field("distance", &Clearances::distance, doc::Clearance_distance)
      .field("lower", &Clearances::lower, "Lower bound of the exact distance for the given numbers, rounding included.")
      .field("upper", &Clearances::upper, "Upper bound of the exact distance for the given numbers, rounding included.")
      .field("link", &Clearances::link, "Link of the nearest pair; -1: none within the limit.")
      .field("other_link", &Clearances::other_link, "Second link, if the nearest pair is two links; otherwise -1.")
      .field("obstacle", &Clearances::obstacle, "Obstacle of the nearest pair; otherwise -1.")
      .field("gradients", &Clearances::gradients,
             "(n, coordinates), mesh units per coordinate; None if not requested.");
  query.def(
      "clearance",
      [](const GuardedQuery& self, const ArrayGiven& given, const GuardedWorld& world, double limit, bool with_world,
         bool with_self, bool gradients, Threads* workers) {
        return clearances_of(self, given, world, {.limit = limit, .world = with_world, .self = with_self}, gradients,
                             workers);
      },
      nb::arg("configurations"), nb::arg("world"), nb::kw_only(),
      nb::arg("limit") = std::numeric_limits<double>::infinity(), nb::arg("with_world") = true,
      nb::arg("with_self") = true, nb::arg("gradients") = false, nb::arg("workers") = nb::none(),
      with_arguments(
          "The clearance of each configuration, (n, coordinates), and with `gradients` its derivatives by the "
          "coordinates: those of the nearest pair. The robot moves, the obstacles stay.",
          {{"limit", doc::ClearanceOptions_limit},
           {"with_world", "False: obstacles do not count"},
           {"with_self", "False: pairs of links do not count"},
           {"workers", "threads; by default the caller's alone"}})
          .c_str());
}

}  // namespace morula::python
