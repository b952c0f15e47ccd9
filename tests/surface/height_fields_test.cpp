// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Height fields: regions that are left out of a search for crossings have none, however folded, wound or cracked.
#include "surface/pairs/height_fields.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <morula/collide/collider.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <numbers>

#include "surface/boxes/lazy_boxes.hpp"
#include "surface/boxes/tree_state.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

using detail::HeightFields;
using detail::SurfaceTreeState;

std::vector<FeaturePair> crossings_by_force(std::span<const Facet> facets, const std::vector<Vec3>& p) {
  std::vector<FeaturePair> found;
  const auto corners = [&](const Facet& f) { return Triangle{p[f[0]], p[f[1]], p[f[2]]}; };
  for (std::uint32_t f = 0; f < facets.size(); ++f)
    for (std::uint32_t g = f + 1; g < facets.size(); ++g) {
      const bool share = std::any_of(facets[f].begin(), facets[f].end(), [&](std::uint32_t v) {
        return std::find(facets[g].begin(), facets[g].end(), v) != facets[g].end();
      });
      if (!share && intersect(corners(facets[f]), corners(facets[g]))) found.push_back({PairKind::facet_facet, f, g});
    }
  return found;
}

/// Looks at all regions of a mesh.
struct Looked {
  SurfaceTreeState state;
  HeightFields fields;

  explicit Looked(const Mesh& mesh, const std::vector<Vec3>* positions = nullptr)
      : state(detail::make_surface_tree(mesh)) {
    if (positions != nullptr) state.pose.from = PositionView(*positions);
    EXPECT_TRUE(state.move(serial_workers()));
    fields.start(state, state.boxes);
    fields.find_all(serial_workers());
  }
  /// All facets as one region.
  bool is_one() const { return fields.is_one(state.boxes.levels.size(), 0); }
};
bool is_height_field(const Mesh& mesh) {
  return Looked(mesh).is_one();
}

using Height = std::function<double(double, double)>;
/// n by n squares from 0 to n in x and y, but for those that `keep` refuses.
Mesh sheet(
    int n, const Height& height, const std::function<bool(int, int)>& keep = [](int, int) { return true; }) {
  Mesh mesh;
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x) mesh.positions.push_back({1.0 * x, 1.0 * y, height(x, y)});
  const auto at = [&](int x, int y) { return static_cast<std::uint32_t>(y * (n + 1) + x); };
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      if (!keep(x, y)) continue;
      mesh.facets.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      mesh.facets.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  return mesh;
}
Mesh moved(const Mesh& mesh, const Vec3& by, double scale = 1) {
  return test::translated(test::scaled(mesh, scale), by);
}
/// A ramp round an axis, `turns` times, that rises by `pitch` a turn; more facets than `steps` times four have none.
Mesh ramp(int steps, double turns, double pitch) {
  Mesh mesh;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2 * std::numbers::pi * std::fmod(turns * i / steps, 1.0);
    for (const double radius : {1.0, 2.0, 3.0})
      mesh.positions.push_back({radius * std::cos(angle), radius * std::sin(angle), pitch * turns * i / steps});
  }
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(steps); ++i)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const std::uint32_t v = 3 * i + k;
      mesh.facets.push_back({v, v + 1, v + 4});
      mesh.facets.push_back({v, v + 4, v + 3});
    }
  return mesh;
}
Mesh turned_to(Mesh mesh, int axis, bool is_mirrored) {
  for (Vec3& p : mesh.positions) {
    for (int k = 0; k < axis; ++k) p = {p.z, p.x, p.y};
    if (is_mirrored) p = p * -1.0;
  }
  return mesh;
}
const Height flat = [](double, double) { return 0.0; };
const Height hilly = [](double x, double y) { return 0.3 * std::sin(x) + 0.2 * std::cos(2 * y); };

