// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nodes of the rule `skinned` that are measured on their own corners. The oracle of cover moves every corner of every
// region by the definition of a skin, in long double, and compares without a tolerance; it shares no code with the
// rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/numbers.hpp>

#include "bodies.hpp"
#include "quadruped.hpp"

namespace morula {
namespace {

using test::Quadruped;
using test::Specimen;
using test::specimens;
using Bones = std::vector<AffineTransform>;
using Place = std::array<long double, 3>;

// A body whose bones have moved, after its morph targets.
struct Pose {
  const Bones& bones;
  const Modes* modes = nullptr;
  std::vector<double> morphs{};
};

// Where the skin puts a vertex: m + sum of weights times (T m - m), with m = rest + sum of morphs times displacements.
Place true_vertex(const Skin& skin, std::uint32_t v, const Vec3& at_rest, const Pose& pose) {
  Place rest{at_rest.x, at_rest.y, at_rest.z};
  for (std::size_t j = 0; j < pose.morphs.size(); ++j)
    for (std::size_t axis = 0; axis < 3; ++axis)
      rest[axis] += static_cast<long double>(pose.morphs[j]) * pose.modes->mode(j)[v][static_cast<int>(axis)];
  Place moved = rest;
  for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
    const AffineTransform& t = pose.bones[skin.bones[k]];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto entry = [&](std::size_t column) {
        return static_cast<long double>(t.columns[column][static_cast<int>(axis)]);
      };
      const int a = static_cast<int>(axis);
      const long double image = entry(0) * rest[0] + entry(1) * rest[1] + entry(2) * rest[2] + t.translation[a];
      moved[axis] += skin.weights[k] * (image - rest[axis]);
    }
  }
  return moved;
}

// The largest distance by which a corner lies outside a sphere that owns it; negative if all lie inside.
long double bare_by(const Body& body, const Mesh& mesh, const Skin& skin, const Pose& pose) {
  const Cover& cover = body.cover();
  const auto corner = [&](std::uint32_t c) {
    if (c < cover.vertex_count) return true_vertex(skin, c, mesh.positions[c], pose);
    const CutPoint& cut = cover.cut_points[c - cover.vertex_count];
    Place sum{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (cut.weight[i] == 0) continue;
      const Place p = true_vertex(skin, cut.vertex[i], mesh.positions[cut.vertex[i]], pose);
      for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += static_cast<long double>(cut.weight[i]) * p[axis];
    }
    return sum;
  };
  long double worst = -HUGE_VALL;
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) {
    const Spheref& s = body.spheres()[node];
    for (const std::uint32_t c : cover.region_corners(node)) {
      const Place p = corner(c);
      const auto away = [&](int axis) {
        const long double center = static_cast<long double>(body.origin()[axis]) + s.center[axis];
        return p[static_cast<std::size_t>(axis)] - center;
      };
      const long double excess = std::hypot(away(0), away(1), away(2)) - s.radius;
      if (!(excess <= worst)) worst = excess;
    }
  }
  return worst;
}

Vec3 offset_within(Random& random, double size) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}

// Affine maps of any kind: near the identity, singular, mirrored, uneven, far away.
AffineTransform affine_of_kind(Random& random, int kind, double size) {
  AffineTransform t;
  for (Vec3& column : t.columns) column += offset_within(random, kind == 0 ? 0.3 : 1.5);
  if (kind == 1) t.columns[1] = t.columns[2] = t.columns[0];
  if (kind == 2) t.columns = {Vec3{-1, 0, 0}, Vec3{0, random.uniform(0, 20), 0}, Vec3{}};
  t.translation = offset_within(random, kind == 3 ? 1e6 * size : size);
  return t;
}
Bones bones_of_kind(Random& random, std::size_t count, int kind, double size) {
  Bones bones;
  for (std::size_t b = 0; b < count; ++b) bones.push_back(affine_of_kind(random, kind, size));
  return bones;
}

