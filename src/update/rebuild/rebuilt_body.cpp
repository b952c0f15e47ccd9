// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "update/points/narrow.hpp"
#include "update/rebuild/ownerships.hpp"
#include "update/rebuild/rebuild_depth.hpp"
#include "update/rebuild/rebuild_job.hpp"
#include "update/rebuild/relative_looseness.hpp"

namespace morula {
using namespace detail;
namespace {

using Clock = std::chrono::steady_clock;

// Before the first rebuild ends, nobody knows how long one takes; and motions do not go on straight for ever. Frames.
constexpr std::size_t first_guess = 20;
constexpr double furthest_lead = 40;
constexpr double longest_pause = 1e6;  // seconds: what a clock can add
// A rebuild is over after one rebuild's time and then serves for about another.
constexpr double lead_over_rebuild = 1.5;

void require_in_range(const RebuildOptions& o) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("rebuild: ") + what);
  };
  require(o.looser_by > 1, "looser_by must be above 1");
  require(o.check_every >= 1, "check_every must be at least 1");
  require(o.rebuild_every >= 0, "rebuild_every must not be negative");
  require(o.look_ahead_frames >= 0, "look_ahead_frames must not be negative");
  require(o.gain < 1, "gain must be below 1");
  require(o.processor_share > 0 && o.processor_share <= 1, "processor_share must be above 0 and at most 1");
  require(o.thread != RebuildThread::host || o.executor, "a host's thread needs an executor");
}

BuildOptions build_options(const RebuildOptions& options, const CoveredTree& home) {
  return {.method = options.method,
          .branching = static_cast<int>(home.tree.branching),
          .depth = depth_of_rebuilds(home),
          .seed = options.seed};
}

std::vector<std::uint32_t> used_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> used;
  for (const Facet& f : mesh.facets) used.insert(used.end(), f.begin(), f.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

// Shares by which figures of one ownership may differ for the pose to count as the same.
constexpr double still = 1e-3, as_built = 0.05;

bool all_within(double share, std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > share * std::max(negligible_looseness, b[i])) return false;
  return true;
}

// Frames over which one estimate is spread at most.
constexpr std::size_t most_steps = 8;

}  // namespace

struct RebuiltBody::State {
  State(const Mesh& mesh, const CoveredTree& built, RebuildOptions rebuild_options, Workers& workers);
  ~State();

  RebuildStatus update(const PositionView& positions, Workers& workers) noexcept;

  bool at_rest(const PositionView& positions) const noexcept;
  void stay_at_rest() noexcept;
  void check(const PositionView& positions, Workers& workers);
  void decide(const PositionView& positions, Workers& workers);

  std::size_t estimate_steps() const noexcept;
  void finish_estimate(const PositionView& positions) noexcept;
  bool has_grown() const noexcept;
  bool has_kept_its_shape(const PositionView& positions) noexcept;
  bool is_off_build() const noexcept;
  bool may_start() const noexcept;
  void request_rebuild(const PositionView& positions, Workers& workers);
  bool looks_ahead() const noexcept;
  void take_pose(const PositionView& positions, Workers& workers);
  int steps_ahead() const noexcept;
  void start(int steps, const PositionView& positions, Workers& workers);
  void collect(bool taken);
  void change_to(Epoch& next) noexcept;
  void raise_threshold() noexcept;

  RebuildOptions options;
  std::vector<Vec3> rest;
  std::vector<std::uint32_t> used;
  LoosenessEstimator estimator;
  Ownerships owned;
  std::array<std::vector<float>, 2> lengths;  // within leaves at rest, at this estimate and the one before
  double strain_now = 0;                      // of the present one, when the estimate under way was begun
  std::vector<double> threshold;              // of looseness, per level: above, a rebuild is wanted
  std::vector<double> estimated;
  RebuildReport report;
  std::uint64_t epoch = 0, frame = 0;
  bool is_still = false;                 // no other than at the estimate before
  bool settled = false;                  // a rebuild was asked for since the body became still
  std::uint64_t start_frame = 0;         // of the rebuild in hand
  std::optional<std::size_t> next_pose;  // that a rebuild waits for
  std::uint64_t next_pose_frame = 0;     // when it is to be taken
  Clock::time_point next_start{};
  std::shared_ptr<RebuildJob> job;
  std::optional<OwnThread> thread;  // last: it goes first
};