TEST(HeightFields, sheets_are_along_every_axis_from_both_sides) {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_mirrored : {false, true})
      for (const Height& height : {flat, hilly}) {
        const Mesh mesh = turned_to(sheet(9, height), axis, is_mirrored);
        EXPECT_TRUE(is_height_field(mesh));
        EXPECT_TRUE(is_height_field(test::inverted(mesh)));
      }
}

TEST(HeightFields, a_sheet_with_holes_is_one_and_so_are_sheets_side_by_side) {
  const Mesh pierced =
      sheet(9, hilly, [](int x, int y) { return (x < 3 || x > 5 || y < 2 || y > 4) && (x != 7 || y != 7); });
  EXPECT_TRUE(is_height_field(pierced));
  EXPECT_TRUE(is_height_field(test::joined(sheet(4, hilly), moved(sheet(4, hilly), {7, 0, 0}))));
  EXPECT_TRUE(is_height_field(test::inverted(test::joined(sheet(4, hilly), moved(sheet(4, hilly), {0, 7, 3})))));
}

TEST(HeightFields, sheets_above_each_other_are_none) {
  for (const bool is_flipped : {false, true})
    for (const double height : {0.0, 0.1, 5.0}) {
      const Mesh both = test::joined(sheet(6, hilly), moved(sheet(4, hilly), {1.5, 1.5, height}, 0.5));
      EXPECT_FALSE(is_height_field(is_flipped ? test::inverted(both) : both)) << height;
    }
  // In a hole, and beside the hole.
  const auto pierced = [](int x, int y) { return x < 2 || x > 5 || y < 2 || y > 5; };
  EXPECT_FALSE(is_height_field(test::joined(sheet(8, flat, pierced), moved(sheet(4, flat), {0.25, 2, 1}, 0.25))));
}

TEST(HeightFields, ramps_are_until_they_come_round) {
  EXPECT_TRUE(is_height_field(ramp(40, 0.9, 1)));
  EXPECT_FALSE(is_height_field(ramp(40, 1, 1)));
  EXPECT_FALSE(is_height_field(ramp(40, 1.1, 1)));
  EXPECT_FALSE(is_height_field(ramp(60, 2.5, 1)));
  EXPECT_FALSE(is_height_field(ramp(60, 2.5, 0)));
  // A spiral of which parts are.
  const Mesh spiral = ramp(300, 3.3, 4);
  const Looked looked(spiral);
  EXPECT_FALSE(looked.is_one());
  std::size_t fields = 0;
  for (std::uint32_t region = 0; 64 * region < spiral.facets.size(); ++region)
    fields += looked.fields.is_one(1, region) ? 1u : 0u;
  EXPECT_GT(fields, 0u);
}

TEST(HeightFields, what_folds_stands_upright_or_has_no_area_is_none) {
  Mesh folded = sheet(6, flat);
  for (Vec3& p : folded.positions) p = {p.x < 4 ? p.x : 8 - p.x, p.y, p.x < 4 ? 0.0 : 1.0};
  EXPECT_FALSE(is_height_field(folded));
  Mesh upright = sheet(6, flat);
  for (Vec3& p : upright.positions) p = {std::min(p.x, 3.0), p.y, std::max(p.x, 3.0)};
  // About x and z by turns: no direction is that of all.
  EXPECT_FALSE(is_height_field(upright));
  Mesh pinched = sheet(6, flat);
  pinched.positions[24] = pinched.positions[25];
  EXPECT_FALSE(is_height_field(pinched));
  EXPECT_FALSE(is_height_field(test::box_mesh({0, 0, 0}, {1, 1, 1})));
}

TEST(HeightFields, odd_edges_and_vertices_make_none) {
  Mesh fin = sheet(4, flat);
  fin.positions.push_back({2, 2.5, 4});
  fin.facets.push_back({12, 13, 25});
  EXPECT_FALSE(is_height_field(fin));
  Mesh turned = sheet(4, flat);
  std::swap(turned.facets[9][0], turned.facets[9][1]);
  EXPECT_FALSE(is_height_field(turned));
  Mesh point = sheet(4, flat);
  point.facets.push_back({3, 3, 4});
  EXPECT_FALSE(is_height_field(point));
}

