// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What contacts come with on request, and bodies whose spheres are brought up to date as a query goes.
#include <gtest/gtest.h>

#include <map>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/distance.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <set>

#include "specimens.hpp"

namespace morula {
namespace {

using test::Specimen;

std::set<std::pair<std::uint32_t, std::uint32_t>> facets_of(std::span<const Crossing> crossings) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Crossing& c : crossings) pairs.emplace(c.facet_a, c.facet_b);
  return pairs;
}
std::set<std::pair<std::uint32_t, std::uint32_t>> nodes_of(const Contacts& contacts) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (const Contact& c : contacts.contacts) pairs.emplace(c.node_a, c.node_b);
  return pairs;
}

TEST(ExactContacts, hold_the_facet_pairs_of_brute_force_for_every_pair_of_bodies) {
  Random random(3);
  Specimen a("limb", 8, test::quick), b("torus", 8, test::quick), c("blob", 6, test::quick);
  for (int pose = 0; pose < 10; ++pose) {
    for (Specimen* s : {&a, &b, &c}) {
      s->deform(random, 0.05);
      s->set_transform(test::random_transform(random, 0.5));
    }
    ContactQuery query({.find_crossings = true});
    query.add(*a.collider, *b.collider);
    query.add(*b.collider, *c.collider);
    ASSERT_TRUE(query.start());
    const Contacts& found = query.contacts();
    ASSERT_EQ(found.crossings_begin.size(), 3u);
    const auto of = [&](std::size_t i) {
      return std::span(found.crossings)
          .subspan(found.crossings_begin[i], found.crossings_begin[i + 1] - found.crossings_begin[i]);
    };
    EXPECT_EQ(facets_of(of(0)), facets_of(brute_force::crossings(*a.collider, *b.collider)));
    EXPECT_EQ(facets_of(of(1)), facets_of(brute_force::crossings(*b.collider, *c.collider)));

    // With a budget: those of what is finished, and none that are not.
    const Contacts part = collide(*a.collider, *b.collider, {.budget = 600, .find_crossings = true});
    const auto all = facets_of(of(0)), some = facets_of(part.crossings);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
  }
}

TEST(Containment, comes_with_contacts_and_tells_a_body_inside_another) {
  Specimen outer("blob", 8, test::quick, 3.0), inner("blob", 6, test::quick, 0.5);
  const CollideOptions options{.containment = true};
  ContactQuery query(options);
  query.add(*outer.collider, *inner.collider);
  const auto expect = [&](std::size_t inner_in_outer, std::size_t outer_in_inner) {
    ASSERT_TRUE(query.start());
    EXPECT_TRUE(query.contacts().contacts.empty());
    const Contacts once = collide(*outer.collider, *inner.collider, options);
    for (const Contacts* found : {&query.contacts(), &once}) {
      ASSERT_EQ(found->containment.size(), 1u);
      EXPECT_EQ(found->containment[0].b_in_a.inside_count, inner_in_outer);
      EXPECT_EQ(found->containment[0].a_in_b.inside_count, outer_in_inner);
      EXPECT_EQ(found->containment[0].b_in_a.inside.size(), 1u);
    }
  };
  expect(1, 0);
  inner.set_transform(RigidTransform::from_axis({0, 1, 0}, 1, {20, 0, 0}));
  expect(0, 0);
}

// The clock goes on by a microsecond every time somebody looks.
TEST(SurfacesUnderABudgetOfTime, end_when_it_ends_and_leave_the_search_its_half) {
  Random random(5);
  Specimen a("limb", 16, test::quick), b("limb", 16, test::quick);
  for (Specimen* s : {&a, &b}) s->deform(random, 0.03);
  b.set_transform(RigidTransform::from_axis({1, 0, 1}, 2, {0.3, 0.6, 0.2}));
  const Contacts all = collide(*a.collider, *b.collider, {.surfaces = true});
  ASSERT_EQ(all.surfaces.size(), all.contacts.size());
  ASSERT_GT(all.contacts.size(), 200u);
  std::size_t shortest = all.contacts.size(), longest = 0;
  for (const int microseconds : {0, 20, 200, 2000, 1000000}) {
    int looks = 0;
    CollideOptions options{.budget = std::chrono::microseconds(microseconds), .surfaces = true};
    options.clock = [&] { return std::chrono::microseconds(++looks); };
    const Contacts found = collide(*a.collider, *b.collider, options);
    EXPECT_LE(found.surfaces.size(), found.finished_count);
    EXPECT_LE(looks, microseconds + 3) << "one look each to begin, to end the search and to end the surfaces";
    for (std::size_t i = 0; i < found.finished_count; ++i)
      EXPECT_TRUE(found.contacts[i].finished) << "these come first";
    shortest = std::min(shortest, found.surfaces.size());
    longest = std::max(longest, found.surfaces.size());
  }
  EXPECT_LT(shortest, all.surfaces.size());
  EXPECT_EQ(longest, all.surfaces.size());
}

