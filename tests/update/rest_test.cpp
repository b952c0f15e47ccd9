// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bits: back at rest, for any number of workers, for any layout of the caller's buffer.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::motions;
using test::Specimen;
using test::specimens;

std::vector<Sphere> copied(const Body& body) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  return spheres;
}

std::vector<UpdateOptions> all_options() {
  std::vector<UpdateOptions> options;
  for (const Rule rule : position_rules()) options.push_back({.rules = {rule}, .details = {}});
  RuleOptions other;
  other.approach1_weights = RuleOptions::Weights::inverse_distance;
  other.approach1_inner_center = RuleOptions::InnerCenter::linked_vertices;
  other.approach2_inner_boxes = RuleOptions::InnerBoxes::child_centers;
  other.distance_floor = 0.25;
  options.push_back({.rules = {Rule::approach1}, .details = other});
  options.push_back({.rules = {Rule::approach2}, .details = other});
  options.push_back({.rules = {Rule::approach2, Rule::exact, Rule::approach1}, .details = {}});
  options.push_back({.rules = {Rule::approach1, Rule::traditional, Rule::exact}, .details = {}});
  return options;
}

TEST(Rest, every_rule_starts_at_rest_and_returns_to_it_bit_for_bit) {
  for (const Specimen& b : specimens())
    for (const UpdateOptions& options : all_options()) {
      Body body(b.mesh, b.model, options);
      const std::uint64_t start = body.hash();
      const Vec3 origin = body.origin();
      for (const test::Motion& motion : motions()) {
        ASSERT_TRUE(body.update(motion.apply(b.mesh.positions)));
        EXPECT_NE(body.hash(), start) << b.name << ", " << motion.name;
        ASSERT_TRUE(body.update(b.mesh.positions));
        EXPECT_EQ(body.hash(), start) << b.name << ", " << motion.name << ", rule " << name(options.rules[0]);
        EXPECT_EQ(body.origin(), origin);
      }
    }
}

// What a frame was before has no influence: the same positions give the same bits by any path.
TEST(Rest, spheres_depend_on_positions_alone) {
  for (const Specimen& b : specimens())
    for (const UpdateOptions& options : all_options()) {
      Body straight(b.mesh, b.model, options), detour(b.mesh, b.model, options);
      const std::vector<Vec3> goal = motions()[5].apply(b.mesh.positions);
      for (const test::Motion& motion : motions()) ASSERT_TRUE(detour.update(motion.apply(b.mesh.positions)));
      ASSERT_TRUE(straight.update(goal));
      ASSERT_TRUE(detour.update(goal));
      EXPECT_EQ(straight.hash(), detour.hash()) << b.name;
    }
}

TEST(Rest, approaches_start_with_the_spheres_of_the_tree_rounded_up) {
  for (const Specimen& b : specimens())
    for (const Rule rule : {Rule::approach1, Rule::approach2}) {
      const Body body(b.mesh, b.model, {.rules = {rule}, .details = {}});
      const double size = bounding_box(b.mesh).diagonal();
      for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) {
        const Sphere &rest = b.model.tree.spheres[i], now = body.sphere(i);
        EXPECT_LE(distance(now.center, rest.center) + rest.radius, now.radius * (1 + 1e-12))
            << b.name << ", node " << i;
        EXPECT_LE(now.radius, rest.radius + 1e-6 * size) << b.name << ", node " << i;
      }
    }
}

TEST(Rest, exact_starts_within_the_spheres_of_the_tree) {
  for (const Specimen& b : specimens()) {
    const Body body(b.mesh, b.model);
    const double size = bounding_box(b.mesh).diagonal();
    for (std::uint32_t i = 0; i < b.model.tree.node_count(); ++i) {
      EXPECT_LE(distance(body.sphere(i).center, b.model.tree.spheres[i].center), 1e-6 * size);
      EXPECT_LE(body.sphere(i).radius, b.model.tree.spheres[i].radius + 1e-5 * size);
    }
  }
}