TEST(HeightFields, squares_that_share_corners_are_until_they_turn_over_each_other) {
  const auto is_field = [](const Mesh& mesh) {
    const bool is_one = is_height_field(mesh);
    EXPECT_EQ(is_one, is_height_field(test::inverted(mesh)));
    EXPECT_TRUE(!is_one || crossings_by_force(mesh.facets, mesh.positions).empty());
    return is_one;
  };
  EXPECT_TRUE(is_field(sheet(4, flat, [](int x, int y) { return (x < 2) == (y < 2); })));
  EXPECT_TRUE(is_field(sheet(9, hilly, [](int x, int y) { return x % 2 == y % 2; })));
  EXPECT_TRUE(is_field(sheet(9, hilly, [](int x, int y) { return x % 3 != 1 || y % 3 != 1; })));
  // One square turns about the corner that it shares with the other: free, edge on edge, over it, edge on edge, free.
  const double s = std::sqrt(0.5);
  const std::pair<Vec3, bool> turned[] = {{{1, 0, 0}, true},   {{s, s, 0}, true},   {{0, 1, 0}, false},
                                          {{-s, s, 0}, false}, {{-1, 0, 0}, false}, {{-s, -s, 0}, false},
                                          {{0, -1, 0}, false}, {{s, -s, 0}, true}};
  for (const auto& [x, free] : turned) {
    Mesh mesh = sheet(4, flat, [](int i, int j) { return (i < 2) == (j < 2); });
    for (Vec3& p : mesh.positions)
      if (const Vec3 d = p - Vec3{2, 2, 0}; d.x > 0 || d.y > 0)
        if (d.x >= 0 && d.y >= 0) p = Vec3{2, 2, 0.1 * (d.x + d.y)} + d.x * x + d.y * Vec3{-x.y, x.x, 0};
    EXPECT_EQ(is_field(mesh), free) << x.x << ' ' << x.y;
  }
}

TEST(HeightFields, an_island_in_a_bay_is_part_of_one_until_it_lies_over_the_shore) {
  // The box of the island is within that of the bay's shore.
  const Mesh bay = sheet(8, flat, [](int x, int y) { return x < 2 || x > 5 || y < 2; });
  for (const bool is_tied : {false, true})
    for (const double scale : {0.25, 0.5, 0.75, 1.2}) {
      Mesh mesh = test::joined(bay, moved(sheet(4, flat), {2.25, 2.25, 1}, scale));
      // By a corner of the bay.
      for (Facet& f : mesh.facets)
        for (std::uint32_t& v : f)
          if (is_tied && v == bay.positions.size()) v = 9 * 2 + 2;
      EXPECT_EQ(is_height_field(mesh), scale < 1) << scale;
      EXPECT_EQ(is_height_field(test::inverted(mesh)), scale < 1) << scale;
      for (Vec3& p : mesh.positions)
        if (p.z == 1) p = p + Vec3{-1.9, -1.9, 0};
      EXPECT_FALSE(is_height_field(mesh)) << scale;
      EXPECT_FALSE(is_height_field(test::inverted(mesh))) << scale;
    }
}

