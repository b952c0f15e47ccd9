// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every allowance of an update at its limit: inputs whose rounding goes the wrong way, so that a corner is lost, or a
// bit, as soon as one of the allowances is taken away. scripts/mutants takes them away, one after the other.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/update/body.hpp>
#include <optional>

#include "bodies.hpp"
#include "update/points/rounding.hpp"
#include "update/rules/corner_walk.hpp"
#include "update/rules/incremental_walk.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double e = 0x1p-24;  // half a unit in the last place of a float, v of a double
constexpr double v = 0x1p-53;

Vec3 random_vector(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}
Vec3 random_direction(Random& random) {
  for (;;) {
    const Vec3 d = random_vector(random);
    if (squared_length(d) > 0.01 && squared_length(d) < 1) return normalized(d);
  }
}

// The walk over corners.

// A root over two leaves that own a point each.
class TwoLeaves {
 public:
  Vec3f root{}, leaf[2];
  LocalPoint point[2];

  void measure() {
    set_transform();
    walk_.measure(points_, spheres_, serial_workers());
    incremental_.forget();
  }
  // The root has gone `moved`, negative for not at all; the second leaf's point has changed or not.
  float measure_incremental(float moved, bool changed) {
    set_transform();
    Marks leaves(2), dirty(3);
    if (changed) leaves.add(1);
    const std::vector<IncrementalWalk::MovedNode> nodes(moved < 0 ? 0 : 1, {0, moved});
    incremental_.measure({walk_.chains(), walk_.reaches(), points_, spheres_}, leaves, nodes, dirty);
    return walk_.squared_reach(0);
  }
  // By itself, from the beginning.
  float measured_anew() const {
    float most = 0;
    for (const LocalPoint& p : point) most = std::max(most, squared_length(Vec3f{p.x, p.y, p.z} - root));
    return most;
  }

 private:
  static SphereTree make_tree() {
    SphereTree tree;
    tree.branching = 2;
    tree.append_level({}, std::vector<Sphere>(1));
    tree.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>(2));
    return tree;
  }
  static Ownership make_ownership() {
    Ownership ownership;
    ownership.begin = {0, 1, 2};
    ownership.points = {0, 1};
    return ownership;
  }
  void set_transform() {
    spheres_ = {{root, 0}, {leaf[0], 0}, {leaf[1], 0}};
    points_ = {point[0], point[1]};
  }

  SphereTree tree_ = make_tree();
  CornerWalk walk_{tree_, depth_first_leaves(tree_), make_ownership(), std::vector<std::uint8_t>{1, 1, 1}};
  IncrementalWalk incremental_{walk_.chains()};
  std::vector<Spheref> spheres_;
  std::vector<LocalPoint> points_;
};

LocalPoint local(const Vec3& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0};
}

// The root goes straight away from the first leaf's point, which so lies farther by the whole way: the bound is tight.
// The second leaf's point is nearer by a few units in the last place only.
void expect_farthest_beyond_the_way(double size, int trials, std::uint64_t seed) {
  Random random(seed);
  TwoLeaves two;
  for (int trial = 0; trial < trials; ++trial) {
    const Vec3 along = random_direction(random);
    const Vec3 from(Vec3f(random_vector(random) * size));
    two.root = Vec3f(from);
    two.point[0] = local(from - along * (size * random.uniform(0.1, 2)));
    two.point[1] = local(from);
    two.leaf[0] = {two.point[0].x, two.point[0].y, two.point[0].z};
    two.measure();
    two.root = Vec3f(from + along * (size * random.uniform(0.1, 2)));
    const Vec3 to(two.root);
    const double reach = distance(to, Vec3(two.leaf[0])) * (1 - random.uniform(-1, 4) * e);
    const Vec3 other = to + random_direction(random) * reach;
    two.point[1] = local(other);
    two.leaf[1] = Vec3f(other + random_direction(random) * size);
    const float found = two.measure_incremental(static_cast<float>(distance(to, from)), true);
    ASSERT_EQ(found, two.measured_anew()) << "trial " << trial << " of size " << size;
  }
}

TEST(CornerWalkAllowance, pays_for_rounding_where_a_bound_by_the_way_is_tight) {
  expect_farthest_beyond_the_way(1, 500000, 1);
}
TEST(CornerWalkAllowance, pays_for_squares_that_underflow) {
  for (const double size : {0x1p-66, 0x1p-72, 0x1p-75}) expect_farthest_beyond_the_way(size, 5000, 3);
}

