// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Patches of a facet that become one, judged in extended precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/power_diagram.hpp>
#include <numeric>
#include <random>
#include <tree/joined_patches.hpp>

namespace morula {
using namespace detail;
namespace {

using Real = long double;
using Patch = std::vector<Barycentric>;

Real twice_area(const Barycentric& a, const Barycentric& b, const Barycentric& c) {
  const Real ux = Real{b[1]} - a[1], uy = Real{b[2]} - a[2], vx = Real{c[1]} - a[1], vy = Real{c[2]} - a[2];
  return ux * vy - uy * vx;
}

Real twice_area(const Patch& patch) {
  Real area = 0;
  for (std::size_t k = 2; k < patch.size(); ++k) area += twice_area(patch[0], patch[k - 1], patch[k]);
  return area;
}

// By how far a point is outside a counter-clockwise convex polygon, at most 2^-60 of it lost to rounding.
Real distance_outside(const Patch& polygon, const Barycentric& p) {
  Real most = -1;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Barycentric &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const Real length = std::hypot(Real{b[1]} - a[1], Real{b[2]} - a[2]);
    most = std::max(most, -twice_area(a, b, p) / length);
  }
  return most;
}

std::vector<Patch> joined(const std::vector<Patch>& patches) {
  PatchJoiner joiner;
  std::vector<Barycentric> corners;
  for (const Patch& patch : patches) {
    joiner.add(patch);
    corners.insert(corners.end(), patch.begin(), patch.end());
  }
  std::vector<Patch> result;
  for (const PatchJoiner::Polygon& polygon : joiner.join()) {
    Patch& made = result.emplace_back();
    for (const std::uint32_t c : polygon.corners) made.push_back(corners[c]);
  }
  return result;
}

// Of points on an edge of the facet the other two coordinates are rounded, and the edge is straight all the same.
constexpr Real rounding = 0x1p-52L;

// What join() promises, whatever the patches.
void expect_same_surface(const std::vector<Patch>& patches, const std::vector<Patch>& result) {
  EXPECT_LE(result.size(), patches.size());
  Real before = 0, after = 0;
  for (const Patch& patch : patches) before += twice_area(patch);
  for (const Patch& patch : result) after += twice_area(patch);
  EXPECT_NEAR(static_cast<double>(before), static_cast<double>(after), 1e-13);
  for (const Patch& patch : result) {
    ASSERT_GE(patch.size(), 3u);
    for (std::size_t k = 0; k < patch.size(); ++k)
      EXPECT_GE(twice_area(patch[k], patch[(k + 1) % patch.size()], patch[(k + 2) % patch.size()]), -rounding);
    for (const Barycentric& b : patch)
      EXPECT_TRUE(std::any_of(patches.begin(), patches.end(), [&](const Patch& p) {
        return std::find(p.begin(), p.end(), b) != p.end();
      })) << "a corner that no patch has";
  }
  for (const Patch& patch : patches)
    EXPECT_TRUE(std::any_of(result.begin(), result.end(), [&](const Patch& made) {
      return std::all_of(patch.begin(), patch.end(),
                         [&](const Barycentric& b) { return distance_outside(made, b) <= rounding; });
    })) << "a patch that is in no polygon as a whole";
}

// The facet between the lines `from` and `to` of weight `of` constant.
Patch slab(std::size_t of, double from, double to) {
  const std::size_t left = (of + 1) % 3, right = (of + 2) % 3;
  const auto at = [&](std::size_t side, double weight) {
    Barycentric b{0, 0, 0};
    b[of] = weight;
    b[side] = 1 - weight;
    return b;
  };
  if (to == 1) return {at(left, from), at(right, from), at(left, 1)};
  return {at(left, from), at(right, from), at(right, to), at(left, to)};
}

TEST(JoinedPatches, of_a_needle_are_one_for_each_run_of_slabs) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t of = static_cast<std::size_t>(trial) % 3;
    std::vector<double> cuts{0, 1};
    for (int k = static_cast<int>(random.uniform(1, 40)); k > 0; --k)
      cuts.push_back(random.uniform() * random.uniform());
    std::sort(cuts.begin(), cuts.end());
    std::vector<Patch> patches;
    std::size_t runs = 0;
    bool owned = false;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
      const bool owned_before = std::exchange(owned, random.uniform() < 0.7);
      if (!owned) continue;
      runs += owned_before ? 0 : 1;
      patches.push_back(slab(of, cuts[k], cuts[k + 1]));
    }
    std::shuffle(patches.begin(), patches.end(), std::mt19937(static_cast<unsigned>(trial)));
    const std::vector<Patch> result = joined(patches);
    expect_same_surface(patches, result);
    EXPECT_EQ(result.size(), runs) << trial;
    // Cuts inside a run leave no corner: they are on edges of the facet, whatever the rounding of their weights.
    for (const Patch& patch : result) EXPECT_LE(patch.size(), 4u) << trial;
  }
}

