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
#include "update/rebuild/rebuild_job.hpp"

namespace morula {
using namespace detail;
namespace {

using Clock = std::chrono::steady_clock;

// Looseness below this is tight enough: ratios of smaller figures say nothing.
constexpr double negligible = 1e-3;

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

BuildOptions build_options(const RebuildOptions& options, const SphereTree& home) {
  return {.method = options.method,
          .branching = static_cast<int>(home.branching),
          .depth = static_cast<int>(home.level_count()) - 1,
          .seed = options.seed};
}

std::vector<std::uint32_t> used_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> used;
  for (const Facet& f : mesh.facets) used.insert(used.end(), f.begin(), f.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  return used;
}

// The root is one ball whatever the ownership: it counts only where there is nothing else.
std::size_t first_counted(std::size_t levels) {
  return levels > 1 ? 1 : 0;
}

// Shares by which figures of one ownership may differ for the pose to count as the same.
constexpr double still = 1e-3, as_built = 0.05;

bool all_within(double share, std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > share * std::max(negligible, b[i])) return false;
  return true;
}

}  // namespace

struct RebuiltBody::State {
  State(const Mesh& mesh, const CoveredTree& built, RebuildOptions rebuild_options, Workers& workers);
  ~State();

  RebuildStatus update(const PositionView& positions, Workers& workers) noexcept;

  bool at_rest(const PositionView& positions) const noexcept;
  void return_to_rest(const PositionView& positions, Workers& workers) noexcept;
  void check(const PositionView& positions, Workers& workers);

  double score(std::span<const double> looseness) const noexcept;
  void estimate_present(const PositionView& positions) noexcept;
  bool has_grown() const noexcept;
  bool is_off_build() const noexcept;
  bool may_start() const noexcept;
  void request_rebuild(const PositionView& positions, Workers& workers);
  bool looks_ahead() const noexcept;
  void take_pose(const PositionView& positions, Workers& workers);
  int steps_ahead() const noexcept;
  void start(int steps, const PositionView& positions, Workers& workers);
  void collect(const PositionView& positions, Workers& workers);
  void judge(std::unique_ptr<Epoch> candidate, const PositionView& positions, Workers& workers) noexcept;
  bool try_home(const PositionView& positions, Workers& workers) noexcept;
  void change_to(Epoch& next) noexcept;
  bool still_fits(const Epoch& candidate, std::span<const double> looseness) const noexcept;
  void raise_threshold() noexcept;

  RebuildOptions options;
  std::vector<Vec3> rest;
  std::vector<std::uint32_t> used;
  LoosenessEstimator estimator;
  Epoch home;
  std::unique_ptr<Epoch> away;  // none: home serves
  Epoch* present;
  std::vector<double> threshold;  // of looseness, per level: above, a rebuild is wanted
  std::vector<double> other;      // looseness of an ownership that is compared
  RebuildReport report;
  std::uint64_t epoch = 0, frame = 0;
  bool estimated = false;                // report.looseness is of this frame
  bool is_still = false;                 // and no other than at the last estimate
  bool settled = false;                  // a rebuild was asked for since the body became still
  std::uint64_t start_frame = 0;         // of the rebuild in hand
  std::optional<std::size_t> next_pose;  // that a rebuild waits for
  std::uint64_t next_pose_frame = 0;     // when it is to be taken
  Clock::time_point next_start{};
  std::shared_ptr<RebuildJob> job;
  std::optional<OwnThread> thread;  // last: it goes first
};

RebuiltBody::State::State(const Mesh& mesh, const CoveredTree& built, RebuildOptions rebuild_options, Workers& workers)
    : options((require_in_range(rebuild_options), std::move(rebuild_options))),
      rest(mesh.positions),
      used(used_vertices(mesh)),
      estimator(mesh, options.sample_count),
      home{Body(mesh, built, {}, workers), std::vector<double>(built.tree.level_count())},
      present(&home),
      other(built.tree.level_count()),
      job(std::make_shared<RebuildJob>(mesh, build_options(options, built.tree), options.sample_count,
                                       built.tree.level_count())) {
  estimator.estimate(home.body, home.looseness_at_build);
  report.looseness = home.looseness_at_build;
  report.looseness_at_build = home.looseness_at_build;
  report.rebuild_frames = first_guess;
  threshold.resize(other.size());
  change_to(home);
  epoch = 0;
  if (options.thread == RebuildThread::background) thread.emplace();
}

RebuiltBody::State::~State() {
  job->request_stop();
}

RebuildStatus RebuiltBody::State::update(const PositionView& positions, Workers& workers) noexcept {
  RebuildStatus status{.update = present->body.update(positions, workers)};
  if (!status) return status;
  const std::uint64_t before = epoch;
  ++frame;
  estimated = false;
  if (at_rest(positions)) {
    return_to_rest(positions, workers);
  } else {
    // A lack of memory, or the host's executor: rebuilding suffers, the spheres do not.
    try {
      check(positions, workers);
    } catch (...) {
      ++report.failed;
    }
  }
  status.swapped = epoch != before;
  return status;
}

