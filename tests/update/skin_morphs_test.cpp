// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Morph targets ahead of bones: positions worked out by hand, the order of calls, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/update/body.hpp>
#include <morula/update/skin_morphs.hpp>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/numbers.hpp>

#include "bodies.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
namespace {

using Poses = std::vector<AffineTransform>;
using Code = UpdateStatus::Code;

constexpr std::size_t bone_count = 5, target_count = 4;

// One to eight influences, at random.
Skin mixed_skin(const Mesh& mesh) {
  Random random(23);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    std::vector<double> weights(1 + v % 8);
    double sum = 0;
    for (double& w : weights) sum += w = random.uniform(0.1, 1);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      skin.bones.push_back(static_cast<std::uint32_t>((v / 5 + k) % bone_count));  // a bone may come twice
      skin.weights.push_back(weights[k] / sum);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

Poses random_poses(std::uint64_t seed) {
  Random random(seed);
  Poses poses(bone_count);
  for (AffineTransform& t : poses) {
    for (Vec3& column : t.columns) column += {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    t.translation = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  }
  return poses;
}

std::vector<double> random_morphs(std::uint64_t seed, std::size_t count = target_count) {
  Random random(seed);
  std::vector<double> morphs(count);
  for (double& q : morphs) q = random.uniform(-1, 1);
  return morphs;
}

UpdateOptions with_targets(const Mesh& mesh, std::vector<Rule> rules = {Rule::skinned}) {
  return {.rules = std::move(rules), .modes = test::smooth_modes(mesh, target_count), .skin = mixed_skin(mesh)};
}

std::vector<Vec3> moved(const Body& body, const Mesh& mesh, const Poses& poses, const std::vector<double>& morphs) {
  std::vector<Vec3> positions(mesh.vertex_count());
  move_by_skin(body.options().skin, body.options().modes, mesh.positions, poses, morphs, positions);
  return positions;
}

bool equal_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

TEST(SkinMorphs, move_vertices_before_the_bones_do) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const Skin skin{2, {0, 1, 3, 3}, {0, 0, 1}, {1, 0.5, 0.5}};  // the third vertex has none
  const Modes modes{3, 2, {{0, 1, 0}, {0, 0, 0}, {2, 0, 0}, {9, 9, 9}, {9, 9, 9}, {9, 9, 9}}};
  Poses poses(2);
  poses[0].columns = {Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, 0, 1}};  // a quarter turn about z
  poses[1].translation = {0, 0, 4};
  std::vector<Vec3> positions(3);
  move_by_skin(skin, modes, mesh.positions, poses, std::vector{2.0, 0.0}, positions);
  EXPECT_EQ(positions[0], (Vec3{-2, 1, 0}));      // (1, 2, 0), turned
  EXPECT_EQ(positions[1], (Vec3{-0.5, 0.5, 2}));  // half of (-1, 0, 0) and (0, 1, 4)
  EXPECT_EQ(positions[2], (Vec3{4, 0, 1}));
}

TEST(SkinMorphs, positions_have_the_same_bits_on_every_path) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens()) {
    const UpdateOptions options = with_targets(b.mesh, {Rule::exact});
    const Poses poses = random_poses(1);
    const std::vector<double> morphs = random_morphs(2);
    // In two steps.
    std::vector<Vec3> first(b.mesh.vertex_count()), expected = first, one = first, other = first;
    move_by_modes(options.modes, b.mesh.positions, morphs, first);
    move_by_skin(options.skin, first, poses, expected);
    move_by_skin(options.skin, options.modes, b.mesh.positions, poses, morphs, one);
    move_by_skin(options.skin, options.modes, b.mesh.positions, poses, morphs, other, three);
    EXPECT_TRUE(equal_bits(one, expected)) << b.name;
    EXPECT_TRUE(equal_bits(one, other)) << b.name;
    // One vertex by itself.
    for (std::size_t v = 0; v < one.size(); ++v) {
      const Vec3 morphed = detail::morphed_vertex(options.modes, v, b.mesh.positions[v], morphs);
      other[v] = detail::skinned_vertex(options.skin, v, morphed, poses);
    }
    EXPECT_TRUE(equal_bits(one, other)) << b.name;
    Body by_skin(b.mesh, b.model, options), exact(b.mesh, b.model);
    ASSERT_TRUE(by_skin.update_skinned(poses, morphs));
    ASSERT_TRUE(exact.update(expected));
    EXPECT_EQ(by_skin.hash(), exact.hash()) << b.name;
    ASSERT_TRUE(by_skin.sphere_state().positions);
    for (std::size_t v = 0; v < b.mesh.vertex_count(); ++v)
      if (is_finite(b.mesh.positions[v])) {
        EXPECT_EQ((*by_skin.sphere_state().positions)[v], expected[v]) << b.name;
      }
    // Nothing moves: rest, bit for bit.
    move_by_skin(options.skin, options.modes, b.mesh.positions, Poses(bone_count), std::vector(target_count, -0.0),
                 one);
    EXPECT_TRUE(equal_bits(one, b.mesh.positions)) << b.name;
    move_by_skin(options.skin, options.modes, b.mesh.positions, poses, {}, one);
    move_by_skin(options.skin, b.mesh.positions, poses, other);
    EXPECT_TRUE(equal_bits(one, other)) << b.name;
  }
}

