// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The front: complete and sound wherever it is interrupted, the same for any number of workers, and of use next frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <set>
#include <tuple>

#include "specimens.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::Specimen;
using Code = ContactStatus::Code;

const BuildOptions four_wide{.method = Method::octree, .branching = 4, .depth = 4};
constexpr Priority priorities[]{Priority::level, Priority::overlap, Priority::importance};

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
std::set<Key> finished_nodes(const Contacts& contacts) {
  std::set<Key> keys;
  for (const Contact& c : contacts.contacts)
    if (c.finished) {
      EXPECT_TRUE(keys.insert({c.pair, c.node_a, c.node_b}).second) << "twice";
    }
  return keys;
}

struct TwoBodies : ::testing::Test {
  Specimen a{"limb", 9, test::quick}, b{"torus", 8, four_wide};
  Random random{3};
  void SetUp() override { pose(); }
  void pose(double amplitude = 0.05) {
    a.deform(random, amplitude);
    b.deform(random, amplitude);
    a.set_transform(test::random_transform(random, 0.6));
    b.set_transform(test::random_transform(random, 0.6));
  }
};

// Every pair of leaves is in or below exactly one pair of the cut: counted by leaves below nodes, and never twice.
void expect_complete(const ContactQuery& query, const Specimen& a, const Specimen& b) {
  std::vector<FrontPair> cut;
  query.cut(cut);
  const auto leaves_below = [](const SphereTree& tree) {
    std::vector<std::set<std::uint32_t>> below(tree.node_count());
    for (std::uint32_t node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
      if (tree.is_leaf(node)) below[node].insert(node);
      if (node > 0) below[tree.parent[node]].insert(below[node].begin(), below[node].end());
    }
    return below;
  };
  const auto below_a = leaves_below(a.body->rest_tree()), below_b = leaves_below(b.body->rest_tree());
  std::set<std::pair<std::uint32_t, std::uint32_t>> covered;
  std::size_t count = 0;
  for (const FrontPair& pair : cut) {
    count += below_a[pair.a].size() * below_b[pair.b].size();
    for (const std::uint32_t i : below_a[pair.a])
      for (const std::uint32_t j : below_b[pair.b]) covered.insert({i, j});
  }
  EXPECT_EQ(count, below_a[0].size() * below_b[0].size());
  EXPECT_EQ(covered.size(), count);
}

TEST_F(TwoBodies, every_interruption_is_complete_and_misses_nothing) {
  std::size_t crossings_seen = 0;
  for (const Priority priority : priorities) {
    pose();
    const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
    crossings_seen += crossings.size();
    const std::set<Key> all = finished_nodes(collide(*a.collider, *b.collider));
    std::set<Key> before;
    bool finished = false;
    for (std::int64_t budget = 0; !finished; budget = budget * 3 / 2 + 40) {
      ContactQuery query({.budget = budget, .priority = priority});
      query.add(*a.collider, *b.collider);
      const ContactStatus status = query.start();
      ASSERT_TRUE(status);
      const Contacts& contacts = query.contacts();
      EXPECT_LE(static_cast<std::int64_t>(status.pair_tests), budget);
      EXPECT_EQ(status.finished, contacts.finished);
      EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, contacts.contacts), 0u) << budget;
      if (budget < 5000) expect_complete(query, a, b);
      // More budget only refines.
      const std::set<Key> now = finished_nodes(contacts);
      EXPECT_TRUE(std::includes(now.begin(), now.end(), before.begin(), before.end()));
      EXPECT_TRUE(std::includes(all.begin(), all.end(), now.begin(), now.end()));
      before = now;
      finished = status.finished;
      // By the same budget in one call.
      const Contacts once = collide(*a.collider, *b.collider, {.budget = budget, .priority = priority});
      EXPECT_EQ(finished_nodes(once), now);
      EXPECT_EQ(once.pair_tests, contacts.pair_tests);
    }
    EXPECT_EQ(before, all);
  }
  EXPECT_GT(crossings_seen, 50u);
}

