// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/progress.hpp"

#include <algorithm>
#include <platform/console.hpp>
#include <string>

#include "shared/console.hpp"

namespace morula::cli {
Progress::Progress(std::string label)
    : label_(std::move(label)), shown_(platform::is_terminal(platform::Stream::errors)) {}

Progress::~Progress() {
  if (shown_ && last_ != Clock::time_point{}) say("\r\x1b[K");
}

void Progress::update(double share) {
  if (!shown_) return;
  const Clock::time_point now = Clock::now();
  if (last_ != Clock::time_point{} && now - last_ < std::chrono::milliseconds(80)) return;
  last_ = now;
  const std::size_t width = 30;
  const double clamped = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(clamped * static_cast<double>(width));
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  constexpr double enough_to_judge = 0.02;
  std::string rest;
  if (elapsed >= 1 && clamped >= enough_to_judge && label_.find(" left") == std::string::npos)
    rest = time_left(elapsed * (1 - clamped) / clamped);
  say("\r\x1b[K[{}{}] {:3.0f}% {}{}", std::string(filled, '#'), std::string(width - filled, '.'), 100 * clamped, label_,
      rest);
}

void Progress::update(double share, std::string label) {
  label_ = std::move(label);
  update(share);
}

std::string time_left(std::optional<double> seconds) {
  if (!seconds || !(*seconds >= 1)) return {};
  if (*seconds < 99.5) return fmt::format(", about {:.0f} s left", *seconds);
  if (*seconds < 99.5 * 60) return fmt::format(", about {:.0f} min left", *seconds / 60);
  return fmt::format(", about {:.0f} h left", *seconds / 3600);
}

}  // namespace morula::cli
