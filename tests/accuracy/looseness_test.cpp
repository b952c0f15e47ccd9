// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle.hpp>
#include <stdexcept>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

namespace morula {
namespace {

using test::box_mesh;
using test::icosphere;

using test::pi;

VoxelGrid fixed_grid(double edge) {
  return {.kind = VoxelGrid::Kind::fixed, .voxel_edge = edge};
}
VoxelGrid level_grid(int resolution) {
  return {.kind = VoxelGrid::Kind::level, .resolution = resolution};
}

std::vector<Sphere> random_spheres(const Box& box, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Sphere> spheres;
  const double size = box.diagonal();
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 c;
    for (int axis = 0; axis < 3; ++axis) c[axis] = random.uniform(box.lower[axis], box.upper[axis]);
    spheres.push_back({c, random.uniform(0.02, 0.3) * size});
  }
  return spheres;
}

// Rounded winding number of a closed, oriented mesh.
int winding(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) sum += solid_angle(mesh.corners(f), p);
  return static_cast<int>(std::lround(sum / (4 * pi)));
}

// Facets that a ray in a direction without meaning crosses.
int crossings(const Mesh& mesh, const Vec3& p) {
  const Vec3 direction{0.812305, 0.351277, 0.465501};
  int count = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    const Vec3 across = cross(direction, c - a);
    const double determinant = dot(b - a, across);
    if (determinant == 0) continue;
    const double u = dot(p - a, across) / determinant;
    const double v = dot(direction, cross(p - a, b - a)) / determinant;
    const double t = dot(c - a, cross(p - a, b - a)) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) ++count;
  }
  return count;
}

struct Counts {
  std::size_t in_union = 0, outside = 0, missed = 0;
  bool operator==(const Counts&) const = default;
};
std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.in_union << " in the union, " << c.outside << " of them outside, " << c.missed << " missed";
}

Counts counts_of(const Looseness& l) {
  const double voxel = l.voxel_edge * l.voxel_edge * l.voxel_edge;
  const auto count = [&](double volume) { return static_cast<std::size_t>(std::llround(volume / voxel)); };
  return {count(l.union_volume), count(l.outside_volume), count(l.missed_volume.value_or(0) * l.object_volume)};
}

// Every voxel of the spheres' and the object's common box, one by one.
template <class IsInside>
Counts slow_counts(const Mesh& mesh, std::span<const Sphere> spheres, const VoxelGrid& grid, double edge,
                   const IsInside& is_inside) {
  Box ball_box;
  for (const Sphere& s : spheres) {
    ball_box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    ball_box.add(s.center + Vec3{s.radius, s.radius, s.radius});
  }
  Box box = ball_box;
  box.add(bounding_box(mesh));
  const Vec3 origin = grid.kind == VoxelGrid::Kind::level ? ball_box.lower : Vec3{0, 0, 0};
  std::array<int, 3> begin, end;
  for (int axis = 0; axis < 3; ++axis) {
    begin[axis] = static_cast<int>(std::floor((box.lower[axis] - origin[axis]) / edge)) - 1;
    end[axis] = static_cast<int>(std::ceil((box.upper[axis] - origin[axis]) / edge)) + 1;
  }
  Counts counts;
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) {
        const Vec3 p = origin + Vec3{i + 0.5, j + 0.5, k + 0.5} * edge;
        bool in_union = false;
        for (const Sphere& s : spheres) in_union = in_union || power(s, p) <= 0;
        const bool inside = is_inside(p);
        counts.in_union += in_union;
        counts.outside += in_union && !inside;
        counts.missed += inside && !in_union;
      }
  return counts;
}

TEST(Looseness, equals_a_count_of_every_voxel_with_winding_numbers) {
  std::vector<test::NamedMesh> meshes;
  for (const char* name : {"icosphere", "two_components", "nested_shells", "inverted", "cones_at_one_vertex",
                           "cubes_at_one_edge", "sliver_facets", "collinear_facet", "repeated_indices", "far_away"})
    meshes.push_back(test::mesh_named(name));
  for (const char* name : {"torus", "blob", "limb"})
    meshes.push_back({name, sample_body(name, 10), true, true, true, 0});
  meshes.push_back(
      {"overlapping", test::joined(icosphere(1), icosphere(2, 0.8, {0.7, 0.1, 0.2})), true, true, true, 0});
  for (const test::NamedMesh& named : meshes) {
    const Box box = bounding_box(named.mesh);
    const auto spheres = random_spheres(box, 5, 11);
    const auto is_inside = [&](const Vec3& p) { return winding(named.mesh, p) != 0; };
    for (const VoxelGrid& grid : {level_grid(17), fixed_grid(box.diagonal() / 15.3)}) {
      const Looseness fast = looseness(named.mesh, spheres, grid);
      EXPECT_EQ(counts_of(fast), slow_counts(named.mesh, spheres, grid, fast.voxel_edge, is_inside)) << named.name;
    }
  }
}