TEST_F(TwoBodies, resuming_ends_where_one_call_does) {
  const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
  for (const Priority priority : priorities) {
    ContactQuery query({.budget = 300, .priority = priority}), whole({.priority = priority});
    query.add(*a.collider, *b.collider);
    whole.add(*a.collider, *b.collider);
    ASSERT_TRUE(whole.start());
    ASSERT_TRUE(whole.contacts().finished);
    ContactStatus status = query.start();
    std::size_t calls = 1, tests = status.pair_tests;
    for (; !status.finished && calls < 1000; ++calls) {
      const std::uint32_t level = query.contacts().achieved_level[0];
      if (calls % 3 == 0) {
        // By way of a copy, in another query.
        ContactQuery other({.budget = 300, .priority = priority});
        other.add(*a.collider, *b.collider);
        other.set_front(query.front());
        ASSERT_TRUE(other.resume());
        const auto in_other = finished_nodes(other.contacts());
        status = query.resume();
        EXPECT_EQ(in_other, finished_nodes(query.contacts()));
      } else {
        status = query.resume();
      }
      ASSERT_TRUE(status);
      tests += status.pair_tests;
      EXPECT_GE(query.contacts().achieved_level[0], level);
      EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, query.contacts().contacts), 0u);
    }
    EXPECT_GT(calls, 5u);
    EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(whole.contacts()));
    EXPECT_EQ(tests, whole.contacts().pair_tests) << "nothing is tested twice";
    EXPECT_EQ(query.contacts().contacts.size(), query.contacts().finished_count);
  }
}

TEST_F(TwoBodies, any_number_of_workers_gives_the_same_front) {
  Specimen c("blob", 8, test::quick);
  c.set_transform(test::random_transform(random, 0.5));
  for (const Priority priority : priorities)
    for (const std::int64_t budget : {700, 6000, 1000000}) {
      Front expected;
      std::vector<Contact> contacts;
      for (const unsigned threads : {1u, 2u, 3u, 8u}) {
        Workers workers(threads);
        ContactQuery query({.budget = budget, .priority = priority});
        query.add(*a.collider, *b.collider, 2);
        query.add(*c.collider, *b.collider, 0.5);
        query.add(*a.collider, *c.collider);
        ASSERT_TRUE(query.start(workers));
        if (threads == 1) {
          expected = query.front();
          contacts = query.contacts().contacts;
        }
        EXPECT_EQ(query.front(), expected) << threads;
        ASSERT_EQ(query.contacts().contacts.size(), contacts.size());
        for (std::size_t i = 0; i < contacts.size(); ++i) {
          const Contact &x = query.contacts().contacts[i], &y = contacts[i];
          EXPECT_TRUE(x.pair == y.pair && x.node_a == y.node_a && x.node_b == y.node_b && x.point == y.point &&
                      x.normal == y.normal && x.depth == y.depth && x.error_bound == y.error_bound);
        }
      }
    }
}

