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
#include "update/rules/skin_blend.hpp"
#include "update/rules/skin_poser.hpp"

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
    std::array<Vec3, 3> rounded;
    FloatColumns columns;
    for (Vec3& c : rounded) c = Vec3{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    if (k % 3 == 0) rounded[2] = rounded[0] * 0.5;
    if (k % 5 == 0) rounded[2] = rounded[1] = rounded[0];
    if (k % 7 == 0)  // nearly a rotation
      rounded = {Vec3{0.6, 0.8, 0} + rounded[0] * 1e-6, Vec3{-0.8, 0.6, 0} + rounded[1] * 1e-6,
                 Vec3{0, 0, 1} + rounded[2] * 1e-6};
    for (std::size_t c = 0; c < 3; ++c) columns[c] = size * Vec3f(rounded[c]), rounded[c] = Vec3(columns[c]);
    const long double reached = reached_stretch(rounded);
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

// A node whose corners fill a ball of radius R, and one on the other side of the pivot.
struct TwoNodes {
  NodeBlend node, other;
  Bones bones;
};

Wide moved(const AffineTransform& t, const Wide& p) {
  Wide result = times(t.columns, p);
  for (int axis = 0; axis < 3; ++axis)
    result[static_cast<std::size_t>(axis)] += static_cast<long double>(t.translation[axis]);
  return result;
}
Wide wide(const Vec3& v) {
  return {v.x, v.y, v.z};
}

// The place of the corner at y, by the fits, in long double.
Wide place_of(const TwoNodes& n, const Wide& y) {
  const Wide c = wide(n.node.node.rest.center);
  const AffineTransform& main = n.bones[n.node.node.bone];
  Wide result = moved(main, {c[0] + y[0], c[1] + y[1], c[2] + y[2]});
  for (const BlendTerm& t : n.node.terms) {
    const AffineTransform& bone = n.bones[t.bone];
    const Wide slope = wide(t.slope), moment = wide(t.moment), to = moved(bone, c), from = moved(main, c);
    const long double weight = t.weight + slope[0] * y[0] + slope[1] * y[1] + slope[2] * y[2];
    Wide turned{};
    for (std::size_t k = 0; k < 3; ++k) turned[k] = moment[k] + static_cast<long double>(t.scale) * y[k];
    const Wide by_bone = times(bone.columns, turned), by_main = times(main.columns, turned);
    for (std::size_t k = 0; k < 3; ++k) result[k] += weight * (to[k] - from[k]) + by_bone[k] - by_main[k];
  }
  return result;
}

// How far the corner at y is outside of the node's sphere.
long double excess_of(const TwoNodes& n, const Wide& y, const SkinKernels& kernels) {
  const SkinBlend blend(std::vector{n.node, n.other});
  std::vector<BoneRow> rows(n.bones.size() + 1);
  std::vector<BoneMotion> motions(n.bones.size());
  std::vector<Vec3> shifts;
  LaneVectors columns[3]{};
  for (std::uint32_t b = 0; b < n.bones.size(); ++b) {
    const AffineTransform& t = n.bones[b];
    shifts.push_back(displacement(t, blend.pivot));
    const Vec3 row[]{t.columns[0] - Vec3{1, 0, 0}, t.columns[1] - Vec3{0, 1, 0}, t.columns[2] - Vec3{0, 0, 1},
                     shifts.back() / blend.unit};
    for (std::size_t k = 0; k < 12; ++k) rows[b].entries[k] = row[k / 3][static_cast<int>(k % 3)];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f column = motions[b].linear[k] = Vec3f(t.columns[k]);
      columns[k].x[b] = column.x, columns[k].y[b] = column.y, columns[k].z[b] = column.z;
    }
    const BonePair whole{static_cast<std::uint32_t>(n.bones.size()), b};
    kernels.differ(rows.data(), {&whole, 1}, 1, &motions[b].change);
  }
  LaneFloats sizes;
  kernels.stretch(columns, sizes);
  for (std::size_t b = 0; b < n.bones.size(); ++b) motions[b].size = sizes[b];
  std::vector<MotionRow> pairs(blend.pairs.size());
  kernels.differ(rows.data(), blend.pairs, 1, pairs.data());
  const SkinFrame frame{motions.data(), pairs.data(), blend.terms.data(), shifts.data(), 1, blend.unit};
  for (const NodeGroup& group : blend.groups)
    for (std::size_t lane = 0; lane < group.count; ++lane) {
      if (group.slot[lane] != 0) continue;
      GroupSpheres spheres;
      kernels.bound(group, frame, spheres);
      const Wide p = place_of(n, y), c = wide(n.node.node.rest.center), shift = wide(shifts[group.bone]);
      const float moves[]{spheres.center.x[lane], spheres.center.y[lane], spheres.center.z[lane]};
      Wide to{};
      for (std::size_t k = 0; k < 3; ++k)
        to[k] = p[k] - (c[k] + shift[k] + static_cast<long double>(blend.unit) * static_cast<long double>(moves[k]));
      return size_of(to) - static_cast<long double>(blend.unit) * static_cast<long double>(spheres.radius[lane]);
    }
  ADD_FAILURE() << "the node is in no group";
  return 0;
}

