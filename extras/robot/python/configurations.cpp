// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of many configurations.
#include <morula/morula.hpp>
#include <string>
#include <vector>

#include "planning.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;

/// One entry per configuration.
struct ConfigurationVerdicts {
  Copy<bool, -1> free;
  Copy<std::int64_t, -1> link, other_link, obstacle;
};

template <class Check>
ConfigurationVerdicts check_with(const GuardedQuery& held, const ArrayGiven& given, Threads* threads,
                                 const Check& check) {
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

constexpr std::initializer_list<std::pair<const char*, const char*>> check_arguments = {
    {"configurations", "(n, coordinates), float32 or float64; for one configuration q[None]"},
    {"workers", "threads; by default the caller's alone"}};

}  // namespace

void bind_robot_configurations(nb::module_& m) {
  Record<ConfigurationVerdicts>(
      m, "ConfigurationVerdicts",
      "Arrays of one entry per configuration, from ConfigurationQuery.check() and check_self(). The contact is that of "
      "the lowest link that touches an obstacle, with the lowest obstacle that it touches; otherwise that of the first "
      "pair of links that touch.")
      .field("free", &ConfigurationVerdicts::free, "bool: nothing touches.")
      .field("link", &ConfigurationVerdicts::link, "Index in Robot.links; -1: no contact.")
      .field("other_link", &ConfigurationVerdicts::other_link,
             "Second link, for a contact of the robot with itself; otherwise -1.")
      .field("obstacle", &ConfigurationVerdicts::obstacle, "Number of the obstacle in the world; otherwise -1.");
  nb::class_<GuardedQuery> query(m, "ConfigurationQuery", doc::ConfigurationQuery);
  bind_copies(query, "ConfigurationQuery");
  query
      .def("__repr__",
           [](const GuardedQuery& self) {
             return "ConfigurationQuery(coordinates=" + std::to_string(self.copy().coordinates()) + ")";
           })
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
          [](GuardedQuery& self, const std::string& link, ArrayGiven given, const std::vector<std::string>& touching,
             const std::vector<std::size_t>& obstacles) {
            const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
            self.change([&](ConfigurationQuery& query) { query.attach(link, spheres, touching, obstacles); });
          },
          nb::arg("link"), nb::arg("spheres"), nb::arg("touching") = std::vector<std::string>{},
          nb::arg("touching_obstacles") = std::vector<std::size_t>{}, doc::ConfigurationQuery_attach)
      .def(
          "detach",
          [](GuardedQuery& self, const std::string& link) {
            self.change([&](ConfigurationQuery& query) { query.detach(link); });
          },
          nb::arg("link"), doc::ConfigurationQuery_detach)
      .def(
          "allow_contacts",
          [](GuardedQuery& self, const std::string& link, const std::vector<std::size_t>& obstacles) {
            self.change([&](ConfigurationQuery& query) { query.allow_contacts(link, obstacles); });
          },
          nb::arg("link"), nb::arg("obstacles"), doc::ConfigurationQuery_allow_contacts)
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
          with_arguments("Checks configurations in a world and against the robot itself.", check_arguments).c_str())
      .def(
          "check_self",
          [](const GuardedQuery& self, ArrayGiven given, Threads* workers) {
            return check_with(self, given, workers,
                              [&](const ConfigurationQuery& query, std::span<const double> values,
                                  std::span<ConfigurationVerdict> verdicts,
                                  Workers& threads) { query.check_self(values, verdicts, threads); });
          },
          nb::arg("configurations"), nb::kw_only(), nb::arg("workers") = nb::none(),
          with_arguments("Checks the robot against itself alone.", check_arguments).c_str());
  bind_robot_clearance(m, query);
  bind_robot_motions(m, query);
}

}  // namespace morula::python