namespace {

ReownedBody::Ways ways_of(const RebuildOptions& options) {
  return {options.reown_tests > 0, options.fit_leaves};
}

void require_poses(const Mesh& mesh, const CoveredTree& built) {
  for (const KnownPose& pose : built.poses)
    // mutant known-size-at-use: `pose.built || pose.positions.size() != mesh.vertex_count()` -> `pose.built`
    if (!pose.built || pose.positions.size() != mesh.vertex_count())
      throw std::invalid_argument("rebuild: the known pose \"" + pose.name + "\" is not one of this mesh");
}

}  // namespace

RebuiltBody::State::State(const Mesh& mesh, const CoveredTree& built, RebuildOptions rebuild_options, Workers& workers)
    : options((require_in_range(rebuild_options), require_poses(mesh, built), std::move(rebuild_options))),
      rest(mesh.positions),
      used(used_vertices(mesh)),
      estimator(mesh, options.sample_count),
      owned(mesh, built, {options.gain, options.reown_tests, ways_of(options)}, estimator, workers),
      threshold(built.tree.level_count()),
      estimated(built.tree.level_count()),
      job(std::make_shared<RebuildJob>(mesh, build_options(options, built), options.sample_count,
                                       built.tree.level_count(), ways_of(options))) {
  for (std::vector<float>& of_estimate : lengths) of_estimate.resize(owned.home().gauge.length_count());
  report.rebuild_frames = first_guess;
  change_to(owned.home());
  epoch = 0;
  if (options.thread == RebuildThread::background) thread.emplace();
}

RebuiltBody::State::~State() {
  job->request_stop();
}

RebuildStatus RebuiltBody::State::update(const PositionView& positions, Workers& workers) noexcept {
  Epoch* chosen = &owned.present();
  const bool whole = positions.size() == rest.size(), resting = whole && at_rest(positions);
  const bool arrived = whole && !resting && job->stage() == RebuildJob::Stage::done;
  if (resting) {
    chosen = &owned.home();
  } else if (whole) {
    owned.measure(positions);
    const bool takes_over = arrived && job->finished() != nullptr && owned.takes_over(*job->finished(), positions);
    chosen = takes_over ? job->finished() : &owned.made_for_this();
  }
  Epoch* const present = &owned.present();
  RebuildStatus status{.update = owned.follow(*chosen, resting, positions, workers)};
  if (!status && chosen != present) status.update = owned.follow(*(chosen = present), resting, positions, workers);
  if (!status) return status;

  const std::uint64_t before = epoch;
  ++frame;
  if (chosen == present && !resting) {
    chosen = &owned.tightest_seen(frame, positions, workers);
    report.compared = owned.compared();
  }
  // A lack of memory, or the host's executor: rebuilding suffers, the spheres do not.
  try {
    if (chosen != present) {
      report.returned_home += chosen == &owned.home();
      report.recalled += owned.is_known(*chosen);
      change_to(*chosen);
    }
    if (arrived) collect(chosen == job->finished());
    if (resting)
      stay_at_rest();
    else
      check(positions, workers);
  } catch (...) {
    ++report.failed;
  }
  status.swapped = epoch != before;
  return status;
}

bool RebuiltBody::State::at_rest(const PositionView& positions) const noexcept {
  if (positions.is_double())
    return std::all_of(used.begin(), used.end(), [&](std::uint32_t v) { return positions[v] == rest[v]; });
  return std::all_of(used.begin(), used.end(),
                     [&](std::uint32_t v) { return positions[v] == nearest_floats(rest[v]); });
}

