// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `skinned`: equations worked by hand, exactness where blending is exact, and what it refuses to promise.
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/update/body.hpp>
#include <random>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/numbers.hpp>

#include "bodies.hpp"
#include "reference.hpp"

namespace morula {
namespace {

using test::allocations;
using test::Specimen;
using test::specimens;
using Transforms = std::vector<AffineTransform>;

using test::infinity;
using test::nan;

AffineTransform affine(const RigidTransform& t) {
  AffineTransform result{.columns = {}, .translation = t.translation};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) result.columns[column][row] = t.rows[row][column];
  return result;
}
AffineTransform turned(const Vec3& axis, double angle, const Vec3& offset = {}) {
  return affine(RigidTransform::from_axis(axis, angle, offset));
}

// Up to four of the bones a vertex, at random; every third vertex has one alone.
Skin some_skin(const Mesh& mesh, std::size_t bone_count, std::uint64_t seed = 1) {
  Random random(seed);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t count = v % 3 == 0 ? 1 : 4;
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      weights.push_back(random.uniform(0.1, 1));
      sum += weights.back();
      skin.bones.push_back(static_cast<std::uint32_t>((v / 5 + k) % bone_count));
    }
    for (const double weight : weights) skin.weights.push_back(weight / sum);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

Transforms some_transforms(std::size_t count, double amount, std::uint64_t seed) {
  Random random(seed);
  Transforms transforms;
  for (std::size_t b = 0; b < count; ++b) {
    const auto vector = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
    const Vec3 axis = vector();
    transforms.push_back(turned(axis, amount * random.uniform(0, 1), amount * vector()));
  }
  return transforms;
}

UpdateOptions with_skin(Skin skin, std::vector<Rule> rules = {Rule::skinned}) {
  return {.rules = std::move(rules), .skin = std::move(skin)};
}

// As the definition has it, in long double and in another order: sum of weights times transformed positions.
Vec3 blended(const Skin& skin, std::size_t v, const Vec3& p, const Transforms& transforms) {
  long double sum[3]{};
  for (std::uint32_t k = skin.begin[v + 1]; k-- > skin.begin[v];) {
    const AffineTransform& t = transforms[skin.bones[k]];
    for (int axis = 0; axis < 3; ++axis)
      sum[axis] +=
          static_cast<long double>(skin.weights[k]) *
          (static_cast<long double>(t.translation[axis]) + static_cast<long double>(t.columns[0][axis]) * p.x +
           static_cast<long double>(t.columns[1][axis]) * p.y + static_cast<long double>(t.columns[2][axis]) * p.z);
  }
  return {static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])};
}

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(Skin, positions_are_those_of_linear_blending) {
  Workers three(3);
  for (const Specimen& b : specimens()) {
    const Skin skin = some_skin(b.mesh, 5);
    const Transforms transforms = some_transforms(5, 2, 7);
    std::vector<Vec3> one(b.mesh.vertex_count()), other(b.mesh.vertex_count());
    move_by_skin(skin, b.mesh.positions, transforms, one);
    move_by_skin(skin, b.mesh.positions, transforms, other, three);
    EXPECT_TRUE(same_bits(one, other)) << b.name;
    for (std::size_t v = 0; v < one.size(); ++v)
      if (is_finite(b.mesh.positions[v])) {  // those that no facet uses may be anything
        EXPECT_LE(distance(one[v], blended(skin, v, b.mesh.positions[v], transforms)), 1e-13) << b.name << ' ' << v;
      }
    move_by_skin(skin, b.mesh.positions, Transforms(5), one);
    for (std::size_t v = 0; v < one.size(); ++v) {
      if (is_finite(b.mesh.positions[v])) {
        EXPECT_EQ(one[v], b.mesh.positions[v]) << b.name << ' ' << v;
      }
    }
  }
}

TEST(Skin, products_of_transforms_apply_the_right_one_first) {
  const AffineTransform a = turned({0, 0, 1}, 0.5, {1, 2, 3});
  AffineTransform b;
  b.columns = {Vec3{2, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 0, 3}};
  b.translation = {-1, 0, 4};
  const Vec3 p{0.3, -0.7, 1.1};
  EXPECT_LE(distance((a * b)(p), a(b(p))), 1e-15);
  EXPECT_GT(distance((b * a)(p), a(b(p))), 0.1);
}