// Whole numbers survive every subtraction, so here the move is exact and so is the answer.
TEST(Rest, pure_translation_is_neutral) {
  Mesh mesh = specimens()[0].mesh;
  for (Vec3& p : mesh.positions) p = {std::round(64 * p.x), std::round(64 * p.y), std::round(64 * p.z)};
  const CoveredTree model = test::hand_made_tree(mesh, {.depth = 2, .cut_facets = true});
  for (const UpdateOptions& options : all_options()) {
    Body body(mesh, model, options);
    const std::vector<Spheref> rest(body.spheres().begin(), body.spheres().end());
    const Vec3 origin = body.origin(), offset{1024, -77, 4096};
    ASSERT_TRUE(body.update(test::translated(mesh.positions, offset)));
    EXPECT_EQ(body.origin(), origin + offset);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      EXPECT_EQ(body.spheres()[i].center, rest[i].center);
      EXPECT_NEAR(body.spheres()[i].radius, rest[i].radius, 1e-5) << "the allowance for mesh coordinates grows";
    }
  }
}

TEST(Rest, same_bits_for_any_number_of_workers) {
  Workers two(2), three(3), eight(8);
  for (const Specimen& b : specimens())
    for (const UpdateOptions& options : all_options()) {
      Body alone(b.mesh, b.model, options);
      for (Workers* workers : {&two, &three, &eight}) {
        Body together(b.mesh, b.model, options, *workers);
        EXPECT_EQ(together.hash(), alone.hash()) << b.name;
        for (const test::Motion& motion : motions()) {
          const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
          ASSERT_TRUE(alone.update(positions));
          ASSERT_TRUE(together.update(positions, *workers));
          EXPECT_EQ(together.hash(), alone.hash()) << b.name << ", " << motion.name;
        }
        ASSERT_TRUE(alone.update(b.mesh.positions));
      }
    }
}

TEST(Rest, large_bodies_have_the_same_bits_for_any_number_of_workers) {
  // Enough vertices, cut points and leaves for several chunks of each.
  Mesh mesh{{}, {}};
  constexpr std::uint32_t n = 150;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) mesh.positions.push_back({i / 50.0, j / 50.0, 0.1 * std::sin(0.3 * i * j)});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
      mesh.facets.push_back({a, b, b + 1});
      mesh.facets.push_back({a, b + 1, a + 1});
    }
  const CoveredTree model = test::hand_made_tree(mesh, {.depth = 4, .cut_facets = true});
  Body alone(mesh, model);
  Workers eight(8);
  Body together(mesh, model, {}, eight);
  EXPECT_GT(alone.update(mesh.positions).cut_points_moved, 8192u);
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const std::vector<Vec3> positions = test::noisy(mesh.positions, 0.1, seed);
    ASSERT_TRUE(alone.update(positions));
    ASSERT_TRUE(together.update(positions, eight));
    EXPECT_EQ(alone.hash(), together.hash());
  }
}

TEST(Rest, any_layout_of_the_same_numbers_gives_the_same_spheres) {
  struct Record {
    float mass, x, y, z;
    double inverse[3], px, py, pz, tail;
  };
  for (const Specimen& b : specimens()) {
    std::vector<Vec3f> packed;
    std::vector<Vec3> packed_double;
    std::vector<Record> records;
    for (const Vec3& p : test::noisy(b.mesh.positions, 0.1, 1)) {
      packed.emplace_back(p);
      packed_double.emplace_back(packed.back());  // the same numbers, in double
      const Vec3& d = packed_double.back();
      records.push_back({-1, packed.back().x, packed.back().y, packed.back().z, {}, d.x, d.y, d.z, -1});
    }
    // A larger array in another order: vertex i is node 2 (n - i), other nodes are not numbers.
    const std::size_t count = records.size();
    std::vector<std::uint32_t> index;
    constexpr float none = std::numeric_limits<float>::quiet_NaN();
    std::vector<Vec3f> nodes(2 * count + 1, Vec3f{none, none, none});
    std::vector<Vec3> double_nodes(nodes.size(), Vec3(nodes[0]));
    std::vector<Record> record_nodes(nodes.size(), Record{-1, none, none, none, {}, none, none, none, -1});
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t node = 2 * (count - i);
      index.push_back(static_cast<std::uint32_t>(node));
      nodes[node] = packed[i], double_nodes[node] = packed_double[i], record_nodes[node] = records[i];
    }
    const auto strided = [](const std::vector<Record>& array) {
      return std::array{PositionView::strided(&array[0].x, array.size(), sizeof(Record)),
                        PositionView::strided(&array[0].px, array.size(), sizeof(Record))};
    };
    const auto [floats, doubles] = strided(records);
    const auto [float_nodes, strided_double_nodes] = strided(record_nodes);
    const std::vector<PositionView> views{
        packed,
        packed_double,
        floats,
        doubles,
        PositionView::indexed(nodes, index),
        PositionView::indexed(double_nodes, index),
        PositionView::indexed(float_nodes, index),
        PositionView::indexed(strided_double_nodes, index),
    };
    for (const UpdateOptions& options : all_options()) {
      Body body(b.mesh, b.model, options);
      ASSERT_TRUE(body.update(views[0]));
      const std::uint64_t expected = body.hash();
      const double excess = certify(body.cover(), views[0], copied(body)).worst_excess;
      for (const PositionView& view : views) {
        ASSERT_TRUE(body.update(b.mesh.positions));
        ASSERT_TRUE(body.update(view));
        EXPECT_EQ(body.hash(), expected) << b.name;
        EXPECT_EQ(certify(body.cover(), view, copied(body)).worst_excess, excess) << b.name;
      }
    }
  }
}

