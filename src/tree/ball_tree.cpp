// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <numeric>
#include <stdexcept>

#include "parallel/float_environment.hpp"

namespace morula {
namespace detail {
namespace {

/// A part of the balls, by number.
using Part = std::span<std::uint32_t>;

Sphere sphere_around(std::span<const Sphere> balls, Part part) {
  if (part.size() == 1) return balls[part.front()];
  std::vector<Vec3> centers;
  for (const std::uint32_t i : part) centers.push_back(balls[i].center);
  Sphere sphere = enclosing_sphere(centers);
  sphere.radius = 0;
  for (const std::uint32_t i : part)
    sphere.radius = std::max(sphere.radius, scaled_length(balls[i].center - sphere.center) + balls[i].radius);
  // Lengths are right to a few units of the last place, of the radius or of the coordinates that they come from.
  constexpr double share = 0x1p-48;
  sphere.radius += share * std::max({sphere.radius, max_norm(sphere.center)});
  if (!is_finite(sphere.center) || !std::isfinite(sphere.radius))
    throw std::invalid_argument("no sphere around the balls is finite; scale them");
  return sphere;
}

/// Puts the lower half along the longest side of the centers' box in front; ties go by number.
std::array<Part, 2> halves(std::span<const Sphere> balls, Part part, std::size_t in_front) {
  Box box;
  for (const std::uint32_t i : part) box.add(balls[i].center);
  const Vec3 extent = box.extent();
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  std::sort(part.begin(), part.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double at = balls[a].center[axis], bt = balls[b].center[axis];
    return at < bt || (at == bt && a < b);
  });
  return {part.first(in_front), part.subspan(in_front)};
}

/// Divides a part into `count` parts whose sizes differ by one at most.
void divide(std::span<const Sphere> balls, Part part, std::size_t count, std::vector<Part>& parts) {
  if (count == 1) {
    parts.push_back(part);
    return;
  }
  const std::size_t lower = count / 2;
  const auto [front, back] = halves(balls, part, part.size() * lower / count);
  divide(balls, front, lower, parts);
  divide(balls, back, count - lower, parts);
}

void require_usable_balls(std::span<const Sphere> balls) {
  if (balls.empty()) throw std::invalid_argument("there are no balls to make a tree of");
  for (std::size_t i = 0; i < balls.size(); ++i)
    if (!is_finite(balls[i].center) || !std::isfinite(balls[i].radius) || balls[i].radius < 0)
      throw std::invalid_argument("ball " + std::to_string(i) +
                                  " has a number that is not finite, or a negative radius");
}

}  // namespace
}  // namespace detail

SphereTree tree_from_spheres(std::span<const Sphere> balls, std::uint32_t branching) {
  using namespace detail;
  const StandardFloats standard;
  require_usable_balls(balls);
  if (branching < 2 || branching > max_branching)
    throw std::invalid_argument("branching " + std::to_string(branching) + " is not in 2…64");
  double room = 1;
  for (int level = 0; level < max_depth; ++level) room *= branching;
  if (static_cast<double>(balls.size()) > room)
    throw std::invalid_argument(std::to_string(balls.size()) + " balls are more than a tree of branching " +
                                std::to_string(branching) + " holds");
  std::vector<std::uint32_t> order(balls.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});

  SphereTree tree;
  tree.branching = branching;
  std::vector<Part> level{order};
  std::vector<std::uint32_t> child_counts;
  while (!level.empty()) {
    std::vector<Sphere> spheres;
    for (const Part part : level) spheres.push_back(sphere_around(balls, part));
    tree.append_level(child_counts, spheres);
    std::vector<Part> next;
    child_counts.clear();
    for (const Part part : level) {
      const std::size_t count = part.size() == 1 ? 0 : std::min<std::size_t>(branching, part.size());
      if (count > 0) divide(balls, part, count, next);
      child_counts.push_back(static_cast<std::uint32_t>(count));
    }
    level = std::move(next);
  }
  return tree;
}

}  // namespace morula
