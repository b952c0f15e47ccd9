// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Which corners a leaf tests: all others lie among them.
#include "update/points/ownership.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <optional>
#include <set>
#include <vector>

#include "../bodies.hpp"
#include "update/points/facet_hull.hpp"

namespace morula {
using namespace detail;
namespace {

// Barycentric coordinates of a corner in a facet, by its second and third vertex; none when it is not in its plane.
std::optional<std::array<double, 2>> in_plane(const Cover& cover, const Facet& facet, std::uint32_t corner) {
  std::array<double, 3> weight{};
  const auto add = [&](std::uint32_t vertex, double w) {
    const auto at = std::find(facet.begin(), facet.end(), vertex);
    if (w != 0 && at == facet.end()) return false;
    if (w != 0) weight[static_cast<std::size_t>(at - facet.begin())] += w;
    return true;
  };
  if (corner < cover.vertex_count) {
    if (!add(corner, 1)) return std::nullopt;
  } else {
    const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
    for (int k = 0; k < 3; ++k)
      if (!add(cut.vertex[k], cut.weight[k])) return std::nullopt;
  }
  return {{weight[1], weight[2]}};
}

double to_segment(const std::array<double, 2>& p, const std::array<double, 2>& a, const std::array<double, 2>& b) {
  const double x = b[0] - a[0], y = b[1] - a[1], squared = x * x + y * y;
  const double along = squared > 0 ? ((p[0] - a[0]) * x + (p[1] - a[1]) * y) / squared : 0;
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p[0] - a[0] - t * x, p[1] - a[1] - t * y);
}

// By brute force: p lies between some three of the points, however near these are to each other, or beside the segment
// of two, no farther off than corners may be left out.
bool surrounded(const std::array<double, 2>& p, const std::vector<std::array<double, 2>>& points) {
  constexpr double allowed = hull_tolerance + 1e-11;
  const auto cross = [](const auto& a, const auto& b, const auto& c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
  };
  for (const auto& a : points)
    for (const auto& b : points) {
      if (to_segment(p, a, b) <= allowed) return true;
      for (const auto& c : points)
        if (cross(a, b, c) > 0 && cross(p, b, c) >= 0 && cross(a, p, c) >= 0 && cross(a, b, p) >= 0) return true;
    }
  return false;
}

TEST(Ownership, every_corner_is_listed_or_surrounded_by_listed_ones_of_its_facet) {
  std::vector<test::Specimen> specimens = test::specimens();
  const Mesh limb = sample_body("limb", 16);
  specimens.push_back({"limb, parts traded", limb, build(limb, {.depth = 2})});
  for (const test::Specimen& b : specimens) {
    const Cover& cover = b.model.cover;
    const LeafOrder order = depth_first_leaves(b.model.tree);
    ASSERT_EQ(order.leaves.size(), b.model.tree.leaf_count());
    EXPECT_EQ(order.end[0], order.leaves.size());
    const std::vector<std::uint8_t> all(order.leaves.size(), 1);
    const Ownership owned = share_points(b.mesh, cover, order, all, hull_tolerance);
    std::size_t dropped = 0;
    for (std::size_t k = 0; k < order.leaves.size(); ++k) {
      const auto points = owned.of_leaf(k);
      ASSERT_TRUE(std::is_sorted(points.begin(), points.end()));
      EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end());
      std::set<std::uint32_t> corners, listed;
      for (const std::uint32_t c : cover.region_corners(order.leaves[k])) corners.insert(c);
      for (const std::uint32_t p : points)
        listed.insert(p < owned.vertices.size() ? owned.vertices[p]
                                                : cover.vertex_count + owned.cut_points[p - owned.vertices.size()]);
      EXPECT_TRUE(std::includes(corners.begin(), corners.end(), listed.begin(), listed.end()));
      for (std::uint32_t p = cover.region_begin[order.leaves[k]]; p < cover.region_end[order.leaves[k]]; ++p) {
        const Facet& facet = b.mesh.facets[cover.patch_facet[p]];
        std::vector<std::array<double, 2>> kept;
        for (const std::uint32_t c : listed)
          if (const auto at = in_plane(cover, facet, c)) kept.push_back(*at);
        for (const std::uint32_t c : cover.patch(p)) {
          if (listed.contains(c)) continue;
          ++dropped;
          ASSERT_GE(c, cover.vertex_count);
          EXPECT_TRUE(surrounded(*in_plane(cover, facet, c), kept)) << b.name << ", leaf " << k << ", corner " << c;
        }
      }
    }
    if (b.name == "bumpy" || b.name.starts_with("limb")) {
      EXPECT_GT(dropped, 100u) << b.name;
    }
    // Vertices of the first leaf have the first numbers.
    const auto first = owned.of_leaf(0);
    for (std::size_t i = 0; i < first.size() && first[i] < owned.vertices.size(); ++i) EXPECT_EQ(first[i], i);
  }
}

}  // namespace
}  // namespace morula
