// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The kernels of the rule `skinned`: bounds of matrices, groups that are not full, and the same bits on all processors.
#include "update/rules/skin_kernels.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <vector>

#include "../bodies.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

using Wide = std::array<long double, 3>;
using Bones = std::vector<AffineTransform>;

Wide times(const std::array<Vec3, 3>& columns, const Wide& v) {
  Wide result{};
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(axis)] += static_cast<long double>(columns[k][axis]) * v[k];
  return result;
}
Wide times_transposed(const std::array<Vec3, 3>& columns, const Wide& v) {
  Wide result{};
  for (std::size_t k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)
      result[k] += static_cast<long double>(columns[k][axis]) * v[static_cast<std::size_t>(axis)];
  return result;
}
long double size_of(const Wide& v) {
  return std::hypot(std::hypot(v[0], v[1]), v[2]);
}

// The stretch that the power method reaches: nearly the largest, and never more.
long double reached_stretch(const std::array<Vec3, 3>& columns) {
  Wide v{0.6L, 0.48L, 0.64L};
  for (int step = 0; step < 300; ++step) {
    const Wide image = times(columns, v), back = times_transposed(columns, image);
    const long double size = size_of(back);
    if (size == 0) break;
    for (std::size_t k = 0; k < 3; ++k) v[k] = back[k] / size;
  }
  return size_of(times(columns, v)) / size_of(v);
}

using FloatColumns = std::array<Vec3f, 3>;

// The bounds that a kernel finds for a matrix in all lanes, or in one of them beside others.
std::vector<float> stretches_of(const FloatColumns& columns, const SkinKernels& kernels, bool is_alone) {
  LaneVectors lanes[3]{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t lane = 0; lane < lanes_of_group; ++lane) {
      const float factor = !is_alone || lane == 5 ? 1 : 0x1p30f;
      lanes[k].x[lane] = columns[k].x * factor;
      lanes[k].y[lane] = columns[k].y;
      lanes[k].z[lane] = columns[k].z * factor;
    }
  LaneFloats stretches;
  kernels.stretch(lanes, stretches);
  if (is_alone) return {stretches[5]};
  return {std::begin(stretches), std::end(stretches)};
}

TEST(SkinKernels, the_stretch_of_matrices_of_any_size_is_bounded) {
  Random random(5);
  for (int k = 0; k < 6000; ++k) {
    const float size = std::ldexp(1.0f, k % 2 == 0 ? 0 : k % 160 - 110);
    std::array<Vec3, 3> wide;
    FloatColumns columns;
    for (Vec3& c : wide) c = Vec3{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    if (k % 3 == 0) wide[2] = wide[0] * 0.5;
    if (k % 5 == 0) wide[2] = wide[1] = wide[0];
    if (k % 7 == 0)  // nearly a rotation
      wide = {Vec3{0.6, 0.8, 0} + wide[0] * 1e-6, Vec3{-0.8, 0.6, 0} + wide[1] * 1e-6, Vec3{0, 0, 1} + wide[2] * 1e-6};
    for (std::size_t c = 0; c < 3; ++c) columns[c] = size * Vec3f(wide[c]), wide[c] = Vec3(columns[c]);
    const long double reached = reached_stretch(wide);
    for (const SkinKernels& kernels : all_skin_kernels())
      for (const bool is_alone : {false, true})
        for (const float stretch : stretches_of(columns, kernels, is_alone)) {
          EXPECT_GE(static_cast<long double>(stretch), reached) << k;
          EXPECT_LE(static_cast<long double>(stretch), (k % 7 == 0 ? 1.0001L : 1.031L) * reached) << k;
        }
  }
  for (const SkinKernels& kernels : all_skin_kernels()) {
    EXPECT_EQ(stretches_of({}, kernels, true)[0], 0);
    EXPECT_NEAR(stretches_of({Vec3f{0, 1, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 0, -1}}, kernels, true)[0], 1, 4e-5);
  }
}

// Facets apart from each other, one per leaf. All have one main bone, and others in turn; one in three, and the first
// of nine, follows it alone.
struct Facets {
  Mesh mesh;
  CoveredTree model;
  Skin skin{.bone_count = 8, .begin = {0}};
};
Facets facets(std::uint32_t count) {
  Facets f;
  std::vector<Sphere> leaves;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double at = 2.0 * i;
    f.mesh.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (const Vec3& p : {Vec3{at, 0, 0}, Vec3{at + 1, 0.1 * i, 0}, Vec3{at, 1, 0.2}}) {
      f.mesh.positions.push_back(p);
      const double other = i % 3 == 0 ? 0 : 0.1 + 0.1 * p.y + 0.05 * (p.x - at);
      f.skin.bones.insert(f.skin.bones.end(), {0, 1 + i % 5, 6 + i % 2});
      f.skin.weights.insert(f.skin.weights.end(), {1 - other - other / 2, other, other / 2});
      f.skin.begin.push_back(static_cast<std::uint32_t>(f.skin.bones.size()));
    }
    leaves.push_back({{at + 0.5, 0.5, 0.1}, 1.5});
  }
  f.model = test::root_with_leaves(f.mesh, {{count - 0.5, 0.5, 0}, 2.0 * count + 2}, leaves);
  return f;
}

