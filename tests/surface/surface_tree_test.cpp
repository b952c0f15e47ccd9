// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surface trees: what boxes hold, what is refused, what depends on nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <morula/surface/obstacles.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <support/aligned.hpp>
#include <support/numbers.hpp>
#include <vector>

#include "surface/boxes/tree_state.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

/// Every vertex of every facet of a block, at both ends, lies in all boxes above it.
void expect_boxes_hold(const SurfaceTree& tree) {
  const detail::SurfaceTreeState& s = detail::state_of(tree);
  std::size_t looked_at = 0;
  for (std::size_t i = 0; i < s.blocks.order.size(); ++i)
    for (const std::uint32_t v : s.mesh.facets[s.blocks.order[i]])
      for (const Vec3& p : {tree.from(v), tree.to(v)}) {
        std::size_t box = i / 8;
        for (const auto& level : s.boxes.levels) {
          const detail::BoxGroup& group = level[box / 8];
          for (int k = 0; k < 3; ++k) {
            const double x = p[k] - s.origin[k];
            ASSERT_LE(static_cast<double>(group.bound[k][box % 8]), x);
            ASSERT_GE(static_cast<double>(group.bound[k + 3][box % 8]), x);
          }
          box /= 8;
          ++looked_at;
        }
      }
  EXPECT_GT(looked_at, 0u);
}

TEST(SurfaceTree, boxes_hold_every_vertex_at_both_ends) {
  Random random(1);
  for (const test::NamedMesh& body : test::all_meshes()) {
    if (body.mesh.facets.empty()) continue;
    SCOPED_TRACE(body.name);
    SurfaceTree tree(body.mesh);
    expect_boxes_hold(tree);
    std::vector<Vec3> to = body.mesh.positions;
    for (Vec3& p : to) p = p * 1.3 + Vec3{random.uniform(-1, 1), 1e6, random.uniform(-1e-3, 1e-3)};
    ASSERT_TRUE(tree.update(PositionView(body.mesh.positions), PositionView(to)));
    EXPECT_TRUE(tree.is_step());
    expect_boxes_hold(tree);
    ASSERT_TRUE(tree.update(PositionView(to)));
    EXPECT_FALSE(tree.is_step());
    expect_boxes_hold(tree);
  }
}

TEST(SurfaceTree, every_vertex_and_edge_has_one_owner_and_blocks_have_eight_facets) {
  for (const test::NamedMesh& body : test::aligned_bodies()) {
    const SurfaceTree tree(body.mesh);
    const detail::SurfaceTreeState& s = detail::state_of(tree);
    std::vector<int> facets(body.mesh.facets.size()), edges(tree.edges().size());
    for (const std::uint32_t f : s.blocks.order) ++facets[f];
    for (const std::uint32_t e : s.blocks.own_edges) ++edges[e];
    EXPECT_EQ(std::count(facets.begin(), facets.end(), 1), std::ssize(facets)) << body.name;
    EXPECT_EQ(std::count(edges.begin(), edges.end(), 1), std::ssize(edges)) << body.name;
    EXPECT_EQ(s.blocks.vertex_of_slot.size(), test::plain_vertices(body.mesh).size()) << body.name;
    EXPECT_EQ(tree.edges().size(), test::plain_edges(body.mesh).size()) << body.name;
    EXPECT_EQ(s.blocks.own_vertices.back(), s.blocks.vertex_of_slot.size());
    EXPECT_EQ(s.blocks.own_edges_begin.back(), s.blocks.own_edges.size());
  }
}

TEST(SurfaceTree, has_the_same_bits_for_any_number_of_workers) {
  Random random(5);
  const test::Moving m = test::wavy_sheet(60, 0.01, random);
  SurfaceTree one(m.mesh), three(m.mesh);
  Workers workers(3);
  ASSERT_TRUE(one.update(m.from, m.to));
  ASSERT_TRUE(three.update(m.from, m.to, workers));
  EXPECT_EQ(one.hash(), three.hash());
  const std::uint64_t before = one.hash();
  ASSERT_TRUE(one.update(m.from));
  EXPECT_NE(one.hash(), before);
}

TEST(SurfaceTree, refuses_what_it_cannot_take_and_stays_as_it_was) {
  Random random(5);
  const test::Moving m = test::wavy_sheet(6, 0.01, random);
  SurfaceTree tree(m.mesh);
  ASSERT_TRUE(tree.update(m.from, m.to));
  const std::uint64_t before = tree.hash();
  std::vector<Vec3> bad = m.to;
  bad[7].y = test::nan;
  bad[9].x = test::infinity;
  const Status status = tree.update(m.from, bad);
  EXPECT_EQ(status.code, Status::Code::non_finite_position);
  EXPECT_EQ(status.index, 7u);
  bad[7].y = 0, bad[9].x = 1e40;
  EXPECT_EQ(tree.update(bad, m.to), (Status{.code = Status::Code::non_finite_position, .index = 9}));
  bad.pop_back();
  EXPECT_EQ(tree.update(bad).code, Status::Code::wrong_vertex_count);
  EXPECT_EQ(tree.hash(), before);
  EXPECT_TRUE(tree.is_step());
  EXPECT_EQ(tree.to(7), m.to[7]);
  EXPECT_THROW(SurfaceTree(Mesh{}), std::invalid_argument);
}

