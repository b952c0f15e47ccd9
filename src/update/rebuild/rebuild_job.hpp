// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rebuild job: takes a pose and makes a body for that pose, on the thread that runs it. One runs at a time.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/update/body.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <optional>
#include <string>
#include <vector>

#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Shared between the body and the runner of the job, so either may go first. `stage` says whose turn it is: the
/// owner's while idle or done, the runner's while queued; the side whose turn ends writes it.
class RebuildJob {
 public:
  /// Builds a tree of a posed mesh; empty: build().
  using Builder = std::function<CoveredTree(const MeshView& posed, const BuildOptions& options)>;
  /// levels: number of looseness figures to compute.
  RebuildJob(const MeshView& home, const BuildOptions& build, std::size_t levels, bool fits_leaves,
             Builder builder = {});

  enum class Stage : std::uint8_t { idle, queued, done };
  Stage stage() const { return stage_.load(std::memory_order_acquire); }

  // The owner's side.
  static constexpr std::size_t pose_count = 3;
  /// Sets a pose of a motion; the last pose is the latest, and all are equally far apart in time.
  void set_pose(std::size_t which, const PositionView& positions);
  /// The runner frees the tree, which takes as long as a frame.
  void retire(std::unique_ptr<TreeVersion> old) { retired_ = std::move(old); }
  /// steps: number of such intervals from the last pose to the one to build for; 0: the last pose itself, the only one
  /// that has to be set.
  void queue(int steps, Quality quality);
  void request_stop() { stop_.request_stop(); }
  /// The result of a job that is done; null if it was stopped or failed.
  TreeVersion* finished() { return result_.tree.get(); }
  struct Result {
    std::unique_ptr<TreeVersion> tree;  ///< null: stopped or failed
    std::string failure{};              ///< error text; empty: stopped
    double seconds = 0;
  };
  Result take();

  // The runner's side.
  void run() noexcept;

 private:
  std::unique_ptr<TreeVersion> rebuilt();
  CoveredTree built(Workers& workers) const;

  Mesh snapshot_;                // the last pose, then the one to build for
  std::vector<Vec3> last_pose_;  // the last pose, if the one to build for is another
  std::array<std::vector<Vec3>, pose_count - 1> earlier_;
  int steps_ = 0;
  BuildOptions build_;
  Builder builder_;
  LoosenessEstimator estimator_;
  std::size_t levels_;
  bool fits_leaves_;
  StopSource stop_;
  std::unique_ptr<TreeVersion> retired_{};
  Result result_{};
  std::atomic<Stage> stage_{Stage::idle};
};

/// A thread that waits for jobs; none if the library is built without threads.
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