TEST(Rest, reading_agrees_in_every_form) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model);
  const std::uint64_t rest_hash = body.hash();
  ASSERT_TRUE(body.update(test::translated(b.mesh.positions, {100, 0, 0})));
  EXPECT_NE(body.hash(), rest_hash) << "the origin counts";
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  const SphereTree tree = body.current_tree();
  EXPECT_EQ(tree.spheres, spheres);
  EXPECT_EQ(tree.first_child, b.model.tree.first_child);
  EXPECT_EQ(body.rest_tree().spheres, b.model.tree.spheres);
  EXPECT_EQ(body.vertex_count(), b.mesh.vertex_count());
  EXPECT_EQ(body.cover().corners, b.model.cover.corners);
  ASSERT_EQ(body.spheres().size(), spheres.size());
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    EXPECT_EQ(body.sphere(i), spheres[i]);
    EXPECT_EQ(spheres[i].center, body.origin() + Vec3(body.spheres()[i].center));
    EXPECT_EQ(spheres[i].radius, static_cast<double>(body.spheres()[i].radius));
  }
}

TEST(Rest, a_body_moves_as_a_value) {
  const Specimen& b = specimens()[0];
  Body first(b.mesh, b.model);
  const std::uint64_t hash = first.hash();
  Body second = std::move(first);
  EXPECT_EQ(second.hash(), hash);
  Body third(b.mesh, b.model, {.rules = {Rule::approach2}, .details = {}});
  third = std::move(second);
  EXPECT_EQ(third.hash(), hash);
  EXPECT_TRUE(third.update(b.mesh.positions));
}

TEST(Body, copies_are_independent_and_share_the_model) {
  const Mesh mesh = sample_body("limb");
  const auto model = std::make_shared<const CoveredTree>(build(mesh, {.method = Method::octree, .depth = 3}));
  Body body(mesh, model);
  EXPECT_EQ(&body.cover(), &model->cover) << "no copy";
  const std::vector<Vec3> bent = deform(mesh, {Bend{90}}, 1.0), twisted = deform(mesh, {Twist{90}}, 1.0);
  ASSERT_TRUE(body.update(bent));

  Body copy = body;
  EXPECT_EQ(&copy.cover(), &model->cover);
  EXPECT_EQ(copy.hash(), body.hash()) << "in the same pose";
  ASSERT_TRUE(copy.update(twisted));
  Body alone(mesh, *model);
  ASSERT_TRUE(alone.update(twisted));
  EXPECT_EQ(copy.hash(), alone.hash());
  ASSERT_TRUE(alone.update(bent));
  EXPECT_EQ(body.hash(), alone.hash()) << "the original has not moved";

  // Partial updates lean on what a body remembers of its last frame: that is copied too.
  std::vector<Vec3> poked = twisted;
  poked[mesh.vertex_count() - 1] += Vec3{0.01, 0, 0};
  const VertexRange last{static_cast<std::uint32_t>(mesh.vertex_count() - 1),
                         static_cast<std::uint32_t>(mesh.vertex_count())};
  Body second = copy;
  ASSERT_TRUE(second.update(poked, std::span(&last, 1)));
  ASSERT_TRUE(alone.update(poked));
  EXPECT_EQ(second.hash(), alone.hash());
  body = second;
  EXPECT_EQ(body.hash(), alone.hash());
  EXPECT_THROW(Body(mesh, std::shared_ptr<const CoveredTree>()), std::invalid_argument);
}

}  // namespace
}  // namespace morula