TEST(SurfaceTree, vertices_that_no_facet_uses_may_be_anything) {
  Mesh mesh = test::icosphere(1);
  mesh.positions.push_back({test::nan, 0, 0});
  SurfaceTree tree(mesh);
  EXPECT_TRUE(tree.update(mesh.positions));
}

TEST(SurfaceQueries, refuse_options_that_make_no_sense_and_questions_about_the_past) {
  EXPECT_THROW(ProximityQuery({.distance = -1}), std::invalid_argument);
  EXPECT_THROW(ProximityQuery({.distance = test::nan}), std::invalid_argument);
  EXPECT_THROW(SweptQuery({.distance = test::infinity}), std::invalid_argument);
  EXPECT_THROW(SurfaceCrossingQuery({.filter = {.rest_distance = -1}}), std::invalid_argument);
  EXPECT_THROW(SurfaceCrossingQuery({.budget = -1}), std::invalid_argument);
  ProximityQuery query({.distance = 0.1});
  EXPECT_EQ(query.resume().code, Status::Code::no_front);
  const Mesh mesh = test::icosphere(2);
  SurfaceTree tree(mesh);
  query.set_options({.distance = 0.1, .filter = {.masks_a = {.category = {1, 2, 3}}}});
  EXPECT_EQ(query.run(tree).code, Status::Code::bad_option);
  query.set_options({.distance = 0.1, .budget = 128});
  EXPECT_FALSE(query.run(tree).finished);
  query.set_options({.distance = 0.2});
  EXPECT_EQ(query.resume().code, Status::Code::other_options);
  query.set_options({.distance = 0.1, .filter = {.masks_a = {.category = {1, 2, 3}}}});
  EXPECT_EQ(query.resume().code, Status::Code::bad_option);
  query.set_options({.distance = 0.1});
  SweptQuery swept({.distance = 0.1, .budget = 128});
  EXPECT_EQ(swept.resume().code, Status::Code::no_front);
  EXPECT_FALSE(swept.run(tree).finished);
  swept.set_options({.distance = 0.1, .candidates_only = true});
  EXPECT_EQ(swept.resume().code, Status::Code::other_options);
  EXPECT_FALSE(swept.open().empty());
  swept.set_options({.distance = 0.1});
  EXPECT_TRUE(swept.resume().finished);
  ASSERT_TRUE(tree.update(mesh.positions));
  EXPECT_EQ(query.resume().code, Status::Code::other_frame);
}

// What is set between a piece of work and the next is what the next one does: nothing of the options before is read.
TEST(SurfaceQueries, go_on_with_the_filter_that_is_set_now) {
  const Mesh mesh = test::joined(test::icosphere(2), test::translated(test::icosphere(2), {0.3, 0.1, 0}));
  const SurfaceTree tree(mesh);
  const auto options = [&](Budget budget) {
    ProximityOptions result{.distance = 0.05, .filter = {}, .budget = budget};
    result.filter.masks_a.category.assign(mesh.facets.size(), 1);
    for (std::size_t f = 0; f < mesh.facets.size(); f += 3) result.filter.masks_a.category[f] = 2;
    result.filter.masks_a.mask.assign(mesh.facets.size(), 2);
    return result;
  };
  ProximityQuery whole(options({})), pieces(options(256));
  ASSERT_TRUE(whole.run(tree).finished);
  SurfaceQueryStatus status = pieces.run(tree);
  while (!status.finished) {
    pieces.set_options(options(256));
    // Memory that the options before had is written over.
    const std::vector<std::uint32_t> other(mesh.facets.size(), 0xffffffffu), another = other;
    status = pieces.resume();
    ASSERT_TRUE(status);
  }
  ASSERT_FALSE(whole.pairs().empty());
  EXPECT_TRUE(std::equal(whole.pairs().begin(), whole.pairs().end(), pieces.pairs().begin(), pieces.pairs().end(),
                         [](const FeaturePair& a, const FeaturePair& b) { return a == b; }));
}

/// Where a query stands, copied.
struct Stand {
  std::vector<FeaturePair> pairs;
  std::vector<std::vector<std::uint32_t>> open;
  bool operator==(const Stand&) const = default;
};
template <class Query>
Stand stand_of(const Query& query) {
  Stand stand;
  stand.pairs.assign(query.pairs().begin(), query.pairs().end());
  for (const OpenFacets& facets : query.open())
    for (const auto& side : {facets.a, facets.b}) stand.open.emplace_back(side.begin(), side.end());
  return stand;
}

