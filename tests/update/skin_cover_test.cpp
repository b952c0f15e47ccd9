// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cover by the rule `skinned`. The oracle computes every corner of every region from the definition of a skin, in long
// double, and compares without a tolerance; it shares no code with the rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/update/body.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;
using Transforms = std::vector<AffineTransform>;
using Point = std::array<long double, 3>;

// The largest |corner - center| - radius over all nodes and corners.
long double skin_excess(const Body& body, const Mesh& mesh, const Skin& skin, const Transforms& transforms) {
  std::vector<Point> vertices(mesh.vertex_count());
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3& p = mesh.positions[v];
      long double missing = 1, sum = 0;
      for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
        const AffineTransform& t = transforms[skin.bones[k]];
        long double moved = t.translation[axis];
        for (int column = 0; column < 3; ++column)
          moved += static_cast<long double>(t.columns[static_cast<std::size_t>(column)][axis]) * p[column];
        missing -= skin.weights[k];
        sum += static_cast<long double>(skin.weights[k]) * moved;
      }
      vertices[v][static_cast<std::size_t>(axis)] = sum + missing * p[axis];
    }
  const Cover& cover = body.cover();
  const auto corner_at = [&](std::uint32_t c) {
    if (c < cover.vertex_count) return vertices[c];
    const CutPoint& cut = cover.cut_points[c - cover.vertex_count];
    Point point{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis)
        point[axis] += static_cast<long double>(cut.weight[k]) * vertices[cut.vertex[k]][axis];
    return point;
  };
  const Vec3 origin = body.origin();
  long double worst = -HUGE_VALL;
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) {
    const Spheref& s = body.spheres()[node];
    for (const std::uint32_t c : cover.region_corners(node)) {
      const Point p = corner_at(c);
      long double squared = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const long double d = p[static_cast<std::size_t>(axis)] -
                              (static_cast<long double>(origin[axis]) + static_cast<long double>(s.center[axis]));
        squared += d * d;
      }
      const long double excess = std::sqrt(squared) - static_cast<long double>(s.radius);
      if (!(excess <= worst)) worst = excess;
    }
  }
  return worst;
}

Vec3 any_vector(Random& random, double size = 1) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}

// Rotations, or affine maps of any kind: singular, mirrored, stretched by up to `size`, far away.
AffineTransform any_transform(Random& random, int kind, double size) {
  AffineTransform t;
  for (Vec3& column : t.columns) column = any_vector(random, kind == 3 ? 100 : 1);
  if (kind == 0) {  // orthonormal columns
    t.columns[0] = normalized(t.columns[0]);
    t.columns[1] = normalized(cross(t.columns[0], t.columns[1]));
    t.columns[2] = cross(t.columns[0], t.columns[1]);
  }
  if (kind == 1) t.columns[2] = t.columns[1] = -t.columns[0];                              // rank one
  if (kind == 2) t.columns = {Vec3{-1, 0, 0}, Vec3{0, random.uniform(0, 50), 0}, Vec3{}};  // mirrored, uneven, flat
  t.translation = any_vector(random, size * (kind == 4 ? 1e9 : 1));
  return t;
}

enum class Kind { smooth, rough, negative, eight, loose_sums };

// Weights that vary with position, or at random; of one bone for some vertices.
Skin any_skin(const Mesh& mesh, std::size_t bone_count, Kind kind, double size) {
  Random random(7);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t count = kind == Kind::eight ? 8 : v % 7 == 0 && kind != Kind::smooth ? 1 : 4;
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 p = is_finite(mesh.positions[v]) ? mesh.positions[v] / size : Vec3{};
      const double smooth = 1.2 + std::sin(static_cast<double>(k) + p.x) + 0.1 * p.y;
      weights.push_back(kind == Kind::smooth ? smooth : random.uniform(kind == Kind::negative ? -0.3 : 0.05, 1));
      sum += weights.back();
      skin.bones.push_back(static_cast<std::uint32_t>((kind == Kind::smooth ? k : v / 9 + k) % bone_count));
    }
    // Far from 0, or the weights become large.
    if (kind == Kind::negative) weights[0] += 2, sum += 2;
    const double wanted = kind == Kind::loose_sums ? 1 + 9e-7 * random.uniform(-1, 1) : 1;
    for (const double weight : weights) skin.weights.push_back(weight / sum * wanted);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

