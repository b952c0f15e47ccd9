// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <toolbox/numbers.hpp>
#include <vector>

namespace morula::toolbox {

std::string figure(double value) {
  const double size = std::abs(value);
  if (size == 0) return "0";
  if (!(size >= 1e-4 && size < 1e6)) return fmt::format("{:.2e}", value);
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(size))), 0, 6);
  return fmt::format("{:.{}f}", value, decimals);
}

std::string percent(double share) {
  const double value = 100 * share;
  if (value == 0) return "0%";
  if (value < 0.01) return "<0.01%";
  return fmt::format("{:.{}f}%", value, value < 0.1 ? 2 : value < 99.95 ? 1 : 0);
}

std::string seconds(double value) {
  return value < 0.0995 ? fmt::format("{:.3f} s", value) : fmt::format("{:.2f} s", value);
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
  return fmt::format("{} {}", count, count == 1 ? one : many.empty() ? one + "s" : many);
}

std::string exact_digits(double value) {
  return fmt::format("{}", value);
}

std::string hash_text(std::uint64_t hash) {
  return fmt::format("0x{:016x}", hash);
}

}  // namespace morula::toolbox
