// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Facets of polygons against areas and parities in whole numbers, in the coordinates in which the polygons were made.
#include "geometry/polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <numeric>

namespace morula {
using namespace detail;
namespace {

struct Point {
  std::int64_t x, y;
  bool operator==(const Point&) const = default;
};
using Outline = std::vector<Point>;

std::int64_t doubled_area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}
std::int64_t doubled_area(const Outline& outline) {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point &a = outline[k], &b = outline[(k + 1) % outline.size()];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

// Crossings of a ray towards larger x; the point's coordinates are fractions that no corner has.
bool is_inside(const Outline& outline, double x, double y) {
  bool inside = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point &a = outline[k], &b = outline[(k + 1) % outline.size()];
    if ((static_cast<double>(a.y) > y) == (static_cast<double>(b.y) > y)) continue;
    const double at = static_cast<double>(a.x) +
                      (y - static_cast<double>(a.y)) * static_cast<double>(b.x - a.x) / static_cast<double>(b.y - a.y);
    inside = inside != (at > x);
  }
  return inside;
}

bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto sign = [](std::int64_t value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
  return sign(doubled_area(a, b, c)) * sign(doubled_area(a, b, d)) <= 0 &&
         sign(doubled_area(c, d, a)) * sign(doubled_area(c, d, b)) <= 0;
}
bool is_simple(const Outline& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const Point &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
      if (a == c || a == d || b == c || b == d) {
        // Neighbors: on one line they may not fold back.
        if (j != i + 1 && !(i == 0 && j == n - 1)) return false;
        const Point &tip = j == i + 1 ? b : a, &one = j == i + 1 ? a : b, &other = j == i + 1 ? d : c;
        if (doubled_area(tip, one, other) == 0 &&
            (one.x - tip.x) * (other.x - tip.x) + (one.y - tip.y) * (other.y - tip.y) >= 0)
          return false;
      } else if (cross(a, b, c, d)) {
        return false;
      }
    }
  return true;
}

// Random points whose tour is untangled until no two sides cross.
Outline random_simple(Random& random, std::size_t corners, std::uint64_t side) {
  for (;;) {
    Outline p;
    while (p.size() < corners) {
      const Point q{static_cast<std::int64_t>(random.next() % side), static_cast<std::int64_t>(random.next() % side)};
      if (std::find(p.begin(), p.end(), q) == p.end()) p.push_back(q);
    }
    bool changed = true;
    for (int round = 0; changed && round < 200; ++round) {
      changed = false;
      for (std::size_t i = 0; i < corners; ++i)
        for (std::size_t j = i + 2; j < corners; ++j) {
          if (i == 0 && j == corners - 1) continue;
          if (!cross(p[i], p[i + 1], p[j], p[(j + 1) % corners])) continue;
          std::reverse(p.begin() + static_cast<std::ptrdiff_t>(i) + 1, p.begin() + static_cast<std::ptrdiff_t>(j) + 1);
          changed = true;
        }
    }
    if (is_simple(p)) return p;
  }
}

// A plane in space: whole axes, so that corners are exact.
struct Plane {
  Vec3 origin, u, v;
  Vec3 operator()(const Point& p) const { return origin + u * static_cast<double>(p.x) + v * static_cast<double>(p.y); }
};
constexpr Plane flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

Plane random_plane(Random& random) {
  const auto whole = [&] { return std::floor(random.uniform(-9, 10)); };
  for (;;) {
    const Plane plane{{whole(), whole(), whole()}, {whole(), whole(), whole()}, {whole(), whole(), whole()}};
    const Vec3 normal = cross(plane.u, plane.v);
    if (dot(normal, normal) > 0) return plane;
  }
}

struct Cut {
  PolygonShape shape;
  std::vector<Facet> facets;
};
Cut cut(const Outline& outline, const Plane& plane, double scale = 1) {
  std::vector<Vec3> points;
  for (const Point& p : outline) points.push_back(plane(p) * scale);
  std::vector<std::uint32_t> corners(points.size());
  std::iota(corners.begin(), corners.end(), 0u);
  Cut result{{}, std::vector<Facet>(points.size() - 2)};
  PolygonCutter cutter;
  result.shape = cutter.cut(points, corners, result.facets);
  return result;
}

