// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The demo's second experiment: two limbs that deform and touch, asked for contacts under budgets.
#pragma once

#include <filesystem>
#include <morula/generators/build.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

/// One budget, over all frames.
struct TouchRow {
  std::optional<std::size_t> budget;  // in pair tests per frame; none: all there is to do
  double contacts = 0;                // per frame, in the mean
  double finished_share = 0;          // of the contacts
  std::size_t missed = 0;             // crossings with a point outside all contacts
  double mean_error_bound = 0;        // as a share of the box's diagonal at rest
  double pair_tests = 0;              // per frame, in the mean
  double microseconds = 0;            // median, one thread
};

struct DemoTouch {
  std::size_t frame_count = 0;
  std::vector<std::size_t> crossings;  // per frame: pairs of facets that really intersect, by brute force
  std::vector<TouchRow> rows;

  std::size_t crossing_count() const;
};

/// Of a limb and the tree that was built for it. Writes both limbs of the middle frame into `folder`, where they are in
/// the world: limb-touching-a.obj and limb-touching-b.obj.
DemoTouch run_touch(const Mesh& limb, const Built& built, int repeats, const std::filesystem::path& folder);

std::string touch_table(const DemoTouch& touch);
/// What the table shows: chosen by looking at the figures.
std::string touch_finding(const DemoTouch& touch);
/// A crossing outside all contacts must never happen, at no budget.
std::vector<std::string> touch_faults(const DemoTouch& touch);
std::string touch_csv(const DemoTouch& touch);
Json touch_json(const DemoTouch& touch);

}  // namespace morula::cli
