// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The depth of a patch along a direction.
#pragma once

#include <vector>

#include "collide/patches/patch_integrals.hpp"

namespace morula::detail {

/// Coordinates along two directions across a normal, and along it.
struct PatchFrame {
  Vec3 first, second, normal, center;
  Vec3 operator()(const Vec3& x) const {
    const Vec3 v = x - center;
    return {dot(first, v), dot(second, v), dot(normal, v)};
  }
};

/// The facets of a patch in the coordinates of a frame.
class ProjectedRegion {
 public:
  struct Part {
    std::uint32_t facet, begin, end;  ///< range of sides
    Vec3 middle;                      ///< mean of its points
    Vec3 area_vector;                 ///< of the whole facet
    Vec3 point;                       ///< of its plane
    double lower, upper;              ///< heights of its points
  };
  struct Side {
    Vec3 from, to;
    int weight;
    bool is_twin;  ///< true for the second of two facets' sides that are one
  };
  std::vector<Part> parts;
  std::vector<Side> sides;
  std::vector<Vec3> points;  ///< ends of all sides, each once

  void read(const PatchRegions& regions, std::size_t which, std::uint32_t patch, const PatchFrame& frame);
  /// True if the line along the normal through (x, y) meets the part; height: that of the common point.
  bool meets(const Part& part, const Vec3& x, double& height) const;

 private:
  std::vector<std::uint32_t> stamp_;  // by element: the patch that read it last
  std::uint32_t now_ = 0;
};

/// The largest height of b's region above a's on a line along the normal, and at least 0.
class PatchDepth {
 public:
  double of(ProjectedRegion& a, ProjectedRegion& b);

 private:
  void try_points(const std::vector<Vec3>& points, const ProjectedRegion& other, double sign);
  void try_sides(const ProjectedRegion& a, const ProjectedRegion& b);
  double best_ = 0;
  std::vector<std::uint32_t> order_a_, order_b_;
};

}  // namespace morula::detail