// The facet's corners follow a second bone, which stretches uniformly, by a third. That is too little for other
// bounds, whose centers differ, to be tried.
TEST(Skinned, a_sphere_follows_the_blend_of_transforms) {
  const Specimen& b = specimens().back();
  ASSERT_EQ(b.mesh.facet_count(), 1u);
  const double third = 1.0 / 3;
  const std::vector<double> weights{1 - third, third, 1 - third, third, 1 - third, third};
  Body body(b.mesh, b.model, with_skin({2, {0, 2, 4, 6}, {0, 1, 0, 1, 0, 1}, weights}));
  const Sphere rest = body.sphere(0);
  Transforms transforms(2);
  transforms[1].columns = {Vec3{1.15, 0, 0}, Vec3{0, 1.15, 0}, Vec3{0, 0, 1.15}};
  transforms[1].translation = {0, 6, 0};
  ASSERT_TRUE(body.update_skinned(transforms));
  EXPECT_LE(distance(body.sphere(0).center, 1.05 * rest.center + Vec3{0, 2, 0}), 1e-5);
  EXPECT_NEAR(body.sphere(0).radius, 1.05 * rest.radius, 1e-5 * rest.radius);
}

// No other center has a smaller radius: the distance to the farthest corner is convex in the center.
TEST(Skinned, identity_is_rest_bit_for_bit_and_rest_has_the_smallest_spheres) {
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> coordinate(-1, 1);
  for (const Specimen& b : specimens()) {
    Body body(b.mesh, b.model, with_skin(some_skin(b.mesh, 4)));
    const std::uint64_t rest = body.hash();
    for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
      const Sphere own = body.sphere(node);
      const double rounding = 5e-5 * own.radius + 1e-6 * (1 + length(own.center));
      EXPECT_LE(own.radius, b.model.tree.spheres[node].radius + rounding) << b.name << ' ' << node;
      for (const double step : {0.01, 0.1, 1.0}) {
        const Vec3 aside = step * own.radius * Vec3{coordinate(random), coordinate(random), coordinate(random)};
        EXPECT_GE(test::owned_reach(b.model, node, own.center + aside, b.mesh.positions), own.radius - rounding)
            << b.name << ' ' << node;
      }
    }
    ASSERT_TRUE(body.update_skinned(some_transforms(4, 1, 3)));
    EXPECT_NE(body.hash(), rest) << b.name;
    ASSERT_TRUE(body.update_skinned(Transforms(4)));
    EXPECT_EQ(body.hash(), rest) << b.name;
  }
}

TEST(Skinned, bones_that_move_as_one_move_the_spheres_rigidly_and_keep_cover) {
  for (const Specimen& b : specimens()) {
    const Skin skin = some_skin(b.mesh, 4);
    Body body(b.mesh, b.model, with_skin(skin));
    std::vector<Sphere> rest;
    body.copy_spheres(rest);
    for (const double angle : {0.1, 1.5, 3.0}) {
      const AffineTransform motion = turned({1, -2, 0.5}, angle, {3, 4, -5});
      const Transforms transforms(4, motion);
      ASSERT_TRUE(body.update_skinned(transforms));
      for (std::uint32_t node = 0; node < rest.size(); ++node) {
        const double size = 1e-6 * (1 + length(rest[node].center) + rest[node].radius);
        EXPECT_LE(distance(body.sphere(node).center, motion(rest[node].center)), 10 * size) << b.name << ' ' << node;
        EXPECT_NEAR(body.sphere(node).radius, rest[node].radius, 4 * size) << b.name << ' ' << node;
      }
    }
  }
}

TEST(Skinned, same_bits_for_any_number_of_workers_and_any_path) {
  const Specimen& b = specimens()[2];
  const Skin skin = some_skin(b.mesh, 6);
  for (const std::vector<Rule>& rules :
       {std::vector{Rule::skinned}, std::vector{Rule::exact, Rule::skinned}, std::vector{Rule::skinned, Rule::exact}})
    for (const bool conservative : {false, true}) {
      UpdateOptions options = with_skin(skin, rules);
      options.conservative = conservative;
      std::uint64_t expected = 0;
      for (const unsigned threads : {1u, 2u, 5u}) {
        Workers workers(threads);
        Body body(b.mesh, b.model, options, workers);
        if (threads == 2) {
          ASSERT_TRUE(body.update_skinned(some_transforms(6, 2, 5), workers));
        }
        ASSERT_TRUE(body.update_skinned(some_transforms(6, 1, 3), workers));
        Body copy = body;
        if (expected == 0) expected = body.hash();
        EXPECT_EQ(body.hash(), expected) << threads;
        ASSERT_TRUE(copy.update_skinned(some_transforms(6, 1, 3), workers));
        EXPECT_EQ(copy.hash(), expected) << threads;
      }
    }
}