// Every side of the outline is one of a facet, and every other side of facets is there in both directions.
void expect_sides(const Outline& outline, const std::vector<Facet>& facets) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  const auto add = [&](std::uint32_t a, std::uint32_t b, int by) {
    if (a < b) sides[{a, b}] += by;
    if (b < a) sides[{b, a}] -= by;
  };
  for (const Facet& f : facets)
    for (std::size_t k = 0; k < 3; ++k) add(f[k], f[(k + 1) % 3], 1);
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (std::uint32_t k = 0; k < n; ++k) add(k, (k + 1) % n, -1);
  for (const auto& [side, count] : sides) EXPECT_EQ(count, 0) << side.first << " " << side.second;
}

// The facets fill the outline, none turned against it, none twice.
void expect_filled(const Outline& outline, const Cut& cut, Random& random) {
  ASSERT_EQ(cut.facets.size(), outline.size() - 2);
  expect_sides(outline, cut.facets);
  const std::int64_t area = doubled_area(outline);
  std::int64_t sum = 0;
  for (const auto& [a, b, c] : cut.facets) {
    const std::int64_t own = doubled_area(outline[a], outline[b], outline[c]);
    EXPECT_TRUE(area > 0 ? own >= 0 : own <= 0) << a << " " << b << " " << c;
    sum += own;
  }
  EXPECT_EQ(sum, area);
  std::int64_t least = outline[0].x, most = outline[0].x, low = outline[0].y, high = outline[0].y;
  for (const Point& p : outline) {
    least = std::min(least, p.x), most = std::max(most, p.x);
    low = std::min(low, p.y), high = std::max(high, p.y);
  }
  for (int k = 0; k < 60; ++k) {
    const double x = random.uniform(static_cast<double>(least), static_cast<double>(most)),
                 y = random.uniform(static_cast<double>(low), static_cast<double>(high));
    int holders = 0;
    for (const auto& [a, b, c] : cut.facets) holders += is_inside({outline[a], outline[b], outline[c]}, x, y);
    EXPECT_EQ(holders, is_inside(outline, x, y) ? 1 : 0) << x << " " << y;
  }
}

// No two sides cross inside of both, and around every place between the grid's lines the outline goes once or not at
// all.
bool goes_once_around(const Outline& p) {
  const std::size_t n = p.size();
  const auto sign = [](std::int64_t value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i + 1; j < n; ++j) {
      const Point &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
      if (sign(doubled_area(a, b, c)) * sign(doubled_area(a, b, d)) < 0 &&
          sign(doubled_area(c, d, a)) * sign(doubled_area(c, d, b)) < 0)
        return false;
    }
  Random random(1);
  for (int k = 0; k < 200; ++k) {
    const double x = random.uniform(0, 3), y = random.uniform(0, 3);
    int winding = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Point &a = p[i], &b = p[(i + 1) % n];
      const bool up = static_cast<double>(b.y) > y, was_up = static_cast<double>(a.y) > y;
      if (up == was_up) continue;
      const double at = static_cast<double>(a.x) + (y - static_cast<double>(a.y)) * static_cast<double>(b.x - a.x) /
                                                       static_cast<double>(b.y - a.y);
      if (at > x) winding += up ? 1 : -1;
    }
    if (winding != 0 && winding != 1) return false;
  }
  return true;
}

Outline rotated(Outline outline, std::size_t by) {
  std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(by), outline.end());
  return outline;
}
Outline reversed(Outline outline) {
  std::reverse(outline.begin(), outline.end());
  return outline;
}

const Outline ell{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};

TEST(Polygon, ell_is_filled_from_every_corner_both_ways) {
  Random random(1);
  for (std::size_t k = 0; k < ell.size(); ++k)
    for (const Outline& outline : {rotated(ell, k), reversed(rotated(ell, k))}) {
      const Cut result = cut(outline, flat);
      EXPECT_NE(result.shape.cut, PolygonCut::crossing);
      EXPECT_FALSE(result.shape.bent);
      expect_filled(outline, result, random);
    }
}