TEST(HeightFields, sheets_that_cross_at_common_corners_alone_are_none) {
  // Two sheets with the corners u and v in common. Seen from above their borders go through each other there, and touch
  // nowhere else.
  const auto patch = [](double low, double high, double height, std::uint32_t first) {
    Mesh mesh;
    for (const double y : {low, high, 0.6 * low + 0.4 * high, 0.4 * low + 0.6 * high})
      mesh.positions.push_back({3, y, height * y});
    const std::uint32_t a = first, b = first + 1, c = first + 2, d = first + 3;
    mesh.facets = {{0, a, c}, {0, c, d}, {0, d, b}, {a, 1, c}, {c, 1, d}, {d, 1, b}};
    return mesh;
  };
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {6, 0, 0}};
  for (const Mesh& one : {patch(-2, 4, 1, 2), patch(-4, 2, -1, 6)}) {
    mesh.positions.insert(mesh.positions.end(), one.positions.begin(), one.positions.end());
    mesh.facets.insert(mesh.facets.end(), one.facets.begin(), one.facets.end());
  }
  EXPECT_FALSE(is_height_field(mesh));
  EXPECT_FALSE(is_height_field(test::inverted(mesh)));
  for (const std::size_t first : {0u, 6u}) {
    Mesh one = mesh;
    one.facets.erase(one.facets.begin() + static_cast<std::ptrdiff_t>(first),
                     one.facets.begin() + static_cast<std::ptrdiff_t>(first) + 6);
    EXPECT_TRUE(is_height_field(one));
  }
}

TEST(HeightFields, sheets_that_cross_at_hollow_corners_alone_are_none) {
  // As above, but each has more than half a turn at the corner at which the other begins within it.
  const auto fan = [](std::uint32_t middle, const std::vector<std::uint32_t>& round) {
    std::vector<Facet> facets;
    for (std::size_t i = 0; i < round.size(); ++i) facets.push_back({middle, round[i], round[(i + 1) % round.size()]});
    return facets;
  };
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {3, 6, 0},  {-2, -4, 0},  {6, -4, 0}, {6, 6, 0},
                    {0, 6, 0}, {7, 10, 0}, {-4, 10, -5}, {3, 1, 0},  {1, 8, 1}};
  const std::vector<Facet> one = fan(8, {0, 2, 3, 4, 1, 5}), other = fan(9, {0, 1, 6, 7});
  for (const std::vector<Facet>& facets : {one, other}) {
    EXPECT_TRUE(is_height_field({mesh.positions, facets}));
    mesh.facets.insert(mesh.facets.end(), facets.begin(), facets.end());
  }
  EXPECT_FALSE(crossings_by_force(mesh.facets, mesh.positions).empty());
  EXPECT_FALSE(is_height_field(mesh));
  EXPECT_FALSE(is_height_field(test::inverted(mesh)));
}

TEST(HeightFields, have_no_crossings_in_random_facets_of_few_vertices) {
  // Facets that run counter-clockwise, on few points of a lattice: pinched everywhere, and over each other.
  Random random(23);
  std::size_t fields = 0, pinched = 0, crossed = 0;
  for (int round = 0; round < 30000; ++round) {
    Mesh mesh;
    const std::size_t points = 5 + random.next() % 8, facets = 2 + random.next() % 8;
    const auto whole = [&](std::uint64_t size) { return static_cast<double>(random.next() % size); };
    for (std::size_t i = 0; i < points; ++i) mesh.positions.push_back({whole(5), whole(5), whole(3)});
    for (int tries = 0; tries < 200 && mesh.facets.size() < facets; ++tries) {
      Facet f;
      for (std::uint32_t& v : f) v = static_cast<std::uint32_t>(random.next() % points);
      const Vec3 u = mesh.positions[f[1]] - mesh.positions[f[0]], w = mesh.positions[f[2]] - mesh.positions[f[0]];
      if (u.x * w.y > u.y * w.x && u.x * w.y - u.y * w.x < 7) mesh.facets.push_back(f);
    }
    if (mesh.facets.empty()) continue;
    mesh = turned_to(round % 2 == 0 ? mesh : test::inverted(mesh), round % 3, round % 4 < 2);
    const Looked looked(mesh);
    const bool has_crossings = !crossings_by_force(mesh.facets, mesh.positions).empty();
    crossed += has_crossings ? 1u : 0u;
    if (!looked.is_one()) continue;
    ++fields;
    std::vector<int> visits(points);
    for (const std::uint32_t slot : looked.state.borders.back().slots)
      ++visits[looked.state.blocks.vertex_of_slot[slot]];
    pinched += std::any_of(visits.begin(), visits.end(), [](int n) { return n > 1; }) ? 1u : 0u;
    ASSERT_FALSE(has_crossings) << "round " << round;
  }
  EXPECT_GT(fields, 1000u);
  EXPECT_GT(pinched, 300u);
  EXPECT_GT(crossed, 3000u);
}