TEST(Looseness, counts_odd_crossings_on_closed_meshes_without_orientation) {
  Mesh mesh = sample_body("blob", 12);
  for (std::size_t f = 0; f < mesh.facet_count(); f += 3) std::swap(mesh.facets[f][0], mesh.facets[f][1]);
  ASSERT_TRUE(inspect(mesh).closed);
  ASSERT_FALSE(inspect(mesh).oriented);
  const auto spheres = random_spheres(bounding_box(mesh), 4, 5);
  const auto is_inside = [&](const Vec3& p) { return crossings(mesh, p) % 2 == 1; };
  const Looseness fast = looseness(mesh, spheres, level_grid(24));
  EXPECT_EQ(counts_of(fast), slow_counts(mesh, spheres, level_grid(24), fast.voxel_edge, is_inside));
  // Without an orientation there is no signed volume, so the object's is counted.
  const double inside =
      static_cast<double>(counts_of(fast).missed + counts_of(fast).in_union - counts_of(fast).outside);
  EXPECT_NEAR(fast.object_volume, inside * std::pow(fast.voxel_edge, 3), 1e-9);
}

// Faces, edges, diagonals and vertices lie exactly on columns and centers; a leak would add or take whole columns.
TEST(Looseness, boxes_on_the_lattice_count_exactly) {
  const double edge = 0.25;
  const std::vector<Sphere> nowhere{{{0.26, 0.27, 0.28}, 0.0}};
  for (const double phase : {0.0, 0.125, 0.25, 0.0625})
    for (int n : {1, 2, 3, 4}) {
      const Mesh mesh = box_mesh({phase - 1, phase - 1.5, phase - 0.75}, {phase + 2, phase + 1.5, phase + 0.75}, n);
      const Looseness l = looseness(mesh, nowhere, fixed_grid(edge));
      EXPECT_EQ(counts_of(l).missed, 12u * 12u * 6u) << "phase " << phase << ", " << n << " squares";
    }
}

TEST(Looseness, boxes_side_by_side_share_no_voxel) {
  const Mesh one = box_mesh({0.125, 0.125, 0.125}, {1.125, 1.125, 1.125}, 2);
  const std::vector<Sphere> nowhere{{{0.3, 0.3, 0.3}, 0.0}};
  Mesh all;
  for (int corner = 0; corner < 8; ++corner)
    all = test::joined(all, test::translated(one, {corner & 1 ? 1.0 : 0, corner & 2 ? 1.0 : 0, corner & 4 ? 1.0 : 0}));
  EXPECT_EQ(counts_of(looseness(all, nowhere, fixed_grid(0.25))).missed, 512u);
}

// Vertices on whole lattice points, so that nearly every column meets edges and vertices. Centers on slanted facets may
// go either way; a leak would show in whole columns beyond those.
TEST(Looseness, does_not_leak_where_columns_meet_edges_and_vertices) {
  const std::vector<Sphere> nowhere{{{0.3, 0.3, 0.3}, 0.0}};
  for (int kind = 0; kind < 4; ++kind) {
    Mesh mesh = kind == 0   ? icosphere(0, 7)
                : kind == 1 ? icosphere(1, 6)
                : kind == 2 ? sample_body("torus", 8)
                            : test::mesh_named("cones_at_one_vertex").mesh;
    const double scale = kind == 2 ? 5 : kind == 3 ? 4 : 1;
    for (Vec3& p : mesh.positions)
      p = {std::nearbyint(p.x * scale) + 0.5, std::nearbyint(p.y * scale) + 0.5, std::nearbyint(p.z * scale) + 0.5};
    std::size_t on_surface = 0;
    const auto is_inside = [&](const Vec3& p) {
      for (std::size_t f = 0; f < mesh.facet_count(); ++f)
        if (closest_point(mesh.corners(f), p).squared_distance < 1e-12) {
          ++on_surface;
          return false;
        }
      return winding(mesh, p) != 0;
    };
    const std::size_t well_inside = slow_counts(mesh, nowhere, fixed_grid(1.0), 1.0, is_inside).missed;
    const std::size_t counted = counts_of(looseness(mesh, nowhere, fixed_grid(1.0))).missed;
    EXPECT_GT(on_surface, 0u) << "kind " << kind;
    EXPECT_GE(counted, well_inside) << "kind " << kind;
    EXPECT_LE(counted, well_inside + on_surface) << "kind " << kind;
  }
}