void expect_cover(const std::string& name, const Mesh& mesh, const CoveredTree& model, double size, int rounds) {
  for (const Kind kind : {Kind::smooth, Kind::rough, Kind::negative, Kind::eight, Kind::loose_sums}) {
    const Skin skin = any_skin(mesh, 9, kind, size);
    Body body(mesh, model, {.rules = {Rule::skinned}, .skin = skin});
    EXPECT_TRUE(body.sphere_state().covers);
    Random random(3);
    std::vector<Vec3> positions(mesh.vertex_count());
    for (int round = 0; round < rounds; ++round) {
      Transforms transforms;
      for (std::size_t b = 0; b < skin.bone_count; ++b)
        transforms.push_back(any_transform(random, round % 6 == 5 ? static_cast<int>(b % 5) : round % 6, size));
      if (round % 4 == 0) transforms[0] = {};
      if (round == 2) transforms.assign(skin.bone_count, transforms[0]);
      ASSERT_TRUE(body.update_skinned(transforms)) << name;
      EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0)
          << name << ", skin " << static_cast<int>(kind) << ", round " << round;
      move_by_skin(skin, mesh.positions, transforms, positions);
      EXPECT_TRUE(body.certify(positions).covered) << name << ' ' << round;
    }
  }
}

TEST(SkinnedCover, every_level_covers_at_any_transforms) {
  for (const Specimen& b : specimens()) expect_cover(b.name, b.mesh, b.model, 1, 24);
}

TEST(SkinnedCover, holds_far_from_the_origin_and_at_any_size) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-9, 1.0, 1e6})
    for (const double away : {0.0, 1e3, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_cover("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh,
                   test::hand_made_tree(mesh, {.cut_facets = true}), scale, 12);
    }
}

// The same facet many times, of size 2^-33 at a distance of 2: positions are rounded to a millionth of it.
TEST(SkinnedCover, pays_for_the_rounding_of_positions) {
  Random random(11);
  for (int round = 0; round < 400; ++round) {
    Mesh mesh;
    const Vec3 middle{2, 2, 2};
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + any_vector(random, 0x1p-33));
    mesh.facets = {{0, 1, 2}};
    Skin skin{.bone_count = 8, .begin = {0}};
    for (std::uint32_t v = 0; v < 3; ++v) {
      for (std::uint32_t k = 0; k < 8; ++k) skin.bones.push_back(k), skin.weights.push_back(0.125);
      skin.begin.push_back(8 * (v + 1));
    }
    const Sphere ball{middle, 0x1p-32};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), {.rules = {Rule::skinned}, .skin = skin});
    // One rotation for all bones: the spheres have no slack.
    const AffineTransform motion = any_transform(random, 0, 1);
    const Transforms transforms(8, motion);
    std::vector<Vec3> positions(3);
    move_by_skin(skin, mesh.positions, transforms, positions);
    ASSERT_TRUE(body.update_skinned(transforms));
    EXPECT_LE(body.certify(positions).worst_excess, 0) << round;
    EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0) << round;
  }
}

// Each summand of the positions is rounded up by a quarter of a unit in the last place.
TEST(SkinnedCover, pays_for_sums_over_many_influences) {
  constexpr std::uint32_t bones = 8192;
  constexpr double size = 0x1p-33;
  Mesh mesh;
  mesh.positions = {{2 - size, 2 - size, 2 - size}, {2 + size, 2 + size, 2 + size}, {2 + size, 2 + size, 2}};
  mesh.facets = {{0, 1, 2}};
  Skin skin{.bone_count = bones, .begin = {0}};
  for (std::uint32_t v = 0; v < 3; ++v) {
    for (std::uint32_t k = 0; k < bones; ++k) skin.bones.push_back(k), skin.weights.push_back(1.0 / bones);
    skin.begin.push_back(bones * (v + 1));
  }
  const double middle = 2 + 0x1p-4 * size, step = -0.75 * 0x1p-52 * bones;
  const Sphere ball{{middle, middle, middle}, 2 * size};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), {.rules = {Rule::skinned}, .skin = skin});
  Transforms transforms(bones);
  for (AffineTransform& t : transforms) t.translation = {step, step, step};
  std::vector<Vec3> positions(3);
  move_by_skin(skin, mesh.positions, transforms, positions);
  ASSERT_LT(positions[0].x, mesh.positions[0].x - 0.9 * bones * 0x1p-52);
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(body.certify(positions).worst_excess, 0);
}

TEST(SkinnedCover, pays_for_weights_that_do_not_add_up) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.facets = {{0, 1, 2}};
  const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1 - 9e-7, 1 + 9e-7, 1}};
  const Sphere ball{{0.5, 0.5, 0}, 1};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), {.rules = {Rule::skinned}, .skin = skin});
  Transforms transforms(1);
  transforms[0].translation = {1e3, 0, 0};
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0);
}