TEST(Polygon, random_ones_are_filled_in_any_plane_from_every_corner) {
  Random random(2);
  std::size_t concave = 0;
  for (int round = 0; round < 300; ++round) {
    // Few places make corners on straight lines; many make none.
    const std::size_t corners = 4 + random.next() % 12;
    const Outline outline = random_simple(random, corners, round % 2 == 0 ? 5 : 1000);
    const Plane plane = random_plane(random);
    for (std::size_t k = 0; k < corners; ++k) {
      const Outline turned = k % 2 == 0 ? rotated(outline, k) : reversed(rotated(outline, k));
      const Cut result = cut(turned, plane);
      ASSERT_NE(result.shape.cut, PolygonCut::crossing);
      EXPECT_FALSE(result.shape.bent);
      expect_filled(turned, result, random);
      if (HasFailure()) {
        for (const Point& p : turned) std::printf("{%d, %d}, ", static_cast<int>(p.x), static_cast<int>(p.y));
        FAIL() << "round " << round;
      }
      if (result.shape.cut != PolygonCut::ears) continue;
      ++concave;
      // Corners on straight lines leave no facet without area.
      for (const auto& [a, b, c] : result.facets) ASSERT_NE(doubled_area(turned[a], turned[b], turned[c]), 0);
    }
  }
  EXPECT_GT(concave, 1000u);
}

TEST(Polygon, convex_ones_are_fans_about_their_first_corner) {
  const Outline round{{4, 0}, {8, 1}, {9, 4}, {8, 7}, {4, 8}, {1, 7}, {0, 4}, {1, 1}};
  // Corners on straight sides, corners twice: facets without area, as ever.
  const Outline square{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  for (const Outline& outline : {round, square, Outline{{0, 0}, {1, 0}, {2, 0}, {3, 0}}, Outline(5, Point{1, 1})})
    for (std::size_t k = 0; k < outline.size(); ++k)
      for (const Outline& turned : {rotated(outline, k), reversed(rotated(outline, k))}) {
        const Cut result = cut(turned, {{1, 2, 3}, {2, 0, 1}, {0, 3, 1}});
        EXPECT_EQ(result.shape.cut, PolygonCut::fan);
        for (std::uint32_t f = 0; f < result.facets.size(); ++f) EXPECT_EQ(result.facets[f], (Facet{0, f + 1, f + 2}));
      }
}

TEST(Polygon, concave_quads_keep_the_fan_where_it_is_right) {
  const Outline dart{{0, 0}, {4, 0}, {1, 1}, {0, 4}};
  Random random(3);
  std::size_t fans = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Cut result = cut(rotated(dart, k), flat);
    fans += result.shape.cut == PolygonCut::fan;
    expect_filled(rotated(dart, k), result, random);
  }
  EXPECT_EQ(fans, 2u);
}