TEST(HeightFields, a_crack_along_which_facets_touch_is_none) {
  // A slit sheet: the vertices of one column twice.
  Mesh slit = sheet(6, flat);
  for (std::uint32_t y = 1; y < 6; ++y) {
    const auto copy = static_cast<std::uint32_t>(slit.positions.size());
    slit.positions.push_back(slit.positions[7 * y + 3]);
    for (Facet& f : slit.facets) {
      const bool is_right = slit.positions[f[0]].x + slit.positions[f[1]].x + slit.positions[f[2]].x > 9;
      for (std::uint32_t& v : f)
        if (is_right && v == 7 * y + 3) v = copy;
    }
  }
  EXPECT_FALSE(is_height_field(slit));
  // A hole of three vertices on one line: the middle one touches the edge of the other two from the other side, where
  // there is no vertex that the facets share.
  Mesh crack;
  crack.positions = {{0, 0, 0},  {4, 0, 0},  {2, 0, 0},  {2, 3, 0},  {0, -3, 0},
                     {4, -3, 0}, {2, -4, 0}, {2, -3, 0}, {-2, 0, 0}, {6, 0, 0}};
  crack.facets = {{0, 1, 3}, {0, 4, 2}, {2, 4, 7}, {2, 7, 5}, {2, 5, 1}, {4, 6, 7},
                  {7, 6, 5}, {3, 8, 0}, {0, 8, 4}, {3, 1, 9}, {1, 5, 9}};
  EXPECT_EQ(crossings_by_force(crack.facets, crack.positions).size(), 2u);
  EXPECT_FALSE(is_height_field(crack));
  for (std::size_t k : {0u, 1u}) {
    Mesh open = crack;
    open.positions[2].y = k == 0 ? -0x1p-40 : 0x1p-40;
    EXPECT_EQ(is_height_field(open), k == 0);
  }
}

/// Few whole numbers, so that much is aligned, upright, doubled or folded, but not all of it.
Mesh random_field(Random& random) {
  const int n = 3 + static_cast<int>(random.next() % 8);
  const double jitter = random.next() % 3 == 0 ? 0 : random.uniform(0, 3);
  const double holes = random.next() % 2 == 0 ? 0 : random.uniform(0, 0.3);
  const auto whole = [&](double reach) { return std::round(random.uniform(-reach, reach)); };
  Mesh mesh = sheet(n, flat, [&](int, int) { return random.uniform(0, 1) >= holes; });
  for (Vec3& p : mesh.positions) p = Vec3{4 * p.x + whole(jitter), 4 * p.y + whole(jitter), whole(2)};
  if (random.next() % 3 == 0) {
    // Some vertices twice: slits.
    for (int k = 0; k < 6; ++k) {
      const auto v = static_cast<std::uint32_t>(random.next() % mesh.positions.size());
      const auto copy = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(mesh.positions[v]);
      if (random.next() % 2 == 0) mesh.positions[copy] = mesh.positions[v] + Vec3{whole(1), whole(1), whole(1)};
      for (Facet& f : mesh.facets)
        for (std::uint32_t& w : f)
          if (w == v && random.next() % 2 == 0) w = copy;
    }
  }
  if (random.next() % 4 == 0)
    mesh =
        test::joined(mesh, moved(sheet(2, flat), {whole(4.0 * n), whole(4.0 * n), whole(2)}, 1 + std::abs(whole(2))));
  if (random.next() % 2 == 0) mesh = test::inverted(mesh);
  if (mesh.facets.empty()) mesh.facets.push_back({0, 1, 2});
  return turned_to(mesh, static_cast<int>(random.next() % 3), random.next() % 2 == 0);
}