// A cut corner inside its facet, beside the vertex that is farthest out: it lies off the facet, and the rule leaves it
// out, because it is in the hull of the facet's vertices.
TEST(SkinnedCover, pays_for_cut_corners_whose_weights_do_not_add_up) {
  constexpr double slack = 9e-13, away = 1e9;
  Mesh mesh;
  mesh.positions = {{away, away, away}, {away + 2, away + 1, away + 1}, {away + 1, away + 1, away + 2}};
  mesh.facets = {{0, 1, 2}};
  const double most = (1 - slack) * (1 - 0x1p-19), least = (1 - slack) * 0x1p-20;
  CoveredTree model;
  model.tree.branching = 2;
  model.tree.append_level({}, std::vector<Sphere>{{{away + 1, away + 0.7, away + 1}, 2}});
  model.cover = {.vertex_count = 3,
                 .facet_count = 1,
                 .cut_points = {{{0, 1, 2}, {most, least, least}}},
                 .patch_facet = {0, 0, 0},
                 .corner_begin = {0, 3, 6, 9},
                 .corners = {0, 1, 3, 1, 2, 3, 2, 0, 3},
                 .region_begin = {0},
                 .region_end = {3}};
  const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
  Body body(mesh, model, {.rules = {Rule::skinned}, .skin = skin});
  Transforms transforms(1);
  transforms[0].translation = {0.25, 0.25, 0.25};
  std::vector<Vec3> positions(3);
  move_by_skin(skin, mesh.positions, transforms, positions);
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(body.certify(positions).worst_excess, 0);
}

// Each of these bones moves a few vertices of the body, by less and less the farther they are.
TEST(SkinnedCover, bones_of_few_vertices_are_covered) {
  const Specimen& b = specimens()[2];
  const auto count = static_cast<std::uint32_t>(b.mesh.vertex_count());
  Skin skin{.bone_count = 1 + count / 7, .begin = {0}};
  for (std::uint32_t v = 0; v < count; ++v) {
    const std::uint32_t bone = 1 + v / 7 % (count / 7);
    const double weight = v % 7 == 6 ? 0 : 0.9 - 0.1 * (v % 7);
    skin.bones.insert(skin.bones.end(), {0, bone});
    skin.weights.insert(skin.weights.end(), {1 - weight, weight});
    skin.begin.push_back(2 * (v + 1));
  }
  Body body(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
  Random random(13);
  for (int round = 0; round < 200; ++round) {
    // All but one of the bones are at rest: that one alone has to pay for its vertices.
    Transforms transforms(skin.bone_count);
    AffineTransform& moved = transforms[1 + static_cast<std::size_t>(round) % (skin.bone_count - 1)];
    if (round % 2 == 0) moved.translation = any_vector(random, 3);
    if (round % 2 == 1) moved = any_transform(random, 0, 0.1);
    ASSERT_TRUE(body.update_skinned(transforms));
    EXPECT_LE(skin_excess(body, b.mesh, skin, transforms), 0) << round;
  }
}

// A bone for each vertex, every second one far to the other side, and negative weights, with which there is no hull.
TEST(SkinnedCover, radii_stay_in_range_at_the_largest_transforms) {
  const Specimen& b = specimens()[0];
  const auto count = static_cast<std::uint32_t>(b.mesh.vertex_count());
  Skin skin{.bone_count = count, .begin = {0}};
  for (std::uint32_t v = 0; v < count; ++v) {
    skin.bones.push_back(v), skin.weights.push_back(1.25);
    skin.bones.push_back((v + 1) % count), skin.weights.push_back(-0.25);
    skin.begin.push_back(2 * (v + 1));
  }
  Body body(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
  Transforms transforms(count);
  for (std::size_t k = 0; k < count; ++k) {
    const double far = k % 2 == 0 ? 0x1p54 : -0x1p54;
    transforms[k].translation = {far, far, far};
  }
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(skin_excess(body, b.mesh, skin, transforms), 0);
  for (const Spheref& s : body.spheres()) EXPECT_LE(s.radius, largest_radius);
}

// Small enough for transforms whose cubes of squares leave the range of double, and for slopes whose squares do.
TEST(SkinnedCover, tiny_bodies_are_covered_and_get_no_huge_spheres) {
  Random random(5);
  for (int round = 0; round < 20000; ++round) {
    const double size = std::ldexp(1, round % 3 == 0 ? -600 : -122 - round % 7);
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(any_vector(random, size));
    mesh.facets = {{0, 1, 2}};
    const Skin skin{2, {0, 1, 3, 4}, {0, 0, 1, round % 2 == 0 ? 0u : 1u}, {1, 0.5, 0.5, 1}};
    const Sphere ball{{}, 2 * size};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), {.rules = {Rule::skinned}, .skin = skin});
    EXPECT_LE(body.spheres()[0].radius, 8 * size + 1e-40) << round;
    Transforms transforms(2);
    const double factor = std::ldexp(1, round % 5 == 0 ? 3 : 170 + round % 2);
    for (Vec3& column : transforms[0].columns) column = any_vector(random, factor);
    transforms[1] = transforms[0];
    if (round % 4 == 0) transforms[1].translation = any_vector(random, 8 * factor * size);
    ASSERT_TRUE(body.update_skinned(transforms)) << round;
    EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0) << round;
    EXPECT_LE(body.spheres()[0].radius, 50 * (1 + factor) * size + 1e-40) << round;
  }
}

