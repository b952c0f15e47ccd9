// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facets of nodes, which all colliders of one covered tree share, and the shares of their areas.
#include "tree/facet_lists.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/tree/cover.hpp>
#include <thread>
#include <vector>

namespace morula {
using namespace detail;
namespace {

bool equal_lists(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

CoveredTree limb_tree(const Mesh& mesh, int depth = 3) {
  return build(mesh, {.method = Method::octree, .depth = depth});
}

TEST(FacetLists, bodies_of_one_tree_share_them) {
  const Mesh mesh = sample_body("limb", 16);
  const auto model = std::make_shared<const CoveredTree>(limb_tree(mesh));
  const Body first(mesh, model), second(mesh, model);
  const Collider a(mesh, first), b(mesh, second);
  EXPECT_EQ(a.facets(0).data(), b.facets(0).data());

  const Body third(mesh, *model);  // a copy of the tree
  const Collider c(mesh, third), d(mesh, third.cover(), third.sphere_state());
  for (const Collider* const other : {&c, &d}) {
    EXPECT_NE(other->facets(0).data(), a.facets(0).data());
    for (std::uint32_t node = 0; node < a.tree().node_count(); ++node)
      ASSERT_TRUE(equal_lists(other->facets(node), a.facets(node))) << node;
  }
}

TEST(FacetLists, outlive_the_body_and_follow_a_copy) {
  const Mesh mesh = sample_body("limb", 16);
  auto body = std::make_unique<Body>(mesh, limb_tree(mesh));
  const Collider a(mesh, *body);
  const Collider copy = a;
  const std::vector<std::uint32_t> before(a.facets(0).begin(), a.facets(0).end());
  body.reset();
  EXPECT_TRUE(equal_lists(a.facets(0), before));
  EXPECT_TRUE(equal_lists(copy.facets(0), before));
}

TEST(FacetLists, a_tree_that_is_assigned_to_gets_its_own) {
  const Mesh mesh = sample_body("limb", 16);
  CoveredTree model = limb_tree(mesh);
  const auto old_lists = model.facet_lists.get(model.tree, model.cover);
  model = limb_tree(mesh, 2);
  const auto lists = model.facet_lists.get(model.tree, model.cover);
  ASSERT_EQ(lists->begin().size(), model.tree.node_count());
  EXPECT_NE(lists->begin().size(), old_lists->begin().size());
  CoveredTree moved = std::move(model);
  moved.tree = {}, moved.cover = {};
  EXPECT_TRUE(moved.facet_lists.get(moved.tree, moved.cover)->facets().empty());
}

/// The area of a convex polygon of the surface, by a fan of triangles.
double area_of(const Cover& cover, std::size_t patch, const PositionView& positions) {
  const std::span<const std::uint32_t> corners = cover.patch(patch);
  const Vec3 first = corner_position(cover, corners[0], positions);
  double area = 0;
  for (std::size_t i = 2; i < corners.size(); ++i)
    area += 0.5 * length(cross(corner_position(cover, corners[i - 1], positions) - first,
                               corner_position(cover, corners[i], positions) - first));
  return area;
}

TEST(FacetLists, shares_are_shares_of_the_area) {
  const Mesh mesh = sample_body("torus", 12);
  const CoveredTree model = limb_tree(mesh);
  const FacetLists lists(model.tree, model.cover);
  std::vector<double> of_facet(mesh.facet_count(), 0.0);
  std::vector<float> shares;
  std::size_t cut = 0;
  for (std::uint32_t leaf = 0; leaf < model.tree.node_count(); ++leaf) {
    if (!model.tree.is_leaf(leaf)) continue;
    lists.copy_shares(leaf, model.cover, mesh.facets, shares);
    const auto facets = lists.facets().subspan(lists.begin()[leaf], lists.end()[leaf] - lists.begin()[leaf]);
    ASSERT_EQ(shares.size(), facets.size());
    for (std::size_t i = 0; i < facets.size(); ++i) {
      double owned = 0;
      for (std::uint32_t p = model.cover.region_begin[leaf]; p < model.cover.region_end[leaf]; ++p)
        if (model.cover.patch_facet[p] == facets[i]) owned += area_of(model.cover, p, mesh.positions);
      ASSERT_NEAR(shares[i], owned / area(mesh.corners(facets[i])), 1e-6);
      of_facet[facets[i]] += static_cast<double>(shares[i]);
      cut += shares[i] < 1 ? 1 : 0;
    }
  }
  for (const double sum : of_facet) ASSERT_NEAR(sum, 1, 1e-5);
  EXPECT_GT(cut, 100u) << "some facets belong to several leaves";
}

TEST(FacetLists, all_threads_read_the_same_shares) {
  const Mesh mesh = sample_body("limb", 24);
  const CoveredTree model = limb_tree(mesh);
  const auto all_shares = [&](const FacetLists& lists) {
    std::vector<float> all, shares;
    for (std::uint32_t leaf = 0; leaf < model.tree.node_count(); ++leaf) {
      if (!model.tree.is_leaf(leaf)) continue;
      lists.copy_shares(leaf, model.cover, mesh.facets, shares);
      all.insert(all.end(), shares.begin(), shares.end());
    }
    return all;
  };
  const std::vector<float> expected = all_shares(FacetLists(model.tree, model.cover));
  for (int round = 0; round < 20; ++round) {
    const FacetLists lists(model.tree, model.cover);
    std::vector<std::vector<float>> found(4);
    std::vector<std::thread> threads;
    for (std::vector<float>& list : found) threads.emplace_back([&] { list = all_shares(lists); });
    for (std::thread& thread : threads) thread.join();
    for (const std::vector<float>& list : found) ASSERT_EQ(list, expected);
  }
}

}  // namespace
}  // namespace morula
