// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cover by the rule `skinned` with morph targets. The oracle computes every corner of every region from the definition,
// morph targets first and bones next, in long double, and compares without a tolerance; it shares no code with the
// rule.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <morula/update/skin_morphs.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using MorphTransforms = std::vector<AffineTransform>;
using LongPoint = std::array<long double, 3>;

LongPoint morphed_and_skinned(const Mesh& mesh, const Skin& skin, const Modes& modes, const MorphTransforms& transforms,
                              const std::vector<double>& morphs, std::size_t v) {
  LongPoint m{}, sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    m[axis] = mesh.positions[v][static_cast<int>(axis)];
    for (std::size_t j = 0; j < modes.mode_count; ++j)
      m[axis] += static_cast<long double>(morphs[j]) * modes.mode(j)[v][static_cast<int>(axis)];
  }
  long double missing = 1;
  for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
    const AffineTransform& t = transforms[skin.bones[k]];
    missing -= skin.weights[k];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      long double moved = t.translation[static_cast<int>(axis)];
      for (std::size_t column = 0; column < 3; ++column)
        moved += static_cast<long double>(t.columns[column][static_cast<int>(axis)]) * m[column];
      sum[axis] += static_cast<long double>(skin.weights[k]) * moved;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += missing * m[axis];
  return sum;
}

// The largest |corner - center| - radius over all nodes and corners.
long double morph_excess(const Body& body, const Mesh& mesh, const MorphTransforms& transforms,
                         const std::vector<double>& morphs) {
  const UpdateOptions& options = body.options();
  std::vector<LongPoint> vertices;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
    vertices.push_back(morphed_and_skinned(mesh, options.skin, options.modes, transforms, morphs, v));
  const Cover& cover = body.cover();
  const Vec3 origin = body.origin();
  long double worst = -HUGE_VALL;
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) {
    const Spheref& s = body.spheres()[node];
    for (const std::uint32_t c : cover.region_corners(node)) {
      long double squared = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        long double p = 0;
        if (c < cover.vertex_count) {
          p = vertices[c][axis];
        } else {
          const CutPoint& cut = cover.cut_points[c - cover.vertex_count];
          for (std::size_t k = 0; k < 3; ++k)
            p += static_cast<long double>(cut.weight[k]) * vertices[cut.vertex[k]][axis];
        }
        const long double d = p - (static_cast<long double>(origin[static_cast<int>(axis)]) +
                                   static_cast<long double>(s.center[static_cast<int>(axis)]));
        squared += d * d;
      }
      const long double excess = std::sqrt(squared) - static_cast<long double>(s.radius);
      if (!(excess <= worst)) worst = excess;
    }
  }
  return worst;
}

Vec3 morph_vector(Random& random, double size = 1) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}

// Rotations, or affine maps of any kind: singular, mirrored, stretched, far away.
AffineTransform morph_transform(Random& random, int kind, double size) {
  AffineTransform t;
  for (Vec3& column : t.columns) column = morph_vector(random, kind == 3 ? 100 : 1);
  if (kind == 0) {
    t.columns[0] = normalized(t.columns[0]);
    t.columns[1] = normalized(cross(t.columns[0], t.columns[1]));
    t.columns[2] = cross(t.columns[0], t.columns[1]);
  }
  if (kind == 1) t.columns[2] = t.columns[1] = -t.columns[0];
  if (kind == 2) t.columns = {Vec3{-1, 0, 0}, Vec3{0, random.uniform(0, 50), 0}, Vec3{}};
  t.translation = morph_vector(random, size * (kind == 4 ? 1e9 : 1));
  return t;
}

enum class Influences { four, smooth, one, negative, eight, loose_sums };

Skin morph_skin(const Mesh& mesh, std::size_t bone_count, Influences kind, double size) {
  Random random(17);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t count = kind == Influences::eight ? 8 : kind == Influences::one || v % 5 == 0 ? 1 : 4;
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const double x = is_finite(mesh.positions[v]) ? mesh.positions[v].x / size : 0;
      weights.push_back(kind == Influences::smooth ? 1.2 + std::sin(static_cast<double>(k) + x)
                                                   : random.uniform(kind == Influences::negative ? -0.3 : 0.05, 1));
      // Far from 0, or the weights become large.
      if (kind == Influences::negative && k == 0) weights[0] += 2;
      sum += weights.back();
      skin.bones.push_back(static_cast<std::uint32_t>((kind == Influences::smooth ? k : v / 9 + k) % bone_count));
    }
    const double wanted = kind == Influences::loose_sums ? 1 + 9e-7 * random.uniform(-1, 1) : 1;
    for (const double weight : weights) skin.weights.push_back(weight / sum * wanted);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

