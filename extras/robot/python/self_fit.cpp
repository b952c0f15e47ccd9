// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// False self-collisions of spheres.
#include <array>
#include <morula/morula.hpp>
#include <morula/robot/self_fit.hpp>
#include <string>
#include <vector>

#include "building.hpp"
#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_self_fit(nb::module_& m) {
  using robot::SelfPairRate;
  using robot::SelfRates;
  Record<SelfPairRate>(m, "SelfPairRate", doc::SelfPairRate)
      .property(
          "a", [](const SelfPairRate& p) { return index_or_none(p.a); }, doc::SelfPairRate_a)
      .property(
          "b", [](const SelfPairRate& p) { return index_or_none(p.b); }, doc::SelfPairRate_a)
      .field("spheres", &SelfPairRate::spheres, doc::SelfPairRate_spheres)
      .field("surfaces", &SelfPairRate::surfaces, doc::SelfPairRate_surfaces)
      .field("false_share", &SelfPairRate::false_share, doc::SelfPairRate_false_share);
  Record<SelfRates>(m, "SelfRates", doc::SelfRates)
      .field("samples", &SelfRates::samples)
      .field("spheres", &SelfRates::spheres, doc::SelfRates_spheres)
      .field("surfaces", &SelfRates::surfaces, doc::SelfRates_surfaces)
      .field("false_share", &SelfRates::false_share, doc::SelfRates_false_share)
      .field("pairs", &SelfRates::pairs, doc::SelfRates_pairs)
      .shown({"samples", "spheres", "surfaces", "false_share", "pairs"});
  m.def(
      "self_collision_rates",
      [](const robot::Robot& robot, const robot::RobotSpheres& spheres, const robot::SelfCollision* ignored,
         std::size_t samples, std::uint64_t seed, const nb::object& progress, Threads* workers) {
        const std::vector<robot::IgnoredPair> pairs = ignored ? ignored->ignored : std::vector<robot::IgnoredPair>{};
        robot::SelfRateOptions options{.samples = samples, .seed = seed};
        options.progress = progress_of(progress);
        return without_gil(
            [&] { return robot::self_collision_rates(robot, spheres, pairs, options, CallWorkers(workers)); });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::arg("ignored") = nb::none(), nb::kw_only(), nb::arg("samples") = 1000,
      nb::arg("seed") = 1, nb::arg("progress") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def self_collision_rates(robot: Robot, spheres: RobotSpheres, ignored: SelfCollision | None = None, *, "
              "samples: int = 1000, seed: int = 1, progress: collections.abc.Callable[[float], object] | None = None, "
              "workers: morula._morula.Workers | None = None) -> SelfRates"),
      with_arguments(doc::self_collision_rates, {{"samples", doc::SelfRateOptions_samples},
                                                 {"seed", doc::SelfRateOptions_seed},
                                                 {"progress", "called with the completed share at intervals"}})
          .c_str());
}

}  // namespace morula::python