// Facets that are so small that the squares of their places are the least numbers of double, or, in the least unit, of
// float beside a bone that moves one of them much farther than the others.
TEST(SkinnedCover, flat_bodies_are_covered_though_squares_underflow) {
  Random random(15);
  for (int round = 0; round < 600; ++round) {
    const bool is_smaller = round % 2 == 1;
    const double size = std::ldexp(1, is_smaller ? -980 - round % 30 : -528 - round % 12);
    const double factor = std::min(1 / size, 0x1p1000);
    Mesh mesh;
    Skin skin{.bone_count = 4, .begin = {0}};
    for (std::uint32_t v = 0; v < 12; ++v) {
      mesh.positions.push_back({random.uniform(-1, 1) * size, random.uniform(-1, 1) * size, 0});
      if (v % 3 == 0) mesh.facets.push_back({v, v + 1, v + 2});
      const double second = random.uniform(0.1, 0.4);
      skin.bones.insert(skin.bones.end(), {v < 9 ? 0u : 3u, 1, 2});
      skin.weights.insert(skin.weights.end(), {0.8 - second, second, 0.2});
      skin.begin.push_back(3 * (v + 1));
    }
    const Sphere ball{{}, 2 * size};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector(4, ball)), {.rules = {Rule::skinned}, .skin = skin});
    Transforms transforms(4);
    for (AffineTransform& t : transforms) {
      const double most = is_smaller && &t != &transforms[3] ? 0x1p-40 * factor : factor;
      for (Vec3& column : t.columns) column = any_vector(random, most);
      t.translation = any_vector(random, most * size);
    }
    ASSERT_TRUE(body.update_skinned(transforms));
    EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0) << round;
    EXPECT_LE(body.spheres()[0].radius, 20 * factor * size + 0x1p-17) << round;
  }
}

// The only node of the rule is around the middle of an edge of a large facet. Its corners stay where they are by the
// main bone; both others move them alike, from places that are very far away for the node.
TEST(SkinnedCover, small_parts_of_large_facets_are_covered) {
  for (int exponent = -40; exponent >= -160; exponent -= 4) {
    const double size = std::ldexp(1, exponent);
    Mesh mesh;
    mesh.positions = {{1, 1, 0}, {-1, -1, 0}, {0, 0, 1}};
    mesh.facets = {{0, 1, 2}};
    const Skin skin{3, {0, 2, 4, 5}, {0, 1, 0, 2, 0}, {0.5, 0.5, 0.5, 0.5, 1}};
    CoveredTree model;
    model.tree.branching = 2;
    const Sphere whole{{}, 4}, part{{}, 2 * size};
    model.tree.append_level({}, std::vector{whole});
    model.tree.append_level(std::vector{2u}, std::vector{part, whole});
    model.tree.append_level(std::vector{1u, 0u}, std::vector{part});
    model.cover = {.vertex_count = 3,
                   .facet_count = 1,
                   .cut_points = {{{0, 1, 2}, {0.5 - size, 0.5, size}},
                                  {{0, 1, 2}, {0.5 - size / 2, 0.5, size / 2}},
                                  {{0, 1, 2}, {0.5, 0.5, 0}}},
                   .patch_facet = {0, 0, 0, 0},
                   .corner_begin = {0, 3, 6, 9, 12},
                   .corners = {3, 4, 5, 0, 3, 2, 1, 2, 3, 0, 1, 5},
                   .region_begin = {0, 0, 1, 0},
                   .region_end = {4, 1, 4, 1}};
    Body body(mesh, model, {.rules = {Rule::exact, Rule::exact, Rule::skinned}, .skin = skin});
    Transforms transforms(3);
    transforms[1].columns = {Vec3{1, 1, 1}, Vec3{-1, -1, -1.5}, Vec3{0, 0, 1}};
    transforms[2].columns = {Vec3{-1, -1, -1}, Vec3{1, 1, 1.5}, Vec3{0, 0, -1}};
    ASSERT_TRUE(body.update_skinned(transforms));
    EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0) << exponent;
    EXPECT_LE(body.spheres()[3].radius, 1e-5) << exponent;
  }
}