TEST(SkinMorphs, levels_mix_with_those_that_follow_positions) {
  for (const test::Specimen& b : test::specimens()) {
    const Poses poses = random_poses(11);
    const std::vector<double> morphs = random_morphs(12);
    Body mixed(b.mesh, b.model, with_targets(b.mesh, {Rule::exact, Rule::skinned}));
    Body skinned(b.mesh, b.model, with_targets(b.mesh)), exact(b.mesh, b.model);
    ASSERT_TRUE(mixed.update_skinned(poses, morphs));
    ASSERT_TRUE(skinned.update_skinned(poses, morphs));
    ASSERT_TRUE(exact.update(moved(skinned, b.mesh, poses, morphs)));
    EXPECT_EQ(mixed.origin(), exact.origin()) << b.name;
    EXPECT_EQ(skinned.origin(), exact.origin()) << b.name;
    EXPECT_EQ(mixed.spheres()[0], exact.spheres()[0]) << b.name;
    for (std::uint32_t node = b.model.tree.level_begin[1]; node < b.model.tree.node_count(); ++node)
      EXPECT_EQ(mixed.spheres()[node], skinned.spheres()[node]) << b.name << ' ' << node;
  }
}

// Each update starts from rest, so earlier ones leave nothing behind: good, bad, with morphs or without.
TEST(SkinMorphs, the_order_of_calls_does_not_matter) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens())
    for (const std::vector<Rule>& rules :
         {std::vector{Rule::skinned}, std::vector{Rule::exact, Rule::skinned}, std::vector{Rule::exact}})
      for (const bool conservative : {false, true}) {
        UpdateOptions options = with_targets(b.mesh, rules), plain = options;
        options.conservative = plain.conservative = conservative;
        plain.modes = {};
        Body body(b.mesh, b.model, options);
        Body without(b.mesh, b.model, plain);
        const Body at_rest = body;
        EXPECT_EQ(at_rest.hash(), without.hash()) << b.name;
        const Poses poses = random_poses(5), bad = Poses(bone_count - 1), identity(bone_count);
        const std::vector<double> morphs = random_morphs(6), others = random_morphs(7), none(target_count, 0.0);
        ASSERT_TRUE(body.update_skinned(poses, morphs));
        const std::uint64_t morphed = body.hash();
        EXPECT_NE(morphed, at_rest.hash());
        const auto expect_all = [&](Body& one, Workers& workers) {
          EXPECT_TRUE(one.update_skinned(poses, others, workers));
          EXPECT_TRUE(one.update_skinned(poses, workers));
          EXPECT_TRUE(without.update_skinned(poses));
          EXPECT_EQ(one.hash(), without.hash()) << b.name;
          EXPECT_TRUE(one.update_skinned(poses, morphs, workers));
          EXPECT_EQ(one.hash(), morphed) << b.name;
          EXPECT_FALSE(one.update_skinned(bad, others, workers));
          EXPECT_FALSE(one.update_skinned(poses, std::span(others).first(1), workers));
          EXPECT_EQ(one.hash(), morphed) << b.name;
          EXPECT_TRUE(one.update_skinned(poses, none, workers));
          EXPECT_EQ(one.hash(), without.hash()) << b.name;
          EXPECT_TRUE(one.update_skinned(identity, none, workers));
          EXPECT_EQ(one.hash(), at_rest.hash()) << b.name;
          EXPECT_TRUE(one.update_skinned(poses, morphs, workers));
          EXPECT_EQ(one.hash(), morphed) << b.name;
        };
        expect_all(body, serial_workers());
        Body copy = body;
        EXPECT_EQ(copy.hash(), morphed) << b.name;
        expect_all(copy, three);
        EXPECT_EQ(body.hash(), morphed) << b.name;
      }
}

