// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of many configurations.
#include <morula/morula.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "planning.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;

using Verdicts = std::tuple<Copy<bool, -1>, Copy<std::int64_t, -1>, Copy<std::int64_t, -1>, Copy<std::int64_t, -1>>;

template <class Check>
Verdicts check_with(const GuardedQuery& held, const ArrayGiven& given, Threads* threads, const Check& check) {
  const ConfigurationQuery query = held.copy();
  std::size_t count = 0;
  const std::vector<double> values = configurations_of(given, "configurations", query, count);
  std::vector<ConfigurationVerdict> verdicts(count);
  without_gil([&] { check(query, values, verdicts, CallWorkers(threads)); });
  return {column_of<bool>(verdicts, [](const auto& v) { return v.is_free(); }),
          column_of<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.link); }),
          column_of<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.other_link); }),
          column_of<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.obstacle); })};
}

constexpr const char* results =
    " Returns arrays of one entry per configuration: free (bool), link, other_link and obstacle (int64, -1 for none). "
    "The contact is that of the lowest link that touches an obstacle, with the lowest obstacle that it touches; "
    "otherwise the first pair of links that touch. workers: threads; by default the caller's alone.";

}  // namespace

void bind_robot_configurations(nb::module_& m) {
  nb::class_<GuardedQuery> query(m, "ConfigurationQuery", doc::ConfigurationQuery);
  query
      .def(
          "__init__",
          [](GuardedQuery* self, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored) {
            ConfigurationQuery made = without_gil(
                [&] { return ConfigurationQuery(robot, spheres, ignored ? *ignored : robot::SelfCollision{}); });
            new (self) GuardedQuery(std::move(made));
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(),
          doc::ConfigurationQuery_ConfigurationQuery)
      .def_prop_ro(
          "coordinates", [](const GuardedQuery& self) { return self.copy().coordinates(); },
          doc::ConfigurationQuery_coordinates)
      .def(
          "set_base",
          [](GuardedQuery& self, TransformGiven given) {
            const RigidTransform base = transform_of(given, "base");
            self.change([&](ConfigurationQuery& query) { query.set_base(base); });
          },
          nb::arg("base"), doc::ConfigurationQuery_set_base)
      .def(
          "attach",
          [](GuardedQuery& self, const std::string& link, ArrayGiven given, const std::vector<std::string>& touching) {
            const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
            self.change([&](ConfigurationQuery& query) { query.attach(link, spheres, touching); });
          },
          nb::arg("link"), nb::arg("spheres"), nb::arg("touching") = std::vector<std::string>{},
          doc::ConfigurationQuery_attach)
      .def(
          "check",
          [](const GuardedQuery& self, ArrayGiven given, const GuardedWorld& world, Threads* workers) {
            const robot::World obstacles = world.copy();
            return check_with(self, given, workers,
                              [&](const ConfigurationQuery& query, std::span<const double> values,
                                  std::span<ConfigurationVerdict> verdicts,
                                  Workers& threads) { query.check(values, obstacles, verdicts, threads); });
          },
          nb::arg("configurations"), nb::arg("world"), nb::kw_only(), nb::arg("workers") = nb::none(),
          (std::string("Checks configurations, (n, coordinates), in a world and against the robot itself.") + results)
              .c_str())
      .def(
          "check_self",
          [](const GuardedQuery& self, ArrayGiven given, Threads* workers) {
            return check_with(self, given, workers,
                              [&](const ConfigurationQuery& query, std::span<const double> values,
                                  std::span<ConfigurationVerdict> verdicts,
                                  Workers& threads) { query.check_self(values, verdicts, threads); });
          },
          nb::arg("configurations"), nb::kw_only(), nb::arg("workers") = nb::none(),
          (std::string("Checks configurations, (n, coordinates), of the robot against itself alone.") + results)
              .c_str());
  bind_robot_clearance(m, query);
  bind_robot_motions(m, query);
}

}  // namespace morula::python