// Smooth and rough modes, and some of a few vertices alone.
Modes morph_modes(const Mesh& mesh, std::size_t count, double size) {
  const Modes smooth = test::smooth_modes(mesh, count), rough = test::rough_modes(mesh, count);
  Modes modes{mesh.vertex_count(), count, {}};
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 u = size * (j % 3 == 0 ? smooth.mode(j)[v] : rough.mode(j)[v]);
      modes.displacements.push_back(j % 3 != 2 || v % 11 == j ? u : Vec3{});
    }
  return modes;
}

std::vector<double> morph_weights(Random& random, std::size_t count, int round) {
  const double most = round % 5 == 4 ? 1e6 : round % 5 == 3 ? 1e-6 : 1;
  std::vector<double> morphs(count);
  for (double& q : morphs)
    if (round % 3 != 0 || random.uniform() < 0.3) q = most * random.uniform(-1, 1);
  return morphs;
}

void expect_morph_cover(const std::string& name, const Mesh& mesh, const CoveredTree& model, double size, int rounds) {
  constexpr std::size_t bones = 9, targets = 6;
  for (const Influences kind : {Influences::four, Influences::smooth, Influences::one, Influences::negative,
                                Influences::eight, Influences::loose_sums}) {
    const Skin skin = morph_skin(mesh, bones, kind, size);
    const Modes modes = morph_modes(mesh, targets, size);
    Body body(mesh, model, {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
    Random random(3);
    std::vector<Vec3> positions(mesh.vertex_count());
    for (int round = 0; round < rounds; ++round) {
      MorphTransforms transforms;
      for (std::size_t b = 0; b < bones; ++b)
        transforms.push_back(morph_transform(random, round % 6 == 5 ? static_cast<int>(b % 5) : round % 6, size));
      if (round % 4 == 1) transforms[0] = {};
      if (round % 8 == 2) transforms.assign(bones, {});
      const std::vector<double> morphs = morph_weights(random, targets, round);
      ASSERT_TRUE(body.update_skinned(transforms, morphs)) << name;
      EXPECT_LE(morph_excess(body, mesh, transforms, morphs), 0)
          << name << ", skin " << static_cast<int>(kind) << ", round " << round;
      move_by_skin(skin, modes, mesh.positions, transforms, morphs, positions);
      EXPECT_TRUE(body.certify(positions).covered) << name << ' ' << round;
    }
  }
}

TEST(SkinMorphCover, every_level_covers_at_any_transforms_and_morphs) {
  for (const test::Specimen& b : test::specimens()) expect_morph_cover(b.name, b.mesh, b.model, 1, 30);
}

TEST(SkinMorphCover, holds_far_from_the_origin_and_at_any_size) {
  const test::Specimen& b = test::specimens()[2];
  for (const double scale : {1e-9, 1.0, 1e6})
    for (const double away : {0.0, 1e3, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_morph_cover("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh,
                         test::hand_made_tree(mesh, {.cut_facets = true}), scale, 12);
    }
}

// Each summand of the positions is rounded by up to three quarters of a unit in the last place.
TEST(SkinMorphCover, pays_for_sums_over_many_morph_targets) {
  constexpr std::size_t count = 8192;
  constexpr double size = 0x1p-33, step = -0.75 * 0x1p-52;
  Mesh mesh;
  mesh.positions = {{2 - size, 2 - size, 2 - size}, {2 + size, 2 + size, 2 + size}, {2 + size, 2 + size, 2}};
  mesh.facets = {{0, 1, 2}};
  const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
  const Modes modes{3, count, std::vector<Vec3>(3 * count, {step, step, step})};
  const Sphere ball{{2, 2, 2}, 2 * size};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}),
            {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
  const std::vector<double> morphs(count, 1.0);
  std::vector<Vec3> positions(3);
  move_by_skin(skin, modes, mesh.positions, MorphTransforms(1), morphs, positions);
  ASSERT_LT(positions[0].x, mesh.positions[0].x - 0.9 * count * 0x1p-52);
  ASSERT_TRUE(body.update_skinned(MorphTransforms(1), morphs));
  EXPECT_LE(body.certify(positions).worst_excess, 0);
  EXPECT_LE(morph_excess(body, mesh, MorphTransforms(1), morphs), 0);
}

// The first target moves a facet of size 2^-33 far away and the last one brings it back; in between all steps are lost.
// Neither the origin nor a bone goes far, but a bone that scales the facet scales the loss.
TEST(SkinMorphCover, pays_for_targets_that_cancel_each_other) {
  constexpr std::size_t count = 8192;
  constexpr double size = 0x1p-33, far = 1024, step = 0.4 * 0x1p-42;
  ASSERT_EQ(far + step, far);
  Mesh mesh;
  mesh.positions = {{-size, -size, -size}, {size, size, size}, {size, size, 0}};
  mesh.facets = {{0, 1, 2}};
  const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
  Modes modes{3, count, {}};
  for (std::size_t j = 0; j < count; ++j) {
    const double by = j == 0 || j + 1 == count ? far : step;
    modes.displacements.insert(modes.displacements.end(), 3, {by, by, by});
  }
  std::vector<double> morphs(count, 1.0);
  morphs.back() = -1;
  const Sphere ball{{}, 2 * size};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}),
            {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
  for (const double scale : {1.0, 0x1p20}) {
    MorphTransforms transforms(1);
    transforms[0].columns = {Vec3{scale, 0, 0}, Vec3{0, scale, 0}, Vec3{0, 0, scale}};
    std::vector<Vec3> positions(3);
    move_by_skin(skin, modes, mesh.positions, transforms, morphs, positions);
    ASSERT_TRUE(body.update_skinned(transforms, morphs));
    EXPECT_LE(body.certify(positions).worst_excess, 0) << scale;
    EXPECT_LE(morph_excess(body, mesh, transforms, morphs), 0) << scale;
  }
}

// Displacements of one unit of the smallest double, by the largest coordinates: shares of a third of them are 0.
TEST(SkinMorphCover, pays_for_targets_that_lose_their_digits) {
  Random random(19);
  constexpr double least = std::numeric_limits<double>::denorm_min(), most = std::numeric_limits<double>::max();
  for (int round = 0; round < 200; ++round) {
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(morph_vector(random, 1e-14));
    mesh.facets = {{0, 1, 2}};
    Skin skin{.bone_count = 3, .begin = {0}};
    for (std::uint32_t v = 0; v < 3; ++v) {
      for (std::uint32_t k = 0; k < 3; ++k) skin.bones.push_back(k), skin.weights.push_back(1.0 / 3);
      skin.begin.push_back(3 * (v + 1));
    }
    const Modes modes{3, 1, {{least, 0, 0}, {}, {0, -least, least}}};
    const Sphere ball{{}, 2e-14};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}),
              {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
    const MorphTransforms transforms(3, morph_transform(random, 0, 0));
    const std::vector<double> morphs{most * random.uniform(-1, 1)};
    ASSERT_TRUE(body.update_skinned(transforms, morphs));
    EXPECT_LE(morph_excess(body, mesh, transforms, morphs), 0) << round;
  }
}

