// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the study looks at: bodies × trees × motions × rules, as plain values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <morula/generators/build.hpp>
#include <morula/update/rules.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/experiment.hpp"
#include "shared/report.hpp"

namespace morula::cli {

/// How spheres follow: a rule per level; `exact` with re-fitting; or a tree built anew at sampled poses, which no
/// update can be expected to beat.
struct StudyRule {
  enum class Kind : std::uint8_t { update, refitted, fresh };
  std::string name;
  Kind kind = Kind::update;
  UpdateOptions options{};  // of `update`
};

/// A tree of one body: of a generator, or from a file.
struct StudySource {
  std::size_t body = 0;
  std::string method;
  std::optional<Method> generator;
  std::filesystem::path file;
};

/// What looseness is divided by.
enum class ErrorUnit : std::uint8_t {
  volume,  ///< the object's volume in that sample
  box,     ///< the volume of the object's box at rest: "object dimensions"
};

struct StudyPlan {
  std::vector<NamedMesh> bodies;
  std::vector<StudySource> sources;
  std::vector<Deformations> motions;
  std::vector<StudyRule> rules;
  std::vector<StudyRule> mixes;  // on the first source and all motions
  std::size_t samples = 13;      // of each motion, from rest to the full amount
  int resolution = 192;          // of the paper's grid; of the fixed lattice, per diagonal at rest
  int branching = 8;
  int depth = 3;
  std::uint64_t seed = 1;
  std::size_t fresh_poses = 2;  // beside rest, of the medial tree; the last at the full amount
  double protrusion_tolerance = 0.05;
  ErrorUnit unit = ErrorUnit::volume;
  std::size_t needle_sides = 64;  // of a prism of long thin triangles, for void spheres; 0: none
  int cost_repeats = 9;
  std::vector<StudySource> press_sources;                         // beside `sources`: trees that are only pressed
  std::vector<StudyRule> press_rules;                             // of kind `update`; none: nothing is pressed
  std::vector<double> press_amounts{0.001, 0.01, 0.02, 0.05};     // shares of the diagonal at rest
  std::vector<std::size_t> press_budgets{100, 500, 2000, 10000};  // pair tests
  Deformations press_pose{Bend{45.0, Axis::automatic}};
  std::string sph_origin = "none";

  /// 0 at rest, 1 at the full amount; one per sample.
  std::vector<double> parameters() const;
  /// The samples at which trees are built anew, rest first. Builds take the most time of a study, so only the trees of
  /// Fig. 2 a and b get more than the full amount.
  std::vector<std::size_t> fresh_samples(const StudySource& source) const;
  /// The levels that are measured: the last two, as in the paper.
  std::vector<std::size_t> levels() const;
  bool has_method(std::string_view name) const;
  bool has_rule(std::string_view name) const;
};

/// The generators of the paper, in its order.
std::vector<std::string> paper_methods();
/// Names that --rules takes: all rules that follow positions, `refitted`, `fresh`.
std::vector<std::string> study_rule_names();
StudyRule study_rule(const std::string& name);
/// Every rule on the inner levels with every rule on the leaves, as it is and made to cover.
std::vector<StudyRule> rule_mixes(int depth);

/// A prism of many sides and no division along: its sides are long thin triangles.
Mesh needle_prism(std::size_t sides);

/// What decides the figures: of the whole plan, without bodies, trees and threads.
Json settings_json(const StudyPlan& plan);

}  // namespace morula::cli
