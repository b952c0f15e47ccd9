// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Front: how far a query has come, as plain values, which may be copied, kept and continued.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <vector>

namespace morula {

/// The pairs of nodes that a query has opened, with the verdict on each pair below them, and those that wait to be
/// opened. Together with the finished and the separated pairs, which the verdicts tell, the waiting ones are a complete
/// cut: every pair of final nodes is in it or below exactly one pair of it. ContactQuery::cut() lists them.
struct Front {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// What the verdicts are about.
  struct Side {
    std::uint64_t cover_id = 0, frame = 0;
    RigidTransform transform;
    Vec3 origin;
    std::vector<Spheref> spheres;
    /// Per node: how far it has come since the front was begun, its radius included, or the farthest of its children.
    /// Sums that are rounded up: two of them differ by no less than what was traveled between.
    std::vector<double> path_length;
    bool operator==(const Side&) const = default;
  };
  enum class Verdict : std::uint8_t { untested, separated, overlapping };
  struct Pair {
    Side a, b;
    Verdict roots = Verdict::untested;
    std::uint32_t opened_roots = none;  ///< in `opened`
    std::array<Vec3, 3> rows;           ///< from b's own coordinates to a's
    Vec3 translation;
    double pad = 0;       ///< what pair tests add to the radii, margin included: more when far from the origin
    double rounding = 0;  ///< verdicts on pairs that are nearer to touching than this may change by rounding alone
    bool operator==(const Pair&) const = default;
  };
  struct Opened {
    std::uint32_t pair, a, b, depth;
    std::uint32_t first_mask;                ///< one per node below b; bit i: the i-th below a overlaps it
    std::uint32_t first_below, next_beside;  ///< opened pairs below this one, in a list
    double clearance;                        ///< the verdicts hold while a and b travel less in sum
    double path_length_a, path_length_b;     ///< from here
    bool operator==(const Opened&) const = default;
  };
  struct Waiting {
    float priority;
    std::uint32_t order;  ///< of finding: among equals, first come, first served
    std::uint32_t pair, a, b, depth;
    std::uint32_t above;   ///< the opened pair that this one is below, or none
    std::uint32_t before;  ///< where it was opened in the previous frame, for the query that made it
    bool operator==(const Waiting&) const = default;
  };

  std::uint32_t level = none;  ///< none: the leaves
  double margin = 0;
  std::vector<Pair> pairs;
  std::vector<Opened> opened;
  std::vector<std::uint64_t> masks;
  std::vector<Waiting> waiting;  ///< overlapping, not opened
  std::uint32_t next_order = 0;

  bool operator==(const Front&) const = default;
};

/// A pair of the cut.
struct FrontPair {
  enum class State : std::uint8_t { separated, finished, waiting };
  std::uint32_t pair, a, b;
  State state;
  bool operator==(const FrontPair&) const = default;
};

}  // namespace morula