// A leaf with so many points that some groups of them are left out: a root over it, and two points that count, far from
// each other in the list.
class ManyPoints {
 public:
  std::array<LocalPoint, 2> point{};

  ManyPoints() {
    SphereTree tree;
    tree.branching = 2;
    tree.append_level({}, std::vector<Sphere>(1));
    tree.append_level(std::vector<std::uint32_t>{1}, std::vector<Sphere>(1));
    Ownership ownership;
    ownership.begin = {0, static_cast<std::uint32_t>(count)};
    for (std::uint32_t i = 0; i < count; ++i) ownership.points.push_back(i);
    walk_.emplace(tree, depth_first_leaves(tree), ownership, std::vector<std::uint8_t>{1, 1});
    incremental_.emplace(walk_->chains());
  }
  // All from the beginning, then by groups: the center is where all other points are.
  void measure(const Vec3f& center) {
    points_.assign(count, {center.x, center.y, center.z, 0});
    points_[20] = point[0], points_[count - 20] = point[1];
    spheres_ = {{center, 0}, {center, 0}};
    walk_->measure(points_, spheres_, serial_workers());
    incremental_->forget();
    measure_incremental(0);
  }
  float measure_incremental(const Vec3f& center, float way) {
    spheres_[1].center = center;
    measure_incremental(way);
    return walk_->squared_reach(1);
  }
  float measured_anew() const {
    const auto squared = [&](const LocalPoint& p) { return squared_length(Vec3f{p.x, p.y, p.z} - spheres_[1].center); };
    return std::max(squared(point[0]), squared(point[1]));
  }
  std::size_t tested() const { return tested_; }  // of the last time

 private:
  static constexpr std::size_t count = 40 * points_per_group;
  void measure_incremental(float way) {
    Marks none(1), dirty(2);
    const std::vector<IncrementalWalk::MovedNode> moved{{1, way}};
    tested_ = incremental_->measure({walk_->chains(), walk_->reaches(), points_, spheres_}, none, moved, dirty);
  }

  std::optional<CornerWalk> walk_;
  std::optional<IncrementalWalk> incremental_;
  std::vector<LocalPoint> points_;
  std::vector<Spheref> spheres_;
  std::size_t tested_ = 0;
};

// The center goes straight towards the farthest point and away from the other one, which comes to be as far within a
// share of that. Returns how many points were tested in the end.
std::size_t expect_farthest_of_groups(double size, double share, int trials, std::uint64_t seed) {
  Random random(seed);
  ManyPoints many;
  std::size_t tested = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Vec3 along = random_direction(random);
    const Vec3f from(random_vector(random) * size);
    const double reach = size * random.uniform(0.5, 2);
    const Vec3f to(Vec3(from) + along * (reach * random.uniform(0.001, trial % 4 == 0 ? 0.3 : 0.01)));
    many.point[0] = local(Vec3(from) + along * reach);
    const double now = distance(Vec3(to), {many.point[0].x, many.point[0].y, many.point[0].z});
    many.point[1] = local(Vec3(to) - along * (now * (1 - random.uniform(-share, share))));
    many.measure(from);
    const float found = many.measure_incremental(to, static_cast<float>(distance(Vec3(to), Vec3(from))));
    EXPECT_EQ(found, many.measured_anew()) << "trial " << trial << " of size " << size;
    if (found != many.measured_anew()) break;
    tested += many.tested();
  }
  return tested;
}

TEST(CornerWalkAllowance, pays_for_rounding_where_a_group_is_left_out_narrowly) {
  constexpr int trials = 100000;
  EXPECT_LT(expect_farthest_of_groups(1, 3 * e, trials, 2), 20 * points_per_group * trials);  // else nothing was tried
}
TEST(CornerWalkAllowance, pays_for_squares_of_groups_that_underflow) {
  for (const double size : {0x1p-66, 0x1p-72, 0x1p-75}) expect_farthest_of_groups(size, 0.1, 5000, 4);
}

// A way so long that a step is nothing beside it: the step is seen all the same.
TEST(CornerWalkAllowance, sees_every_step_of_a_long_way) {
  TwoLeaves two;
  two.point[0] = local({-1, 0, 0});
  two.point[1] = local({0.5, 0, 0});
  two.leaf[0] = {-1, 0, 0};
  two.measure();
  float x = 0;
  for (const float step : {0x1p40f, -0x1p40f, 0x1p-14f, 0x1p-15f, 0x1p-14f}) {
    x += step;
    two.root = {x, 0, 0};
    EXPECT_EQ(two.measure_incremental(std::abs(step), false), two.measured_anew()) << x;
  }
}

