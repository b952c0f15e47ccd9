// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/looseness_watch.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// Shares by which figures of one tree may differ while the pose counts as the same.
constexpr double still = 1e-3, as_built = 0.05;
// Frames over which one estimate is spread at most.
constexpr std::size_t max_steps = 8;

bool all_within(double share, std::span<const double> a, std::span<const double> b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (std::abs(a[i] - b[i]) > share * std::max(negligible_looseness, b[i])) return false;
  return true;
}

}  // namespace

LoosenessWatch::LoosenessWatch(const MeshView& mesh, std::size_t levels, const RebuildOptions& options,
                               RebuildReport& report)
    : options_(options), report_(report), estimator_(mesh), thresholds_(levels), estimated_(levels) {}

void LoosenessWatch::follow(const TreeVersion& present) noexcept {
  estimator_.give_up();
  report_.looseness = report_.looseness_at_build = present.looseness_at_build;
  for (std::size_t level = 0; level < thresholds_.size(); ++level)
    thresholds_[level] = options_.rebuild_threshold * std::max(negligible_looseness, present.looseness_at_build[level]);
}

void LoosenessWatch::rest(const TreeVersion& home) noexcept {
  estimator_.give_up();
  report_.looseness = home.looseness_at_build;
}

void LoosenessWatch::begin(const PositionView& positions, const TreeVersions& trees) noexcept {
  ++report_.checks;
  estimator_.begin(positions, trees.present().body, steps());
  strain_at_begin_ = trees.strain();
}

// On the caller's thread, a frame with a rebuild takes as long as a build anyway.
std::size_t LoosenessWatch::steps() const noexcept {
  if (options_.thread == RebuildThread::caller) return 1;
  const auto period = static_cast<std::size_t>(options_.rebuild_every.value_or(options_.check_every));
  return std::min(max_steps, period);
}

bool LoosenessWatch::step(TreeVersions& trees) noexcept {
  if (!estimator_.step(estimated_)) return false;
  if (!all_within(still, estimated_, report_.looseness))
    motion_ = Motion::moving;
  else if (motion_ == Motion::moving)
    motion_ = Motion::stopped;
  report_.looseness = estimated_;
  trees.learn(estimated_, strain_at_begin_);
  return true;
}

bool LoosenessWatch::has_grown() const noexcept {
  for (std::size_t level = first_counted_level(thresholds_.size()); level < thresholds_.size(); ++level)
    if (report_.looseness[level] > thresholds_[level]) return true;
  return false;
}

bool LoosenessWatch::is_off_build(const TreeVersion& present) const noexcept {
  return !all_within(as_built, report_.looseness, present.looseness_at_build);
}

void LoosenessWatch::raise_thresholds() noexcept {
  for (std::size_t level = 0; level < thresholds_.size(); ++level)
    thresholds_[level] = std::max(thresholds_[level], options_.rebuild_threshold * report_.looseness[level]);
}

void LoosenessWatch::settle() noexcept {
  if (motion_ == Motion::stopped) motion_ = Motion::settled;
}

}  // namespace morula::detail