// A target moves a body by a million times its size, on a path that floats cannot follow.
TEST(SkinMorphCover, pays_for_motions_much_larger_than_the_body) {
  Random random(23);
  for (int round = 0; round < 200; ++round) {
    Mesh mesh;
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(morph_vector(random, 1e-6));
    mesh.facets = {{0, 1, 2}};
    const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1, 1, 1}};
    const Modes modes{3, 1, std::vector<Vec3>(3, morph_vector(random, 1))};
    const Sphere ball{{}, 2e-6};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}),
              {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
    const MorphTransforms transforms(1);
    const std::vector<double> morphs{random.uniform(-9, 9)};
    ASSERT_TRUE(body.update_skinned(transforms, morphs));
    EXPECT_LE(morph_excess(body, mesh, transforms, morphs), 0) << round;
  }
}

// The body is a point at rest, or nearly one, and its targets unfold it.
TEST(SkinMorphCover, bodies_that_targets_unfold_get_no_huge_spheres) {
  for (const double size : {0.0, 1e-300, 1e-60, 1e-39, 1e-3}) {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
    mesh.facets = {{0, 1, 2}};
    const Skin skin{2, {0, 1, 2, 4}, {0, 0, 0, 1}, {1, 1, 0.25, 0.75}};
    const Modes modes{3, 1, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Sphere ball{{}, 2 * size};
    Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}),
              {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
    for (const double coordinate : {-1.0, 1e-9, 1.0, 1e9}) {
      MorphTransforms transforms(2);
      transforms[1].columns = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};
      const std::vector<double> morphs{coordinate};
      ASSERT_TRUE(body.update_skinned(transforms, morphs));
      EXPECT_LE(morph_excess(body, mesh, transforms, morphs), 0) << size << ' ' << coordinate;
      EXPECT_LE(body.spheres()[0].radius, 3 * std::abs(coordinate) + 3 * size) << size << ' ' << coordinate;
    }
  }
}

// The parts that a body moves all at once: no larger than the sphere at rest.
TEST(SkinMorphCover, a_target_that_moves_a_node_as_a_whole_does_not_enlarge_it) {
  const test::Specimen& b = test::specimens()[2];
  const Modes modes{b.mesh.vertex_count(), 1, std::vector<Vec3>(b.mesh.vertex_count(), {0.5, -2, 1})};
  const Skin skin = morph_skin(b.mesh, 4, Influences::four, 1);
  Body body(b.mesh, b.model, {.rules = {Rule::skinned}, .modes = modes, .skin = skin});
  const Body rest = body;
  ASSERT_TRUE(body.update_skinned(MorphTransforms(4), std::vector{-3.0}));
  for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
    EXPECT_LE(distance(body.sphere(node).center, rest.sphere(node).center + Vec3{-1.5, 6, -3}), 1e-6) << node;
    EXPECT_NEAR(body.sphere(node).radius, rest.sphere(node).radius, 1e-6 * rest.sphere(node).radius) << node;
  }
}

}  // namespace
}  // namespace morula