TEST(Looseness, of_a_ball_around_a_ball) {
  const Mesh mesh = icosphere(5);
  const double object = signed_volume(mesh);
  const std::vector<Sphere> ball{{{0, 0, 0}, 1.25}};
  const Looseness l = looseness(mesh, ball);
  ASSERT_TRUE(l.looseness && l.missed_volume);
  EXPECT_NEAR(*l.looseness, volume(ball[0]) / object - 1, 2e-3);
  EXPECT_EQ(*l.missed_volume, 0);
  EXPECT_DOUBLE_EQ(l.object_volume, object);
  EXPECT_NEAR(l.union_volume, volume(ball[0]), 1e-3 * volume(ball[0]));
  EXPECT_NEAR(l.voxel_edge, 2.5 / 192, 1e-15);
  EXPECT_EQ(l.voxels, 192u * 192u * 192u);
}

TEST(Looseness, of_a_cube_in_its_circumscribed_and_its_inscribed_ball) {
  const Mesh mesh = box_mesh({-1, -1, -1}, {1, 1, 1}, 3);
  const std::vector<Sphere> around{{{0, 0, 0}, std::sqrt(3.0)}}, within{{{0, 0, 0}, 1.0}};
  const Looseness outer = looseness(mesh, around);
  // The lattice is parallel to the cube's sides, the worst case: each may be off by half a voxel.
  EXPECT_NEAR(*outer.looseness, pi * std::sqrt(3.0) / 2 - 1, 0.5 * outer.voxel_edge * 24 / 8);
  EXPECT_EQ(*outer.missed_volume, 0);
  const Looseness inner = looseness(mesh, within);
  EXPECT_EQ(*inner.looseness, 0);
  EXPECT_NEAR(*inner.missed_volume, 1 - pi / 6, 0.5 * inner.voxel_edge * 24 / 8);
}

TEST(Looseness, of_two_overlapping_balls_counts_the_lens_once) {
  const Mesh mesh = box_mesh({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1});
  const std::vector<Sphere> balls{{{-0.5, 0, 0}, 1}, {{0.5, 0, 0}, 1}};
  const double lens = pi * std::pow(2 - 1.0, 2) * (1 + 4 * 1.0) / 12;  // equal radii 1 at distance 1
  const Looseness l = looseness(mesh, balls);
  EXPECT_NEAR(l.union_volume, 2 * volume(balls[0]) - lens, 1e-2);
  EXPECT_NEAR(*l.looseness, (2 * volume(balls[0]) - lens) / 0.008 - 1, 1e-2 / 0.008);
}

TEST(Looseness, of_a_capsule_in_its_three_balls) {
  // Tube of radius ½ from −1 to 1, covered by balls of radius √(¼ + ¼) about −1, 0 and 1.
  const Mesh mesh = sample_body("capsule", 96);
  const double r = std::sqrt(0.5);
  const std::vector<Sphere> balls{{{-1, 0, 0}, r}, {{0, 0, 0}, r}, {{1, 0, 0}, r}};
  const double height = r - 0.5, cap = pi * height * height * (3 * r - height) / 3;
  const Looseness l = looseness(mesh, balls);
  const double expected = (3 * volume(balls[0]) - 4 * cap) / l.object_volume - 1;
  EXPECT_NEAR(*l.looseness, expected, 5e-3);
  EXPECT_LT(*l.missed_volume, 1e-3);
}

TEST(Looseness, converges_as_voxels_shrink) {
  const Mesh mesh = icosphere(4);
  const std::vector<Sphere> balls{{{0.1, 0.05, -0.02}, 1.2}, {{0.9, 0.2, 0.1}, 0.5}};
  const double finest = *looseness(mesh, balls, level_grid(768)).looseness;
  double last = *looseness(mesh, balls, level_grid(12)).looseness;
  double largest_allowed = 0.3;
  for (int resolution = 24; resolution <= 384; resolution *= 2) {
    const double now = *looseness(mesh, balls, level_grid(resolution)).looseness;
    EXPECT_LT(std::abs(now - finest), largest_allowed) << resolution;
    last = now;
    largest_allowed /= 2;
  }
  EXPECT_NEAR(last, finest, 0.02 * finest);
}