// A body with many targets of which a few move is one with these few.
TEST(SkinMorphs, targets_that_do_not_move_count_for_nothing) {
  const test::Specimen& b = test::specimens()[2];
  const UpdateOptions few = with_targets(b.mesh);
  UpdateOptions many = few;
  many.modes = test::rough_modes(b.mesh, 40);
  std::vector<double> morphs = random_morphs(9), sparse(40, 0.0);
  const std::size_t v_count = b.mesh.vertex_count();
  for (std::size_t j = 0; j < target_count; ++j) {
    const std::span<const Vec3> own = few.modes.mode(j);
    std::copy(own.begin(), own.end(),
              many.modes.displacements.begin() + static_cast<std::ptrdiff_t>((3 + 11 * j) * v_count));
    sparse[3 + 11 * j] = morphs[j];
  }
  Body one(b.mesh, b.model, few), other(b.mesh, b.model, many);
  ASSERT_TRUE(one.update_skinned(random_poses(8), morphs));
  ASSERT_TRUE(other.update_skinned(random_poses(8), sparse));
  EXPECT_EQ(one.hash(), other.hash());
}

TEST(SkinMorphs, bad_input_is_named_and_changes_nothing) {
  const test::Specimen& b = test::specimens()[0];
  Body body(b.mesh, b.model, with_targets(b.mesh));
  const Poses poses = random_poses(3);
  const std::vector<double> morphs = random_morphs(4);
  ASSERT_TRUE(body.update_skinned(poses, morphs));
  const std::uint64_t last_good = body.hash();
  EXPECT_EQ(body.update_skinned(poses, {}).code, Code::wrong_coordinate_count);
  EXPECT_EQ(body.update_skinned(poses, random_morphs(1, 5)).code, Code::wrong_coordinate_count);
  EXPECT_EQ(body.update_skinned({}, morphs).code, Code::wrong_transform_count);
  EXPECT_EQ(body.update_modal(morphs).code, Code::needs_transforms);
  for (const double bad : {test::nan, test::infinity, 1e40}) {
    std::vector<double> spoiled = morphs;
    spoiled[2] = bad;
    const UpdateStatus status = body.update_skinned(poses, spoiled);
    EXPECT_EQ(status.code, Code::bad_coordinate) << bad;
    EXPECT_EQ(status.index, 2u) << bad;
    Poses wrong = poses;
    wrong[1].columns[0].z = bad;
    EXPECT_EQ(body.update_skinned(wrong, morphs).code, Code::bad_transform) << bad;
    EXPECT_EQ(body.update_skinned(wrong, morphs).index, 1u) << bad;
  }
  EXPECT_FALSE(body.is_current());
  EXPECT_EQ(body.hash(), last_good);
  ASSERT_TRUE(body.update_skinned(poses, morphs));
  EXPECT_EQ(body.hash(), last_good);

  UpdateOptions options = with_targets(b.mesh);
  options.modes = {};
  EXPECT_EQ(Body(b.mesh, b.model, options).update_skinned(poses, morphs).code, Code::no_modes);
  EXPECT_TRUE(Body(b.mesh, b.model, options).update_skinned(poses, {}));  // none for a body without any
  EXPECT_EQ(Body(b.mesh, b.model).update_skinned(poses, morphs).code, Code::no_skin);
  options = with_targets(b.mesh, {Rule::modal});
  EXPECT_EQ(Body(b.mesh, b.model, options).update_skinned(poses, morphs).code, Code::needs_coordinates);
  // With positions alone to follow, a body with both takes either.
  Body either(b.mesh, b.model, with_targets(b.mesh, {Rule::exact}));
  EXPECT_TRUE(either.update_modal(morphs));
  EXPECT_TRUE(either.update_skinned(poses, morphs));
}

// Each in range by itself, but not the two together.
TEST(SkinMorphs, morphs_and_transforms_share_one_range) {
  const test::Specimen& b = test::specimens()[0];
  UpdateOptions options = with_targets(b.mesh);
  options.modes = {b.mesh.vertex_count(), 1, std::vector<Vec3>(b.mesh.vertex_count(), {1, 0, 0})};
  Body body(b.mesh, b.model, options);
  const std::vector<double> far{0.75 * 0x1p55};
  Poses poses(bone_count);
  EXPECT_TRUE(body.update_skinned(poses, far));
  poses[3].translation = {0, 0.75 * 0x1p55, 0};
  EXPECT_TRUE(body.update_skinned(poses, std::vector{0.0}));
  const UpdateStatus status = body.update_skinned(poses, far);
  EXPECT_EQ(status.code, Code::bad_transform);
  EXPECT_EQ(status.index, 3u);
  // A stretch of a morphed body.
  poses = Poses(bone_count);
  poses[1].columns[0].x = 1000;
  EXPECT_TRUE(body.update_skinned(poses, std::vector{0x1p40}));
  EXPECT_EQ(body.update_skinned(poses, std::vector{0x1p50}).code, Code::bad_transform);
}