// A strip whose right end is pulled along it: centers follow it, straight away from the left end, and both ends are
// nearly as far from them.
TEST(CornerWalkAllowance, updates_of_a_changed_end_have_the_bits_of_full_ones_where_centers_go_straight) {
  Mesh strip;
  constexpr int columns = 300;  // vertices are looked at in blocks: the left end has some of its own
  for (int i = 0; i <= columns; ++i)
    for (const double y : {-1e-3, 1e-3}) strip.positions.push_back({1.0 * i / columns, y, 0});
  for (std::uint32_t i = 0; i < columns; ++i) {
    strip.facets.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    strip.facets.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  const auto count = static_cast<std::uint32_t>(strip.positions.size());
  Random random(5);
  for (const int branching : {2, 3, 5}) {
    const CoveredTree model = test::hand_made_tree(strip, {.depth = 2, .branching = branching, .center_shift = 0.02});
    Body full(strip, model), partial(strip, model);
    std::vector<Vec3> positions = strip.positions;
    for (int frame = 0; frame < 2000; ++frame) {
      const VertexRange range{count - 2 * (1 + static_cast<std::uint32_t>(random.uniform(0, 40))), count};
      const double pull = random.uniform(-0.3, 0.8);
      for (std::uint32_t i = range.begin; i < range.end; ++i) positions[i].x = strip.positions[i].x + pull;
      ASSERT_TRUE(full.update(positions));
      ASSERT_TRUE(partial.update(positions, std::span(&range, 1)));
      ASSERT_EQ(partial.hash(), full.hash()) << "frame " << frame << ", branching " << branching;
    }
  }
}

// Radii, from corners as they are rounded.

struct HandMadePatch {
  std::uint32_t facet;
  std::vector<std::uint32_t> corners;
  Sphere sphere;  // of its leaf
};
// A root over one leaf for each patch. Patches need not tile anything: what a body promises of corners, it promises of
// these.
CoveredTree with_leaves(const Mesh& mesh, const std::vector<CutPoint>& cut_points,
                        const std::vector<HandMadePatch>& patches, const Sphere& root) {
  CoveredTree model;
  Cover& cover = model.cover;
  cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
  cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
  cover.cut_points = cut_points;
  cover.corner_begin = {0};
  std::vector<Sphere> leaves;
  const auto count = static_cast<std::uint32_t>(patches.size());
  cover.region_begin = {0};
  cover.region_end = {count};
  for (std::uint32_t p = 0; p < count; ++p) {
    cover.patch_facet.push_back(patches[p].facet);
    cover.corners.insert(cover.corners.end(), patches[p].corners.begin(), patches[p].corners.end());
    cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    cover.region_begin.push_back(p);
    cover.region_end.push_back(p + 1);
    leaves.push_back(patches[p].sphere);
  }
  model.tree.branching = std::max(2u, count);
  model.tree.append_level({}, std::vector<Sphere>{root});
  model.tree.append_level(std::vector<std::uint32_t>{count}, leaves);
  return model;
}

double excess_of(const Body& body, const std::vector<Vec3>& positions) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  return certify(body.cover(), positions, spheres).worst_excess;
}