// Levels of other rules are what update() makes of the blended positions, and about the same origin.
TEST(Skinned, levels_mix_with_those_that_follow_positions) {
  for (const Specimen& b : specimens()) {
    const Skin skin = some_skin(b.mesh, 5);
    const Transforms transforms = some_transforms(5, 0.7, 11);
    std::vector<Vec3> positions(b.mesh.vertex_count());
    move_by_skin(skin, b.mesh.positions, transforms, positions);
    Body mixed(b.mesh, b.model, with_skin(skin, {Rule::exact, Rule::skinned}));
    Body skinned(b.mesh, b.model, with_skin(skin)), exact(b.mesh, b.model);
    Body by_skin(b.mesh, b.model, with_skin(skin, {Rule::exact}));
    ASSERT_TRUE(mixed.update_skinned(transforms));
    ASSERT_TRUE(skinned.update_skinned(transforms));
    ASSERT_TRUE(exact.update(positions));
    ASSERT_TRUE(by_skin.update_skinned(transforms));
    EXPECT_EQ(by_skin.hash(), exact.hash()) << b.name;
    EXPECT_EQ(mixed.origin(), exact.origin()) << b.name;
    EXPECT_EQ(skinned.origin(), exact.origin()) << b.name;
    EXPECT_EQ(mixed.spheres()[0], exact.spheres()[0]) << b.name;
    for (std::uint32_t node = b.model.tree.level_begin[1]; node < b.model.tree.node_count(); ++node)
      EXPECT_EQ(mixed.spheres()[node], skinned.spheres()[node]) << b.name << ' ' << node;
  }
}

TEST(Skinned, promises_cover_and_reads_no_vertex) {
  const Specimen& b = specimens()[2];
  const Skin skin = some_skin(b.mesh, 5);
  const Transforms transforms = some_transforms(5, 1, 2);
  std::vector<Vec3> positions(b.mesh.vertex_count());
  move_by_skin(skin, b.mesh.positions, transforms, positions);
  EXPECT_TRUE(traits(Rule::skinned).covers);
  Body body(b.mesh, b.model, with_skin(skin));
  EXPECT_TRUE(covers(body.options()));
  EXPECT_TRUE(body.sphere_state().covers);
  const UpdateStatus status = body.update_skinned(transforms);
  ASSERT_TRUE(status);
  EXPECT_EQ(status.vertices_read, 0u);
  EXPECT_TRUE(certify(b.model.cover, positions, test::spheres_of(body)).covered);
  EXPECT_TRUE(covers(with_skin(skin, {Rule::wrapped, Rule::skinned}), Rule::wrapped));
}

TEST(Skinned, bad_input_is_named_and_changes_nothing) {
  const Specimen& b = specimens()[0];
  Body body(b.mesh, b.model, with_skin(some_skin(b.mesh, 3)));
  const Transforms good = some_transforms(3, 1, 4);
  ASSERT_TRUE(body.update_skinned(good));
  const std::uint64_t last_good = body.hash();
  using Code = UpdateStatus::Code;
  EXPECT_EQ(body.update(b.mesh.positions).code, Code::needs_transforms);
  const VertexRange all{0, static_cast<std::uint32_t>(b.mesh.vertex_count())};
  EXPECT_EQ(body.update(b.mesh.positions, std::span(&all, 1)).code, Code::needs_transforms);
  EXPECT_EQ(body.update_lazily(b.mesh.positions, 0).code, Code::needs_transforms);
  EXPECT_EQ(body.update_modal(std::vector{1.0}).code, Code::no_modes);
  EXPECT_EQ(body.update_skinned(Transforms(2)).code, Code::wrong_transform_count);
  EXPECT_EQ(body.update_skinned({}).code, Code::wrong_transform_count);
  for (const double bad : {nan, infinity, 1e40}) {
    Transforms transforms = good;
    transforms[1].translation.y = bad;
    const UpdateStatus status = body.update_skinned(transforms);
    EXPECT_EQ(status.code, Code::bad_transform) << bad;
    EXPECT_EQ(status.index, 1u) << bad;
    transforms = good;
    transforms[2].columns[0].z = bad;
    EXPECT_EQ(body.update_skinned(transforms).index, 2u) << bad;
  }
  EXPECT_FALSE(body.is_current());
  EXPECT_EQ(body.hash(), last_good);
  ASSERT_TRUE(body.update_skinned(good));
  EXPECT_EQ(body.hash(), last_good);
  Body plain(b.mesh, b.model);
  EXPECT_EQ(plain.update_skinned(good).code, Code::no_skin);
}

