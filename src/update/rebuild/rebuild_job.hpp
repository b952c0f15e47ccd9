// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rebuild job: a pose goes in, a body made for that pose comes out, on whatever thread runs it. One runs at a time.
#pragma once

#include <array>
#include <atomic>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Shared between the body and whoever runs the job, so either may go first. `stage` says whose turn it is: the owner's
/// while idle or done, the runner's while queued; whoever hands over does so by writing it.
class RebuildJob {
 public:
  /// levels: figures of looseness wanted.
  RebuildJob(const MeshView& home, const BuildOptions& build, std::size_t levels, bool fits_leaves);

  enum class Stage : std::uint8_t { idle, queued, done };
  Stage stage() const { return stage_.load(std::memory_order_acquire); }

  // Owner.
  static constexpr std::size_t pose_count = 3;
  /// Poses of a motion, the last one the latest, equally far apart in time.
  void set_pose(std::size_t which, const PositionView& positions);
  /// The runner frees it: that takes as long as a frame.
  void retire(std::unique_ptr<TreeVersion> old) { retired_ = std::move(old); }
  /// steps: how many such intervals after the last pose is the one to build for; 0: the last pose itself, the only one
  /// that has to be set.
  void queue(int steps, Quality quality);
  void request_stop() { stop_.request_stop(); }
  /// When done: what there is to take; nothing when stopped or failed.
  TreeVersion* finished() { return result_.tree.get(); }
  struct Result {
    std::unique_ptr<TreeVersion> tree;  ///< nothing: stopped or failed
    std::string failure{};              ///< empty: stopped
    double seconds = 0;
  };
  Result take();

  // Runner.
  void run() noexcept;

 private:
  std::unique_ptr<TreeVersion> rebuilt();

  Mesh snapshot_;                // the last pose, then the one to build for
  std::vector<Vec3> last_pose_;  // where that is another
  std::array<std::vector<Vec3>, pose_count - 1> earlier_;
  int steps_ = 0;
  BuildOptions build_;
  LoosenessEstimator estimator_;
  std::size_t levels_;
  bool fits_leaves_;
  std::stop_source stop_;
  std::unique_ptr<TreeVersion> retired_{};
  Result result_{};
  std::atomic<Stage> stage_{Stage::idle};
};

/// A thread that waits for jobs; none where the library is built without threads.
class OwnThread {
 public:
  OwnThread();
  ~OwnThread();
  void run(std::shared_ptr<RebuildJob> job);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula::detail
