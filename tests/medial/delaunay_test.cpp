// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/delaunay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <set>
#include <string>

namespace morula::test {
using namespace detail;
namespace {

__extension__ typedef __int128 Wide;
using WidePoint = std::array<Wide, 3>;

WidePoint from(const LatticePoint& a, const LatticePoint& b) {
  return {Wide{b[0]} - a[0], Wide{b[1]} - a[1], Wide{b[2]} - a[2]};
}
Wide dot(const WidePoint& a, const WidePoint& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
WidePoint cross(const WidePoint& a, const WidePoint& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

constexpr std::size_t brute_force_limit = 1000;

/// Everything a Delaunay tetrahedralization is, by brute force and exactly: its spheres hold no point (by their
/// centers, which are fractions: another formula than the library's determinant), no point is outside of its hull,
/// facets are shared by two, every point is a corner. Of many points only those across a facet are looked at, which is
/// enough as long as tetrahedra do not overlap.
void expect_delaunay(const Delaunay& delaunay, const std::string& name) {
  std::set<std::uint32_t> used;
  std::size_t wrong_links = 0, flat = 0, inside = 0, outside = 0;
  for (std::uint32_t slot = 0; slot < delaunay.slots().size(); ++slot) {
    if (!delaunay.is_alive(slot)) continue;
    const Delaunay::Tetrahedron& t = delaunay.slots()[slot];
    for (std::size_t k = 0; k < 4; ++k) {
      const Delaunay::Tetrahedron& neighbor = delaunay.slots()[t.neighbors[k]];
      if (!delaunay.is_alive(t.neighbors[k]) ||
          std::count(neighbor.neighbors.begin(), neighbor.neighbors.end(), slot) != 1) {
        ++wrong_links;
        continue;
      }
      // The corners across from each other differ, the other three are the same.
      const auto back = std::find(neighbor.neighbors.begin(), neighbor.neighbors.end(), slot);
      auto mine = t.vertices, its = neighbor.vertices;
      mine[k] = its[static_cast<std::size_t>(back - neighbor.neighbors.begin())] = 0xfffffffe;
      std::sort(mine.begin(), mine.end());
      std::sort(its.begin(), its.end());
      if (mine != its) ++wrong_links;
    }
    const auto& points = delaunay.points();
    const LatticePoint& a = points[t.vertices[0]];
    const WidePoint b = from(a, points[t.vertices[1]]), c = from(a, points[t.vertices[2]]);
    if (delaunay.is_ghost(slot)) {
      const std::size_t step = points.size() <= brute_force_limit ? 1 : 97;
      for (std::size_t i = 0; i < points.size(); i += step) outside += dot(cross(b, c), from(a, points[i])) > 0;
      continue;
    }
    used.insert(t.vertices.begin(), t.vertices.end());
    const WidePoint d = from(a, points[t.vertices[3]]);
    const Wide volume = dot(cross(b, c), d);
    flat += volume <= 0;
    const WidePoint cd = cross(c, d), db = cross(d, b), bc = cross(b, c);
    WidePoint twice_center;  // times the volume
    for (std::size_t i = 0; i < 3; ++i) twice_center[i] = dot(b, b) * cd[i] + dot(c, c) * db[i] + dot(d, d) * bc[i];
    const auto look_at = [&](const LatticePoint& p) {
      const WidePoint x = from(a, p);
      inside += dot(x, x) * volume < dot(x, twice_center);
    };
    if (points.size() <= brute_force_limit) std::for_each(points.begin(), points.end(), look_at);
    for (const std::uint32_t neighbor : t.neighbors) {
      for (const std::uint32_t vertex : delaunay.slots()[neighbor].vertices) {
        if (vertex != Delaunay::no_point) look_at(points[vertex]);
      }
    }
  }
  EXPECT_EQ(wrong_links, 0u) << name;
  EXPECT_EQ(flat, 0u) << name;
  EXPECT_EQ(inside, 0u) << name;
  EXPECT_EQ(outside, 0u) << name;
  EXPECT_EQ(used.size(), delaunay.points().size()) << name;
}

LatticePoint random_point(Random& random, double lower = 0, double upper = Delaunay::lattice_size) {
  LatticePoint p;
  for (std::int32_t& x : p) x = static_cast<std::int32_t>(random.uniform(lower, upper));
  return p;
}

std::vector<LatticePoint> shuffled(std::vector<LatticePoint> points, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = points.size(); i > 1; --i) std::swap(points[i - 1], points[random.next() % i]);
  return points;
}

std::vector<LatticePoint> cube_lattice(std::int32_t n, std::int32_t step) {
  std::vector<LatticePoint> points;
  for (std::int32_t x = 0; x < n; ++x) {
    for (std::int32_t y = 0; y < n; ++y) {
      for (std::int32_t z = 0; z < n; ++z) points.push_back({x * step, y * step, z * step});
    }
  }
  return points;
}

/// Points of the lattice exactly on a sphere: all signs and orders of the ways to write a square as three squares.
std::vector<LatticePoint> exactly_cospherical() {
  std::vector<LatticePoint> points;
  constexpr std::int32_t radius = 45, scale = 11000, middle = 1 << 19;
  for (std::int32_t x = -radius; x <= radius; ++x) {
    for (std::int32_t y = -radius; y <= radius; ++y) {
      for (std::int32_t z = -radius; z <= radius; ++z) {
        if (x * x + y * y + z * z != radius * radius) continue;
        points.push_back({middle + scale * x, middle + scale * y, middle + scale * z});
      }
    }
  }
  return points;
}

void expect_all_inserted(const std::vector<LatticePoint>& points, const std::string& name) {
  Delaunay delaunay;
  for (const LatticePoint& p : points) EXPECT_TRUE(delaunay.insert(p)) << name;
  expect_delaunay(delaunay, name);
}

TEST(Delaunay, spheres_are_empty_for_random_points) {
  Random random(1);
  std::vector<LatticePoint> points;
  for (int i = 0; i < 400; ++i) points.push_back(random_point(random));
  expect_all_inserted(points, "random");
}

TEST(Delaunay, spheres_are_empty_and_nothing_is_flat_for_lattices_in_any_order) {
  // A step of the whole lattice has the largest numbers there are.
  for (const auto& [n, step] : {std::pair{5, 1}, std::pair{6, 4096}, std::pair{2, Delaunay::lattice_size}}) {
    const std::vector<LatticePoint> points = cube_lattice(n, step);
    expect_all_inserted(points, "in order");
    for (std::uint64_t seed = 1; seed <= 5; ++seed) expect_all_inserted(shuffled(points, seed), "shuffled");
  }
}

TEST(Delaunay, spheres_are_empty_for_points_on_one_sphere) {
  const std::vector<LatticePoint> points = exactly_cospherical();
  ASSERT_GT(points.size(), 100u);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) expect_all_inserted(shuffled(points, seed), "cospherical");
  std::vector<LatticePoint> with_center = points;
  with_center.insert(with_center.begin() + 50, {1 << 19, 1 << 19, 1 << 19});
  expect_all_inserted(with_center, "cospherical with center");
}

TEST(Delaunay, twenty_thousand_points_in_space_and_on_the_sides_of_a_box) {
  Random random(6);
  std::vector<LatticePoint> in_space, on_sides;
  for (int i = 0; i < 20000; ++i) {
    in_space.push_back(random_point(random));
    LatticePoint p = random_point(random);
    p[random.next() % 3] = random.next() % 2 == 0 ? 0 : Delaunay::lattice_size;
    on_sides.push_back(p);
  }
  expect_all_inserted(in_space, "in space");
  expect_all_inserted(on_sides, "on sides");
}

TEST(Delaunay, points_of_one_line_or_plane_wait) {
  Random random(2);
  Delaunay delaunay;
  for (std::int32_t i = 0; i < 20; ++i) EXPECT_TRUE(delaunay.insert({i * 100, i * 200, 5000 - i * 50}));
  EXPECT_FALSE(delaunay.insert({100, 200, 4950}));
  EXPECT_TRUE(delaunay.slots().empty());
  // The plane of that line and the x axis.
  for (std::int32_t i = 0; i < 100; ++i) {
    const std::int32_t along = static_cast<std::int32_t>(random.next() % 50);
    const std::int32_t across = 1 + static_cast<std::int32_t>(random.next() % 9000);
    EXPECT_TRUE(delaunay.insert({across * 7 + along * 100, along * 200, 5000 - along * 50}));
  }
  EXPECT_TRUE(delaunay.slots().empty());
  EXPECT_TRUE(delaunay.created().empty());
  EXPECT_TRUE(delaunay.insert({30000, 5000, 500000}));
  EXPECT_TRUE(delaunay.removed().empty());
  EXPECT_FALSE(delaunay.created().empty());
  expect_delaunay(delaunay, "one plane and a point");
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(delaunay.insert(random_point(random)));
  expect_delaunay(delaunay, "one plane and many points");
}

TEST(Delaunay, refuses_duplicates_and_only_those) {
  Random random(3);
  Delaunay delaunay;
  std::set<LatticePoint> seen;
  for (int i = 0; i < 2000; ++i) {
    const LatticePoint p = random_point(random, 0, 8);
    const std::uint64_t size = delaunay.points().size();
    EXPECT_EQ(delaunay.insert(p), seen.insert(p).second);
    EXPECT_EQ(delaunay.points().size(), seen.size()) << size;
  }
  expect_delaunay(delaunay, "crowded");
}

TEST(Delaunay, says_which_slots_it_freed_and_filled) {
  Random random(4);
  Delaunay delaunay;
  std::set<std::uint32_t> alive;
  for (int i = 0; i < 300; ++i) {
    // A crowded lattice, so that ties and duplicates occur; the first few in one plane.
    LatticePoint p = random_point(random, 0, 10);
    if (i < 10) p[2] = 0;
    if (!delaunay.insert(p)) continue;
    for (const std::uint32_t slot : delaunay.removed()) EXPECT_EQ(alive.erase(slot), 1u);
    for (const std::uint32_t slot : delaunay.created()) EXPECT_TRUE(alive.insert(slot).second);
    for (std::uint32_t slot = 0; slot < delaunay.slots().size(); ++slot) {
      ASSERT_EQ(delaunay.is_alive(slot), alive.count(slot) == 1) << "slot " << slot;
    }
  }
}

TEST(Delaunay, circumcenters_are_as_far_from_all_corners) {
  Random random(5);
  Delaunay delaunay;
  // Thin: the hardest there are, since the offset is a small difference of large products.
  for (int i = 0; i < 200; ++i) {
    LatticePoint p = random_point(random);
    p[2] = static_cast<std::int32_t>(random.next() % 3);
    delaunay.insert(p);
  }
  for (std::uint32_t slot = 0; slot < delaunay.slots().size(); ++slot) {
    if (!delaunay.is_alive(slot) || delaunay.is_ghost(slot)) continue;
    const auto& vertices = delaunay.slots()[slot].vertices;
    const auto at = [&](std::size_t k) {
      const LatticePoint& p = delaunay.points()[vertices[k]];
      return Vec3(p[0], p[1], p[2]);
    };
    const Vec3 offset = delaunay.circumcenter_offset(slot);
    const double radius = length(offset);
    for (std::size_t k = 1; k < 4; ++k) EXPECT_NEAR(length(at(k) - at(0) - offset), radius, 1e-15 * radius);
  }
}

}  // namespace
}  // namespace morula::test