TEST(Looseness, of_a_fixed_grid_does_not_see_whole_steps_of_the_lattice) {
  const Mesh mesh = sample_body("blob", 20);
  const auto spheres = random_spheres(bounding_box(mesh), 6, 3);
  const VoxelGrid grid = fixed_grid(0x1p-5);
  const Looseness here = looseness(mesh, spheres, grid);
  const auto moved = [&](const Vec3& offset) {
    std::vector<Sphere> there = spheres;
    for (Sphere& s : there) s.center += offset;
    return looseness(test::translated(mesh, offset), there, grid);
  };
  // Moving rounds the coordinates, so a center that all but touches the surface may change sides.
  const Looseness whole = moved({3 * 0x1p-5, -40 * 0x1p-5, 17 * 0x1p-5});
  EXPECT_NEAR(whole.outside_volume, here.outside_volume, 3 * std::pow(0x1p-5, 3));
  EXPECT_NEAR(*whole.missed_volume, *here.missed_volume, 1e-4);
  const Looseness part = moved({0.013, 0.007, -0.021});
  EXPECT_NEAR(*part.looseness, *here.looseness, 0.02 * *here.looseness);
}

TEST(Looseness, of_a_level_grid_follows_the_spheres) {
  const Mesh mesh = sample_body("torus", 20);
  const auto spheres = random_spheres(bounding_box(mesh), 6, 8);
  const Looseness here = looseness(mesh, spheres, level_grid(64));
  const Vec3 offset{1024, -512, 256};
  std::vector<Sphere> there = spheres;
  for (Sphere& s : there) s.center += offset;
  const Looseness moved = looseness(test::translated(mesh, offset), there, level_grid(64));
  EXPECT_NEAR(moved.outside_volume, here.outside_volume, 3 * std::pow(here.voxel_edge, 3));
  EXPECT_NEAR(moved.voxel_edge, here.voxel_edge, 1e-12);
}

TEST(Looseness, counts_what_sticks_out_of_the_spheres_box) {
  const Mesh mesh = box_mesh({0, 0, 0}, {4, 1, 1}, 2);
  const std::vector<Sphere> small{{{0.5, 0.5, 0.5}, 0.4}};
  const Looseness l = looseness(mesh, small, level_grid(48));
  EXPECT_EQ(*l.looseness, 0);
  EXPECT_NEAR(*l.missed_volume, 1 - volume(small[0]) / 4, 1e-2);
  EXPECT_NEAR(l.voxel_edge, 0.8 / 48, 1e-15);
}

TEST(Looseness, of_spheres_that_touch_nothing_misses_everything) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<Sphere> beside{{{3, 0.5, 0.5}, 0.5}};
  for (const VoxelGrid& grid : {level_grid(32), fixed_grid(0x1p-5)}) {
    const Looseness l = looseness(mesh, beside, grid);
    EXPECT_NEAR(*l.missed_volume, 1, 1e-12);
    EXPECT_NEAR(*l.looseness, pi / 6, 1e-2);
  }
}

TEST(Looseness, takes_longer_edges_for_spheres_that_are_nothing_beside_the_object) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1e-3, 1e-3});
  const std::vector<Sphere> speck{{{0.5, 5e-4, 5e-4}, 1e-9}}, points{{{0.5, 5e-4, 5e-4}, 0}};
  for (const auto& spheres : {speck, points}) {
    const Looseness l = looseness(mesh, spheres, level_grid(192));
    EXPECT_GT(l.voxel_edge, 1.0 / 8192);
    EXPECT_LT(l.voxel_edge, 1.0 / 8000);
    EXPECT_NEAR(*l.missed_volume, 1, 0.05);
  }
  EXPECT_THROW(looseness(mesh, speck, fixed_grid(1e-9)), std::invalid_argument);
}

TEST(Looseness, says_nothing_about_open_meshes) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (named.closed) continue;
    const auto spheres = random_spheres(bounding_box(named.mesh), 3, 2);
    const Looseness l = looseness(named.mesh, spheres, level_grid(32));
    EXPECT_FALSE(l.looseness) << named.name;
    EXPECT_FALSE(l.missed_volume) << named.name;
    EXPECT_EQ(l.outside_volume, 0) << named.name;
    EXPECT_EQ(l.object_volume, 0) << named.name;
    EXPECT_GT(l.union_volume, 0) << named.name;
  }
}

TEST(Looseness, says_nothing_about_objects_without_volume) {
  const Mesh& folded = test::mesh_named("folded_facet").mesh;
  const std::vector<Sphere> ball{{{0.3, 0.3, 0}, 0.5}};
  const Looseness l = looseness(folded, ball, level_grid(32));
  EXPECT_FALSE(l.looseness);
  EXPECT_NEAR(l.outside_volume, l.union_volume, 0);
}