TEST_F(TwoBodies, carried_front_has_the_contacts_of_a_fresh_one) {
  const RigidTransform home_a = a.collider->transform(), home_b = b.collider->transform();
  for (const double away : {0.0, 1e6}) {
    pose();
    const Vec3 far = away * Vec3{1, -0.3, 0.7};
    RigidTransform home = home_a, other = home_b;
    home.translation += far, other.translation += far;
    a.set_transform(home), b.set_transform(other);
    ContactQuery carried, fresh;
    carried.add(*a.collider, *b.collider);
    fresh.add(*a.collider, *b.collider);
    ASSERT_TRUE(carried.start());
    ASSERT_TRUE(fresh.start());
    std::size_t crossings_seen = 0, largest_fresh = 0, largest_carried = 0, saved = 0;
    std::vector<Vec3> start_a = a.positions;
    for (int frame = 0; frame < 60; ++frame) {
      const double t = 0.1 * frame;
      // Slow, then fast, then at rest; now deforming, now placed elsewhere, now both; out of contact and back.
      const double speed = frame % 20 < 10 ? 0.002 : frame % 20 < 15 ? 0.3 : 0;
      if (frame % 3 != 1) {
        for (std::size_t i = 0; i < start_a.size(); ++i)
          a.positions[i] = start_a[i] + speed * std::sin(t) * Vec3{start_a[i].y, 1, std::cos(start_a[i].x)};
        ASSERT_TRUE(a.body->update(a.positions));
        a.collider->set_positions(a.positions);
      }
      if (frame % 3 != 0) {
        RigidTransform place = home;
        place.translation += speed * 5 * std::sin(2 * t) * Vec3{1, 1, 0};
        a.set_transform(place);
      }
      if (frame == 30) b.deform(random, 0.05);
      ASSERT_TRUE(carried.carry());
      ASSERT_TRUE(fresh.start());
      EXPECT_EQ(finished_nodes(carried.contacts()), finished_nodes(fresh.contacts())) << frame;
      EXPECT_LE(carried.contacts().pair_tests, fresh.contacts().pair_tests);
      if (frame % 6 == 0) {
        const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
        crossings_seen += crossings.size();
        EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, carried.contacts().contacts), 0u);
      }
      largest_fresh = std::max(largest_fresh, fresh.front().opened.size());
      largest_carried = std::max(largest_carried, carried.front().opened.size());
      saved += fresh.contacts().pair_tests - carried.contacts().pair_tests;
    }
    EXPECT_GT(crossings_seen, 100u);
    EXPECT_GT(saved, 1000u);
    EXPECT_EQ(largest_carried, largest_fresh) << "a front does not grow with time";
  }
}

// While the vertex that the origin follows is a million away, pads are of the size of the bodies, and pairs that are
// apart by less count as overlapping.
TEST_F(TwoBodies, carried_front_forgets_the_pads_of_a_vertex_that_came_back) {
  const std::uint32_t first = b.mesh.facets[0][0];
  for (int pose = 0; pose < 20; ++pose) {
    a.set_transform(test::random_transform(random, 2));
    b.set_transform(test::random_transform(random, 2));
    std::vector<Vec3> positions = b.mesh.positions;
    positions[first].x += 1e6;
    ASSERT_TRUE(b.body->update(positions));
    b.collider->set_positions(positions);
    ContactQuery query;
    query.add(*a.collider, *b.collider);
    ASSERT_TRUE(query.start());
    ASSERT_TRUE(query.contacts().finished);
    ASSERT_TRUE(b.body->update(b.mesh.positions));
    b.collider->set_positions(b.mesh.positions);
    ASSERT_TRUE(query.carry());
    EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(collide(*a.collider, *b.collider))) << pose;
  }
}

TEST_F(TwoBodies, at_rest_nothing_but_the_roots_is_tested_again) {
  ContactQuery query;
  query.add(*a.collider, *b.collider);
  ASSERT_TRUE(query.start());
  const std::size_t fresh = query.contacts().pair_tests;
  const auto before = finished_nodes(query.contacts());
  ASSERT_TRUE(a.body->update(a.positions));  // another frame, the same place
  a.collider->set_positions(a.positions);
  ASSERT_TRUE(query.carry());
  EXPECT_EQ(query.contacts().pair_tests, 1u);
  EXPECT_EQ(finished_nodes(query.contacts()), before);
  EXPECT_GT(fresh, 1000u);
  // Both placed elsewhere, together.
  const RigidTransform shift = RigidTransform::from_axis({1, 2, 0}, 0.3, {4, 5, 6});
  const auto moved = [&](const RigidTransform& t) {
    RigidTransform m = t;
    const RigidTransform columns = inverse({t.rows, {}});
    for (std::size_t r = 0; r < 3; ++r)
      m.rows[r] = {dot(shift.rows[r], columns.rows[0]), dot(shift.rows[r], columns.rows[1]),
                   dot(shift.rows[r], columns.rows[2])};
    m.translation = shift(t.translation);
    return m;
  };
  a.set_transform(moved(a.collider->transform()));
  b.set_transform(moved(b.collider->transform()));
  ASSERT_TRUE(query.carry());
  EXPECT_LT(query.contacts().pair_tests, fresh / 3);
  EXPECT_EQ(finished_nodes(query.contacts()), before);
}

