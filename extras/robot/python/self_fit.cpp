// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// False self-collisions of spheres.
#include <array>
#include <map>
#include <morula/morula.hpp>
#include <morula/robot/self_fit.hpp>
#include <optional>
#include <set>
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
      .field("false_share", &SelfPairRate::false_share, doc::SelfPairRate_false_share)
      .field("always_collides", &SelfPairRate::always_collides, doc::SelfPairRate_always_collides);
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
  using robot::SelfFit;
  using robot::SelfFitStep;
  Record<SelfFitStep>(m, "SelfFitStep", doc::SelfFitStep)
      .field("spheres", &SelfFitStep::spheres)
      .field("false_share", &SelfFitStep::false_share, doc::SelfFitStep_false_share);
  Record<SelfFit>(m, "SelfFit", doc::SelfFit)
      .field("spheres", &SelfFit::spheres)
      .field("rates", &SelfFit::rates, doc::SelfFit_rates)
      .field("evenly", &SelfFit::evenly, doc::SelfFit_evenly)
      .field("total", &SelfFit::total, doc::SelfFit_total)
      .field("steps", &SelfFit::steps, doc::SelfFit_steps)
      .shown({"total", "rates", "evenly", "steps"});
  m.def(
      "fit_for_self_collision",
      [](const robot::Robot& robot, std::optional<std::size_t> spheres, std::optional<std::size_t> max_total,
         const std::map<std::string, std::size_t>& link_spheres, double tolerance, double padding, double min_radius,
         bool visual, const std::set<std::string>& skip, std::uint64_t seed, std::size_t samples,
         const std::vector<std::array<std::string, 2>>& given, const nb::object& progress, Threads* workers) {
        robot::FitOptions fit;
        fit.spheres = spheres;
        fit.max_total = max_total;
        fit.link_spheres = link_spheres;
        fit.tolerance = tolerance;
        fit.padding = padding;
        fit.min_radius = min_radius;
        fit.visual = visual;
        fit.skip = skip;
        fit.seed = seed;
        fit.progress = progress_of(progress);
        return without_gil([&] {
          return robot::fit_for_self_collision(robot, fit, {.samples = samples, .given = given}, CallWorkers(workers));
        });
      },
      nb::arg("robot"), nb::kw_only(), nb::arg("spheres") = nb::none(), nb::arg("max_total") = nb::none(),
      nb::arg("link_spheres") = std::map<std::string, std::size_t>{}, nb::arg("tolerance") = 0.0,
      nb::arg("padding") = 0.0, nb::arg("min_radius") = 0.0, nb::arg("visual") = false,
      nb::arg("skip") = std::set<std::string>{}, nb::arg("seed") = 1, nb::arg("samples") = 1000,
      nb::arg("given") = std::vector<std::array<std::string, 2>>{}, nb::arg("progress") = nb::none(),
      nb::arg("workers") = nb::none(),
      nb::sig("def fit_for_self_collision(robot: Robot, *, spheres: int | None = None, max_total: int | None = None, "
              "link_spheres: dict[str, int] = {}, tolerance: float = 0.0, padding: float = 0.0, min_radius: float = "
              "0.0, visual: bool = False, skip: set[str] = set(), seed: int = 1, samples: int = 1000, given: "
              "collections.abc.Sequence[collections.abc.Sequence[str]] = [], progress: "
              "collections.abc.Callable[[float, str], object] | None = None, workers: morula._morula.Workers | None = "
              "None) -> SelfFit"),
      with_arguments(doc::fit_for_self_collision, {{"spheres", doc::FitOptions_spheres},
                                                   {"max_total", doc::FitOptions_max_total},
                                                   {"link_spheres", doc::FitOptions_link_spheres},
                                                   {"tolerance", doc::FitOptions_tolerance},
                                                   {"padding", doc::FitOptions_padding},
                                                   {"min_radius", doc::FitOptions_min_radius},
                                                   {"visual", doc::FitOptions_visual},
                                                   {"skip", doc::FitOptions_skip},
                                                   {"samples", doc::SelfFitOptions_samples},
                                                   {"given", doc::SelfFitOptions_given}})
          .c_str());
}

}  // namespace morula::python