TEST(HeightFields, have_no_crossings_in_random_cracked_sheets) {
  Random random(7);
  std::size_t fields = 0, others = 0, crossed = 0;
  for (int round = 0; round < 4000; ++round) {
    const Mesh mesh = random_field(random);
    const Looked looked(mesh);
    const SurfaceTreeState& s = looked.state;
    for (std::size_t level = 1; level <= s.boxes.levels.size(); ++level) {
      const std::size_t size = std::size_t{8} << (3 * level);
      for (std::uint32_t region = 0; region * size < s.blocks.order.size(); ++region) {
        const std::size_t begin = region * size, end = std::min(s.blocks.order.size(), begin + size);
        const auto facets = std::span(s.blocks.facets_in_order).subspan(begin, end - begin);
        const std::size_t pairs = crossings_by_force(facets, mesh.positions).size();
        crossed += pairs > 0 ? 1u : 0u;
        const bool is_field = looked.fields.is_one(level, region);
        (is_field ? fields : others) += 1;
        ASSERT_TRUE(!is_field || pairs == 0) << "round " << round << ", level " << level << ", region " << region;
      }
    }
  }
  EXPECT_GT(fields, 1000u);
  EXPECT_GT(others, 1000u);
  EXPECT_GT(crossed, 1000u);
}

TEST(HeightFields, are_left_out_of_a_query_that_finds_what_brute_force_finds) {
  Random random(11);
  std::size_t total = 0, all_tests = 0;
  for (int round = 0; round < 300; ++round) {
    const Mesh mesh = round % 10 == 0 ? ramp(100 + round / 10, 2.3, 0.01 * (round % 3)) : random_field(random);
    SurfaceTree tree(mesh);
    SurfaceCrossingQuery query, bit_by_bit({.budget = 100});
    const SurfaceQueryStatus all = query.run(tree);
    ASSERT_TRUE(all.finished);
    const std::vector<FeaturePair> expected = crossings_by_force(mesh.facets, mesh.positions);
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), query.pairs().begin(), query.pairs().end())) << round;
    SurfaceQueryStatus status = bit_by_bit.run(tree);
    for (int calls = 0; status && !status.finished && calls < 10000; ++calls) status = bit_by_bit.resume();
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), bit_by_bit.pairs().begin(), bit_by_bit.pairs().end()));
    total += expected.size();
    all_tests += all.box_tests;
  }
  EXPECT_GT(total, 3000u);
  EXPECT_GT(all_tests, 0u);
}

TEST(HeightFields, of_separate_facets_are_small_so_that_borders_stay_short) {
  // Facets that look upwards and have no vertex in common: all together they are a height field, with a border of all
  // their edges, which is not looked at.
  const Mesh whole = sheet(64, hilly);
  Mesh mesh;
  for (const Facet& f : whole.facets) {
    const Vec3 middle = (whole.positions[f[0]] + whole.positions[f[1]] + whole.positions[f[2]]) * (1.0 / 3);
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const std::uint32_t v : f) mesh.positions.push_back(middle + (whole.positions[v] - middle) * 0.9);
    mesh.facets.push_back({first, first + 1, first + 2});
  }
  const Looked looked(mesh);
  const std::vector<detail::RegionBorders>& borders = looked.state.borders;
  for (std::uint32_t region = 0; 64 * region < mesh.facets.size(); ++region)
    EXPECT_TRUE(looked.fields.is_one(1, region));
  EXPECT_EQ(borders[1].slots.size(), 3 * mesh.facets.size());
  for (std::size_t level = 2; level < borders.size(); ++level) EXPECT_TRUE(borders[level].slots.empty());
  EXPECT_FALSE(looked.is_one());
  // Of a sheet in one piece all borders are kept.
  const Looked one_piece(whole);
  for (const detail::RegionBorders& of_level : std::span(one_piece.state.borders).subspan(1))
    for (std::size_t region = 0; region + 1 < of_level.loops_begin.size(); ++region)
      EXPECT_LT(of_level.loops_begin[region], of_level.loops_begin[region + 1]);
  EXPECT_TRUE(one_piece.is_one());
}

