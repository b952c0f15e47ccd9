// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/build_run.hpp"

#include <algorithm>
#include <memory>

namespace morula::detail {

namespace {

int depth_of(const BuildOptions& options, const MeshView& mesh) {
  constexpr int of_flat_sets = 3;
  if (options.spheres || options.max_protrusion) return of_flat_sets;
  return options.depth ? *options.depth : automatic_depth(mesh, options.branching);
}

/// Sets what this thread checks as long as it lives.
class WithInterruption {
 public:
  explicit WithInterruption(const ActiveInterruption& next) noexcept : before_(exchange_active_interruption(next)) {}
  ~WithInterruption() { exchange_active_interruption(before_); }
  WithInterruption(const WithInterruption&) = delete;
  WithInterruption& operator=(const WithInterruption&) = delete;

 private:
  ActiveInterruption before_;
};

ActiveInterruption present_interruption() noexcept {
  const ActiveInterruption present = exchange_active_interruption({});
  exchange_active_interruption(present);
  return present;
}

/// Replacements of std::stop_token do not say it.
template <class Token>
bool may_be_stopped(const Token& token) {
  if constexpr (requires { token.stop_possible(); }) return token.stop_possible();
  return true;
}

}  // namespace

BuildRun::BuildRun(const BuildOptions& options, const MeshView& mesh)
    : BuildOptions(options),
      depth(depth_of(options, mesh)),
      spheres(options.spheres.value_or(0)),
      max_protrusion(options.max_protrusion ? *options.max_protrusion + options.tolerance : 0),
      box_(bounding_box(mesh)) {
  if (time_limit_seconds) {
    // A limit of years would overflow the clock.
    constexpr double longest = 1e9;
    deadline_ = start_ + std::chrono::duration_cast<Clock::duration>(
                             std::chrono::duration<double>(std::min(longest, *time_limit_seconds)));
  }
  if (progress)
    progress = [reported = std::make_shared<BuildProgress>(), forward = progress,
                caller = present_interruption()](const BuildProgress& now) {
      reported->share = std::clamp(now.share, reported->share, 1.0);
      reported->level = std::max(reported->level, now.level);
      reported->seconds_left = now.seconds_left;
      // A stop ends the build, not calls of the callback into the library.
      const WithInterruption as_outside(caller);
      forward(*reported);
    };
}

BuildRun BuildRun::pass(double from, double to) const {
  BuildRun part = *this;
  part.from_ = from_ + from * (to_ - from_);
  part.to_ = from_ + to * (to_ - from_);
  return part;
}

BuildRun BuildRun::one_level(std::size_t children) const {
  BuildRun level = *this;
  level.spheres = 0;
  level.branching = static_cast<int>(children);
  level.depth = 1;
  return level;
}

void BuildRun::tell(double share, int level, std::optional<double> seconds_left) const {
  if (!progress) return;
  const double of_all = from_ + share * (to_ - from_);
  // The share of other passes is the only estimate of their time.
  constexpr double enough_to_judge = 0.02;
  if (to_ < 1) {
    seconds_left.reset();
    if (of_all > enough_to_judge) seconds_left = seconds() * (1 - of_all) / of_all;
  }
  progress({of_all, level, seconds_left});
}

StopChecks::StopChecks(const BuildRun& run) : checks_(may_be_stopped(run.stop)) {
  if (!checks_) return;
  state_.callback = [this, &run] {
    run.throw_if_stopped();
    const WithInterruption of_caller(state_.outer);
    check_interrupt();
  };
  state_.outer = exchange_active_interruption({&state_, true});
}

StopChecks::~StopChecks() {
  if (checks_) exchange_active_interruption(state_.outer);
}

TimeEstimate::TimeEstimate(int depth, int branching, std::size_t patches, unsigned threads)
    : depth_(depth), branching_(branching), patches_(static_cast<double>(patches)), threads_(threads) {}

void TimeEstimate::begin_level(std::size_t nodes) {
  levels_.push_back({.nodes = static_cast<double>(nodes)});
}

void TimeEstimate::add(std::size_t nodes, std::size_t children, double seconds) {
  Level& level = levels_.back();
  level.done += static_cast<double>(nodes);
  level.children += static_cast<double>(children);
  level.seconds += seconds;
}

double TimeEstimate::wall(double seconds, double nodes) const {
  return seconds / std::max(1.0, std::min(threads_, nodes));
}

std::optional<double> TimeEstimate::seconds_left() const {
  if (levels_.empty() || levels_.back().done == 0) return std::nullopt;
  const Level& now = levels_.back();
  // Before two levels are measured: a node costs as much as so many patches. The estimate errs upwards, because the
  // progress bar does not go back.
  constexpr double patches_per_node = 20000;
  double per_node = now.all_seconds() / (now.nodes + patches_ / patches_per_node);
  if (levels_.size() > 1) {
    const Level& before = levels_[levels_.size() - 2];
    if (now.nodes > before.nodes) per_node = (now.all_seconds() - before.all_seconds()) / (now.nodes - before.nodes);
  }
  per_node = std::clamp(per_node, 0.0, now.all_seconds() / now.nodes);
  const double per_level = now.all_seconds() - per_node * now.nodes;

  double left = wall(now.all_seconds() - now.seconds, now.nodes - now.done);
  double nodes = now.nodes * now.children / now.done;
  for (int level = static_cast<int>(levels_.size()); level < depth_ && nodes > 0; ++level) {
    left += wall(per_level + per_node * nodes, nodes);
    nodes *= branching_;
  }
  return left;
}

}  // namespace morula::detail