// Whatever is asked for, within whatever budget, by whatever door: finished says that all of it is there, and not
// finished that some of it is not.
TEST(Finished, says_whether_all_that_was_asked_for_is_there) {
  Random random(5);
  Specimen a("limb", 10, test::quick), b("limb", 10, test::quick);
  for (Specimen* s : {&a, &b}) s->deform(random, 0.03);
  b.set_transform(RigidTransform::from_axis({1, 0, 1}, 2, {0.3, 0.6, 0.2}));
  const Contacts all = collide(*a.collider, *b.collider, {.surfaces = true});
  const auto crossings = facets_of(brute_force::crossings(*a.collider, *b.collider));
  ASSERT_GT(crossings.size(), 20u);
  std::map<std::pair<std::uint32_t, std::uint32_t>, ContactSurface> surfaces;
  for (std::size_t i = 0; i < all.contacts.size(); ++i)
    surfaces[{all.contacts[i].node_a, all.contacts[i].node_b}] = all.surfaces[i];
  ASSERT_GT(surfaces.size(), 50u);

  const auto is_whole = [&](const CollideOptions& asked, const Contacts& found) {
    bool whole = nodes_of(found) == nodes_of(all);
    for (const Contact& c : found.contacts) whole = whole && c.finished;
    if (asked.surfaces) whole = whole && found.surfaces.size() == found.contacts.size();
    if (asked.find_crossings) whole = whole && facets_of(found.crossings) == crossings;
    if (asked.containment) whole = whole && found.containment.size() == 1;
    for (std::size_t i = 0; i < found.surfaces.size(); ++i) {
      const auto is = surfaces.find({found.contacts[i].node_a, found.contacts[i].node_b});
      if (is == surfaces.end()) continue;  // not a final pair
      EXPECT_EQ(found.surfaces[i].depth, is->second.depth);
      EXPECT_EQ(found.surfaces[i].on_a.point, is->second.on_a.point);
    }
    return whole;
  };
  std::int64_t looks = 0;
  const std::vector<Budget> budgets{{},
                                    0,
                                    1,
                                    30,
                                    200,
                                    1'000'000,
                                    std::chrono::nanoseconds(0),
                                    std::chrono::nanoseconds(5),
                                    std::chrono::nanoseconds(20),
                                    std::chrono::nanoseconds(100),
                                    std::chrono::seconds(1)};
  std::size_t cut_in_surfaces = 0, whole = 0, resumed = 0;
  for (const Budget& budget : budgets)
    for (int request = 0; request < 8; ++request) {
      const CollideOptions options{.budget = budget,
                                   .surfaces = (request & 1) != 0,
                                   .find_crossings = (request & 2) != 0,
                                   .containment = (request & 4) != 0,
                                   .clock = [&looks] { return std::chrono::nanoseconds(++looks); }};
      const auto expect_told = [&](const Contacts& found, bool finished) {
        EXPECT_EQ(found.finished, is_whole(options, found)) << request;
        EXPECT_EQ(finished, found.finished);
        whole += finished ? 1 : 0;
        cut_in_surfaces += !finished && found.finished_count == all.contacts.size() ? 1 : 0;
      };
      const Contacts once = collide(*a.collider, *b.collider, options);
      expect_told(once, once.finished);
      ContactQuery query(options);
      query.add(*a.collider, *b.collider);
      for (int door = 0; door < 3; ++door) {
        ContactStatus status = door == 0 ? query.run() : door == 1 ? query.start() : query.carry();
        ASSERT_TRUE(status);
        expect_told(query.contacts(), status.finished);
        const bool has_any =
            budget.is_unlimited() || (budget.is_time() ? budget.time().count() : budget.tests() / 64) > 1;
        if (door == 0 || !has_any) continue;
        for (int calls = 0; !status.finished; ++calls) {
          ASSERT_LT(calls, 20000) << "it never ends";
          ASSERT_TRUE(status = query.resume());
          expect_told(query.contacts(), status.finished);
          ++resumed;
        }
      }
    }
  EXPECT_GT(cut_in_surfaces, 10u);
  EXPECT_GT(whole, 50u);
  EXPECT_GT(resumed, 50u);
}

TEST(Finished, is_of_all_contacts_also_when_those_of_an_interrupted_query_were_taken_away) {
  Specimen a("limb", 10, test::quick), b("limb", 10, test::quick);
  b.set_transform(RigidTransform::from_axis({1, 0, 1}, 2, {0.3, 0.6, 0.2}));
  const auto crossings = facets_of(brute_force::crossings(*a.collider, *b.collider));
  const auto nodes = nodes_of(collide(*a.collider, *b.collider));
  int cut = 0;
  for (int budget = 200; budget < 20000; budget += budget / 4) {
    CollideOptions options{.budget = budget, .surfaces = true, .find_crossings = true};
    ContactQuery query(options);
    query.add(*a.collider, *b.collider);
    const bool finished = query.start().finished;
    const Contacts taken = query.take_contacts();
    cut += !finished && taken.finished_count > 0 ? 1 : 0;
    options.budget = {};
    query.set_options(options);
    ASSERT_TRUE(query.resume().finished);
    EXPECT_EQ(nodes_of(query.contacts()), nodes);
    EXPECT_EQ(query.contacts().surfaces.size(), query.contacts().contacts.size());
    EXPECT_EQ(facets_of(query.contacts().crossings), crossings);
  }
  EXPECT_GT(cut, 3);
}

