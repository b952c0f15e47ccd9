// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/join.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <morula/query/signed_distance.hpp>
#include <tuple>

#include "generators/fit/sphere_fit.hpp"

namespace morula::detail {
namespace {

struct NodePair {
  double radius;
  std::size_t first, second;
  bool operator<(const NodePair& other) const {
    return std::tie(radius, first, second) < std::tie(other.radius, other.first, other.second);
  }
};

std::vector<NodePair> pairs_by_radius(const std::vector<BuildNode>& nodes) {
  std::vector<NodePair> pairs;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size(); ++j)
      pairs.push_back({common_radius(nodes[i].sphere, nodes[j].sphere), i, j});
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace

double common_radius(const Sphere& a, const Sphere& b) {
  return std::max({a.radius, b.radius, 0.5 * (a.radius + b.radius + distance(a.center, b.center))});
}

BuildNode joined(const BuildNode& a, const BuildNode& b, const Sphere& sphere) {
  BuildNode node = a;
  for (std::size_t k = 0; k < b.region.size(); ++k) node.region.add(b.region.facet[k], b.region.polygon(k));
  node.cell.add(b.cell);
  node.sphere = sphere;
  return node;
}

LeafScore::LeafScore(const MeshView& mesh, const SignedDistance& shape, const BuildRun& run)
    : mesh_(mesh), shape_(shape), max_protrusion_(run.max_protrusion), pad_(run.largest_coordinate()) {}

// Looseness adds up outside volume, and dividing by it gave sets up to 17 % tighter than by the bound times r².
Verdict LeafScore::operator()(const Sphere& sphere) const {
  const double bound = shape_.protrusion_bound(sphere);
  if (max_protrusion_ > 0) return {bound, bound};
  if (shape_.has_volume()) return {bound, outside_volume(shape_, sphere)};
  return {bound, bound * sphere.radius * sphere.radius};
}

Sphere LeafScore::fitted(const std::vector<Vec3>& points, const Vec3& start) const {
  const Sphere sphere = recenter(points, start, shape_);
  return {sphere.center, rounded_up_radius(sphere.radius, std::max(pad_, max_norm(sphere.center)))};
}

Sphere LeafScore::common_sphere(const BuildNode& a, const BuildNode& b) const {
  std::vector<Vec3> points, more;
  corner_positions(mesh_, a.region, points);
  corner_positions(mesh_, b.region, more);
  points.insert(points.end(), more.begin(), more.end());
  return fitted(points, (a.sphere.center + b.sphere.center) * 0.5);
}

Join LeafScore::join(const BuildNode& a, const Verdict& of_a, const BuildNode& b, const Verdict& of_b) const {
  const Sphere sphere = common_sphere(a, b);
  const Verdict verdict = (*this)(sphere);
  return {max_protrusion_ > 0 ? verdict.bound : verdict.gain - of_a.gain - of_b.gain, sphere, verdict};
}

void LeafScore::make_few(Division& division) const {
  const auto good = [&](const Sphere& sphere) { return shape_.protrusion_bound(sphere) <= max_protrusion_; };
  std::vector<BuildNode>& nodes = division.children;
  std::vector<Vec3> points;
  for (BuildNode& node : nodes) {
    if (good(node.sphere)) continue;
    corner_positions(mesh_, node.region, points);
    const Sphere moved = fitted(points, node.sphere.center);
    if (good(moved)) node.sphere = moved;
  }
  for (bool again = nodes.size() > 1; again;) {
    again = false;
    for (const auto& [radius, first, second] : pairs_by_radius(nodes)) {
      if (!good(nodes[first].sphere) || !good(nodes[second].sphere)) continue;
      const Sphere common = common_sphere(nodes[first], nodes[second]);
      if (!good(common)) continue;
      nodes[first] = joined(nodes[first], nodes[second], common);
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

}  // namespace morula::detail
