// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/budget.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

namespace morula::robot {

double Demand::at(std::size_t count) const {
  std::size_t i = counts.size() - 2;
  while (i > 0 && count < counts[i]) --i;
  const double low = std::max(outside[i], 1e-300), high = std::clamp(outside[i + 1], 1e-300, low);
  const double steps = std::log(static_cast<double>(counts[i + 1]) / static_cast<double>(counts[i]));
  const double power = std::log(high / low) / steps;
  return low * std::exp(power * std::log(static_cast<double>(count) / static_cast<double>(counts[i])));
}

std::vector<std::size_t> share_spheres(std::span<const Demand> demands, std::size_t total) {
  std::vector<std::size_t> counts(demands.size(), 0);
  std::size_t used = 0;
  struct Wish {
    double gain;
    std::size_t link;
    // Equal gains go to the lower link.
    bool operator<(const Wish& other) const { return gain != other.gain ? gain < other.gain : link > other.link; }
  };
  std::priority_queue<Wish> wishes;
  const auto wish = [&](std::size_t i) {
    const std::size_t n = counts[i] - demands[i].fixed;
    wishes.push({demands[i].at(n) - demands[i].at(n + 1), i});
  };
  for (std::size_t i = 0; i < demands.size(); ++i) {
    counts[i] = demands[i].fixed + (demands[i].has_mesh ? 1 : 0);
    used += counts[i] * demands[i].links;
  }
  for (std::size_t i = 0; i < demands.size(); ++i) {
    if (demands[i].has_mesh) wish(i);
  }
  while (!wishes.empty()) {
    const Wish next = wishes.top();
    wishes.pop();
    // A number that is too large for links that share their set may fit another link.
    if (used + demands[next.link].links > total) continue;
    ++counts[next.link];
    used += demands[next.link].links;
    wish(next.link);
  }
  return counts;
}

}  // namespace morula::robot