// Each bone adds less than half a unit in the last place to every entry of a matrix, which sums in float lose. The
// farthest corner is where all these entries add up.
TEST(SkinnedCover, pays_for_terms_that_sums_in_float_lose) {
  constexpr std::uint32_t bones = 4096;
  constexpr double weight = 0.5 / bones, lost = 0.49 * 0x1p-24 / weight;
  Mesh mesh;
  mesh.positions = {normalized(Vec3{1, 1, 1}), {-0.6, 0.8, 0}, {0, -0.6, 0.8}};
  mesh.facets = {{0, 1, 2}};
  Skin skin{.bone_count = bones + 1, .begin = {0}};
  for (std::uint32_t v = 0; v < 3; ++v) {
    skin.bones.push_back(0), skin.weights.push_back(0.5);
    for (std::uint32_t k = 1; k <= bones; ++k) skin.bones.push_back(k), skin.weights.push_back(weight);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  const Sphere ball{{}, 1};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), {.rules = {Rule::skinned}, .skin = skin});
  AffineTransform main, other;
  main.columns = {Vec3{-0.25, 0.5, 0.5}, Vec3{0.5, -0.25, 0.5}, Vec3{0.5, 0.5, -0.25}};
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      other.columns[k][axis] = main.columns[k][axis] + (static_cast<std::size_t>(axis) == k ? lost / 4 : lost);
  Transforms transforms(bones + 1, other);
  transforms[0] = main;
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(skin_excess(body, mesh, skin, transforms), 0);
}

// A bone for each vertex, and all of them move alike: the hull of many bones is the body itself.
TEST(SkinnedCover, nodes_with_many_bones_have_a_hull) {
  const Specimen& b = specimens()[0];
  const auto count = static_cast<std::uint32_t>(b.mesh.vertex_count());
  ASSERT_GT(count, 2 * 64u);
  Skin skin{.bone_count = count, .begin = {0}};
  for (std::uint32_t v = 0; v < count; ++v) {
    skin.bones.push_back(v), skin.weights.push_back(1);
    skin.begin.push_back(v + 1);
  }
  Body body(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
  const double at_rest = body.sphere(0).radius;
  Random random(3);
  Transforms transforms(count);
  for (AffineTransform& t : transforms) t.translation = any_vector(random, 0.1 * at_rest);
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(skin_excess(body, b.mesh, skin, transforms), 0);
  EXPECT_LE(body.sphere(0).radius, 1.5 * at_rest);
}

// A tube that bends at a joint: no larger than 1.5 times the spheres of `exact` in the middle of all leaves.
TEST(SkinnedCover, leaves_of_a_bent_limb_stay_near_those_of_exact) {
  const Specimen& b = specimens()[0];
  Skin skin{.bone_count = 2, .begin = {0}};
  for (const Vec3& p : b.mesh.positions) {
    const double second = std::clamp(p.x + 0.5, 0.0, 1.0);
    for (const std::uint32_t bone : {0u, 1u}) {
      const double weight = bone == 0 ? 1 - second : second;
      if (weight > 0) skin.bones.push_back(bone), skin.weights.push_back(weight);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  Body skinned(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
  Body exact(b.mesh, b.model, {.rules = {Rule::exact}, .skin = skin});
  Transforms transforms(2);
  transforms[1].columns = {Vec3{0.5, 0.866, 0}, Vec3{-0.866, 0.5, 0}, Vec3{0, 0, 1}};
  ASSERT_TRUE(skinned.update_skinned(transforms));
  ASSERT_TRUE(exact.update_skinned(transforms));
  std::vector<double> ratios;
  for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node)
    if (b.model.tree.is_leaf(node))
      ratios.push_back(static_cast<double>(skinned.spheres()[node].radius / exact.spheres()[node].radius));
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.5);
  EXPECT_LE(ratios.back(), 3);
}

}  // namespace
}  // namespace morula
