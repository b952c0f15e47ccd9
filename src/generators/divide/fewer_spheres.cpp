// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/fewer_spheres.hpp"

#include <algorithm>
#include <morula/geometry/enclosing_sphere.hpp>
#include <tuple>

#include "generators/divide/exchange.hpp"
#include "generators/driver/join.hpp"
#include "generators/fit/extremes.hpp"

namespace morula::detail {
namespace {

// Which pair is joined matters less than how well the sphere is fitted afterwards, so pairs are judged along a quarter
// of the lines that sets are compared by.
constexpr int lines_for_pairs = 48;
constexpr std::size_t most_neighbors = 6;  // with which a leaf may be joined

}  // namespace

FewerSpheres::FewerSpheres(const FitInput& input, UnionVolume& total, std::vector<BuildNode> leaves)
    : input_(input), total_(total), of_pairs_(input.lines, lines_for_pairs), leaves_(std::move(leaves)) {
  judged_.resize(leaves_.size());
  for (std::size_t i = 0; i < leaves_.size(); ++i) add_pairs(i);
  measure();
}

bool FewerSpheres::join() {
  const auto cheapest = std::min_element(pairs_.begin(), pairs_.end(), [](const Pair& a, const Pair& b) {
    return std::tie(a.cost, a.first, a.second) < std::tie(b.cost, b.first, b.second);
  });
  if (cheapest == pairs_.end()) return false;
  const std::size_t first = cheapest->first, second = cheapest->second;
  const Vec3 center = cheapest->center;
  BuildNode& leaf = leaves_[first];
  for (std::size_t k = 0; k < leaves_[second].region.size(); ++k) leaf.region.add(leaves_[second].region, k);
  leaf.cell.add(leaves_[second].cell);
  std::vector<Vec3> corners;
  corner_positions(input_.mesh, leaf.region, corners);
  leaf.sphere = {center, rounded_up_radius(farthest_distance(center, corners), std::max(input_.pad, max_norm(center)))};
  leaves_.erase(leaves_.begin() + static_cast<std::ptrdiff_t>(second));
  leaf.sphere = settled(input_, leaves_, first);

  judged_[first] = {};
  judged_.erase(judged_.begin() + static_cast<std::ptrdiff_t>(second));
  std::erase_if(pairs_, [&](const Pair& p) {
    return p.first == first || p.second == first || p.first == second || p.second == second;
  });
  for (Pair& p : pairs_) {
    p.first -= p.first > second ? 1 : 0;
    p.second -= p.second > second ? 1 : 0;
  }
  add_pairs(first);
  measure();
  return true;
}

const FewerSpheres::Judged& FewerSpheres::judged(std::size_t leaf) {
  Judged& known = judged_[leaf];
  if (!known.extremes.empty()) return known;
  const GroupPoints points =
      extremes(some_corner_positions(input_.mesh, leaves_[leaf].region, most_candidates), input_.lines);
  for (std::size_t i = 0; i < points.size(); ++i)
    known.extremes.push_back(
        {static_cast<double>(points.x[i]), static_cast<double>(points.y[i]), static_cast<double>(points.z[i])});
  known.outside = of_pairs_.outside(leaves_[leaf].sphere);
  return known;
}

FewerSpheres::Pair FewerSpheres::pair_of(std::size_t first, std::size_t second) {
  const Judged &a = judged(first), &b = judged(second);
  std::vector<Vec3> both = a.extremes;
  both.insert(both.end(), b.extremes.begin(), b.extremes.end());
  const Sphere in_lattice = enclosing_sphere(both);
  const Sphere common{input_.lines.from_lattice(in_lattice.center), in_lattice.radius * input_.lines.cell()};
  const double apart = a.outside + b.outside - of_pairs_.outside_both(leaves_[first].sphere, leaves_[second].sphere);
  return {first, second, common.center, of_pairs_.outside(common) - apart};
}

// With those that are nearest.
void FewerSpheres::add_pairs(std::size_t leaf) {
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t other = 0; other < leaves_.size(); ++other)
    if (other != leaf) near.emplace_back(common_radius(leaves_[leaf].sphere, leaves_[other].sphere), other);
  const std::size_t count = std::min(most_neighbors, near.size());
  std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = std::min(leaf, near[k].second), second = std::max(leaf, near[k].second);
    const bool is_known =
        std::ranges::any_of(pairs_, [&](const Pair& p) { return p.first == first && p.second == second; });
    if (!is_known) pairs_.push_back(pair_of(first, second));
  }
}

void FewerSpheres::measure() {
  std::vector<Sphere> spheres;
  for (const BuildNode& leaf : leaves_) spheres.push_back(leaf.sphere);
  outside_ = total_.outside(spheres);
}

}  // namespace morula::detail
