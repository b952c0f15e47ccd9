// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/budget.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

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

std::vector<std::size_t> share_by_size(std::span<const MeshSize> sizes, std::size_t total) {
  double largest = 0;
  for (const MeshSize& size : sizes) largest = std::max(largest, size.area);
  std::vector<std::size_t> counts(sizes.size(), 1);
  std::vector<double> weights(sizes.size(), 0.0);
  std::size_t used = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    // Square roots give the same bits on every machine, unlike powers.
    const double root = largest > 0 ? std::sqrt(sizes[i].area / largest) : 1;
    weights[i] = root * std::sqrt(root);
    used += sizes[i].links;
  }
  const auto share = [&](std::size_t i) { return weights[i] / (static_cast<double>(counts[i]) + 0.5); };
  // Equal shares go to the lower link.
  const auto is_less = [](const std::pair<double, std::size_t>& a, const std::pair<double, std::size_t>& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  };
  std::priority_queue<std::pair<double, std::size_t>, std::vector<std::pair<double, std::size_t>>, decltype(is_less)>
      queue(is_less);
  for (std::size_t i = 0; i < sizes.size(); ++i) queue.push({share(i), i});
  while (!queue.empty()) {
    const std::size_t i = queue.top().second;
    queue.pop();
    // The rest goes to no smaller link, so that a larger total never takes a sphere away.
    if (used + sizes[i].links > total) break;
    ++counts[i];
    used += sizes[i].links;
    queue.push({share(i), i});
  }
  return counts;
}

}  // namespace morula::robot