AffineTransform any_transform(Random& random, double amount, double away) {
  AffineTransform t;
  const auto number = [&] { return random.uniform(-1, 1); };
  for (Vec3& column : t.columns) column += amount * Vec3{number(), number(), number()};
  t.translation = away * Vec3{number(), number(), number()};
  return t;
}

// Rest, small and large motions, bones that shrink to a point or fly off, and one motion for all.
std::vector<Bones> motions(std::size_t bone_count) {
  Random random(9);
  std::vector<Bones> result{Bones(bone_count)};
  for (int k = 0; k < 12; ++k) {
    Bones& bones = result.emplace_back();
    for (std::size_t b = 0; b < bone_count; ++b)
      bones.push_back(any_transform(random, k % 3 == 0 ? 0.2 : 2, k % 4 == 3 ? 1e6 : 1));
    if (k % 4 == 1) bones[1].columns = {}, bones[0].columns[2] = {};
    if (k == 5) bones.assign(bone_count, bones[2]);
    if (k == 7) bones[0].columns = {};
  }
  return result;
}

TEST(SkinKernels, groups_of_any_number_of_nodes_cover_with_any_number_of_workers) {
  for (std::uint32_t count = 1; count <= 19; ++count) {
    const Facets f = facets(count);
    Body body(f.mesh, f.model, {.rules = {Rule::skinned}, .skin = f.skin});
    std::vector<Vec3> positions(f.mesh.vertex_count());
    for (const Bones& bones : motions(f.skin.bone_count)) {
      move_by_skin(f.skin, f.mesh.positions, bones, positions);
      ASSERT_TRUE(body.update_skinned(bones));
      EXPECT_LE(body.certify(positions).worst_excess, 0) << count;
      const std::uint64_t expected = body.hash();
      for (const unsigned threads : {2u, 5u}) {
        Workers workers(threads);
        ASSERT_TRUE(body.update_skinned(bones, workers));
        EXPECT_EQ(body.hash(), expected) << count;
      }
    }
  }
}

TEST(SkinKernels, all_processors_give_the_same_bits) {
  const std::size_t kinds = runnable_kinds();
  for (const std::uint32_t count : {1u, 3u, 9u, 40u}) {
    const Facets f = facets(count);
    std::vector<std::uint64_t> expected;
    for (std::size_t most = 1; most <= kinds; ++most) {
      allow_kinds(most);
      Body body(f.mesh, f.model, {.rules = {Rule::skinned}, .skin = f.skin});
      std::vector<std::uint64_t> hashes{body.hash()};
      for (const Bones& bones : motions(f.skin.bone_count)) {
        EXPECT_TRUE(body.update_skinned(bones));
        hashes.push_back(body.hash());
      }
      if (expected.empty()) expected = hashes;
      EXPECT_EQ(hashes, expected) << kind_name(most - 1);
    }
    allow_kinds(kinds);
  }
}

// A bone that no vertex follows, and one that vertices name with a weight of 0.
TEST(SkinKernels, bones_without_weight_change_no_sphere) {
  Facets f = facets(9);
  Body without(f.mesh, f.model, {.rules = {Rule::skinned}, .skin = f.skin});
  for (std::size_t k = 0; k < f.skin.weights.size(); ++k)
    if (f.skin.weights[k] == 0) f.skin.bones[k] = 9;
  f.skin.bone_count = 10;
  Body with(f.mesh, f.model, {.rules = {Rule::skinned}, .skin = f.skin});
  for (Bones bones : motions(8)) {
    ASSERT_TRUE(without.update_skinned(bones));
    bones.resize(10);
    bones[8].translation = bones[9].translation = {1e9, -1e9, 1e9};
    ASSERT_TRUE(with.update_skinned(bones));
    EXPECT_EQ(with.hash(), without.hash());
  }
}

}  // namespace
}  // namespace morula::detail
