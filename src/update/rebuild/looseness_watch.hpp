// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness watch: estimates how loose the present tree is, a share of the work in each frame, and so decides when a
// rebuild is due.
//
//             estimate as the last one              settle(): a rebuild was requested
//   +--------+ ---------------------> +---------+ ------------------------------------> +---------+
//   | moving |                        | stopped |                                       | settled |
//   +--------+ <--------------------- +---------+                                       +---------+
//       ^        estimate differs                                                            |
//       +------------------------------------------------------------------------------------+
//                                        estimate differs
#pragma once

#include <cstdint>
#include <morula/update/looseness_estimate.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <vector>

#include "update/rebuild/tree_versions.hpp"

namespace morula::detail {

class LoosenessWatch {
 public:
  enum class Motion : std::uint8_t { moving, stopped, settled };

  /// options and report: borrowed, and at one place. Writes the report's looseness. levels: of the home tree.
  LoosenessWatch(const MeshView& mesh, std::size_t levels, const RebuildOptions& options, RebuildReport& report);

  LoosenessEstimator& estimator() noexcept { return estimator_; }
  Motion motion() const noexcept { return motion_; }

  /// Drops the estimate in progress because another tree serves, and expects that tree's looseness at its build.
  void follow(const TreeVersion& present) noexcept;
  /// Drops the estimate in progress because the body is at rest.
  void rest(const TreeVersion& home) noexcept;
  /// Begins an estimate of the present tree, which is at these positions.
  void begin(const PositionView& positions, const TreeVersions& trees) noexcept;
  /// Does a frame's share. Returns true with the last one, when the figures are in the report and the trees have
  /// recorded them.
  bool step(TreeVersions& trees) noexcept;

  /// Whether a level is above its threshold.
  bool has_grown() const noexcept;
  /// Whether the tree was made for another pose than this.
  bool is_off_build(const TreeVersion& present) const noexcept;
  /// Raises the thresholds because a tree made for this very pose is no better: the pose has to change before another
  /// try.
  void raise_thresholds() noexcept;
  /// Records that a rebuild was requested: if the body has stopped, it is the one for that pose.
  void settle() noexcept;

 private:
  std::size_t steps() const noexcept;

  const RebuildOptions& options_;
  RebuildReport& report_;
  LoosenessEstimator estimator_;
  std::vector<double> thresholds_;  // thresholds per level; a rebuild is due above them
  std::vector<double> estimated_;
  double strain_at_begin_ = 0;  // strain of the tree at the start of the estimate in progress
  Motion motion_ = Motion::moving;
};

}  // namespace morula::detail