TEST(Polygon, holes_joined_to_the_outline_stay_holes) {
  // A square and a smaller one inside, joined by sides that go in and come back; a second hole from the first.
  const Outline keyhole{{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}};
  const Outline two_holes{{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {1, 1}, {1, 3}, {3, 3},
                          {5, 5}, {5, 7}, {7, 7}, {7, 5}, {5, 5}, {3, 3}, {3, 1}, {1, 1}};
  // Touches the outline at a corner.
  const Outline pinched{{0, 0}, {6, 0}, {6, 6}, {0, 6}, {0, 0}, {1, 3}, {3, 3}, {3, 1}};
  Random random(4);
  for (const Outline& outline : {keyhole, two_holes, pinched})
    for (std::size_t k = 0; k < outline.size(); ++k)
      for (const Outline& turned : {rotated(outline, k), reversed(rotated(outline, k))}) {
        const Cut result = cut(turned, {{1, 2, 3}, {1, 0, 1}, {0, 1, 2}});
        EXPECT_EQ(result.shape.cut, PolygonCut::ears);
        expect_filled(turned, result, random);
        ASSERT_FALSE(HasFailure()) << "from corner " << k;
      }
}

TEST(Polygon, sides_that_go_out_and_back_enclose_nothing) {
  const Outline spike{{0, 0}, {4, 0}, {4, 2}, {7, 2}, {4, 2}, {4, 4}, {0, 4}};
  const Outline hook{{0, 0}, {4, 0}, {4, 2}, {7, 2}, {7, 4}, {7, 2}, {4, 2}, {4, 4}, {0, 4}};
  const Outline inward{{0, 0}, {4, 0}, {4, 2}, {2, 2}, {2, 3}, {2, 2}, {4, 2}, {4, 4}, {0, 4}};
  Random random(5);
  for (const Outline& outline : {spike, hook, inward})
    for (std::size_t k = 0; k < outline.size(); ++k)
      for (const Outline& turned : {rotated(outline, k), reversed(rotated(outline, k))}) {
        const Cut result = cut(turned, flat);
        EXPECT_NE(result.shape.cut, PolygonCut::crossing);
        expect_filled(turned, result, random);
        ASSERT_FALSE(HasFailure()) << "from corner " << k;
      }
}

TEST(Polygon, ones_that_cross_themselves_are_named_and_become_fans) {
  const Outline bow{{0, 0}, {4, 4}, {4, 0}, {0, 4}};
  const Outline star{{0, 10}, {6, -8}, {-9, 3}, {9, 3}, {-6, -8}};
  // A loop inside, turned as the outline is: every facet of ears is turned well, and some overlap.
  const Outline loop{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 6}, {6, 6},
                     {6, 4}, {3, 4},  {3, 9},   {1, 9},  {1, 5}, {0, 5}};
  // Twice around its first corner.
  const Outline spiral{{0, 0}, {3, 0}, {1, 4}, {-4, 2}, {-4, -3}, {1, -5}, {5, 0}, {3, 5}, {-1, 6}};
  // Two triangles at a common corner, turned against each other.
  const Outline eight{{0, 0}, {4, 0}, {2, 2}, {1, 3}, {3, 3}, {2, 2}};
  for (const Outline& outline : {bow, star, loop, spiral, eight})
    for (std::size_t k = 0; k < outline.size(); ++k)
      for (const Outline& turned : {rotated(outline, k), reversed(rotated(outline, k))}) {
        ASSERT_FALSE(is_simple(turned));
        const Cut result = cut(turned, {{0, 0, 0}, {0, 1, 2}, {0, 3, 1}});
        EXPECT_EQ(result.shape.cut, PolygonCut::crossing) << outline.size() << " corners, from " << k;
        for (std::uint32_t f = 0; f < result.facets.size(); ++f) EXPECT_EQ(result.facets[f], (Facet{0, f + 1, f + 2}));
      }
}

TEST(Polygon, ones_that_cancel_out_are_not_seen_edge_on) {
  // Bow ties whose two halves have the same area, in planes through the third axis: only rounding tells their normal.
  Random random(8);
  for (int round = 0; round < 500; ++round) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-3, 3);
    const std::vector<Vec3> points{{x, y, z}, {2 * x, 2 * y, z + 1}, {2 * x, 2 * y, z}, {x, y, z + 1}};
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::vector<std::uint32_t> corners{k, (k + 1) % 4, (k + 2) % 4, (k + 3) % 4};
      std::vector<Facet> facets(2);
      PolygonCutter cutter;
      ASSERT_EQ(cutter.cut(points, corners, facets).cut, PolygonCut::crossing) << round;
    }
  }
}

TEST(Polygon, ones_that_touch_themselves_are_filled) {
  // Random tours over few places, of which no two sides cross and that go once around all that they enclose.
  Random random(9);
  std::size_t tried = 0;
  while (tried < 400) {
    Outline outline;
    const std::size_t count = 5 + random.next() % 5;
    while (outline.size() < count)
      outline.push_back({static_cast<std::int64_t>(random.next() % 4), static_cast<std::int64_t>(random.next() % 4)});
    if (doubled_area(outline) <= 0 || is_simple(outline) || !goes_once_around(outline)) continue;
    ++tried;
    const Cut result = cut(outline, flat);
    std::string text;
    for (const Point& p : outline) text += "{" + std::to_string(p.x) + ", " + std::to_string(p.y) + "}, ";
    ASSERT_NE(result.shape.cut, PolygonCut::crossing) << text;
    expect_filled(outline, result, random);
    ASSERT_FALSE(HasFailure()) << text;
  }
}