TEST_F(TwoBodies, carried_and_interrupted_misses_nothing) {
  std::size_t crossings_seen = 0;
  for (const std::int64_t budget : {1, 100, 500, 2000}) {
    ContactQuery query({.budget = budget});
    query.add(*a.collider, *b.collider);
    ASSERT_TRUE(query.start());
    for (int frame = 0; frame < 12; ++frame) {
      if (frame % 4 < 2) {
        for (Vec3& p : a.positions) p += 0.05 * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 1};
        ASSERT_TRUE(a.body->update(a.positions));
        a.collider->set_positions(a.positions);
      }
      const bool resumes = frame % 3 == 2 && frame % 4 >= 2;
      ASSERT_TRUE(resumes ? query.resume() : query.carry());
      // resume() opens one pair at any cost.
      const std::int64_t largest = resumes ? std::max<std::int64_t>(budget, 8 * 4) : budget;
      EXPECT_LE(static_cast<std::int64_t>(query.contacts().pair_tests), largest);
      if (frame % 2 == 0) expect_complete(query, a, b);
      const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
      crossings_seen += crossings.size();
      EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, query.contacts().contacts), 0u);
    }
  }
  EXPECT_GT(crossings_seen, 100u);
}

// At rest, a small budget per frame gets as far as a large one at once.
TEST_F(TwoBodies, work_adds_up_over_frames_at_rest) {
  ContactQuery query({.budget = 400});
  query.add(*a.collider, *b.collider);
  ASSERT_TRUE(query.start());
  int frames = 1;
  for (; !query.contacts().finished && frames < 500; ++frames) ASSERT_TRUE(query.carry());
  EXPECT_GT(frames, 3);
  EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(collide(*a.collider, *b.collider)));
}

TEST_F(TwoBodies, several_pairs_share_one_budget) {
  Specimen c("blob", 8, test::quick);
  c.set_transform(a.collider->transform());
  ContactQuery query({.budget = 2000, .priority = Priority::importance});
  EXPECT_EQ(query.add(*a.collider, *b.collider, 1), 0u);
  EXPECT_EQ(query.add(*a.collider, *c.collider, 0), 1u) << "of no importance";
  ASSERT_TRUE(query.start());
  EXPECT_LE(query.contacts().pair_tests, 2000u);
  const auto of = [&](std::uint32_t bodies) {
    return std::count_if(query.contacts().contacts.begin(), query.contacts().contacts.end(),
                         [&](const Contact& contact) { return contact.pair == bodies && contact.finished; });
  };
  EXPECT_GT(of(0), 0);
  EXPECT_EQ(of(1), 0);
  query.set_options({.budget = 2000, .priority = Priority::level});
  ASSERT_TRUE(query.start());
  EXPECT_GT(query.contacts().achieved_level[0], 0u);
  EXPECT_GT(query.contacts().achieved_level[1], 0u);
  query.set_options({});
  ASSERT_TRUE(query.start());
  std::set<Key> expected = finished_nodes(collide(*a.collider, *b.collider));
  for (const Key& k : finished_nodes(collide(*a.collider, *c.collider)))
    expected.insert({1, std::get<1>(k), std::get<2>(k)});
  EXPECT_EQ(finished_nodes(query.contacts()), expected);
}