TEST(SkinMorphs, no_update_allocates_good_or_bad) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens())
    for (const std::vector<Rule>& rules : {std::vector{Rule::skinned}, std::vector{Rule::exact, Rule::skinned}}) {
      Body body(b.mesh, b.model, with_targets(b.mesh, rules));
      const Poses poses = random_poses(3);
      const std::vector<double> morphs = random_morphs(4);
      for (Workers* workers : {&serial_workers(), &three}) {
        const std::size_t before = test::allocations;
        const bool ok = static_cast<bool>(body.update_skinned(poses, morphs, *workers));
        const bool refused = !body.update_skinned(poses, {}, *workers) && !body.update_skinned({}, morphs, *workers);
        const std::size_t after = test::allocations;
        EXPECT_TRUE(ok && refused);
        EXPECT_EQ(after - before, 0u) << b.name;
      }
    }
}

TEST(CompleteWeights, a_bone_takes_what_is_missing) {
  const test::Specimen& b = test::specimens()[2];
  Random random(31);
  Skin skin = mixed_skin(b.mesh);
  for (double& w : skin.weights) w *= random.uniform(0, 1.5);
  EXPECT_THROW(Body(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = skin}), std::invalid_argument);
  const Skin whole = complete_weights(skin);
  EXPECT_EQ(whole.bone_count, bone_count + 1);
  Body body(b.mesh, b.model, {.rules = {Rule::skinned}, .skin = whole});
  Poses poses = random_poses(13);
  for (const bool as_libigl : {true, false}) {
    poses.resize(bone_count);
    std::vector<Vec3> positions(b.mesh.vertex_count());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3 p = b.mesh.positions[v];
      Vec3 sum;
      double missing = 1;
      for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
        sum += skin.weights[k] * poses[skin.bones[k]](p);
        missing -= skin.weights[k];
      }
      positions[v] = as_libigl ? sum : sum + missing * p;
    }
    poses.push_back(as_libigl ? AffineTransform{.columns = {}} : AffineTransform{});
    std::vector<Vec3> ours(positions.size());
    move_by_skin(whole, b.mesh.positions, poses, ours);
    for (std::size_t v = 0; v < ours.size(); ++v) EXPECT_LE(distance(ours[v], positions[v]), 1e-14) << v;
    ASSERT_TRUE(body.update_skinned(poses));
    EXPECT_TRUE(body.certify(ours).covered);
  }
}

TEST(CompleteWeights, leaves_whole_vertices_alone_and_names_bad_input) {
  const Skin skin{2, {0, 2, 2, 3, 4}, {0, 1, 1, 0}, {0.5, 0.5 - 9e-7, 1, 3}};
  const Skin loose = complete_weights(skin), tight = complete_weights(skin, 0);
  EXPECT_EQ(loose.begin, (std::vector<std::uint32_t>{0, 2, 3, 4, 6}));
  EXPECT_EQ(loose.bones, (std::vector<std::uint32_t>{0, 1, 2, 1, 0, 2}));
  EXPECT_EQ(loose.weights[2], 1);  // a vertex without influences
  EXPECT_EQ(loose.weights[5], -2);
  EXPECT_EQ(tight.begin, (std::vector<std::uint32_t>{0, 3, 4, 5, 7}));
  const auto refused = [](Skin spoiled, double tolerance, const std::string& word) {
    try {
      complete_weights(spoiled, tolerance);
      ADD_FAILURE() << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  Skin spoiled = skin;
  spoiled.weights[2] = test::nan;
  refused(spoiled, 0, "vertex 2");
  spoiled = skin;
  spoiled.bones[3] = 2;  // the number that the new bone gets
  refused(spoiled, 0, "vertex 3");
  spoiled = skin;
  spoiled.begin.pop_back();
  refused(spoiled, 0, "influences");
  refused(Skin{}, 0, "influences");
  refused(skin, 1e-5, "tolerance");
  refused(skin, test::nan, "tolerance");
  refused(skin, -1, "tolerance");
}

}  // namespace
}  // namespace morula