TEST(Looseness, reads_inside_out_meshes_either_way_round) {
  const Mesh mesh = sample_body("limb", 16);
  const auto spheres = random_spheres(bounding_box(mesh), 6, 4);
  const Looseness a = looseness(mesh, spheres, level_grid(48));
  const Looseness b = looseness(test::inverted(mesh), spheres, level_grid(48));
  EXPECT_EQ(*a.looseness, *b.looseness);
  EXPECT_EQ(*a.missed_volume, *b.missed_volume);
}

TEST(Looseness, leaves_cavities_outside_and_counts_overlaps_once) {
  const double edge = 0.125;
  const Mesh& shells = test::mesh_named("nested_shells").mesh;  // a cube of 4 with a hole of 2
  const std::vector<Sphere> around{{{2, 2, 2}, 4}};
  const Looseness hollow = looseness(shells, around, fixed_grid(edge));
  EXPECT_NEAR(hollow.outside_volume, hollow.union_volume - 56, 1e-9);
  EXPECT_NEAR(*hollow.looseness, hollow.outside_volume / 56, 1e-12);

  const Mesh overlapping = test::joined(box_mesh({0, 0, 0}, {2, 1, 1}), box_mesh({1, 0, 0}, {3, 1, 1}));
  const Looseness twice = looseness(overlapping, around, fixed_grid(edge));
  EXPECT_NEAR(twice.outside_volume, twice.union_volume - 3, 1e-9);
  EXPECT_NEAR(twice.object_volume, 4, 1e-12);
}

TEST(Looseness, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 48);
  const auto spheres = random_spheres(bounding_box(mesh), 64, 9);
  const Looseness one = looseness(mesh, spheres, level_grid(100));
  Workers two(2), eight(8);
  Workers backwards(
      [](std::size_t count, ChunkFunction chunk) {
        while (count > 0) chunk(--count);
      },
      3);
  for (Workers* workers : {&two, &eight, &backwards}) {
    const Looseness many = looseness(mesh, spheres, level_grid(100), *workers);
    EXPECT_EQ(one.looseness, many.looseness);
    EXPECT_EQ(one.missed_volume, many.missed_volume);
    EXPECT_EQ(one.union_volume, many.union_volume);
    EXPECT_EQ(one.object_volume, many.object_volume);
  }
}

TEST(LoosenessMeter, measures_deformed_positions_like_a_deformed_mesh) {
  Mesh mesh = sample_body("torus", 16);
  const LoosenessMeter meter(mesh);
  EXPECT_TRUE(meter.has_volume());
  EXPECT_FALSE(LoosenessMeter(test::grid_plate(2)).has_volume());
  for (Vec3& p : mesh.positions) p = {2 * p.x, 0.7 * p.y + 0.1 * p.x, p.z};
  const auto spheres = random_spheres(bounding_box(mesh), 6, 4);
  const Looseness a = meter.measure(mesh.positions, spheres, level_grid(40));
  const Looseness b = looseness(mesh, spheres, level_grid(40));
  EXPECT_EQ(a.looseness, b.looseness);
  EXPECT_EQ(a.missed_volume, b.missed_volume);
  EXPECT_EQ(a.object_volume, b.object_volume);
}

TEST(Looseness, refuses_bad_input_by_name) {
  const Mesh mesh = box_mesh({0, 0, 0}, {1, 1, 1});
  const std::vector<Sphere> ball{{{0, 0, 0}, 1}};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(looseness(mesh, {}, {}), std::invalid_argument);
  EXPECT_THROW(looseness(mesh, ball, level_grid(7)), std::invalid_argument);
  EXPECT_THROW(looseness(mesh, ball, level_grid(4097)), std::invalid_argument);
  EXPECT_THROW(looseness(mesh, ball, fixed_grid(0)), std::invalid_argument);
  EXPECT_THROW(looseness(mesh, ball, fixed_grid(nan)), std::invalid_argument);
  for (const Sphere& bad : {Sphere{{nan, 0, 0}, 1}, Sphere{{0, 0, 0}, -1}, Sphere{{0, 0, 0}, nan}}) {
    const std::vector<Sphere> spheres{ball[0], bad};
    try {
      looseness(mesh, spheres);
      FAIL() << "a bad sphere went through";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("sphere 1"), std::string::npos) << error.what();
    }
  }
  std::vector<Vec3> positions = mesh.positions;
  positions[3].y = nan;
  EXPECT_THROW(LoosenessMeter(mesh).measure(positions, ball, {}), std::invalid_argument);
  positions.pop_back();
  EXPECT_THROW(LoosenessMeter(mesh).measure(positions, ball, {}), std::invalid_argument);
}

}  // namespace
}  // namespace morula
