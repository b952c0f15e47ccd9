// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Driver: the root, the divisions that count, and the report, for both orders of building.
#pragma once

#include "generators/driver/top_down.hpp"

namespace morula::detail {

/// The node that owns the whole surface.
BuildNode root_node(const MeshView& mesh, const BuildRun& run, const Box& cell);

/// The node's children, with level and seed; none if a division would gain nothing.
Division children_of(const BuildNode& node, const Divider& divide, double too_small);
/// Regions with a smaller radius count as points.
double smallest_radius(const BuildRun& run);

/// The report with everything that is computed before the first division.
BuildReport new_report(const MeshView& mesh, const BuildRun& run);

/// How often each reducer's proposal was used, in the order of first use.
class Winners {
 public:
  void add(const Division& division);
  /// Empty if there was no choice and no fallback.
  std::string note() const;

 private:
  std::vector<std::pair<std::string_view, std::size_t>> counts_;
};

/// Worst leaf first, for options.spheres and options.max_protrusion.
CoveredTree best_first(const MeshView& mesh, const BuildRun& run, const Box& root_cell, const Divider& divide,
                       const SignedDistance& shape, Workers& workers);

}  // namespace morula::detail
