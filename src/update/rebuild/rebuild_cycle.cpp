// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/rebuild_cycle.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace morula::detail {
namespace {

// Estimated frames of the first rebuild, until one has ended; and a limit, because no motion continues straight
// forever.
constexpr std::size_t first_guess = 20;
constexpr double furthest_lead = 40;
constexpr double longest_pause = 1e6;  // seconds: a clock can add them
// A rebuild is over after one rebuild's time and then serves for about another.
constexpr double lead_over_rebuild = 1.5;

}  // namespace

RebuildCycle::RebuildCycle(const RebuildOptions& options, RebuildReport& report, std::shared_ptr<RebuildJob> job)
    : options_(options), report_(report), job_(std::move(job)) {
  report_.rebuild_frames = first_guess;
  if (options_.thread == RebuildThread::background) thread_.emplace();
}

RebuildCycle::~RebuildCycle() {
  job_->request_stop();
}

void RebuildCycle::step(Event event, const Moment& now) {
  switch (event) {
    case Event::wanted:
      assert(phase_ == Phase::idle);
      phase_ = Phase::gathering;
      next_pose_ = looks_ahead() ? 0 : RebuildJob::pose_count - 1;
      [[fallthrough]];
    case Event::frame:
      if (phase_ == Phase::gathering) take_pose(now);
      break;
    case Event::at_rest:
      // mutant rebuild-poses-kept-at-rest: `phase_ == Phase::gathering` -> `false`
      if (phase_ == Phase::gathering) phase_ = Phase::idle;
      [[fallthrough]];
    case Event::body_stopped:
      if (phase_ == Phase::building) job_->request_stop();
      break;
    case Event::collected:
      phase_ = Phase::idle;
      break;
  }
}

bool RebuildCycle::may_start() const noexcept {
  if (options_.thread == RebuildThread::none || phase_ != Phase::idle) return false;
  return options_.thread == RebuildThread::caller || Clock::now() >= next_start_;
}

bool RebuildCycle::is_under_way() const noexcept {
  return phase_ == Phase::gathering || (phase_ == Phase::building && !is_done());
}

bool RebuildCycle::is_done() const noexcept {
  return job_->stage() == RebuildJob::Stage::done;
}

RebuildJob::Result RebuildCycle::collect(const Moment& now) {
  RebuildJob::Result result = job_->take();
  const std::chrono::duration<double> pause(
      std::min(longest_pause, result.seconds * (1 / options_.processor_share - 1)));
  next_start_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(pause);
  step(Event::collected, now);
  if (result.tree) {
    ++report_.finished;
    report_.rebuild_seconds = result.seconds;
    report_.rebuild_frames = now.frame - start_frame_;
  } else if (result.failure.empty()) {
    ++report_.stopped;
  } else {
    ++report_.failed;
    report_.failure = std::move(result.failure);
  }
  return result;
}

// Not on the caller's thread: there the pose is still the same when the rebuild is done.
bool RebuildCycle::looks_ahead() const noexcept {
  return options_.thread != RebuildThread::caller && options_.look_ahead;
}

// Steps to the middle of the time that the new tree will serve.
int RebuildCycle::steps_ahead() const noexcept {
  return static_cast<int>(
      std::lround(std::min(furthest_lead, lead_over_rebuild * static_cast<double>(report_.rebuild_frames))));
}

// One pose is enough to build for itself; to look ahead takes three, a frame apart.
void RebuildCycle::take_pose(const Moment& now) {
  job_->set_pose(next_pose_++, now.positions);
  if (next_pose_ < RebuildJob::pose_count) return;
  phase_ = Phase::idle;  // the phase if the start fails
  start(now);
}

void RebuildCycle::start(const Moment& now) {
  start_frame_ = now.frame;
  job_->queue(looks_ahead() ? steps_ahead() : 0, now.quality);
  phase_ = Phase::building;
  ++report_.started;
  switch (options_.thread) {
    case RebuildThread::caller:
      job_->run();
      break;
    case RebuildThread::none:
      break;
    case RebuildThread::background:
      thread_->run(job_);
      break;
    case RebuildThread::host:
      options_.executor([job = job_] { job->run(); });
      break;
  }
}

}  // namespace morula::detail
