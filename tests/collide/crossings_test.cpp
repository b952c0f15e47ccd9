// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <morula/collide/crossings.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <set>
#include <support/meshes.hpp>
#include <support/transforms.hpp>

#include "collide/facets/box_kernels.hpp"
#include "simd/processors.hpp"
#include "stale_pose.hpp"

namespace morula {
using namespace detail;
namespace {

/// A body with all that a collider borrows.
struct Bent {
  std::string name;
  Mesh mesh;
  CoveredTree model;
  Body body;
  std::vector<Vec3> positions;
  std::vector<Vec3f> narrow;
  Collider collider;

  Bent(std::string mesh_name, Mesh of)
      : name(std::move(mesh_name)),
        mesh(std::move(of)),
        model(build(mesh, {.method = Method::octree, .branching = 8, .depth = 2})),
        body(mesh, model),
        positions(mesh.positions),
        collider(mesh, body) {}
  Bent(const Bent&) = delete;

  PositionView view() const { return narrow.empty() ? PositionView(positions) : PositionView(narrow); }
  void deform_by(double amount, bool in_float) {
    positions = deform(mesh, {Stretch{1 + amount}, Noise{0.06 * amount, 0.4}}, 1.0);
    narrow.clear();
    if (in_float)
      for (const Vec3& p : positions) narrow.emplace_back(p);
    ASSERT_TRUE(body.update(view()));
    collider.set_positions(view());
  }
};

std::vector<std::unique_ptr<Bent>> specimens() {
  std::vector<std::unique_ptr<Bent>> all;
  for (const test::NamedMesh& named : test::all_meshes())
    if (named.mesh.facet_count() <= 1500) all.push_back(std::make_unique<Bent>(named.name, named.mesh));
  for (const std::string_view name : sample_body_names())
    all.push_back(std::make_unique<Bent>(std::string(name), sample_body(name, 14)));
  return all;
}

void expect_equal(std::span<const Crossing> found, const std::vector<Crossing>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected[i]);
}

double size_of(const Mesh& mesh) {
  return bounding_box(mesh).diagonal();
}

TEST(Crossings, equal_brute_force_for_random_poses_of_deformed_bodies) {
  Random random(1);
  const auto all = specimens();
  CrossingQuery result;
  std::size_t poses_that_cross = 0, pairs = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    Bent &a = *all[i], &b = *all[(i * 7 + 3) % all.size()];
    // The same spot of both, where none may be: their boxes' centers, somewhere in the world.
    const double reach = 0.4 * std::min(size_of(a.mesh), size_of(b.mesh));
    for (int pose = 0; pose < 3; ++pose) {
      ASSERT_NO_FATAL_FAILURE(a.deform_by(0.4 * pose, pose == 1));
      if (&a != &b) {
        ASSERT_NO_FATAL_FAILURE(b.deform_by(0.3 * pose, pose == 2));
      }
      RigidTransform place_a = test::random_transform(random, 1), place_b = test::random_transform(random, 1);
      const Vec3 spot = test::random_transform(random, reach).translation + Vec3{0, 0, pose == 2 ? 1e6 * reach : 0.0};
      place_a.translation = spot - place_a.rotate(bounding_box({a.positions, a.mesh.facets}).center());
      place_b.translation = spot + test::random_transform(random, reach).translation -
                            place_b.rotate(bounding_box({b.positions, b.mesh.facets}).center());
      a.collider.set_transform(place_a);
      Collider other(b.mesh, b.body);
      other.set_positions(b.view());
      other.set_transform(place_b);
      ASSERT_TRUE(result.run(a.collider, other));
      const std::vector<Crossing> expected = brute_force::crossings(a.collider, other);
      ASSERT_NO_FATAL_FAILURE(expect_equal(result.pairs(), expected)) << a.name << " against " << b.name;
      EXPECT_LE(result.pairs().size(), result.pairs_tested());
      poses_that_cross += !expected.empty();
      pairs += expected.size();
    }
  }
  EXPECT_GT(poses_that_cross, all.size());
  EXPECT_GT(pairs, 1000u);
}