/// Asks, ends the surfaces in the given way, and asks about others.
template <class Query, class Options>
void expect_outlives_surfaces(const Options& options, bool with_itself, bool by_assignment) {
  const Mesh mesh = test::joined(test::icosphere(3), test::translated(test::icosphere(3), {0.3, 0.1, 0}));
  const Mesh other = test::joined(test::icosphere(2), test::translated(test::icosphere(2), {0.2, 0, 0}));
  auto a = std::make_unique<SurfaceTree>(mesh), b = std::make_unique<SurfaceTree>(mesh);
  Query query(options);
  const auto ask = [&](Query& of) { return with_itself ? of.run(*a) : of.run(*a, *b); };
  ASSERT_FALSE(ask(query).finished);
  const Stand before = stand_of(query);
  ASSERT_FALSE(before.open.empty());
  const std::weak_ptr<const detail::SurfaceTreeState> left = detail::state_of(*a).weak_from_this();
  if (by_assignment) {
    *a = SurfaceTree(other), *b = SurfaceTree(other);
  } else {
    a = std::make_unique<SurfaceTree>(other), b = std::make_unique<SurfaceTree>(other);
  }
  EXPECT_TRUE(stand_of(query) == before);
  EXPECT_EQ(query.resume().code, Status::Code::other_frame);
  EXPECT_TRUE(stand_of(query) == before);
  Query fresh(options);
  EXPECT_EQ(ask(query).finished, ask(fresh).finished);
  EXPECT_TRUE(stand_of(query) == stand_of(fresh));
  EXPECT_TRUE(left.expired()) << "nobody asks about it any more";
}

TEST(SurfaceQueries, outlive_surfaces_that_end_or_become_others) {
  for (const bool with_itself : {true, false})
    for (const bool by_assignment : {true, false}) {
      expect_outlives_surfaces<ProximityQuery>(ProximityOptions{.distance = 0.05, .filter = {}, .budget = Budget(256)},
                                               with_itself, by_assignment);
      expect_outlives_surfaces<SweptQuery>(SweptOptions{.distance = 0.05, .filter = {}, .budget = Budget(256)},
                                           with_itself, by_assignment);
      expect_outlives_surfaces<SurfaceCrossingQuery>(SurfaceCrossingOptions{.filter = {}, .budget = Budget(256)},
                                                     with_itself, by_assignment);
    }
}

TEST(SurfaceQueries, of_obstacles_outlive_surfaces_that_end_or_become_others) {
  const Mesh mesh = test::icosphere(4), other = test::icosphere(2);
  for (const bool by_assignment : {true, false}) {
    auto surface = std::make_unique<SurfaceTree>(mesh);
    ObstacleOptions options;
    options.margin = 10;
    options.budget = Budget(64);
    ObstacleQuery query(options), fresh(options);
    const HalfSpace floor{{0, 0, 1}, 0};
    ASSERT_FALSE(query.run(*surface, floor).finished);
    const auto open_now = [&] {
      std::vector<std::vector<std::uint32_t>> open;
      for (const auto& facets : query.open()) open.emplace_back(facets.begin(), facets.end());
      return open;
    };
    const auto open = open_now();
    const std::size_t found = query.contacts().size();
    ASSERT_FALSE(open.empty());
    const std::weak_ptr<const detail::SurfaceTreeState> left = detail::state_of(*surface).weak_from_this();
    if (by_assignment)
      *surface = SurfaceTree(other);
    else
      surface = std::make_unique<SurfaceTree>(other);
    EXPECT_EQ(open_now(), open);
    EXPECT_EQ(query.resume().code, Status::Code::other_frame);
    EXPECT_EQ(query.contacts().size(), found);
    const SurfaceQueryStatus again = query.run(*surface, floor), first = fresh.run(*surface, floor);
    ASSERT_TRUE(again) << message(again);
    ASSERT_TRUE(first) << message(first);
    EXPECT_EQ(again.finished, first.finished);
    EXPECT_EQ(query.contacts().size(), fresh.contacts().size());
    EXPECT_TRUE(left.expired()) << "nobody asks about it any more";
  }
}

TEST(SurfaceQueries, find_all_pairs_where_the_distance_is_beyond_float) {
  const Mesh a = test::icosphere(0), b = test::translated(test::icosphere(0), {5, 0, 0});  // 20 facets: not in eights
  const SurfaceTree tree_a(a), tree_b(b);
  for (const double distance : {100.0, 1e39, 1e200, std::numeric_limits<double>::max()}) {
    ProximityQuery query({.distance = distance});
    ASSERT_TRUE(query.run(tree_a, tree_b).finished);
    EXPECT_EQ(query.pairs().size(), 2 * 12 * 20 + 30 * 30u) << distance;
    const std::size_t with_itself = query.run(tree_a).candidates;
    EXPECT_EQ(with_itself, 12 * 20 - 20 * 3 + (30 * 29 - 30 * 8) / 2u) << distance;
    SweptQuery swept({.distance = distance, .candidates_only = true});
    ASSERT_TRUE(swept.run(tree_a, tree_b).finished);
    EXPECT_EQ(swept.candidates().size(), 2 * 12 * 20 + 30 * 30u) << distance;
  }
}

}  // namespace
}  // namespace morula