TEST(Skinned, skins_that_do_not_fit_are_refused) {
  const Specimen& b = specimens()[0];
  const auto refused = [&](const std::function<void(UpdateOptions&)>& spoil, const std::string& word) {
    UpdateOptions options = with_skin(some_skin(b.mesh, 3));
    spoil(options);
    try {
      Body body(b.mesh, b.model, options);
      ADD_FAILURE() << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  refused([](UpdateOptions& o) { o.skin = {}; }, "needs a skin");
  refused([](UpdateOptions& o) { o.skin.begin.pop_back(); }, "vertices");
  refused([](UpdateOptions& o) { o.skin.begin[1] = 1000000; }, "begin");
  refused([](UpdateOptions& o) { o.skin.bones[2] = 3; }, "bone 3");
  refused([](UpdateOptions& o) { o.skin.weights.pop_back(); }, "weights");
  refused([](UpdateOptions& o) { o.skin.weights[0] = nan; }, "vertex 0");
  refused([](UpdateOptions& o) { o.skin.weights[0] = 0.5; }, "vertex 0");
  refused([](UpdateOptions& o) { o.skin.weights[0] = infinity; }, "vertex 0");
  refused(
      [&](UpdateOptions& o) {
        o.modes = test::smooth_modes(b.mesh, 2);
        o.rules = {Rule::modal, Rule::skinned};
      },
      "modal and skinned");
  EXPECT_THROW(Body(b.mesh, b.model, {.rules = {Rule::exact, static_cast<Rule>(rule_table.size())}}),
               std::invalid_argument);
}

TEST(Skinned, no_update_allocates_good_or_bad) {
  Workers three(3);
  for (const Specimen& b : specimens()) {
    const Skin skin = some_skin(b.mesh, 4);
    const Transforms good = some_transforms(4, 1, 3);
    Transforms bad = good;
    bad[3].columns[1].x = nan;
    for (const std::vector<Rule>& rules :
         {std::vector{Rule::skinned}, std::vector{Rule::exact, Rule::skinned}, std::vector{Rule::exact}}) {
      Body body(b.mesh, b.model, with_skin(skin, rules));
      for (Workers* workers : {&serial_workers(), &three}) {
        const std::size_t before = allocations;
        const bool ok = static_cast<bool>(body.update_skinned(good, *workers));
        const bool refused = !body.update_skinned(bad, *workers) && !body.update_skinned({}, *workers);
        const std::size_t after = allocations;
        EXPECT_TRUE(ok && refused);
        EXPECT_EQ(after - before, 0u) << b.name;
      }
    }
  }
}

TEST(Rules, every_rule_has_a_name_of_its_own_and_knows_what_it_follows) {
  std::size_t position_count = 0;
  for (const Rule rule : all_rules()) {
    EXPECT_TRUE(is_rule(rule));
    EXPECT_EQ(rule_from_name(name(rule)), rule);
    position_count += traits(rule).follows == RuleTraits::Follows::positions;
  }
  EXPECT_EQ(all_rules().size(), rule_table.size());
  EXPECT_EQ(position_rules().size(), position_count);
  EXPECT_EQ(rule_from_name("nobody"), std::nullopt);
  EXPECT_EQ(name(static_cast<Rule>(200)), "unknown");
  // Written down by hand: the table must not learn what cover is from itself.
  EXPECT_TRUE(covers({.rules = {Rule::exact, Rule::wrapped, Rule::modal}}));
  EXPECT_TRUE(covers({.rules = {Rule::exact, Rule::wrapped, Rule::skinned}}));
  for (const Rule rule : {Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2}) {
    EXPECT_FALSE(covers({.rules = {rule}}));
    EXPECT_FALSE(covers({.rules = {Rule::exact, rule}}));
    EXPECT_FALSE(covers({.rules = {Rule::wrapped, rule}}, Rule::wrapped));
    EXPECT_TRUE(covers({.rules = {Rule::wrapped, rule}, .conservative = true}, rule));
    EXPECT_TRUE(covers({.rules = {Rule::exact, rule}}, Rule::exact));
  }
}

}  // namespace
}  // namespace morula