TEST(Polygon, decisions_are_exact_at_any_scale_and_by_a_last_bit) {
  Random random(6);
  for (int round = 0; round < 60; ++round) {
    const Outline outline = random_simple(random, 9, 50);
    const Plane plane = random_plane(random);
    const Cut expected = cut(outline, plane);
    for (const double scale : {0x1p-1000, 0x1p-400, 0x1p100, 0x1p900, -1.0}) {
      const Cut result = cut(outline, plane, scale);
      EXPECT_EQ(result.shape.cut, expected.shape.cut) << scale;
      EXPECT_EQ(result.shape.bent, expected.shape.bent) << scale;
      if (scale > 0) {
        EXPECT_EQ(result.facets, expected.facets) << scale;
      }
    }
  }
  // Outlines so thin, far along a slope, that products in double cannot tell which way they turn.
  for (int round = 0; round < 3000; ++round) {
    const Outline outline = random_simple(random, 4 + random.next() % 3, 4);
    const auto slope = [&] { return static_cast<double>((std::uint64_t{1} << 50) + random.next() % (1 << 30)); };
    const Outline turned = round % 2 == 0 ? outline : reversed(outline);
    const Cut result = cut(turned, {{0, 0, 0}, {slope(), slope(), 0}, {0, 1, 0}});
    ASSERT_NE(result.shape.cut, PolygonCut::crossing) << round;
    expect_filled(turned, result, random);
  }
  // A dent of one unit in the last place at the second corner: a fan about the first would turn over.
  const std::vector<Vec3> dented{{0, 0, 0}, {0.5, std::nextafter(0.5, 1.0), 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<Vec3> straight{{0, 0, 0}, {0.5, 0.5, 0}, {1, 1, 0}, {0, 1, 0}};
  const std::vector<std::uint32_t> corners{0, 1, 2, 3};
  std::vector<Facet> facets(2);
  PolygonCutter cutter;
  EXPECT_EQ(cutter.cut(dented, corners, facets).cut, PolygonCut::ears);
  EXPECT_EQ(cutter.cut(straight, corners, facets).cut, PolygonCut::fan);
}

TEST(Polygon, ones_that_no_plane_fits_are_named) {
  const auto is_bent = [](double height, double scale) {
    const std::vector<Vec3> points{Vec3{0, 0, height} * scale, Vec3{1, 0, 0} * scale, Vec3{1, 1, height} * scale,
                                   Vec3{0, 1, 0} * scale};
    const std::vector<std::uint32_t> corners{0, 1, 2, 3};
    std::vector<Facet> facets(2);
    PolygonCutter cutter;
    return cutter.cut(points, corners, facets).bent;
  };
  for (const double scale : {1.0, 0x1p-900, 0x1p900}) {
    EXPECT_FALSE(is_bent(0, scale));
    EXPECT_FALSE(is_bent(0.1, scale));  // 0.1 of 1.42
    EXPECT_TRUE(is_bent(0.2, scale));
    EXPECT_TRUE(is_bent(-1, scale));
  }
}

TEST(Polygon, long_ones_are_cut_in_time_or_named) {
  // A comb: a thousand teeth are cut; thirty thousand are more than anybody waits for.
  for (const std::int64_t teeth : {1000, 30000}) {
    Outline comb;
    for (std::int64_t k = 0; k < teeth; ++k) {
      comb.push_back({4 * k, k % 7});
      comb.push_back({4 * k + 1, 100 + k % 5});
    }
    comb.push_back({4 * teeth, 200});
    comb.push_back({-1, 200});
    const Cut result = cut(comb, flat);
    if (teeth > 1000) {
      EXPECT_EQ(result.shape.cut, PolygonCut::crossing);
      continue;
    }
    EXPECT_EQ(result.shape.cut, PolygonCut::ears);
    Random random(7);
    expect_filled(comb, result, random);
  }
}

}  // namespace
}  // namespace morula
