// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness watch: estimates how loose the present tree is, a share in each frame, and so tells when a rebuild is
// wanted.
//
//             estimate as the last one              settle(): a rebuild was asked for
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

  /// Another tree serves: gives up the estimate under way, and expects of it what it was where it was made.
  void follow(const TreeVersion& present) noexcept;
  /// The body is at rest: gives up the estimate under way.
  void rest(const TreeVersion& home) noexcept;
  /// Begins an estimate of the present tree, which is at these positions.
  void begin(const PositionView& positions, const TreeVersions& trees) noexcept;
  /// Does a frame's share. True with the last one, when the figures are in the report and the trees have learned them.
  bool step(TreeVersions& trees) noexcept;

  /// Some level is above its threshold.
  bool has_grown() const noexcept;
  /// The tree was made for another pose than this.
  bool is_off_build(const TreeVersion& present) const noexcept;
  /// A tree made for this very pose is no better: the pose has to change before another try.
  void raise_thresholds() noexcept;
  /// A rebuild was asked for: if the body has stopped, it is the one for that pose.
  void settle() noexcept;

 private:
  std::size_t steps() const noexcept;

  const RebuildOptions& options_;
  RebuildReport& report_;
  LoosenessEstimator estimator_;
  std::vector<double> thresholds_;  // per level: above, a rebuild is wanted
  std::vector<double> estimated_;
  double strain_at_begin_ = 0;  // of the tree, at the estimate under way
  Motion motion_ = Motion::moving;
};

}  // namespace morula::detail