TEST_F(TwoBodies, time_is_looked_at_before_every_64_tests) {
  const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
  // A clock that counts its readings: so many looks, so many blocks of tests.
  for (const int looks : {0, 1, 2, 5, 20, 100000}) {
    std::int64_t time = 1000;
    CollideOptions options{.budget = std::chrono::nanoseconds(looks)};
    options.clock = [&time] { return std::chrono::nanoseconds(time++); };
    const Contacts contacts = collide(*a.collider, *b.collider, options);
    EXPECT_LE(contacts.pair_tests, 64u * static_cast<std::size_t>(looks));
    EXPECT_EQ(contacts.finished, looks == 100000);
    EXPECT_LE(time - 1000, looks + 3);
    EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, contacts.contacts), 0u);
  }
  // Wide nodes: up to 4,096 tests in a pair, stopped half way.
  const BuildOptions wide{.method = Method::octree, .branching = 64, .depth = 1};
  Specimen c("limb", 12, wide), d("limb", 12, wide);
  for (const int looks : {2, 5, 10, 1000}) {
    std::int64_t time = 0;
    CollideOptions options{.budget = std::chrono::nanoseconds(looks)};
    options.clock = [&time] { return std::chrono::nanoseconds(time++); };
    ContactQuery query(options);
    query.add(*c.collider, *d.collider);
    ASSERT_TRUE(query.start());
    EXPECT_LE(query.contacts().pair_tests, 64u * static_cast<std::size_t>(looks));
    expect_complete(query, c, d);
    // What was stopped half way is done again.
    query.set_options({});
    ASSERT_TRUE(query.resume());
    EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(collide(*c.collider, *d.collider)));
  }
}

TEST_F(TwoBodies, what_cannot_be_reached_stays_unfinished) {
  const auto crossings = test::crossings_by_brute_force(*a.collider, *b.collider);
  const SphereTree& tree = a.body->rest_tree();
  std::set<std::uint32_t> reached;
  bool all = false;
  CollideOptions options;
  options.refresh_children = [&](const Collider& collider, std::uint32_t node) {
    if (!(collider == *a.collider)) return true;
    reached.insert(node);
    return all || node < tree.level_begin[2];
  };
  ContactQuery query(options);
  query.add(*a.collider, *b.collider);
  ASSERT_TRUE(query.start());
  EXPECT_FALSE(query.contacts().finished);
  EXPECT_LE(query.contacts().achieved_level[0], 2u);
  for (const Contact& c : query.contacts().contacts)
    if (!c.finished) {
      EXPECT_EQ(tree.level_of(c.node_a), 2u);
    }
  expect_complete(query, a, b);
  EXPECT_EQ(test::crossings_missed(crossings, *a.collider, *b.collider, query.contacts().contacts), 0u);
  EXPECT_FALSE(reached.empty());
  EXPECT_LT(reached.size(), tree.node_count()) << "only where the query goes";
  all = true;
  ASSERT_TRUE(query.resume());
  EXPECT_TRUE(query.contacts().finished);
  EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(collide(*a.collider, *b.collider)));
}

// Far away, rounding makes pair tests err on the near side by more than the bodies are apart here. Neither moves
// against the other on the way back.
TEST_F(TwoBodies, carried_back_from_far_away_it_forgets_what_only_distance_blurred) {
  ContactQuery query;
  query.add(*a.collider, *b.collider);
  std::size_t blurred = 0;
  for (const double far : {1e6, 1e8, 1e9})
    for (const double gap : {1e-9, 1e-7, 1e-6, 1e-5}) {
      double apart = 0;
      const auto place = [&](double away) {
        a.set_transform({.translation = {away, 0, 0}});
        b.set_transform({.translation = {away + apart, 0, 0}});
      };
      // Just too far for any sphere to overlap.
      double touching = 0;
      for (double step = 4 * a.size; step > 1e-12 * a.size; step /= 2) {
        apart = touching + step;
        place(0);
        if (overlap(*a.collider, *b.collider)) touching = apart;
      }
      apart = touching + gap * a.size;
      place(far);
      ASSERT_TRUE(query.start());
      blurred += query.contacts().contacts.size();
      place(0);
      ASSERT_TRUE(query.carry());
      ASSERT_TRUE(query.contacts().finished);
      ContactQuery fresh;
      fresh.add(*a.collider, *b.collider);
      ASSERT_TRUE(fresh.start());
      EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(fresh.contacts())) << far << ' ' << gap;
      blurred -= std::min(blurred, fresh.contacts().contacts.size());
    }
  EXPECT_GT(blurred, 0u) << "what the test is about";
}