// Leaves that are one cut point each, in large facets: nothing but the point's own rounding, which the narrowing of its
// vertices, of its weights and the sums add up to. It is largest where one vertex is opposite to the other two and
// coordinates lie a little above a power of two: up to 4.7 e of them was found.
TEST(CoveringRadius, pays_for_narrowing_and_for_moving_cut_points) {
  Random random(6);
  constexpr std::uint32_t facets = 16;
  const auto place_facet = [&](Vec3* corners) {
    for (int axis = 0; axis < 3; ++axis) {
      const double side = random.uniform() < 0.5 ? -1 : 1;
      for (int k = 0; k < 3; ++k) corners[k][axis] = (k == 0 ? side : -side) * random.uniform(0.5, 0.52);
    }
  };
  for (int round = 0; round < 200; ++round) {
    Mesh mesh;
    mesh.positions = {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
    std::vector<CutPoint> cut_points;
    std::vector<HandMadePatch> patches;
    for (std::uint32_t f = 0; f < facets; ++f) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.resize(first + 3);
      place_facet(&mesh.positions[first]);
      mesh.facets.push_back({first, first + 1, first + 2});
      const double a = random.uniform(0.28, 0.33), b = random.uniform(0.28, 0.33);
      cut_points.push_back({{first, first + 1, first + 2}, {1 - a - b, a, b}});
    }
    mesh.facets.push_back({0, 0, 1});  // the body's first vertex does not move, so the origin stays
    for (std::uint32_t f = 0; f < facets; ++f) {
      const auto cut = static_cast<std::uint32_t>(mesh.vertex_count()) + f;
      const CutPoint& c = cut_points[f];
      const Vec3 place = mesh.positions[c.vertex[0]] * c.weight[0] + mesh.positions[c.vertex[1]] * c.weight[1] +
                         mesh.positions[c.vertex[2]] * c.weight[2];
      patches.push_back({f, {cut, cut, cut}, {place, 1e-9}});
    }
    Body body(mesh, with_leaves(mesh, cut_points, patches, {{}, 4}));
    std::vector<Vec3> positions = mesh.positions;
    for (int pose = 0; pose < 20; ++pose) {
      for (std::size_t i = 2; i < positions.size(); i += 3) place_facet(&positions[i]);
      ASSERT_TRUE(body.update(positions));
      ASSERT_LE(excess_of(body, positions), 0) << round;
    }
  }
}

// Spheres whose centers are far outside the body: distances a thousand times the body's size, squared in float.
TEST(CoveringRadius, pays_for_distances_taken_in_float) {
  Random random(7);
  for (int round = 0; round < 500; ++round) {
    Mesh mesh;
    for (int i = 0; i < 3; ++i) mesh.positions.push_back(Vec3(Vec3f(random_vector(random))));
    mesh.facets = {{0, 1, 2}};
    const Vec3 away = random_direction(random) * random.uniform(500, 1000);
    Body body(mesh, with_leaves(mesh, {}, {{0, {0, 1, 2}, {away, 1100}}}, {{}, 4}));
    ASSERT_LE(excess_of(body, mesh.positions), 0) << round;
  }
}

// A body whose size is a few units in the last place of where it is.
TEST(CoveringRadius, pays_for_reading_centers_far_from_the_origin) {
  Random random(8);
  const Vec3 away{1e9, 1.1e9, 1.2e9};
  const double unit = 0x1p-22;  // of coordinates there
  for (int round = 0; round < 400; ++round) {
    Mesh mesh;
    for (int i = 0; i < 6; ++i) {
      const Vec3 p = random_vector(random) * 40.0;
      mesh.positions.push_back(away + Vec3{std::round(p.x), std::round(p.y), std::round(p.z)} * unit);
    }
    mesh.facets = {{0, 1, 2}, {3, 4, 5}};
    const double a = random.uniform(0.2, 0.4), b = random.uniform(0.2, 0.4);
    const std::vector<CutPoint> cuts{{{0, 1, 2}, {1 - a - b, a, b}}, {{3, 4, 5}, {1 - a - b, b, a}}};
    const Vec3 place = mesh.positions[0];
    Body body(mesh,
              with_leaves(mesh, cuts, {{0, {6, 6, 6}, {place, 1e-6}}, {1, {7, 7, 7}, {place, 1e-6}}}, {away, 1e-4}));
    std::vector<Vec3> positions = mesh.positions;
    for (int pose = 0; pose < 20; ++pose) {
      for (Vec3& p : positions) {
        const Vec3 step = random_vector(random) * 40.0;
        p = away + Vec3{std::round(step.x), std::round(step.y), std::round(step.z)} * unit;
      }
      ASSERT_TRUE(body.update(positions));
      ASSERT_LE(excess_of(body, positions), 0) << round;
    }
  }
}

// Distances whose squares vanish.
TEST(CoveringRadius, pays_for_squares_that_underflow) {
  for (const double size : {0x1p-64, 0x1p-70, 0x1p-75, 0x1p-80}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
    mesh.facets = {{0, 1, 2}};
    Body body(mesh, with_leaves(mesh, {}, {{0, {0, 1, 2}, {{}, size}}}, {{}, size}));
    std::vector<Vec3> positions = mesh.positions;
    for (int pose = 0; pose < 50; ++pose) {
      for (std::size_t i = 1; i < 3; ++i) positions[i] = positions[i] + Vec3{0.1 * size, -0.13 * size, 0.17 * size};
      ASSERT_TRUE(body.update(positions));
      ASSERT_LE(excess_of(body, positions), 0) << size;
    }
  }
}