// Four weights that vary smoothly, or at random, also negative; a vertex in seven has one bone.
Skin skin_with(const Mesh& mesh, std::size_t bone_count, bool smooth) {
  Random random(5);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t count = v % 7 == 0 && !smooth ? 1 : 4;
    const Vec3 p = is_finite(mesh.positions[v]) ? mesh.positions[v] : Vec3{};
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      weights.push_back(smooth   ? 1.2 + std::sin(3 * p.x + static_cast<double>(k))
                        : k == 0 ? 2
                                 : random.uniform(-0.3, 1));
      sum += weights.back();
      skin.bones.push_back(static_cast<std::uint32_t>((smooth ? k : v / 9 + k) % bone_count));
    }
    for (const double weight : weights) skin.weights.push_back(weight / sum);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

UpdateOptions measured_by(const Skin& skin, double budget, const std::vector<Bones>& poses) {
  UpdateOptions options{.rules = {Rule::skinned}, .skin = skin};
  options.details.skinned_measured = budget;
  for (const Bones& pose : poses) options.training.insert(options.training.end(), pose.begin(), pose.end());
  return options;
}

constexpr std::size_t nine = 9;
std::vector<Bones> any_training(double size) {
  Random random(17);
  std::vector<Bones> poses;
  for (int k = 0; k < 4; ++k) poses.push_back(bones_of_kind(random, nine, k % 3, size));
  return poses;
}

void expect_measured_cover(const std::string& name, const Mesh& mesh, const CoveredTree& model, double size) {
  for (const bool smooth : {true, false})
    for (const double budget : {0.3, 1.0}) {
      const Skin skin = skin_with(mesh, nine, smooth);
      Body body(mesh, model, measured_by(skin, budget, any_training(size)));
      const std::uint64_t rest = body.hash();
      const Bones identities(nine);
      EXPECT_LE(bare_by(body, mesh, skin, {identities}), 0) << name;
      Random random(23);
      std::vector<Vec3> positions(mesh.vertex_count());
      for (int round = 0; round < 12; ++round) {
        const Bones bones = bones_of_kind(random, nine, round % 4, size);
        ASSERT_TRUE(body.update_skinned(bones)) << name;
        EXPECT_LE(bare_by(body, mesh, skin, {bones}), 0) << name << ", round " << round;
        move_by_skin(skin, mesh.positions, bones, positions);
        EXPECT_TRUE(body.certify(positions).covered) << name << ", round " << round;
      }
      ASSERT_TRUE(body.update_skinned(identities));
      EXPECT_EQ(body.hash(), rest) << name;
    }
}

TEST(SkinMeasured, every_level_covers_at_any_transforms) {
  for (const Specimen& b : specimens()) expect_measured_cover(b.name, b.mesh, b.model, 1);
}

TEST(SkinMeasured, covers_far_from_the_origin_and_at_any_size) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-9, 1e6})
    for (const double away : {0.0, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_measured_cover("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh,
                            test::hand_made_tree(mesh, {.cut_facets = true}), scale);
    }
}

TEST(SkinMeasured, covers_vertices_that_morph_targets_move_before_the_bones) {
  const Specimen& b = specimens()[2];
  const Skin skin = skin_with(b.mesh, nine, true);
  const Modes modes = test::smooth_modes(b.mesh, 3);
  UpdateOptions options = measured_by(skin, 0.5, any_training(1));
  const Body without(b.mesh, b.model, options);
  options.modes = modes;
  Body body(b.mesh, b.model, options);
  ASSERT_GT(body.bind_report().nodes_measured, 0u);
  EXPECT_EQ(body.bind_report().nodes_measured, without.bind_report().nodes_measured);
  const std::uint64_t rest = body.hash();
  Random random(37);
  for (int round = 0; round < 12; ++round) {
    const Bones bones = bones_of_kind(random, nine, round % 4, 1);
    const std::vector<double> morphs{random.uniform(-2, 2), 0, random.uniform(-1, 1)};
    ASSERT_TRUE(body.update_skinned(bones, morphs));
    EXPECT_LE(bare_by(body, b.mesh, skin, {bones, &modes, morphs}), 0) << round;
  }
  ASSERT_TRUE(body.update_skinned(Bones(nine), std::vector<double>(3)));
  EXPECT_EQ(body.hash(), rest);
}