// Bars about the origin keep their distance bit for bit where it is a multiple of 2^-22 and they move by a power of
// two: nothing but the pads changes.
TEST(TwoBars, carried_back_from_a_power_of_two_away_have_the_contacts_of_a_fresh_front) {
  Specimen a{"bar", 4, test::quick}, b{"bar", 4, test::quick};
  ContactQuery query;
  query.add(*a.collider, *b.collider);
  std::size_t blurred = 0;
  for (const double far : {0x1p26, 0x1p28, 0x1p30})
    for (const double gap : {0x1p-22, 0x1p-20, 0x1p-18, 0x1p-16}) {
      double apart = 0;
      const auto place = [&](double away) {
        a.set_transform({.translation = {away, 0, 0}});
        b.set_transform({.translation = {away + apart, 0, 0}});
      };
      double touching = 0;
      for (double step = 8; step > 0x1p-23; step /= 2) {
        apart = touching + step;
        place(0);
        if (overlap(*a.collider, *b.collider)) touching = apart;
      }
      apart = touching + gap;
      place(far);
      ASSERT_TRUE(query.start());
      const std::size_t then = query.contacts().contacts.size();
      place(0);
      ASSERT_TRUE(query.carry());
      ContactQuery fresh;
      fresh.add(*a.collider, *b.collider);
      ASSERT_TRUE(fresh.start());
      EXPECT_EQ(finished_nodes(query.contacts()), finished_nodes(fresh.contacts())) << far << ' ' << gap;
      blurred += then > fresh.contacts().contacts.size() ? 1 : 0;
    }
  EXPECT_GT(blurred, 0u) << "what the test is about";
}

// Bodies of one tree count their frames alike: numbers of frames and transforms do not tell them apart.
TEST_F(TwoBodies, a_front_is_not_continued_after_another_body_of_its_tree_was_assigned) {
  Body twin_body(a.mesh, a.model);
  std::vector<Vec3> moved = a.positions;
  for (Vec3& p : moved) p.x += 0.3;
  const std::uint64_t frame = a.body->sphere_state().frame;
  while (twin_body.sphere_state().frame < frame) ASSERT_TRUE(twin_body.update(moved));
  ASSERT_EQ(twin_body.sphere_state().frame, frame);
  Collider twin(a.mesh, twin_body), first = *a.collider;
  twin.set_transform(first.transform());
  const auto fresh_nodes = [&](const Collider& of) { return finished_nodes(collide(of, *b.collider)); };
  ASSERT_NE(fresh_nodes(twin), fresh_nodes(first));
  ContactQuery query({.budget = 500}), other({.budget = 500});
  query.add(first, *b.collider);
  other.add(twin, *b.collider);
  ASSERT_TRUE(query.start());
  other.set_front(query.front());
  EXPECT_EQ(other.resume().code, Code::other_bodies) << "a front of a twin";
  const Collider before = first;
  first = twin;
  EXPECT_EQ(query.resume(), (Status{.code = Code::other_bodies, .pair = 0}));
  EXPECT_EQ(query.resume().code, Code::other_bodies) << "again";
  first = before;
  EXPECT_TRUE(query.resume()) << "the same body again";
  first = twin;
  query.set_options({});
  ASSERT_TRUE(query.carry()) << "as if the body had moved there";
  EXPECT_EQ(finished_nodes(query.contacts()), fresh_nodes(twin));
  query = ContactQuery({.budget = 500});
  EXPECT_EQ(query.resume().code, Code::no_front) << "the query itself was assigned to";
}

