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

template <class Number, class F>
Copy<Number, -1> column(std::span<const ConfigurationVerdict> verdicts, const F& number) {
  // std::vector<bool> has no array.
  auto* values = new Number[verdicts.size()];
  const nb::capsule owner(values, [](void* p) noexcept { delete[] static_cast<Number*>(p); });
  for (std::size_t i = 0; i < verdicts.size(); ++i) values[i] = number(verdicts[i]);
  return Copy<Number, -1>(values, {verdicts.size()}, owner);
}

std::int64_t number_or_less(std::uint32_t number) {
  return number == ConfigurationVerdict::free_link ? -1 : static_cast<std::int64_t>(number);
}

template <class Check>
Verdicts check_with(const HeldQuery& held, const ArrayGiven& given, Threads* threads, const Check& check) {
  const ConfigurationQuery query = held.copy();
  std::vector<std::size_t> shape;
  const std::vector<double> values =
      numbers_of(given.object, "configurations", {-1, static_cast<std::int64_t>(query.coordinates())}, shape);
  std::vector<ConfigurationVerdict> verdicts(shape[0]);
  without_gil([&] { check(query, values, verdicts, CallWorkers(threads)); });
  return {column<bool>(verdicts, [](const auto& v) { return v.is_free(); }),
          column<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.link); }),
          column<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.other_link); }),
          column<std::int64_t>(verdicts, [](const auto& v) { return number_or_less(v.obstacle); })};
}

constexpr const char* results =
    " Returns arrays of one entry per configuration: free (bool), link, other_link and obstacle (int64, -1 for none). "
    "The contact is that of the lowest link that touches an obstacle, with the lowest obstacle that it touches; "
    "otherwise the first pair of links that touch. workers: threads; by default the caller's alone.";

}  // namespace

void bind_robot_configurations(nb::module_& m) {
  nb::class_<HeldQuery>(m, "ConfigurationQuery", doc::ConfigurationQuery)
      .def(
          "__init__",
          [](HeldQuery* self, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored) {
            ConfigurationQuery made = without_gil(
                [&] { return ConfigurationQuery(robot, spheres, ignored ? *ignored : robot::SelfCollision{}); });
            new (self) HeldQuery(std::move(made));
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(),
          doc::ConfigurationQuery_ConfigurationQuery)
      .def_prop_ro(
          "coordinates", [](const HeldQuery& self) { return self.copy().coordinates(); },
          doc::ConfigurationQuery_coordinates)
      .def(
          "set_base",
          [](HeldQuery& self, TransformGiven given) {
            const RigidTransform base = transform_of(given, "base");
            self.change([&](ConfigurationQuery& query) { query.set_base(base); });
          },
          nb::arg("base"), doc::ConfigurationQuery_set_base)
      .def(
          "attach",
          [](HeldQuery& self, const std::string& link, ArrayGiven given, const std::vector<std::string>& touching) {
            const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
            self.change([&](ConfigurationQuery& query) { query.attach(link, spheres, touching); });
          },
          nb::arg("link"), nb::arg("spheres"), nb::arg("touching") = std::vector<std::string>{},
          doc::ConfigurationQuery_attach)
      .def(
          "check",
          [](const HeldQuery& self, ArrayGiven given, const HeldWorld& world, Threads* workers) {
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
          [](const HeldQuery& self, ArrayGiven given, Threads* workers) {
            return check_with(self, given, workers,
                              [&](const ConfigurationQuery& query, std::span<const double> values,
                                  std::span<ConfigurationVerdict> verdicts,
                                  Workers& threads) { query.check_self(values, verdicts, threads); });
          },
          nb::arg("configurations"), nb::kw_only(), nb::arg("workers") = nb::none(),
          (std::string("Checks configurations, (n, coordinates), of the robot against itself alone.") + results)
              .c_str());
}

}  // namespace morula::python