// Rounding keeps each summand from vertices above 2, and raises those from vertices below: the moved facet is smaller
// than the true one by far more than `exact` allows for.
TEST(SkinMeasured, pays_for_the_rounding_of_long_sums) {
  constexpr std::uint32_t many = 8192;
  constexpr double size = 0x1p-33;
  Mesh mesh;
  mesh.positions = {{2 - size, 2 - size, 2 - size}, {2 + size, 2 + size, 2 + size}, {2 + size, 2 + size, 2}};
  mesh.facets = {{0, 1, 2}};
  Skin skin{.bone_count = many, .begin = {0}};
  for (std::uint32_t v = 0; v < 3; ++v) {
    for (std::uint32_t k = 0; k < many; ++k) skin.bones.push_back(k), skin.weights.push_back(1.0 / many);
    skin.begin.push_back(many * (v + 1));
  }
  const Sphere ball{{2, 2, 2}, 2 * size};
  Bones stretched(many), moved(many);
  for (AffineTransform& t : stretched) t.columns[0] = {3, 0, 0};
  const double step = 0.75 * 0x1p-52 * many;
  for (AffineTransform& t : moved) t.translation = {step, step, step};
  Body body(mesh, test::root_with_leaves(mesh, ball, std::vector{ball}), measured_by(skin, 1, {stretched}));
  ASSERT_GT(body.bind_report().nodes_measured, 0u);
  ASSERT_TRUE(body.update_skinned(moved));
  EXPECT_LE(bare_by(body, mesh, skin, {moved}), 0);
}