// A cut point whose weights add up to 1 - s lies s times its coordinates nearer to the origin than its facet.
TEST(CoveringRadius, pays_for_weights_that_do_not_add_up) {
  constexpr double slack = 9e-13;
  const double away = 1e9;
  Mesh mesh;
  mesh.positions = {{away, away, away}, {away + 1, away, away}, {away, away + 1, away}};
  mesh.facets = {{0, 1, 2}};
  const std::vector<CutPoint> cuts{{{0, 1, 2}, {0.4 * (1 - slack), 0.3 * (1 - slack), 0.3 * (1 - slack)}}};
  const Vec3 place{away + 0.3, away + 0.3, away};
  Body body(mesh, with_leaves(mesh, cuts, {{0, {3, 3, 3}, {place, 1e-6}}, {0, {0, 1, 2}, {place, 1}}}, {place, 1}));
  EXPECT_LE(excess_of(body, mesh.positions), 0);
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p = {p.y, p.z, p.x};
  ASSERT_TRUE(body.update(positions));
  EXPECT_LE(excess_of(body, positions), 0);
}

// Corners around a leaf's share of a facet, each beside another one that sticks out by a little more or less than a
// hull may lose: where one is left out, its twin and the allowance for moving points have to contain it.
TEST(HullAllowance, what_is_left_out_stays_inside) {
  Random random(10);
  for (int round = 0; round < 2000; ++round) {
    Mesh mesh;
    mesh.positions = {{-1, -1, -1}, {1, 1, -1}, {-1, 1, 1}};
    mesh.facets = {{0, 1, 2}};
    const double far = random.uniform(0.1, 1.2) * (round % 2 == 0 ? 0x1p-19 : 0x1p-31), turned = random.uniform(0, 1);
    const double aside = random.uniform() < 0.5 ? -1 : 1;  // the twin comes first, or second
    std::vector<CutPoint> cuts;
    HandMadePatch patch{0, {}, {{}, 1}};
    for (int i = 0; i < 6; ++i) {
      const double angle = turned + i * 1.0471975511965976;
      const double x = std::cos(angle), y = std::sin(angle);
      for (const double out : {0.0, far}) {
        const double a = 0.33 + 0.2 * x + out * (0.3 * x - aside * y), b = 0.33 + 0.2 * y + out * (0.3 * y + aside * x);
        patch.corners.push_back(3 + static_cast<std::uint32_t>(cuts.size()));
        cuts.push_back({{0, 1, 2}, {1 - a - b, a, b}});
      }
    }
    const Vec3 middle = 0.34 * mesh.positions[0] + 0.33 * mesh.positions[1] + 0.33 * mesh.positions[2];
    patch.sphere.center = middle + 0.2 * random_vector(random);
    const CoveredTree model = with_leaves(mesh, cuts, {patch}, {middle, 1});
    const Modes still{.vertex_count = 3, .mode_count = 1, .displacements = std::vector<Vec3>(3)};
    const Body exact(mesh, model), modal(mesh, model, {.rules = {Rule::modal}, .modes = still});
    ASSERT_LE(excess_of(exact, mesh.positions), 0) << round;
    ASSERT_LE(excess_of(modal, mesh.positions), 0) << round;
  }
}

// Spheres about spheres.

// Contains, in real numbers, a sphere that is read at origin + center, both rounded to double.
bool contains_as_read(const Vec3& origin, const Spheref& outer, const Spheref& inner) {
  const Vec3 c = origin + Vec3(outer.center), d = origin + Vec3(inner.center);
  const long double x = static_cast<long double>(c.x) - d.x, y = static_cast<long double>(c.y) - d.y,
                    z = static_cast<long double>(c.z) - d.z;
  return std::sqrt(x * x + y * y + z * z) + static_cast<long double>(inner.radius) <=
         static_cast<long double>(outer.radius);
}
float wrapped(const Rounding& rounding, const Vec3f& center, const Spheref& inner) {
  return rounding.wrapping_radius(distance(Vec3(center), Vec3(inner.center)) + static_cast<double>(inner.radius),
                                  center);
}

