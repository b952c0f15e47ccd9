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

std::vector<Pair> pairs_by_radius(const std::vector<BuildNode>& nodes) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size(); ++j)
      pairs.push_back({common_radius(nodes[i].sphere, nodes[j].sphere), i, j});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

Judge::Judge(const Mesh& mesh, const SignedDistance& shape, double max_protrusion)
    : mesh_(mesh), shape_(shape), max_protrusion_(max_protrusion), pad_(largest_coordinate(mesh)) {}

double Judge::worth(const Sphere& sphere) const {
  if (max_protrusion_ > 0) return bound(sphere);
  if (shape_.has_volume()) return outside_volume(shape_, sphere);
  return bound(sphere) * sphere.radius * sphere.radius;
}

BuildNode Judge::joined(const BuildNode& a, const BuildNode& b) const {
  BuildNode node;
  node.region = a.region;
  for (std::size_t k = 0; k < b.region.size(); ++k) node.region.add(b.region.facet[k], b.region.polygon(k));
  std::vector<Vec3> points;
  corner_positions(mesh_, node.region, points);
  node.sphere = refit(points, (a.sphere.center + b.sphere.center) * 0.5, shape_);
  node.sphere.radius = rounded_up_radius(node.sphere.radius, std::max(pad_, largest_component(node.sphere.center)));
  node.cell = a.cell;
  node.cell.add(b.cell);
  node.level = a.level;
  node.seed = a.seed;
  return node;
}

void Judge::join_to(Division& division, std::size_t most) const {
  // Fitting is what costs: only the closest pairs are tried.
  constexpr std::size_t most_trials = 12;
  std::vector<BuildNode>& nodes = division.children;
  while (nodes.size() > most) {
    const std::vector<Pair> pairs = pairs_by_radius(nodes);
    double least = std::numeric_limits<double>::infinity();
    BuildNode best;
    Pair at{};
    for (std::size_t k = 0; k < std::min(most_trials, pairs.size()); ++k) {
      const auto [radius, first, second] = pairs[k];
      BuildNode trial = joined(nodes[first], nodes[second]);
      const double more = worth(trial.sphere) - worth(nodes[first].sphere) - worth(nodes[second].sphere);
      if (more < least) least = more, best = std::move(trial), at = pairs[k];
    }
    nodes[at.first] = std::move(best);
    nodes.erase(nodes.begin() + static_cast<std::ptrdiff_t>(at.second));
  }
}

void Judge::join_while_good(Division& division) const {
  std::vector<BuildNode>& nodes = division.children;
  for (bool again = nodes.size() > 1; again;) {
    again = false;
    for (const auto& [radius, first, second] : pairs_by_radius(nodes)) {
      if (bound(nodes[first].sphere) > max_protrusion_ || bound(nodes[second].sphere) > max_protrusion_) continue;
      BuildNode trial = joined(nodes[first], nodes[second]);
      if (bound(trial.sphere) > max_protrusion_) continue;
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
