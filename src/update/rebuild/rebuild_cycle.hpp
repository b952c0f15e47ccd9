// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rebuild cycle: the life of a rebuild, from the frame that requests one to the frame that takes its result.
//
//           wanted, where may_start()
//   +------+ ------------------------> +-----------+
//   | idle |                           | gathering | --+ frame: takes a pose,
//   +------+ <------------------------ +-----------+ <-+ with others to come
//      ^       at_rest: the motion is over   |
//      |                                     | frame: takes the last pose and hands the job to its thread,
//      |                                     | in the same frame where one pose is enough
//      |  collected: the result is taken     v
//      |  over, not tighter, stopped,  +----------+
//      +------------------------------ | building | --+ at_rest, body_stopped: asks the job
//         or failed                    +----------+ <-+ to stop, which ends it sooner
//
// The job runs on another thread. When it ends, is_done() holds, and the next frame away from rest collects it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <morula/update/rebuilt_body.hpp>
#include <optional>

#include "update/rebuild/rebuild_job.hpp"

namespace morula::detail {

class RebuildCycle {
 public:
  enum class Phase : std::uint8_t { idle, gathering, building };
  enum class Event : std::uint8_t {
    frame,         ///< a frame away from rest
    wanted,        ///< a rebuild is due for the present pose or the one to come; only if may_start()
    body_stopped,  ///< the body stands still away from rest: a rebuild for another pose is of no use
    at_rest,       ///< the body is exactly at rest
    collected,     ///< the result was taken from the job
  };
  /// State of the rebuilt body at the frame of an event.
  struct Moment {
    std::uint64_t frame;
    const PositionView& positions;
    Quality quality;  ///< quality of a build that starts in this frame
  };

  /// options and report: borrowed, and at one place. Counts the outcomes of rebuilds in the report.
  RebuildCycle(const RebuildOptions& options, RebuildReport& report, std::shared_ptr<RebuildJob> job);
  ~RebuildCycle();
  RebuildCycle(const RebuildCycle&) = delete;
  RebuildCycle& operator=(const RebuildCycle&) = delete;

  /// The one place where the phase changes. Throws the errors of the host's executor, and for lack of memory: the phase
  /// then stays, so an executor that throws is never called again.
  void step(Event event, const Moment& now);

  /// Whether no rebuild is in progress, and the pause after the last one is over.
  bool may_start() const noexcept;
  /// Whether poses are collected or the job runs.
  bool is_under_way() const noexcept;
  /// Whether the job has ended and waits to be collected.
  bool is_done() const noexcept;
  /// The tree that a finished job built; null if it was stopped or failed.
  TreeVersion* result() const noexcept { return job_->finished(); }
  /// Takes the result out of the job and returns to idle.
  RebuildJob::Result collect(const Moment& now);
  /// The job frees the tree on its thread, which takes as long as a frame.
  void retire(std::unique_ptr<TreeVersion> old) { job_->retire(std::move(old)); }

 private:
  using Clock = std::chrono::steady_clock;

  bool looks_ahead() const noexcept;
  int steps_ahead() const noexcept;
  void take_pose(const Moment& now);
  void start(const Moment& now);

  const RebuildOptions& options_;
  RebuildReport& report_;
  Phase phase_ = Phase::idle;
  std::size_t next_pose_ = 0;      // while gathering
  std::uint64_t start_frame_ = 0;  // frame in which the build began
  Clock::time_point next_start_{};
  std::shared_ptr<RebuildJob> job_;
  std::optional<OwnThread> thread_;  // last member: it is destroyed first
};

}  // namespace morula::detail