TEST(Crossings, count_every_way_of_touching) {
  const Bent box("box", test::box_mesh({0, 0, 0}, {1, 1, 1}, 3)), twin("box", test::box_mesh({0, 0, 0}, {1, 1, 1}, 3));
  Collider a(box.mesh, box.body), b(twin.mesh, twin.body);
  CrossingQuery result;
  const auto pairs_at = [&](const Vec3& shift) {
    b.set_transform({.translation = shift});
    EXPECT_TRUE(result.run(a, b));
    expect_equal(result.pairs(), brute_force::crossings(a, b));
    return result.pairs().size();
  };
  EXPECT_GE(pairs_at({0, 0, 0}), box.mesh.facet_count()) << "each facet meets itself";
  EXPECT_GE(pairs_at({1, 0, 0}), 18u) << "a common side";
  EXPECT_GE(pairs_at({1, 1.0 / 3, 0}), 12u) << "two thirds of a side";
  EXPECT_GE(pairs_at({1, 1, 0}), 3u) << "a common edge";
  EXPECT_GE(pairs_at({1, 1, 1}), 1u) << "a common corner";
  EXPECT_GE(pairs_at({0.5, 0.25, 0}), 1u) << "coplanar sides that overlap";
  EXPECT_EQ(pairs_at({1 + 0x1p-52, 0, 0}), 0u) << "apart by the last bit";
  EXPECT_EQ(pairs_at({0, -1 - 0x1p-52, 0}), 0u);
  EXPECT_EQ(pairs_at({0.5, 0.5, 1e300}), 0u);
}

TEST(Crossings, of_identical_bodies_are_each_facet_with_itself_and_its_neighbors) {
  for (const char* const name : {"limb", "torus"}) {
    const Bent one(name, sample_body(name, 12)), two(name, sample_body(name, 12));
    Collider a(one.mesh, one.body), b(two.mesh, two.body);
    for (const RigidTransform& transform :
         {RigidTransform{}, RigidTransform::from_axis({1, 2, 3}, 0.7, {1e7, -3e6, 0.1})}) {
      a.set_transform(transform);
      b.set_transform(transform);
      CrossingQuery result;
      ASSERT_TRUE(result.run(a, b));
      ASSERT_NO_FATAL_FAILURE(expect_equal(result.pairs(), brute_force::crossings(a, b)));
      std::set<std::pair<std::uint32_t, std::uint32_t>> found;
      for (const Crossing& c : result.pairs()) found.insert({c.facet_a, c.facet_b});
      for (std::uint32_t f = 0; f < one.mesh.facet_count(); ++f)
        for (std::uint32_t g = 0; g < one.mesh.facet_count(); ++g) {
          bool share = false;
          for (const std::uint32_t v : one.mesh.facets[f])
            for (const std::uint32_t w : one.mesh.facets[g]) share = share || v == w;
          ASSERT_TRUE(!share || found.contains({f, g}));
        }
    }
  }
}

// The contract for pairs of nodes that the caller chose, inner ones among them.
TEST(Crossings, of_given_nodes_are_those_of_their_facets) {
  const Bent one("limb", sample_body("limb", 14)), two("torus", sample_body("torus", 14));
  Collider a(one.mesh, one.body), b(two.mesh, two.body);
  a.set_transform(RigidTransform::from_axis({0, 1, 0}, 0.3, {0.6, 0.2, 0}));
  const std::vector<Crossing> all = brute_force::crossings(a, b);
  ASSERT_FALSE(all.empty());
  Random random(5);
  CrossingQuery result;
  for (int round = 0; round < 30; ++round) {
    std::vector<NodePair> nodes;
    for (int k = 0; k < 1 + round % 7; ++k)
      nodes.push_back({static_cast<std::uint32_t>(random.next() % one.model.tree.node_count()),
                       static_cast<std::uint32_t>(random.next() % two.model.tree.node_count())});
    std::vector<Crossing> expected;
    const auto owns = [](const Collider& collider, std::uint32_t node, std::uint32_t facet) {
      const auto facets = collider.facets(node);
      return std::find(facets.begin(), facets.end(), facet) != facets.end();
    };
    for (const Crossing& c : all)
      for (const NodePair& pair : nodes)
        if (owns(a, pair.a, c.facet_a) && owns(b, pair.b, c.facet_b)) {
          expected.push_back(c);
          break;
        }
    ASSERT_TRUE(result.run(a, b, nodes));
    ASSERT_NO_FATAL_FAILURE(expect_equal(result.pairs(), expected));
    EXPECT_EQ(result.leaf_pairs(), nodes.size());
  }
  ASSERT_TRUE(result.run(a, b, std::span<const NodePair>{}));
  EXPECT_TRUE(result.pairs().empty());
}

