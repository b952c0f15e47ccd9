// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "build/join.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <morula/query/sphere_volume.hpp>
#include <tuple>

#include "build/refit.hpp"

namespace morula {
namespace {

// Smallest sphere around two, as far as its radius goes.
double common_radius(const Sphere& a, const Sphere& b) {
  return std::max({a.radius, b.radius, 0.5 * (a.radius + b.radius + distance(a.center, b.center))});
}

struct Pair {
  double radius;
  std::size_t first, second;
  bool operator<(const Pair& other) const {
    return std::tie(radius, first, second) < std::tie(other.radius, other.first, other.second);
  }
};

std::vector<Pair> pairs_by_radius(std::span<const BuildNode* const> nodes) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size(); ++j)
      pairs.push_back({common_radius(nodes[i]->sphere, nodes[j]->sphere), i, j});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

Judge::Judge(const Mesh& mesh, const SignedDistance& shape, double max_protrusion)
    : mesh_(mesh), shape_(shape), max_protrusion_(max_protrusion), pad_(largest_coordinate(mesh)) {}

// Outside volume is what looseness adds up, and dividing by it gave sets up to 17 % tighter than by the bound times r².
Verdict Judge::operator()(const Sphere& sphere) const {
  const double bound = shape_.protrusion_bound(sphere);
  if (max_protrusion_ > 0) return {bound, bound};
  if (shape_.has_volume()) return {bound, outside_volume(shape_, sphere)};
  return {bound, bound * sphere.radius * sphere.radius};
}

Sphere Judge::fitted(const Region& region, const Vec3& start) const {
  std::vector<Vec3> points;
  corner_positions(mesh_, region, points);
  const Sphere sphere = refit(points, start, shape_);
  return {sphere.center, rounded_up_radius(sphere.radius, std::max(pad_, largest_component(sphere.center)))};
}

BuildNode Judge::joined(const BuildNode& a, const BuildNode& b) const {
  BuildNode node;
  node.region = a.region;
  for (std::size_t k = 0; k < b.region.size(); ++k) node.region.add(b.region.facet[k], b.region.polygon(k));
  node.sphere = fitted(node.region, (a.sphere.center + b.sphere.center) * 0.5);
  node.cell = a.cell;
  node.cell.add(b.cell);
  node.level = a.level;
  node.seed = a.seed;
  return node;
}

std::optional<Join> Judge::cheapest_join(std::span<const BuildNode* const> siblings,
                                         std::span<const Verdict> verdicts) const {
  // Fitting is what costs: only the closest pairs are tried.
  constexpr std::size_t most_trials = 8;
  const std::vector<Pair> pairs = pairs_by_radius(siblings);
  std::optional<Join> best;
  for (std::size_t k = 0; k < std::min(most_trials, pairs.size()); ++k) {
    const auto [radius, first, second] = pairs[k];
    BuildNode node = joined(*siblings[first], *siblings[second]);
    const Verdict verdict = (*this)(node.sphere);
    const double cost =
        max_protrusion_ > 0 ? verdict.bound : verdict.worth - verdicts[first].worth - verdicts[second].worth;
    if (!best || cost < best->cost) best = Join{cost, std::move(node), verdict, first, second};
  }
  return best;
}

void Judge::make_few(Division& division) const {
  const auto good = [&](const Sphere& sphere) { return shape_.protrusion_bound(sphere) <= max_protrusion_; };
  std::vector<BuildNode>& nodes = division.children;
  for (BuildNode& node : nodes) {
    if (good(node.sphere)) continue;
    const Sphere moved = fitted(node.region, node.sphere.center);
    if (good(moved)) node.sphere = moved;
  }
  for (bool again = nodes.size() > 1; again;) {
    again = false;
    std::vector<const BuildNode*> siblings;
    for (const BuildNode& node : nodes) siblings.push_back(&node);
    for (const auto& [radius, first, second] : pairs_by_radius(siblings)) {
      if (!good(nodes[first].sphere) || !good(nodes[second].sphere)) continue;
      BuildNode trial = joined(nodes[first], nodes[second]);
      if (!good(trial.sphere)) continue;
      nodes[first] = std::move(trial);
      nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(second));
      again = nodes.size() > 1;
      break;
    }
  }
}

std::string short_number(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return {text.data(), end.ptr};
}

}  // namespace morula