TEST(WrappingRadius, pays_for_reading_centers_far_from_the_origin) {
  Random random(9);
  for (int round = 0; round < 20000; ++round) {
    const Vec3 origin = random_direction(random) * random.uniform(1e8, 1e9);
    const double size = 1e-7;
    const Spheref inner{Vec3f(random_vector(random) * size), static_cast<float>(random.uniform(0, size))};
    const Vec3f center(random_vector(random) * size);
    const Rounding rounding{size, max_norm(origin), 0};
    ASSERT_TRUE(contains_as_read(origin, {center, wrapped(rounding, center, inner)}, inner)) << round;
  }
}
TEST(WrappingRadius, pays_for_sums_that_swallow_a_distance) {
  for (const double apart : {0x1p-54, 0x1p-57, 0x1p-60}) {
    const Spheref inner{{static_cast<float>(apart), 0, 0}, 1};
    const Rounding rounding{apart, 0, 0};
    EXPECT_TRUE(contains_as_read({}, {{}, wrapped(rounding, {}, inner)}, inner)) << apart;
  }
}

// Modal bodies.

// Steps of three quarters of a unit in the last place: below 2 each is rounded to a whole unit, above 2 to nothing. So
// a corner goes away from its center by as many units as there are modes, though in real numbers both go together.
TEST(ModalAllowance, pays_for_sums_over_many_modes) {
  constexpr std::size_t mode_count = 2000;
  constexpr double size = 0x1p-33;
  Mesh mesh;
  mesh.positions = {{2 - size, 2 - size, 2 - size}, {2 + size, 2 + size, 2 + size}, {2 + size, 2 + size, 2}};
  mesh.facets = {{0, 1, 2}};
  Modes modes{.vertex_count = 3, .mode_count = mode_count, .displacements = {}};
  const double step = -0.75 * 0x1p-52;
  modes.displacements.assign(3 * mode_count, {step, step, step});
  const double middle = 2 + 0x1p-4 * size;
  const Sphere ball{{middle, middle, middle}, 2 * size};
  for (const RuleOptions::ModalBound bound : {RuleOptions::ModalBound::shift, RuleOptions::ModalBound::gradient}) {
    Body body(mesh, with_leaves(mesh, {}, {{0, {0, 1, 2}, ball}}, ball),
              {.rules = {Rule::modal}, .details = {.modal_bound = bound}, .modes = modes});
    const std::vector<double> coordinates(mode_count, 1.0);
    std::vector<Vec3> positions(3);
    move_by_modes(modes, mesh.positions, coordinates, positions);
    ASSERT_LT(positions[0].x, mesh.positions[0].x - 0.9 * mode_count * 0x1p-52);
    ASSERT_EQ(positions[1].x, mesh.positions[1].x);
    ASSERT_TRUE(body.update_modal(coordinates));
    EXPECT_LE(excess_of(body, positions), 0);
  }
}

// A cut corner inside its facet, beside the vertex that is farthest out: nobody measures it, and it lies off the facet.
TEST(ModalAllowance, pays_for_weights_that_do_not_add_up) {
  constexpr double slack = 9e-13, away = 1e9;
  Mesh mesh;
  mesh.positions = {{away, away, away}, {away + 2, away + 1, away + 1}, {away + 1, away + 1, away + 2}};
  mesh.facets = {{0, 1, 2}};
  const double most = (1 - slack) * (1 - 0x1p-19), least = (1 - slack) * 0x1p-20;
  const std::vector<CutPoint> cuts{{{0, 1, 2}, {most, least, least}}};
  CoveredTree model = with_leaves(mesh, cuts, {{0, {0, 1, 3}, {}}, {0, {1, 2, 3}, {}}, {0, {2, 0, 3}, {}}}, {});
  // One leaf for all three patches, so that the cut corner lies inside.
  const Sphere ball{{away + 1, away + 0.7, away + 1}, 2};
  SphereTree tree;
  tree.branching = 2;
  tree.append_level({}, std::vector<Sphere>{ball});
  model.tree = tree;
  model.cover.region_begin = {0};
  model.cover.region_end = {3};
  Modes modes{.vertex_count = 3, .mode_count = 1, .displacements = std::vector<Vec3>(3, Vec3{0.25, 0.25, 0.25})};
  Body modal(mesh, model, {.rules = {Rule::modal}, .modes = modes}), exact(mesh, model);
  const std::vector<double> coordinates{1.0};
  std::vector<Vec3> positions(3);
  move_by_modes(modes, mesh.positions, coordinates, positions);
  ASSERT_TRUE(modal.update_modal(coordinates));
  EXPECT_LE(excess_of(modal, positions), 0);
  ASSERT_TRUE(exact.update(positions));
  EXPECT_LE(excess_of(exact, positions), 0);
}

}  // namespace
}  // namespace morula