TEST(Crossings, refuse_what_is_not_current_and_keep_the_result) {
  Bent one("limb", sample_body("limb", 8)), two("limb", sample_body("limb", 8));
  CrossingQuery result;
  ASSERT_TRUE(result.run(one.collider, two.collider));
  const std::vector<Crossing> before(result.pairs().begin(), result.pairs().end());
  ASSERT_FALSE(before.empty());
  const auto expect_refused = [&](const auto& query) {
    EXPECT_FALSE(query());
    ASSERT_NO_FATAL_FAILURE(expect_equal(result.pairs(), before));
  };
  test::StalePose late(two.mesh, two.model.cover, two.body.sphere_state());
  expect_refused([&] { return result.run(one.collider, late.collider); });
  EXPECT_THROW(crossings(one.collider, late.collider), std::invalid_argument);
  const NodePair none{0, static_cast<std::uint32_t>(two.model.tree.node_count())};
  expect_refused([&] { return result.run(one.collider, two.collider, std::span(&none, 1)); });
  std::vector<Vec3> bad = one.mesh.positions;
  bad[one.mesh.facets[0][0]].y = std::numeric_limits<double>::infinity();
  ASSERT_FALSE(one.body.update(bad));
  expect_refused([&] { return result.run(one.collider, two.collider); });
  EXPECT_THROW(brute_force::crossings(one.collider, two.collider), std::invalid_argument);
}

TEST(BoxKernels, find_what_plain_loops_find) {
  Random random(3);
  std::vector<float> columns[6];
  for (std::size_t k = 0; k < 6; ++k) columns[k].assign(48, FloatBox{}.bound[k]);
  for (std::size_t i = 0; i < 41; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      columns[k][i] = static_cast<float>(random.next() % 5);
      columns[k + 3][i] = columns[k][i] + static_cast<float>(random.next() % 3);
    }
  BoxList list{{}, 48};
  for (std::size_t k = 0; k < 6; ++k) list.column[k] = columns[k].data();
  std::size_t found = 0;
  for (int round = 0; round < 200; ++round) {
    FloatBox box;
    for (std::size_t k = 0; k < 3; ++k) {
      box.bound[k] = static_cast<float>(random.next() % 5);
      box.bound[k + 3] = box.bound[k] + static_cast<float>(random.next() % 3);
    }
    std::vector<std::uint32_t> expected(48), other(48);
    expected.resize(all_box_kernels().front().select(list, box, expected.data()));
    found += expected.size();
    for (std::size_t kind = 0; kind < all_box_kernels().size(); ++kind) {
      const BoxKernels& kernels = all_box_kernels()[kind];
      other.resize(48);
      other.resize(kernels.select(list, box, other.data()));
      ASSERT_EQ(other, expected) << kind_name(kind);
      const FloatBox around = kernels.box_of_meeting(list, box),
                     all = all_box_kernels().front().box_of_meeting(list, box);
      ASSERT_EQ(around.is_empty(), expected.empty());
      for (std::size_t k = 0; k < 6; ++k) ASSERT_EQ(around.bound[k], all.bound[k]) << kind_name(kind);
    }
  }
  EXPECT_GT(found, 200u);
}

}  // namespace
}  // namespace morula