// Cut again and again, as by levels of a tree: what is left of a cell is one polygon.
TEST(JoinedPatches, of_a_cell_are_the_cell_however_often_it_was_cut) {
  Random random(8);
  std::size_t least = 1000;
  for (int trial = 0; trial < 200; ++trial) {
    const Triangle t{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0.2, 0.01 + random.uniform(), 0}};
    const FacetGeometry facet{t, {0, 1, 2}};
    const auto spheres = [&](int count) {
      std::vector<Sphere> made;
      for (int k = 0; k < count; ++k)
        made.push_back({Vec3{random.uniform(), random.uniform(), 0}, random.uniform(0, 0.5)});
      return made;
    };
    const auto cut_into = [&](const std::vector<Patch>& patches, const std::vector<Sphere>& by) {
      std::vector<std::uint32_t> all(by.size());
      std::iota(all.begin(), all.end(), 0u);
      CutFacet cut;
      for (const Patch& patch : patches) cut_by_power(facet, patch, by, all, cut);
      return cut;
    };
    std::vector<Patch> patches{{whole_facet.begin(), whole_facet.end()}};
    for (int level = 0; level < 2; ++level) {
      const CutFacet cut = cut_into(patches, spheres(4));
      patches.clear();
      for (std::size_t k = 0; k < cut.size(); ++k) patches.push_back({cut.polygon(k).begin(), cut.polygon(k).end()});
    }
    const std::vector<Sphere> owners = spheres(3);
    const CutFacet cut = cut_into(patches, owners);
    for (std::uint32_t owner = 0; owner < owners.size(); ++owner) {
      std::vector<Patch> owned;
      for (std::size_t k = 0; k < cut.size(); ++k)
        if (cut.owner[k] == owner) owned.push_back({cut.polygon(k).begin(), cut.polygon(k).end()});
      if (owned.empty()) continue;
      const std::vector<Patch> result = joined(owned);
      expect_same_surface(owned, result);
      EXPECT_EQ(result.size(), 1u) << trial;
      if (owned.size() > 1) least = std::min(least, owned.size());
    }
  }
  EXPECT_LT(least, 1000u) << "nothing was to be joined";
}

TEST(JoinedPatches, stay_apart_where_their_union_is_not_convex) {
  const auto quad = [](double b1, double b2, double width, double height) {
    const auto at = [](double x, double y) { return Barycentric{1 - x - y, x, y}; };
    return Patch{at(b1, b2), at(b1 + width, b2), at(b1 + width, b2 + height), at(b1, b2 + height)};
  };
  // An L, and a notch of a billionth.
  for (const double height : {0.125, 0.25 - 0x1p-30}) {
    const std::vector<Patch> patches{quad(0, 0, 0.25, 0.25), quad(0.25, 0, 0.25, height)};
    EXPECT_EQ(joined(patches), patches) << height;
  }
  // A ring about a hole: no two neighbors that stay in line make more than a side of it.
  const std::vector<Patch> ring{quad(0, 0, 0.25, 0.125), quad(0.25, 0, 0.125, 0.25), quad(0.125, 0.25, 0.25, 0.125),
                                quad(0, 0.125, 0.125, 0.25)};
  const std::vector<Patch> result = joined(ring);
  expect_same_surface(ring, result);
  EXPECT_EQ(result.size(), 4u);
  // With the hole no two are convex together, but all five are.
  std::vector<Patch> pinwheel = ring;
  pinwheel.push_back(quad(0.125, 0.125, 0.125, 0.125));
  EXPECT_EQ(joined(pinwheel).size(), 1u);
}

TEST(JoinedPatches, without_area_make_no_polygon_of_two_corners) {
  const auto on_line = [](double x) { return Barycentric{1 - 2 * x, x, x}; };
  const std::vector<Patch> patches{{on_line(0.125), on_line(0.25), on_line(0.25)},
                                   {on_line(0.25), on_line(0.25), on_line(0.375)}};
  EXPECT_EQ(joined(patches), patches);
}

}  // namespace
}  // namespace morula