TEST_F(TwoBodies, stale_fronts_are_refused_and_nothing_changes) {
  ContactQuery query({.budget = 500});
  query.add(*a.collider, *b.collider);
  EXPECT_EQ(query.resume().code, Code::no_front);
  EXPECT_EQ(query.carry().code, Code::no_front);
  ASSERT_TRUE(query.start());
  const Front front = query.front();
  const std::size_t contacts = query.contacts().contacts.size();
  const auto refused = [&](const ContactStatus& status, Code code) {
    EXPECT_EQ(status.code, code) << message(status);
    EXPECT_FALSE(message(status).empty());
    EXPECT_EQ(query.front(), front);
    EXPECT_EQ(query.contacts().contacts.size(), contacts);
  };

  const RigidTransform home = b.collider->transform();
  b.set_transform(RigidTransform::from_axis({1, 0, 0}, 0.1));
  refused(query.resume(), Code::other_transform);
  b.set_transform(home);
  query.set_options({.margin = 0.1, .budget = 500});
  refused(query.resume(), Code::other_options);
  refused(query.carry(), Code::other_options);
  query.set_options({.level = 1, .budget = 500});
  refused(query.carry(), Code::other_options);
  query.set_options({.level = 9});
  refused(query.start(), Code::bad_level);
  query.set_options({.budget = 500});

  ASSERT_TRUE(a.body->update(a.positions));
  refused(query.resume(), Code::other_frame);
  test::StalePose late(a.mesh, a.model.cover, a.body->sphere_state());
  ContactQuery of_late({.budget = 500, .surfaces = true});
  of_late.add(*b.collider, late.collider);
  EXPECT_EQ(of_late.start(), (Status{Code::positions_not_current, 1, 0}));
  ASSERT_FALSE(a.body->update(std::vector<Vec3>(2)));
  refused(query.start(), Code::body_not_current);
  refused(query.resume(), Code::body_not_current);
  refused(query.carry(), Code::body_not_current);
  ASSERT_TRUE(a.body->update(a.positions));
  EXPECT_TRUE(query.carry());

  // A front of another body, of another tree on the same mesh, of another number of pairs.
  Specimen other("limb", 9, four_wide);
  ContactQuery stranger;
  stranger.add(*other.collider, *b.collider);
  stranger.set_front(query.front());
  EXPECT_EQ(stranger.carry().code, Code::other_bodies);
  EXPECT_EQ(stranger.resume().code, Code::other_bodies);
  EXPECT_THROW(query.add(*a.collider, *b.collider, -1), std::invalid_argument);
  EXPECT_THROW(query.set_options({.margin = -1}), std::invalid_argument);
  EXPECT_THROW(ContactQuery({.budget = -1}), std::invalid_argument);
  const Front of_one = query.front();
  query.add(*b.collider, *a.collider);
  EXPECT_EQ(query.carry().code, Code::no_front);
  query.set_front(of_one);
  EXPECT_EQ(query.carry().code, Code::other_bodies);
  EXPECT_TRUE(query.start());
}

TEST_F(TwoBodies, a_front_of_other_bodies_has_no_cut) {
  const Specimen small("bar", 4, test::quick);
  ContactQuery maker({.budget = 500});
  maker.add(*a.collider, *b.collider);
  ASSERT_TRUE(maker.start());
  std::vector<FrontPair> cut;
  const auto expect_refused = [&](ContactQuery& query, const Front& front) {
    query.set_front(front);
    EXPECT_THROW(query.cut(cut), std::invalid_argument);
  };
  ContactQuery other, two, none;
  other.add(*small.collider, *small.collider);
  two.add(*a.collider, *b.collider), two.add(*a.collider, *b.collider);
  expect_refused(other, maker.front());
  expect_refused(two, maker.front());
  expect_refused(none, maker.front());
  Front without_pairs = maker.front();
  without_pairs.pairs.clear();
  none.set_front(without_pairs);
  none.cut(cut);
  EXPECT_TRUE(cut.empty());
  // The front of these bodies has the cut of the query that made it, in a later frame as well.
  ContactQuery same({.budget = 500});
  same.add(*a.collider, *b.collider);
  same.set_front(maker.front());
  ASSERT_TRUE(a.body->update(a.positions));
  std::vector<FrontPair> expected;
  maker.cut(expected);
  same.cut(cut);
  EXPECT_FALSE(cut.empty());
  EXPECT_EQ(cut, expected);
}