struct LazyBodies : ::testing::Test {
  LazyBodies() {
    Random random(9);
    for (Specimen* s : {&a, &b}) s->deform(random, 0.03);
    b.set_transform(RigidTransform::from_axis({1, 0, 1}, 2, {0.3, 0.6, 0.2}));
    options.refresh_children = [this](const Collider& collider, std::uint32_t node) {
      (collider == *a.collider ? a : b).body->refresh_children(node);
      return true;
    };
  }
  void update_lazily(std::size_t level) {
    for (Specimen* s : {&a, &b}) {
      ASSERT_TRUE(s->body->update_lazily(s->positions, level));
      s->collider->set_positions(s->positions);
    }
  }
  Specimen a{"limb", 16, test::quick}, b{"limb", 16, test::quick};
  CollideOptions options;
};

TEST_F(LazyBodies, give_the_contacts_of_full_updates_and_leave_nodes_untouched) {
  const auto expected = nodes_of(collide(*a.collider, *b.collider));
  ASSERT_FALSE(expected.empty());
  update_lazily(0);
  options.surfaces = options.find_crossings = true;
  const Contacts found = collide(*a.collider, *b.collider, options);
  EXPECT_TRUE(found.finished);
  EXPECT_EQ(nodes_of(found), expected);
  EXPECT_EQ(facets_of(found.crossings), facets_of(brute_force::crossings(*a.collider, *b.collider)));
  EXPECT_FALSE(a.body->is_complete()) << "far nodes were never asked for";
}

TEST_F(LazyBodies, are_refused_by_queries_that_cannot_reach) {
  update_lazily(1);
  EXPECT_THROW(static_cast<void>(collide(*a.collider, *b.collider)), std::invalid_argument);
  EXPECT_THROW(overlap(*a.collider, *b.collider), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(distance(*a.collider, *b.collider)), std::invalid_argument);
  CrossingQuery crossed;
  EXPECT_EQ(crossed.run(*a.collider, *b.collider).code, Status::Code::body_not_complete);
  ContactQuery query;
  query.add(*a.collider, *b.collider);
  EXPECT_EQ(query.start().code, ContactStatus::Code::body_not_complete);
  EXPECT_FALSE(message(query.start()).empty());
  query.set_options(options);
  EXPECT_TRUE(query.start());
}

TEST_F(LazyBodies, carry_fronts_between_lazy_and_full_frames) {
  Random random(4);
  ContactQuery query(options);
  query.add(*a.collider, *b.collider);
  for (int frame = 0; frame < 8; ++frame) {
    for (Specimen* s : {&a, &b}) s->deform(random, 0.03);
    const auto expected = nodes_of(collide(*a.collider, *b.collider));
    const bool lazy = frame % 3 != 2;
    if (lazy) update_lazily(0);
    query.set_options(lazy ? options : CollideOptions{});
    ASSERT_TRUE(frame == 0 ? query.start() : query.carry());
    EXPECT_EQ(nodes_of(query.contacts()), expected) << frame;
  }
}

TEST(RebuiltContacts, miss_no_crossing_through_swaps_when_colliders_follow_the_tree_version) {
  const Mesh mesh = sample_body("limb", 12);
  RebuiltBody limb(mesh, build(mesh, test::quick),
                   {.rebuild_every = 2, .min_improvement = -1e9, .thread = RebuildThread::caller});
  Specimen torus("torus", 8, test::quick);
  torus.set_transform(RigidTransform::from_axis({1, 0, 0}, 0.5, {0.2, 0.1, 0}));
  std::optional<Collider> collider;
  ContactQuery query({.find_crossings = true});
  std::uint64_t version = limb.tree_version();
  std::size_t swaps = 0, crossings = 0;
  for (int frame = 0; frame <= 12; ++frame) {
    const std::vector<Vec3> positions = deform(mesh, {Twist{120}}, frame / 12.0);
    ASSERT_TRUE(limb.update(positions));
    const bool other = !collider || limb.tree_version() != version;
    if (other) {
      swaps += frame > 0;
      version = limb.tree_version();
      collider.emplace(mesh, limb.body());
      query.clear();
      query.add(*collider, *torus.collider);
    }
    collider->set_positions(positions);
    ASSERT_TRUE(other ? query.start() : query.carry());
    const auto expected = facets_of(brute_force::crossings(*collider, *torus.collider));
    EXPECT_EQ(facets_of(query.contacts().crossings), expected) << frame;
    crossings += expected.size();
  }
  EXPECT_GT(swaps, 2u);
  EXPECT_GT(crossings, 100u);
}

}  // namespace
}  // namespace morula