// Vertices about the origin leave the range of points in single precision: the spheres from bones stay.
TEST(SkinMeasured, covers_vertices_that_are_too_far_to_be_measured) {
  const Specimen& b = specimens()[0];
  double reach = 0;
  for (const Vec3& p : b.mesh.positions) reach = std::max(reach, max_norm(p));
  const double scale = 0.9 * static_cast<double>(largest_local_coordinate) / reach;
  Mesh mesh = b.mesh;
  for (Vec3& p : mesh.positions) p *= scale;
  const CoveredTree model = test::hand_made_tree(mesh, {.cut_facets = true, .center_shift = 0});
  const Skin skin = skin_with(b.mesh, nine, true);
  const auto stretched = [](double shear, double stretch) {
    Bones bones(nine);
    for (std::size_t k = 0; k < nine; ++k) {
      const double sign = k % 2 == 0 ? 1 : -1;
      bones[k].columns = {Vec3{1 + stretch, sign * shear, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    }
    return bones;
  };
  Body body(mesh, model, measured_by(skin, 1, {stretched(0.04, -0.02)}));
  ASSERT_GT(body.bind_report().nodes_measured, 0u);
  Body exact(mesh, model, {.rules = {Rule::exact}, .skin = skin});
  const Bones out = stretched(0.02, 0.2);
  ASSERT_FALSE(exact.update_skinned(out));
  ASSERT_TRUE(body.update_skinned(out));
  EXPECT_LE(bare_by(body, mesh, skin, {out}), 0);
  for (const Spheref& s : body.spheres()) EXPECT_LE(s.radius, largest_radius);
}

TEST(SkinMeasured, spheres_are_never_larger_than_by_bones_alone) {
  for (const Specimen& b : specimens()) {
    const Skin skin = skin_with(b.mesh, nine, true);
    Body bones_alone(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
    Body body(b.mesh, b.model, measured_by(skin, 1, any_training(1)));
    Random random(3);
    for (int round = 0; round < 12; ++round) {
      const Bones bones = bones_of_kind(random, nine, round % 4, 1);
      ASSERT_TRUE(body.update_skinned(bones));
      ASSERT_TRUE(bones_alone.update_skinned(bones));
      for (std::size_t node = 0; node < body.spheres().size(); ++node)
        EXPECT_LE(body.spheres()[node].radius, bones_alone.spheres()[node].radius) << b.name << ' ' << node;
    }
  }
}

TEST(SkinMeasured, a_budget_of_0_is_bones_alone) {
  const Specimen& b = specimens()[2];
  const Skin skin = skin_with(b.mesh, nine, false);
  Body bones_alone(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin});
  Body body(b.mesh, b.model, measured_by(skin, 0, any_training(1)));
  EXPECT_EQ(body.bind_report().nodes_measured, 0u);
  Random random(3);
  const Bones bones = bones_of_kind(random, nine, 0, 1);
  const UpdateStatus status = body.update_skinned(bones);
  ASSERT_TRUE(status);
  EXPECT_EQ(status.vertices_read, 0u);
  EXPECT_EQ(status.points_tested, 0u);
  ASSERT_TRUE(bones_alone.update_skinned(bones));
  EXPECT_EQ(body.hash(), bones_alone.hash());
}

TEST(SkinMeasured, nothing_is_measured_where_nothing_is_gained) {
  const Specimen& b = specimens()[0];
  const Skin skin = skin_with(b.mesh, nine, true);
  Bones shifted(nine);
  for (AffineTransform& t : shifted) t.translation = {3, -1, 2};
  const Body body(b.mesh, b.model, measured_by(skin, 1, {Bones(nine), shifted}));
  EXPECT_EQ(body.bind_report().nodes_measured, 0u);
}

TEST(SkinMeasured, a_larger_budget_moves_more_vertices_up_to_all) {
  const Specimen& b = specimens()[0];
  const Skin skin = skin_with(b.mesh, nine, false);
  std::size_t nodes = 0, vertices = 0, tested = 0;
  for (const double budget : {0.05, 0.2, 0.5, 1.0}) {
    Body body(b.mesh, b.model, measured_by(skin, budget, any_training(1)));
    const UpdateStatus status = body.update_skinned(Bones(nine));
    EXPECT_GT(body.bind_report().nodes_measured, nodes) << budget;
    EXPECT_GT(status.points_tested, tested) << budget;
    EXPECT_GE(status.vertices_read, vertices) << budget;
    nodes = body.bind_report().nodes_measured, vertices = status.vertices_read, tested = status.points_tested;
    if (budget < 0.5) {
      EXPECT_LE(vertices, b.mesh.vertex_count() / 2) << budget;
    }
  }
  EXPECT_EQ(nodes, b.model.tree.node_count());
  EXPECT_EQ(vertices, b.mesh.vertex_count());
}

TEST(SkinMeasured, results_do_not_depend_on_workers_copies_or_rejected_updates) {
  const Specimen& b = specimens()[2];
  const Skin skin = skin_with(b.mesh, nine, true);
  Random random(29);
  const Bones first = bones_of_kind(random, nine, 0, 1), second = bones_of_kind(random, nine, 2, 1);
  Bones wrong = first;
  wrong[3].columns[1].x = test::nan;
  for (const std::vector<Rule>& rules :
       {std::vector{Rule::skinned}, std::vector{Rule::exact, Rule::skinned}, std::vector{Rule::wrapped, Rule::skinned}})
    for (const bool conservative : {false, true}) {
      UpdateOptions options = measured_by(skin, 0.4, any_training(1));
      options.rules = rules;
      options.conservative = conservative;
      std::uint64_t expected = 0;
      for (const unsigned threads : {1u, 2u, 5u}) {
        Workers workers(threads);
        Body body(b.mesh, b.model, options, workers);
        EXPECT_GT(body.bind_report().nodes_measured, 0u);
        if (threads == 2) {
          ASSERT_TRUE(body.update_skinned(second, workers));
          ASSERT_FALSE(body.update_skinned(wrong, workers));
          ASSERT_FALSE(body.update_skinned(Bones(3), workers));
        }
        Body copy = body;
        ASSERT_TRUE(body.update_skinned(first, workers));
        if (expected == 0) expected = body.hash();
        EXPECT_EQ(body.hash(), expected) << threads;
        ASSERT_TRUE(copy.update_skinned(second));
        EXPECT_EQ(body.hash(), expected) << threads;
        ASSERT_TRUE(copy.update_skinned(first));
        EXPECT_EQ(copy.hash(), expected) << threads;
      }
    }
}

TEST(SkinMeasured, updates_allocate_nothing) {
  const Specimen& b = specimens()[0];
  const Skin skin = skin_with(b.mesh, nine, true);
  Body body(b.mesh, b.model, measured_by(skin, 0.5, any_training(1)));
  ASSERT_GT(body.bind_report().nodes_measured, 0u);
  Random random(31);
  const Bones bones = bones_of_kind(random, nine, 0, 1);
  const std::size_t before = test::allocations;
  ASSERT_TRUE(body.update_skinned(bones));
  EXPECT_EQ(test::allocations, before);
}

TEST(SkinMeasured, rejects_budgets_and_training_that_no_body_can_use) {
  const Specimen& b = specimens()[0];
  const Skin skin = skin_with(b.mesh, nine, true);
  const auto message_of = [&](const UpdateOptions& options) {
    try {
      const Body body(b.mesh, b.model, options);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const double budget : {-0.1, 1.01, test::nan, test::infinity})
    EXPECT_NE(message_of(measured_by(skin, budget, any_training(1))).find("skinned_measured"), std::string::npos);
  EXPECT_NE(message_of(measured_by(skin, 0.5, {})).find("UpdateOptions::training"), std::string::npos);
  EXPECT_NE(message_of(measured_by(skin, 0.5, {Bones(nine), Bones(4)})).find("no multiple"), std::string::npos);
  std::vector<Bones> poses = any_training(1);
  poses[2][5].translation.y = test::nan;
  EXPECT_NE(message_of(measured_by(skin, 0.5, poses)).find("frame 2 of the training moves bone 5"), std::string::npos);
  poses[2][5].translation.y = 0x1p60;
  EXPECT_NE(message_of(measured_by(skin, 0.5, poses)).find("frame 2 of the training moves bone 5"), std::string::npos);
  // Unused, so not looked at.
  EXPECT_EQ(message_of(measured_by(skin, 0, {Bones(4)})), "");
  UpdateOptions exact = measured_by(skin, 0.5, {});
  exact.rules = {Rule::exact};
  EXPECT_EQ(message_of(exact), "");
}

// Gaits between those of the training, some of them wider.
TEST(SkinMeasured, leaves_of_a_walking_body_stay_near_those_of_exact) {
  const Quadruped body_and_bones = test::quadruped(16);
  const CoveredTree model =
      test::hand_made_tree(body_and_bones.mesh, {.depth = 3, .smallest_leaf = 12, .center_shift = 0});
  std::vector<Bones> poses;
  for (int f = 0; f < 20; ++f) poses.push_back(body_and_bones.gait(f / 20.0, f % 2 == 0 ? 0.35 : 0.5));
  Body body(body_and_bones.mesh, model, measured_by(body_and_bones.skin, 0.2, poses));
  Body exact(body_and_bones.mesh, model, {.rules = {Rule::exact}, .skin = body_and_bones.skin});
  std::vector<double> ratios;
  for (int f = 0; f < 20; ++f) {
    const Bones pose = body_and_bones.gait(f / 20.0 + 0.013, 0.25 + 0.35 * (f * 7 % 10) / 9.0);
    ASSERT_TRUE(body.update_skinned(pose));
    ASSERT_TRUE(exact.update_skinned(pose));
    EXPECT_LE(bare_by(body, body_and_bones.mesh, body_and_bones.skin, {pose}), 0) << f;
    for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
      if (model.tree.is_leaf(node))
        ratios.push_back(static_cast<double>(body.spheres()[node].radius / exact.spheres()[node].radius));
  }
  std::sort(ratios.begin(), ratios.end());
  EXPECT_LE(ratios[ratios.size() / 2], 1.05);
  EXPECT_LE(ratios[ratios.size() * 95 / 100], 1.25);
  EXPECT_LE(ratios.back(), 1.8);
}

}  // namespace
}  // namespace morula