TEST(HeightFields, are_those_of_the_present_pose) {
  const Mesh mesh = sheet(9, hilly);
  SurfaceTree tree(mesh);
  SurfaceCrossingQuery query;
  const SurfaceQueryStatus at_rest = query.run(tree);
  EXPECT_TRUE(query.pairs().empty());
  // One field: nothing to compare.
  EXPECT_EQ(at_rest.box_tests, 64u);
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions)
    if (p.x > 4) p = {8 - p.x, p.y, 0.5 - p.z};
  ASSERT_TRUE(tree.update(positions));
  ASSERT_TRUE(query.run(tree).finished);
  const std::vector<FeaturePair> expected = crossings_by_force(mesh.facets, positions);
  EXPECT_GT(expected.size(), 10u);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), query.pairs().begin(), query.pairs().end()));
  ASSERT_TRUE(tree.update(mesh.positions));
  EXPECT_EQ(query.run(tree).box_tests, 64u);
  EXPECT_TRUE(query.pairs().empty());
}

TEST(HeightFields, of_a_surface_that_follows_a_placed_body_are_those_of_where_it_is_placed) {
  // Seen along one axis alone: turned by a quarter, along another one.
  const Mesh mesh = sheet(9, [](double x, double y) { return std::sin(0.7 * x) * std::cos(1.3 * y); });
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 1});
  const Body body(mesh, model);
  Collider collider(mesh, body);
  SurfaceTree surface(mesh);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{1, 1, 1}})
    for (const double quarter : {0.5 * std::numbers::pi, -0.5 * std::numbers::pi, std::numbers::pi}) {
      if (axis.z != 0 && quarter > 3) continue;
      const double angle = axis.z != 0 ? quarter * 4 / 3 : quarter;
      collider.set_transform(RigidTransform::from_axis(axis, angle, {3, 2, 1}));
      ASSERT_TRUE(surface.follow(collider));
      detail::QueryBoxes boxes;
      boxes.start(detail::state_of(surface), detail::state_of(surface), 0, false, serial_workers());
      HeightFields fields;
      fields.start(detail::state_of(surface), boxes.a());
      fields.find_all(serial_workers());
      EXPECT_TRUE(fields.is_one(detail::state_of(surface).boxes.levels.size(), 0))
          << axis.x << axis.y << axis.z << ' ' << angle;
      // Looked at one by one, as a query with a budget does.
      HeightFields alone;
      alone.start(detail::state_of(surface), boxes.a());
      alone.find(1, 0);
      EXPECT_TRUE(alone.is_one(1, 0)) << axis.x << axis.y << axis.z << ' ' << angle;
    }
}

TEST(HeightFields, are_the_same_for_any_number_of_workers) {
  const Mesh mesh = sheet(60, [](double x, double y) { return std::sin(0.7 * x) * std::cos(1.3 * y); });
  const Looked serial(mesh);
  Looked parallel(mesh);
  Workers workers(4);
  parallel.fields.start(parallel.state, parallel.state.boxes);
  parallel.fields.find_all(workers);
  std::size_t fields = 0;
  for (std::size_t level = 1; level <= serial.state.boxes.levels.size(); ++level)
    for (std::uint32_t region = 0; region < 200; ++region) {
      EXPECT_EQ(serial.fields.is_one(level, region), parallel.fields.is_one(level, region));
      fields += serial.fields.is_one(level, region) ? 1u : 0u;
    }
  EXPECT_GT(fields, 20u);
}

}  // namespace
}  // namespace morula