bool RebuiltBody::State::at_rest(const PositionView& positions) const noexcept {
  if (positions.is_double())
    return std::all_of(used.begin(), used.end(), [&](std::uint32_t v) { return positions[v] == rest[v]; });
  return std::all_of(used.begin(), used.end(), [&](std::uint32_t v) { return positions[v] == Vec3(Vec3f(rest[v])); });
}

double RebuiltBody::State::score(std::span<const double> looseness) const noexcept {
  double sum = 0;
  for (std::size_t level = first_counted(looseness.size()); level < looseness.size(); ++level)
    sum += looseness[level] / std::max(negligible, home.looseness_at_build[level]);
  return sum;
}

bool RebuiltBody::State::has_grown() const noexcept {
  for (std::size_t level = first_counted(threshold.size()); level < threshold.size(); ++level)
    if (report.looseness[level] > threshold[level]) return true;
  return false;
}

void RebuiltBody::State::change_to(Epoch& next) noexcept {
  present = &next;
  ++epoch;
  report.looseness_at_build = next.looseness_at_build;
  for (std::size_t level = 0; level < threshold.size(); ++level)
    threshold[level] = options.looser_by * std::max(negligible, next.looseness_at_build[level]);
}

void RebuiltBody::State::return_to_rest(const PositionView& positions, Workers& workers) noexcept {
  next_pose.reset();
  job->request_stop();
  if (present == &home) return;
  home.body.update(positions, workers);
  change_to(home);
  report.looseness = home.looseness_at_build;
  ++report.returned_home;
}

// Results first: they may make the next rebuild unnecessary.
void RebuiltBody::State::check(const PositionView& positions, Workers& workers) {
  if (job->stage() == RebuildJob::Stage::done) collect(positions, workers);
  if (next_pose && next_pose_frame == frame) take_pose(positions, workers);
  const bool fixed = options.rebuild_every > 0;
  if (frame % static_cast<std::uint64_t>(fixed ? options.rebuild_every : options.check_every) != 0) return;
  estimate_present(positions);
  ++report.checks;
  const bool settling = is_still && !settled && (present != &home || is_off_build());
  if (settling) job->request_stop();  // of a pose that the body did not stop at
  if (!may_start() || !(fixed || settling || has_grown())) return;
  if (!fixed && try_home(positions, workers) && !has_grown()) return;
  settled = is_still;
  request_rebuild(positions, workers);
}

void RebuiltBody::State::estimate_present(const PositionView& positions) noexcept {
  if (estimated) return;
  std::copy(report.looseness.begin(), report.looseness.end(), other.begin());
  estimator.pose(positions);
  estimator.estimate(present->body, report.looseness);
  estimated = true;
  is_still = all_within(still, report.looseness, other);
  settled = settled && is_still;
}

bool RebuiltBody::State::is_off_build() const noexcept {
  return !all_within(as_built, report.looseness, present->looseness_at_build);
}

bool RebuiltBody::State::may_start() const noexcept {
  if (job->stage() != RebuildJob::Stage::idle || next_pose) return false;
  return options.thread == RebuildThread::caller || Clock::now() >= next_start;
}

// Home is ready and may fit again before the body is quite at rest.
bool RebuiltBody::State::try_home(const PositionView& positions, Workers& workers) noexcept {
  if (present == &home || !home.body.update(positions, workers)) return false;
  estimator.estimate(home.body, other);
  if (!(score(other) < (1 - options.gain) * score(report.looseness))) return false;
  change_to(home);
  report.looseness = other;
  ++report.returned_home;
  return true;
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
    case RebuildThread::caller:
      job->run();
      collect(positions, workers);
      break;
    case RebuildThread::background:
      thread->run(job);
      break;
    case RebuildThread::host:
      options.executor([job = job] { job->run(); });
      break;
  }
}

void RebuiltBody::State::collect(const PositionView& positions, Workers& workers) {
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
  judge(std::move(result.epoch), positions, workers);
}

void RebuiltBody::State::judge(std::unique_ptr<Epoch> candidate, const PositionView& positions,
                               Workers& workers) noexcept {
  estimate_present(positions);
  try_home(positions, workers);
  const bool usable = static_cast<bool>(candidate->body.update(positions, workers));
  if (usable) estimator.estimate(candidate->body, other);
  if (usable && score(other) < (1 - options.gain) * score(report.looseness)) {
    ++report.swapped;
    change_to(*candidate);
    std::swap(report.looseness, other);
    std::swap(away, candidate);
  } else {
    ++report.refused;
    if (usable && still_fits(*candidate, other)) raise_threshold();
  }
  job->retire(std::move(candidate));
}

bool RebuiltBody::State::still_fits(const Epoch& candidate, std::span<const double> looseness) const noexcept {
  for (std::size_t level = first_counted(looseness.size()); level < looseness.size(); ++level)
    if (looseness[level] > options.looser_by * std::max(negligible, candidate.looseness_at_build[level])) return false;
  return true;
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
  return state_->present->body;
}

std::uint64_t RebuiltBody::epoch() const {
  return state_->epoch;
}

bool RebuiltBody::is_home() const {
  return state_->present == &state_->home;
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