// Where patches change hands, figures go on changing after the body has stopped.
bool RebuiltBody::State::has_kept_its_shape(const PositionView& positions) noexcept {
  if (options.reown_tests == 0) return false;
  std::swap(lengths[0], lengths[1]);
  owned.home().gauge.measure(positions, lengths[0]);
  return StrainGauge::strain(lengths[0], lengths[1]) < still_strain;
}

bool RebuiltBody::State::has_grown() const noexcept {
  for (std::size_t level = first_counted_level(threshold.size()); level < threshold.size(); ++level)
    if (report.looseness[level] > threshold[level]) return true;
  return false;
}

void RebuiltBody::State::change_to(Epoch& next) noexcept {
  owned.serve(next);
  ++epoch;
  estimator.give_up();
  report.looseness = report.looseness_at_build = next.looseness_at_build;
  for (std::size_t level = 0; level < threshold.size(); ++level)
    threshold[level] = options.looser_by * std::max(negligible_looseness, next.looseness_at_build[level]);
}

void RebuiltBody::State::stay_at_rest() noexcept {
  // mutant rebuild-poses-kept-at-rest: `next_pose = std::nullopt` -> ``
  next_pose = std::nullopt;  // of a motion that is over
  job->request_stop();
  estimator.give_up();
  report.looseness = owned.home().looseness_at_build;
}

void RebuiltBody::State::check(const PositionView& positions, Workers& workers) {
  if (next_pose && next_pose_frame == frame) take_pose(positions, workers);
  const bool fixed = options.rebuild_every > 0;
  const bool due = frame % static_cast<std::uint64_t>(fixed ? options.rebuild_every : options.check_every) == 0;
  if (due) {
    ++report.checks;
    estimator.begin(positions, owned.present().body, estimate_steps());
    strain_now = owned.strain();
  }
  const bool is_known = estimator.step(estimated);
  if (is_known) finish_estimate(positions);
  if (!fixed && is_known) decide(positions, workers);
  if (fixed && due && may_start()) request_rebuild(positions, workers);
}

// On the caller's thread, frames take as long as a build anyway.
std::size_t RebuiltBody::State::estimate_steps() const noexcept {
  if (options.thread == RebuildThread::caller) return 1;
  const int period = options.rebuild_every > 0 ? options.rebuild_every : options.check_every;
  return std::min(most_steps, static_cast<std::size_t>(period));
}

void RebuiltBody::State::finish_estimate(const PositionView& positions) noexcept {
  const bool has_kept_shape = has_kept_its_shape(positions);
  is_still = has_kept_shape || all_within(still, estimated, report.looseness);
  settled = settled && is_still;
  report.looseness = estimated;
  owned.learn(estimated, strain_now);
}

void RebuiltBody::State::decide(const PositionView& positions, Workers& workers) {
  const bool settling = is_still && !settled && (!owned.home_serves() || is_off_build());
  if (settling) job->request_stop();  // of a pose that the body did not stop at
  if (!may_start() || !(settling || has_grown())) return;
  settled = is_still;
  request_rebuild(positions, workers);
}

bool RebuiltBody::State::is_off_build() const noexcept {
  return !all_within(as_built, report.looseness, owned.present().looseness_at_build);
}

bool RebuiltBody::State::may_start() const noexcept {
  if (options.thread == RebuildThread::none) return false;
  if (job->stage() != RebuildJob::Stage::idle || next_pose) return false;
  return options.thread == RebuildThread::caller || Clock::now() >= next_start;
}

// Not on the caller's thread: there the pose is still the same when the rebuild is done.
bool RebuiltBody::State::looks_ahead() const noexcept {
  return options.thread != RebuildThread::caller && options.look_ahead_frames > 0;
}

// One pose is enough to build for itself; to look ahead takes three.
void RebuiltBody::State::request_rebuild(const PositionView& positions, Workers& workers) {
  next_pose = looks_ahead() ? 0 : RebuildJob::pose_count - 1;
  take_pose(positions, workers);
}