TEST_F(TwoBodies, after_clear_nothing_refers_to_the_removed_pairs) {
  const Specimen small("bar", 4, test::quick);
  ContactQuery query({.surfaces = true, .containment = true});
  query.add(*a.collider, *b.collider);
  ASSERT_TRUE(query.start());
  ASSERT_FALSE(query.contacts().contacts.empty());
  query.clear();
  const auto expect_nothing = [&] {
    const Contacts& left = query.contacts();
    EXPECT_TRUE(left.contacts.empty() && left.surfaces.empty() && left.containment.empty());
    EXPECT_EQ(left.finished_count, 0u);
    EXPECT_FALSE(left.finished);
    EXPECT_EQ(query.front(), Front{});
    std::vector<FrontPair> cut(1);
    query.cut(cut);
    EXPECT_TRUE(cut.empty());
    EXPECT_THROW(query.surface(0), std::invalid_argument);
    EXPECT_EQ(query.resume().code, Code::no_front);
    EXPECT_EQ(query.carry().code, Code::no_front);
  };
  expect_nothing();
  // Nodes of the removed bodies would be out of range of these.
  query.add(*small.collider, *small.collider);
  expect_nothing();
  ASSERT_TRUE(query.start());
  ContactQuery fresh({.surfaces = true, .containment = true});
  fresh.add(*small.collider, *small.collider);
  ASSERT_TRUE(fresh.start());
  EXPECT_EQ(query.front(), fresh.front());
  EXPECT_EQ(query.contacts().contacts.size(), fresh.contacts().contacts.size());
}

// What a front says about bodies cannot be checked, but none makes a query read where it should not.
TEST_F(TwoBodies, fronts_out_of_range_are_refused) {
  ContactQuery maker({.budget = 3000});
  maker.add(*a.collider, *b.collider);
  ASSERT_TRUE(maker.start());
  ASSERT_FALSE(maker.front().waiting.empty());
  std::size_t refused = 0, taken = 0;
  std::vector<FrontPair> cut;
  for (int round = 0; round < 400; ++round) {
    Front front = maker.front();
    const auto bad = static_cast<std::uint32_t>(round % 2 == 0 ? random.next() : random.next() % 100);
    Front::Opened& opened = front.opened[random.next() % front.opened.size()];
    Front::Waiting& waiting = front.waiting[random.next() % front.waiting.size()];
    std::uint32_t* const places[]{&opened.a,
                                  &opened.b,
                                  &opened.depth,
                                  &opened.first_mask,
                                  &opened.first_below,
                                  &opened.pair,
                                  &opened.next_beside,
                                  &waiting.a,
                                  &waiting.b,
                                  &waiting.above,
                                  &waiting.pair,
                                  &waiting.before,
                                  &front.pairs[0].opened_roots};
    const std::size_t place = random.next() % (std::size(places) + 2);
    if (place < std::size(places)) {
      *places[place] = bad;
    } else if (place == std::size(places)) {
      front.masks[random.next() % front.masks.size()] |= std::uint64_t{1} << (random.next() % 64);
    } else {
      front.masks.resize(front.masks.size() / 2);
    }
    ContactQuery query({.budget = 3000});
    query.add(*a.collider, *b.collider);
    query.set_front(front);
    bool has_cut = true;
    try {
      query.cut(cut);
    } catch (const std::invalid_argument& error) {
      has_cut = false;
      EXPECT_EQ(error.what(), message(Status{Code::bad_front}));
    }
    const ContactStatus status = round % 3 == 0 ? query.resume() : query.carry();
    EXPECT_TRUE(status || status.code == Code::bad_front);
    EXPECT_EQ(has_cut, bool(status)) << "cut() takes and rejects the same fronts";
    ++(status ? taken : refused);
    EXPECT_TRUE(query.start());
  }
  EXPECT_GT(refused, 100u);
  EXPECT_GT(taken, 10u);
}

}  // namespace
}  // namespace morula
