// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Edges between configurations.
#include <morula/morula.hpp>
#include <stdexcept>
#include <vector>

#include "planning.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

using robot::MotionResult;
using robot::MotionVerdict;

/// One entry per edge.
struct MotionVerdicts {
  Copy<std::uint8_t, -1> result;
  Copy<double, -1> time;
  Copy<std::int64_t, -1> link, other_link, obstacle;
};

MotionVerdicts motions_of(const GuardedQuery& held, const ArrayGiven& start, const ArrayGiven& end,
                          const GuardedWorld& world, const robot::MotionOptions& options, Threads* workers) {
  const robot::ConfigurationQuery query = held.copy();
  const robot::World obstacles = world.copy();
  std::size_t count = 0, end_count = 0;
  const std::vector<double> from = configurations_of(start, "start", query, count);
  const std::vector<double> to = configurations_of(end, "end", query, end_count);
  if (count != end_count) throw std::invalid_argument("end: not as many configurations as start");
  std::vector<MotionVerdict> found(count);
  without_gil([&] { query.check_motions(from, to, obstacles, found, options, CallWorkers(workers)); });
  return {column_of<std::uint8_t>(found, [](const auto& v) { return static_cast<std::uint8_t>(v.result); }),
          column_of<double>(found, [](const auto& v) { return v.time; }),
          column_of<std::int64_t>(found, [](const auto& v) { return number_or_less(v.contact.link); }),
          column_of<std::int64_t>(found, [](const auto& v) { return number_or_less(v.contact.other_link); }),
          column_of<std::int64_t>(found, [](const auto& v) { return number_or_less(v.contact.obstacle); })};
}

}  // namespace

void bind_robot_motions(nb::module_& m, nb::class_<GuardedQuery>& query) {
  nb::enum_<MotionResult>(m, "MotionResult", nb::is_arithmetic(), doc::MotionResult)
      .value("free", MotionResult::free, "Proven: no configuration of the edge has a contact.")
      .value("touches", MotionResult::touches, "The configuration at `time` has a contact.")
      .value("undecided", MotionResult::undecided, "Nearer than the tolerance to a contact, and none was found.");
  Record<MotionVerdicts>(m, "MotionVerdicts", "Arrays of one entry per edge, from ConfigurationQuery.check_motions().")
      .field("result", &MotionVerdicts::result, "uint8, values of MotionResult: 0 free, 1 touches, 2 undecided.")
      .field("time", &MotionVerdicts::time, doc::MotionVerdict_time)
      .field("link", &MotionVerdicts::link, "Link of the contact at `time`; -1: none.")
      .field("other_link", &MotionVerdicts::other_link,
             "Second link, for a contact of the robot with itself; -1: none.")
      .field("obstacle", &MotionVerdicts::obstacle, "Obstacle of the contact at `time`; -1: none.");
  query.def(
      "check_motions",
      [](const GuardedQuery& self, const ArrayGiven& start, const ArrayGiven& end, const GuardedWorld& world,
         double resolution, double tolerance, bool with_world, bool with_self, Threads* workers) {
        return motions_of(self, start, end, world,
                          {.resolution = resolution, .tolerance = tolerance, .world = with_world, .self = with_self},
                          workers);
      },
      nb::arg("start"), nb::arg("end"), nb::arg("world"), nb::kw_only(), nb::arg("resolution") = 0.0,
      nb::arg("tolerance") = 1e-4, nb::arg("with_world") = true, nb::arg("with_self") = true,
      nb::arg("workers") = nb::none(),
      with_arguments(
          "Checks edges: row i of `start` to row i of `end`, along the straight line between them.\n\nA "
          "certified edge is halved until bounds of each sphere's motion prove its parts free; `free` holds "
          "for every configuration of it. Results are the same for any number of workers. Throws ValueError for "
          "arrays of other shapes, numbers that are not finite, options out of range, and edges of more than a "
          "billion configurations at a resolution.",
          {{"start", "(n, coordinates)"},
           {"end", "(n, coordinates)"},
           {"resolution", doc::MotionOptions_resolution},
           {"tolerance", doc::MotionOptions_tolerance},
           {"with_world", "False: obstacles do not count"},
           {"with_self", "False: pairs of links do not count"},
           {"workers", "threads; by default the caller's alone"}})
          .c_str());
}

}  // namespace morula::python
