// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Variants of Approach 1 and 2: every reading of the paper's sentences where they are ambiguous, as rules of the study.
#pragma once

#include <cstdint>
#include <morula/study/study.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// One reading. Defaults are the library's choices: docs/reference/update_rules.md.
struct Variant {
  enum class Approach : std::uint8_t { first, second };
  Approach approach = Approach::first;
  std::string name{};  ///< "approach1-area": a name of a rule
  std::string text{};  ///< the reading as text
  /// Weights of linked vertices in the center of Approach 1.
  enum class Weights : std::uint8_t { uniform, area, inverse_distance };
  Weights weights = Weights::uniform;
  /// Inner nodes of Approach 1 weigh the displacements of their children's centers by inverse distance.
  bool weighs_children = false;
  /// Inner nodes follow the vertices that their own sphere is linked to: the center of Approach 1, the box of
  /// Approach 2. Otherwise they follow their children.
  bool inner_vertices = false;
  /// Boxes of inner nodes of Approach 2 hold the children's centers instead of their spheres.
  bool boxes_of_centers = false;
  /// Distances below this share of the radius are raised before Approach 1 divides by them.
  double distance_floor = 0;
  /// The vertices that a sphere is linked to: those of the facets that meet it; those in it; those of the facets in its
  /// node's region; the eight nearest to its center. A sphere without any takes those of the nearest facet.
  enum class Links : std::uint8_t { facets, enclosed, region, nearest };
  Links links = Links::facets;
};

/// The library's choices first, for each approach.
std::vector<Variant> paper_variants();

/// The rule of a variant, plain and in the arithmetic of the library: for the library's choices, its spheres bit for
/// bit, near the origin. Its version is that of the library.
std::shared_ptr<const OwnRule> rule_of(const Variant& variant);

/// The verdict on one claim of the paper.
struct VariantVerdict {
  std::string claim;  ///< id of the claim
  Verdict verdict = Verdict::undecided;
  std::string numbers{};
};

struct VariantResult {
  Variant variant;
  std::vector<VariantVerdict> verdicts{};  ///< in the order of variant_claims()
  double looseness_rest = 0;               ///< mean over motions and levels
  double looseness = 0;                    ///< mean over motions, levels and deformed samples
  double uncovered = 0;                    ///< worst share of the surface
};

/// Ids of the claims that are decided for each variant.
std::vector<std::string_view> variant_claims();

/// Runs all variants on the medial tree of the first body, or its first tree, with the motions, samples and levels of
/// the plan. Throws like run().
std::vector<VariantResult> run_variants(const Plan& plan, Workers& workers = serial_workers(),
                                        const RunOptions& options = {});

/// Variants × claims: verdicts, then mean looseness and uncovered area.
Table variants_table(const Plan& plan, const std::vector<VariantResult>& results);
}  // namespace morula::study