Vec3 any_vector(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

// Nodes that are small for the body: their radii do not hide what rounding to float moves.
TwoNodes any_nodes(Random& random, int kind) {
  TwoNodes n;
  const double radius = kind % 2 == 0 ? 1e-9 : 0.3;
  const Vec3 center = any_vector(random);
  n.node.node = {.node = 0, .bone = 0, .rest = {center, radius}};
  n.other.node = {.node = 1, .bone = 0, .rest = {-center, 1e-9}};
  n.node.shape = {{}, {Vec3{radius, 0, 0}, Vec3{0, radius, 0}, Vec3{0, 0, radius}}};
  const auto transform = [&] {
    AffineTransform t;
    for (Vec3& column : t.columns) column = column + any_vector(random);
    t.translation = any_vector(random);
    return t;
  };
  n.bones.push_back(kind < 2 || kind > 5 ? transform() : AffineTransform{});
  if (kind < 2) return n;
  for (std::uint32_t b = 1; b < 4; ++b) {
    AffineTransform t = transform();
    if (kind < 4) t.columns = n.bones[0].columns;                                // D_b moves all points alike
    if (kind >= 4 && kind < 6) t.translation += n.bones[0](center) - t(center);  // D_b moves the center nowhere
    n.bones.push_back(t);
    BlendTerm term;
    term.bone = b;
    term.weight = random.uniform(-1, 1), term.scale = random.uniform(-1, 1);
    if (kind % 2 == 1) term.slope = any_vector(random);
    term.moment = any_vector(random) * radius;
    n.node.terms.push_back(term);
  }
  return n;
}

TEST(SkinKernels, radii_pay_for_rounding_to_float) {
  Random random(8);
  for (int round = 0; round < 4000; ++round) {
    const TwoNodes n = any_nodes(random, round % 8);
    const Vec3 way = normalized(any_vector(random), {1, 0, 0}) * n.node.node.rest.radius;
    for (const SkinKernels& kernels : all_skin_kernels())
      EXPECT_LE(excess_of(n, wide(way * (1 - 1e-12)), kernels), 1e-13L) << round;
  }
}

// The main bone shrinks to a point, and the other takes its ball nearly there, from afar: only the balls' radii pay.
TEST(SkinKernels, balls_pay_for_rounding_to_float) {
  Random random(9);
  for (int round = 0; round < 500; ++round) {
    TwoNodes n;
    n.node.node = {.node = 0, .bone = 0, .rest = {{}, 4}};
    n.other.node = {.node = 1, .bone = 0, .rest = {{}, 4}};
    const Vec3 far = any_vector(random);
    AffineTransform shrunk, other;
    shrunk.columns = {};
    for (Vec3& column : other.columns) column = any_vector(random);
    other.translation = 1e-6 * any_vector(random) - other(far);
    n.bones = {shrunk, other};
    BlendTerm term;  // the corner is at `far`, and moves with the other bone alone
    term.bone = 1, term.weight = 1, term.moment = far;
    term.weight_stray = term.moment_stray = 1;
    n.node.terms = {term};
    n.node.balls = {{0, {}, 0}, {1, far, 0}};
    n.node.shape = {{}, {Vec3{9, 0, 0}, Vec3{0, 9, 0}, Vec3{0, 0, 9}}};
    for (const SkinKernels& kernels : all_skin_kernels()) EXPECT_LE(excess_of(n, {}, kernels), 1e-14L) << round;
  }
}

// An ellipsoid that is far longer than the ball of the corners: the sums of its axes lose what moves the corner.
TEST(SkinKernels, shapes_pay_for_rounding_to_float) {
  constexpr double lost = 0.99 * 0x1p-14;
  TwoNodes n;
  n.node.node = {.node = 0, .bone = 0, .rest = {{}, 0.75}};
  n.other.node = {.node = 1, .bone = 0, .rest = {{}, 0.75}};
  AffineTransform shrunk, other;
  shrunk.columns = {};
  other.columns = {Vec3{lost, 0, 0}, Vec3{1, 0, 0}, Vec3{-1, 0, 0}};
  n.bones = {shrunk, other};
  BlendTerm term;
  term.bone = 1, term.scale = 1;
  n.node.terms = {term};
  // The corner is 0.7 times the first axis less 0.7 times the second.
  n.node.shape = {{}, {Vec3{1, 1024, 1024}, Vec3{0, 1024, 1024}, Vec3{}}};
  for (const SkinKernels& kernels : all_skin_kernels()) EXPECT_LE(excess_of(n, {0.7L, 0, 0}, kernels), 0);
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

// Slivers far from each other, moved alike: only the narrowed centers are off.
TEST(SkinKernels, radii_pay_for_narrowing_the_center) {
  Random random(10);
  Mesh mesh;
  Skin skin{.bone_count = 1, .begin = {0}};
  std::vector<Sphere> leaves;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const Vec3 at = any_vector(random);
    leaves.push_back({at, 4e-7});
    mesh.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (std::uint32_t k = 0; k < 3; ++k) {
      mesh.positions.push_back(at + 2e-7 * any_vector(random));
      skin.bones.push_back(0), skin.weights.push_back(1), skin.begin.push_back(3 * i + k + 1);
    }
  }
  Body body(mesh, test::root_with_leaves(mesh, {{}, 2}, leaves), {.rules = {Rule::skinned}, .skin = skin});
  std::vector<Vec3> positions(mesh.vertex_count());
  for (int round = 0; round < 50; ++round) {
    Bones bones(1);
    bones[0].translation = any_vector(random);
    move_by_skin(skin, mesh.positions, bones, positions);
    ASSERT_TRUE(body.update_skinned(bones));
    EXPECT_LE(body.certify(positions).worst_excess, 0) << round;
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
