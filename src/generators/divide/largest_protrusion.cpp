// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/largest_protrusion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/triangle.hpp>
#include <utility>
#include <vector>

#include "geometry/triangles/scan_triangle.hpp"

namespace morula::detail {
namespace {

constexpr double rounding = 1e-9;  // relative to a length; far above the rounding of all computations here
constexpr std::size_t facets_per_box = 16;

Box box_of(const Triangle& t) {
  return {min(min(t[0], t[1]), t[2]), max(max(t[0], t[1]), t[2])};
}

// Leaves, their spheres and the facets of their parts, with a box around every few of these facets.
class Parts {
 public:
  Parts(const MeshView& mesh, std::span<const BuildNode> leaves) : mesh_(mesh), leaves_(leaves), boxes_(leaves.size()) {
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      const auto& facets = leaves[i].region.facet;
      boxes_[i].resize((facets.size() + facets_per_box - 1) / facets_per_box);
      for (std::size_t k = 0; k < facets.size(); ++k) {
        Box& box = boxes_[i][k / facets_per_box];
        for (const Vec3& corner : mesh.corners(facets[k])) box.add(corner);
      }
    }
  }

  // Distance to the surface. The nearest point of the surface is in some leaf's part, and the part in the leaf's
  // sphere: spheres farther away than the nearest surface so far cannot contain it, nor can facets whose boxes are
  // farther away. The least of the distances computed for facets is that of the nearest, so it is the same as by the
  // index.
  double distance_to_surface(std::size_t own) const {
    const Vec3& p = leaves_[own].sphere.center;
    double least = std::numeric_limits<double>::infinity();
    const auto look_at = [&](std::size_t leaf) {
      each_facet(
          leaf, [&](const Box& box) { return squared_distance(box, p) <= least * (1 + rounding); },
          [&](std::uint32_t, const Triangle& t) {
            if (squared_distance(box_of(t), p) <= least * (1 + rounding))
              least = std::min(least, closest_point(t, p).squared_distance);
          });
    };
    look_at(own);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      const Sphere& other = leaves_[i].sphere;
      // mutant protrusion-only-where-the-center-is: `(std::sqrt(least) + other.radius)` -> `std::sqrt(least)`
      if (i != own && distance(p, other.center) <= (std::sqrt(least) + other.radius) * (1 + rounding)) look_at(i);
    }
    return std::sqrt(least);
  }

  // Winding number of the surface around p: the facets crossed outward on the way up an axis, less those crossed
  // inward. A crossed facet has its part there in a sphere that the way meets. If p is farther from the surface than
  // rounding reaches, it does not matter on which side of an edge the way passes: every facet with that edge, its
  // corners computed relative to p, agrees.
  int winding_number(const Vec3& p, double slack) const {
    constexpr LineLattice up{0, 1, 2, 0.0, 1, 0, 1};
    std::vector<std::pair<std::uint32_t, int>> passed;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      const Vec3 to = leaves_[i].sphere.center - p;
      // mutant protrusion-half-of-the-spheres-passed: `leaves_` -> `0.5 * leaves_`
      const double reach = leaves_[i].sphere.radius + slack;
      if (to.x * to.x + to.y * to.y > reach * reach || to.z < -reach) continue;
      each_facet(
          i,
          [&](const Box& box) {
            return std::abs(p.x - std::clamp(p.x, box.lower.x, box.upper.x)) <= slack &&
                   std::abs(p.y - std::clamp(p.y, box.lower.y, box.upper.y)) <= slack && box.upper.z + slack >= p.z;
          },
          [&](std::uint32_t f, const Triangle& t) {
            scan_triangle({t[0] - p, t[1] - p, t[2] - p}, up, [&](int, int, double z, bool leaves_it) {
              if (z > 0) passed.push_back({f, leaves_it ? 1 : -1});
            });
          });
    }
    // Several spheres may have parts of one facet.
    std::sort(passed.begin(), passed.end());
    // mutant protrusion-passed-twice: `passed.erase(std::unique(passed.begin(), passed.end()), passed.end())` -> ``
    passed.erase(std::unique(passed.begin(), passed.end()), passed.end());
    int sum = 0;
    for (const auto& [facet, side] : passed) sum += side;
    return sum;
  }

 private:
  template <class Wanted, class Visit>
  void each_facet(std::size_t leaf, const Wanted& is_wanted, const Visit& visit) const {
    const auto& facets = leaves_[leaf].region.facet;
    for (std::size_t b = 0; b < boxes_[leaf].size(); ++b) {
      if (!is_wanted(boxes_[leaf][b])) continue;
      for (std::size_t k = b * facets_per_box; k < std::min(facets.size(), (b + 1) * facets_per_box); ++k)
        visit(facets[k], mesh_.corners(facets[k]));
    }
  }

  MeshView mesh_;
  std::span<const BuildNode> leaves_;
  std::vector<std::vector<Box>> boxes_;
};

}  // namespace

double largest_protrusion(const MeshView& mesh, const ObjectShape& shape, std::span<const BuildNode> leaves) {
  const bool uses_index = shape.has_index() || !shape.has_volume();
  const Parts parts(mesh, uses_index ? std::span<const BuildNode>{} : leaves);
  double largest = 0;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Sphere& sphere = leaves[i].sphere;
    const double slack = rounding * std::max(sphere.radius, max_norm(sphere.center) + sphere.radius);
    const double away = uses_index ? 0.0 : parts.distance_to_surface(i);
    if (away <= 2 * slack) {
      largest = std::max(largest, shape.distance().protrusion_bound(sphere));
    } else {
      // mutant protrusion-inside-out: `shape.orientation()` -> `1`
      const bool inside = shape.orientation() * parts.winding_number(sphere.center, slack) > 0;
      largest = std::max(largest, sphere.radius + (inside ? -away : away));
    }
  }
  return largest;
}

}  // namespace morula::detail
