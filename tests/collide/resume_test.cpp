// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A search that is resumed with any budget above zero ends, with the contacts of one call.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/contacts.hpp>
#include <tuple>
#include <vector>

#include "specimens.hpp"

namespace morula {
namespace {

using test::Specimen;

const BuildOptions eight_wide{.method = Method::octree, .branching = 8, .depth = 3};
constexpr std::size_t largest_block = 8 * 8;

using Key = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
std::vector<Key> keys_of(const Contacts& contacts, std::uint32_t pair_of_all) {
  std::vector<Key> keys;
  for (const Contact& c : contacts.contacts) keys.emplace_back(pair_of_all + c.pair, c.node_a, c.node_b);
  std::sort(keys.begin(), keys.end());
  return keys;
}

struct LeastBudget : ::testing::Test {
  LeastBudget() {
    b.set_transform(RigidTransform::from_axis({1, 0, 1}, 2, {0.3, 0.2, 0.1}));
    c.set_transform(RigidTransform::from_axis({0, 1, 1}, 1, {0.1, 0.3, 0}));
  }
  void add_to(ContactQuery& query) const {
    query.add(*a.collider, *b.collider);
    query.add(*c.collider, *b.collider);
    query.add(*a.collider, *far.collider);
  }
  /// By two calls that keep no front.
  std::vector<Key> expected() const {
    std::vector<Key> keys = keys_of(collide(*a.collider, *b.collider), 0);
    for (const Key& key : keys_of(collide(*c.collider, *b.collider), 1)) keys.push_back(key);
    return keys;
  }
  Specimen a{"limb", 9, eight_wide}, b{"torus", 8, eight_wide}, c{"blob", 8, eight_wide};
  Specimen far{"torus", 8, eight_wide, 1, {100, 0, 0}};
};

TEST_F(LeastBudget, in_tests_makes_progress_in_every_call) {
  const std::vector<Key> all = expected();
  ASSERT_GT(all.size(), 50u);
  for (const std::int64_t budget : {1, 65})
    for (const Priority priority : {Priority::level, Priority::overlap, Priority::importance}) {
      ContactQuery whole({.priority = priority}), query({.budget = budget, .priority = priority});
      add_to(whole), add_to(query);
      ASSERT_TRUE(whole.start());
      ContactStatus status = query.start();
      ASSERT_TRUE(status);
      EXPECT_LE(static_cast<std::int64_t>(status.pair_tests), budget) << "only resume() may exceed it";
      std::size_t tests = status.pair_tests, calls = 1;
      for (; !status.finished; ++calls) {
        ASSERT_LT(calls, 20000u) << "it never ends";
        ASSERT_TRUE(status = query.resume());
        EXPECT_GT(status.pair_tests, 0u) << "no progress in call " << calls;
        EXPECT_LE(status.pair_tests, std::max(static_cast<std::size_t>(budget), largest_block));
        tests += status.pair_tests;
      }
      EXPECT_GT(calls, 5u);
      EXPECT_EQ(keys_of(query.contacts(), 0), all);
      EXPECT_EQ(tests, whole.contacts().pair_tests) << "nothing is tested twice";
    }
}

TEST_F(LeastBudget, in_time_makes_progress_in_every_call) {
  const std::vector<Key> all = expected();
  std::int64_t looks = 0;
  // At every reading of the clock the time is over.
  const Clock clock = [&looks] { return std::chrono::seconds(++looks); };
  for (const bool surfaces : {false, true}) {
    ContactQuery query({.budget = std::chrono::nanoseconds(1), .surfaces = surfaces, .clock = clock});
    add_to(query);
    ContactStatus status = query.start();
    ASSERT_TRUE(status);
    EXPECT_EQ(status.pair_tests, 0u);
    std::size_t calls = 0, with_tests = 0;
    for (; !status.finished; ++calls) {
      ASSERT_LT(calls, 20000u) << "it never ends";
      const std::size_t described = query.contacts().surfaces.size();
      ASSERT_TRUE(status = query.resume());
      with_tests += status.pair_tests > 0 ? 1 : 0;
      EXPECT_LE(status.pair_tests, largest_block) << "more than one step";
      EXPECT_LE(query.contacts().surfaces.size(), described + 1);
      EXPECT_TRUE(status.pair_tests > 0 || query.contacts().surfaces.size() > described) << calls;
    }
    EXPECT_GT(with_tests, 10u);
    EXPECT_EQ(keys_of(query.contacts(), 0), all);
    EXPECT_EQ(query.contacts().surfaces.size(), surfaces ? all.size() : 0u);
  }
}

TEST_F(LeastBudget, of_zero_does_nothing) {
  for (const Budget& nothing : {Budget(0), Budget(std::chrono::nanoseconds(0))}) {
    ContactQuery query({.budget = nothing});
    add_to(query);
    ASSERT_TRUE(query.start());
    const Front before = query.front();
    const ContactStatus status = query.resume();
    ASSERT_TRUE(status);
    EXPECT_EQ(status.pair_tests, 0u);
    EXPECT_FALSE(status.finished);
    EXPECT_EQ(query.front(), before);
  }
}

// The first pairs of the queue cannot be opened: the next one is, at any cost.
TEST_F(LeastBudget, opens_another_pair_where_children_are_not_fresh) {
  std::size_t rejected = 0;
  bool rejects = true;
  const auto refresh = [&](const Collider&, std::uint32_t node) {
    if (!rejects || node % 2 == 0) return true;
    ++rejected;
    return false;
  };
  ContactQuery query({.budget = 1, .refresh_children = refresh});
  add_to(query);
  ContactStatus status = query.start();
  ASSERT_TRUE(status);
  std::size_t calls = 0;
  do {
    ASSERT_LT(++calls, 20000u) << "it never ends";
    ASSERT_TRUE(status = query.resume());
  } while (status.pair_tests > 0);
  EXPECT_GT(rejected, 0u);
  EXPECT_FALSE(status.finished);
  rejects = false;
  while (!status.finished) {
    ASSERT_LT(++calls, 20000u) << "it never ends";
    ASSERT_TRUE(status = query.resume());
  }
  EXPECT_EQ(keys_of(query.contacts(), 0), expected());
}

}  // namespace
}  // namespace morula
