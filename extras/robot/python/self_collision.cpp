// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of links that need not be tested against each other.
#include <array>
#include <morula/morula.hpp>
#include <morula/robot/self_collision.hpp>
#include <string>
#include <vector>

#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_self_collision(nb::module_& m) {
  using robot::IgnoredPair;
  using robot::SelfCollision;
  Record<IgnoredPair>(m, "IgnoredPair", "Two links that need not be tested against each other, with the reason.")
      .property(
          "a", [](const IgnoredPair& p) { return index_or_none(p.a); }, doc::IgnoredPair_a)
      .property(
          "b", [](const IgnoredPair& p) { return index_or_none(p.b); }, doc::IgnoredPair_a)
      .property(
          "reason",
          [](const IgnoredPair& p) -> std::string {
            switch (p.reason) {
              case robot::IgnoreReason::given:
                return "given";
              case robot::IgnoreReason::adjacent:
                return "adjacent";
              case robot::IgnoreReason::rest:
                return "rest";
              case robot::IgnoreReason::apart:
                return "apart";
              case robot::IgnoreReason::never:
                break;
            }
            return "never";
          },
          "given, adjacent, rest, apart (proven) or never (sampled).");
  using robot::OverlappingPair;
  Record<OverlappingPair>(m, "OverlappingPair", doc::OverlappingPair)
      .property(
          "a", [](const OverlappingPair& p) { return index_or_none(p.a); }, doc::OverlappingPair_a)
      .property(
          "b", [](const OverlappingPair& p) { return index_or_none(p.b); }, doc::OverlappingPair_a)
      .field("rest_distance", &OverlappingPair::rest_distance, doc::OverlappingPair_rest_distance)
      .field("share", &OverlappingPair::share, doc::OverlappingPair_share)
      .shown({"a", "b", "rest_distance", "share"});
  Record<SelfCollision>(m, "SelfCollision", "Pairs of links that a planner need not test against each other.")
      .field("ignored", &SelfCollision::ignored, doc::SelfCollision_ignored)
      .field("samples", &SelfCollision::samples, doc::SelfCollision_samples)
      .field("pairs", &SelfCollision::pairs, doc::SelfCollision_pairs)
      .field("overlapping", &SelfCollision::overlapping, doc::SelfCollision_overlapping)
      .field("notes", &SelfCollision::notes, doc::SelfCollision_notes)
      .property(
          "never_bound", [](const SelfCollision& s) { return s.never_bound(); }, doc::SelfCollision_never_bound)
      .shown({"ignored", "samples", "pairs"});
  m.def(
      "find_ignored",
      [](const robot::Robot& robot, const robot::RobotSpheres& spheres, std::size_t samples, std::uint64_t seed,
         const std::vector<std::array<std::string, 2>>& given, Threads* workers) {
        return without_gil([&] {
          return robot::find_ignored(robot, spheres, {.samples = samples, .seed = seed, .given = given},
                                     CallWorkers(workers));
        });
      },
      nb::arg("robot"), nb::arg("spheres"), nb::kw_only(), nb::arg("samples") = 100000, nb::arg("seed") = 1,
      nb::arg("given") = std::vector<std::array<std::string, 2>>{}, nb::arg("workers") = nb::none(),
      nb::sig("def find_ignored(robot: Robot, spheres: RobotSpheres, *, samples: int = 100000, seed: int = 1, "
              "given: collections.abc.Sequence[collections.abc.Sequence[str]] = [], workers: morula._morula.Workers | "
              "None = None) -> SelfCollision"),
      with_arguments("The pairs of links that need no test against each other.",
                     {{"samples", doc::SelfCollisionOptions_samples}, {"given", doc::SelfCollisionOptions_given}})
          .c_str());
  m.def(
      "overlap",
      [](ArrayGiven a, const RigidTransform& at_a, ArrayGiven b, const RigidTransform& at_b) {
        return robot::overlap(spheres_of(a.object, "a"), at_a, spheres_of(b.object, "b"), at_b);
      },
      nb::arg("a"), nb::arg("at_a"), nb::arg("b"), nb::arg("at_b"),
      "True if the spheres of two links overlap, with the links at these poses.");
  m.def(
      "read_ignored_pairs", [](const FilePath& srdf) { return robot::read_ignored_pairs(srdf); }, nb::arg("srdf"),
      doc::read_ignored_pairs);
}

}  // namespace morula::python