void RebuiltBody::State::take_pose(const PositionView& positions, Workers& workers) {
  job->set_pose((*next_pose)++, positions);
  next_pose_frame = frame + static_cast<std::uint64_t>(options.look_ahead_frames);
  if (*next_pose < RebuildJob::pose_count) return;
  next_pose.reset();
  start(looks_ahead() ? steps_ahead() : 0, positions, workers);
}

// To the middle of the time that the new ownership will serve.
int RebuiltBody::State::steps_ahead() const noexcept {
  const double lead = std::min(furthest_lead, lead_over_rebuild * static_cast<double>(report.rebuild_frames));
  return static_cast<int>(std::lround(lead / options.look_ahead_frames));
}

void RebuiltBody::State::start(int steps, const PositionView& positions, Workers& workers) {
  start_frame = frame;
  job->queue(steps, settled ? options.still_quality : options.quality);
  ++report.started;
  switch (options.thread) {
    case RebuildThread::caller: {
      job->run();
      Epoch* const made = job->finished();
      const bool taken = made != nullptr && owned.takes_over(*made, positions) && made->body.update(positions, workers);
      if (taken) change_to(*made);
      collect(taken);
      break;
    }
    case RebuildThread::none:
      break;
    case RebuildThread::background:
      thread->run(job);
      break;
    case RebuildThread::host:
      options.executor([job = job] { job->run(); });
      break;
  }
}

// taken: it serves already, and was updated.
void RebuiltBody::State::collect(bool taken) {
  RebuildJob::Result result = job->take();
  const std::chrono::duration<double> pause(
      std::min(longest_pause, result.seconds * (1 / options.processor_share - 1)));
  next_start = Clock::now() + std::chrono::duration_cast<Clock::duration>(pause);
  if (!result.epoch) {
    ++(result.failure.empty() ? report.stopped : report.failed);
    if (!result.failure.empty()) report.failure = std::move(result.failure);
    return;
  }
  ++report.finished;
  report.rebuild_seconds = result.seconds;
  report.rebuild_frames = frame - start_frame;
  if (taken) {
    ++report.swapped;
    estimator.reserve(result.epoch->body.rest_tree().node_count());
    owned.keep(result.epoch);
  } else {
    ++report.refused;
    if (owned.fits_here(*result.epoch, options.looser_by)) raise_threshold();
  }
  job->retire(std::move(result.epoch));
}

// What was built for this very pose is no better, so the pose is what is loose: it has to change before another try.
void RebuiltBody::State::raise_threshold() noexcept {
  for (std::size_t level = 0; level < threshold.size(); ++level)
    threshold[level] = std::max(threshold[level], options.looser_by * report.looseness[level]);
}

RebuiltBody::RebuiltBody(const Mesh& mesh, const CoveredTree& built, RebuildOptions options, Workers& workers)
    : state_([&] {
        const StandardFloats standard;
        return std::make_unique<State>(mesh, built, std::move(options), workers);
      }()) {}

RebuiltBody::~RebuiltBody() = default;
RebuiltBody::RebuiltBody(RebuiltBody&&) noexcept = default;
RebuiltBody& RebuiltBody::operator=(RebuiltBody&&) noexcept = default;

RebuildStatus RebuiltBody::update(const PositionView& positions, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->update(positions, workers);
}

const Body& RebuiltBody::body() const {
  return state_->owned.present().body;
}

std::uint64_t RebuiltBody::epoch() const {
  return state_->epoch;
}

bool RebuiltBody::is_home() const {
  return state_->owned.home_serves();
}

bool RebuiltBody::is_rebuilding() const {
  return state_->next_pose || state_->job->stage() == RebuildJob::Stage::queued;
}

const RebuildReport& RebuiltBody::report() const {
  return state_->report;
}

const RebuildOptions& RebuiltBody::options() const {
  return state_->options;
}

}  // namespace morula
