// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Front: the progress of a query as plain values, which can be copied, stored and continued.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <vector>

namespace morula {

/// The pairs of nodes that a query has opened, with the verdict on each pair below them, and the pairs that wait to be
/// opened. The waiting pairs, with the finished and separated pairs that follow from the verdicts, are a complete cut:
/// every pair of final nodes is in it or below exactly one pair of it. ContactQuery::cut() lists them.
struct Front {
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// The state of a body that the verdicts are based on.
  struct Side {
    std::uint64_t cover_id = 0, frame = 0;
    RigidTransform transform;
    Vec3 origin;
    std::vector<Spheref> spheres;
    /// One per node: length of its path since the front was begun, including changes of its radius, or the longest path
    /// of its children; mesh units. Sums are rounded up, and the difference of two of them is at least the path between
    /// them.
    std::vector<double> path_length;
    bool operator==(const Side&) const = default;
  };
  enum class Verdict : std::uint8_t { untested, separated, overlapping };
  struct Pair {
    Side a, b;
    Verdict roots = Verdict::untested;
    std::uint32_t opened_roots = none;  ///< index in `opened`
    std::array<Vec3, 3> rows;           ///< rotation from b's own coordinates to a's
    Vec3 translation;
    double pad = 0;  ///< sum of the margin and the allowance that pair tests add to the radii, mesh units; larger far
                     ///< from the origin
    /// Mesh units: rounding alone may change verdicts on pairs that are nearer to touching than this.
    double rounding = 0;
    bool operator==(const Pair&) const = default;
  };
  struct Opened {
    std::uint32_t pair, a, b, depth;
    std::uint32_t first_mask;  ///< index of its masks, one per child of b; bit i: the i-th child of a overlaps it
    std::uint32_t first_below, next_beside;  ///< list of the opened pairs below this one
    double clearance;                     ///< the verdicts hold while the paths of a and b sum up to less, mesh units
    double path_length_a, path_length_b;  ///< paths of a and b at the time of opening, mesh units
    bool operator==(const Opened&) const = default;
  };
  struct Waiting {
    float priority;
    std::uint32_t order;  ///< order of discovery; it decides among equal priorities
    std::uint32_t pair, a, b, depth;
    std::uint32_t above;   ///< opened pair above this one; none for roots
    std::uint32_t before;  ///< place of the pair in the previous frame, for the query that made it
    bool operator==(const Waiting&) const = default;
  };

  std::uint32_t level = none;  ///< level set; none: the leaves
  double margin = 0;
  std::vector<Pair> pairs;
  std::vector<Opened> opened;
  std::vector<std::uint64_t> masks;
  std::vector<Waiting> waiting;  ///< overlapping pairs that are not opened
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
