// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Searches of the C interface that a budget ends and a later call continues: whole searches judge them.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <tuple>
#include <vector>

#include "pair_body.hpp"

namespace morula {
namespace {

using test::Key;
using test::keys_of;
using test::PairBody;

TEST(CPairs, a_budget_ends_a_search_and_resume_continues_it) {
  for (const bool near : {true, false}) {
    PairBody* limb = new PairBody("limb", 16);
    PairBody* torus = new PairBody("torus", 16);
    torus->move({0.2, 0.1, 0.1});
    const auto search = near ? &morula_pairs_near : &morula_pairs_crossing;
    morula_pair_options options;
    morula_pair_options_init(&options);
    options.distance = 0.05;
    morula_pairs* pairs = nullptr;
    ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
    EXPECT_EQ(morula_pairs_resume(pairs, -1, -1), MORULA_BAD_ARGUMENT) << "nothing was searched";
    ASSERT_EQ(search(limb->body, torus->body, &options, pairs), MORULA_OK) << morula_message();
    const std::vector<Key> all = keys_of(pairs);
    ASSERT_GT(all.size(), 5u);
    EXPECT_EQ(morula_pairs_resume(pairs, -1, -1), MORULA_BAD_ARGUMENT) << "the search is complete";

    options.box_tests = 10;
    ASSERT_EQ(search(limb->body, torus->body, &options, pairs), MORULA_OK) << morula_message();
    EXPECT_FALSE(morula_pairs_finished(pairs));
    EXPECT_LT(morula_pairs_count(pairs), all.size());
    // A failed search changes nothing, also not what is continued.
    morula_pair_options bad = options;
    bad.distance = -1, bad.rings = -1;
    EXPECT_EQ(search(limb->body, torus->body, &bad, pairs), MORULA_BAD_ARGUMENT);
    EXPECT_EQ(search(nullptr, torus->body, &options, pairs), MORULA_BAD_ARGUMENT);
    EXPECT_EQ(morula_pairs_resume(pairs, 10, 10), MORULA_BAD_ARGUMENT) << "two budgets";
    // The list keeps the bodies alive.
    delete limb;
    delete torus;
    int resumed = 0;
    for (; !morula_pairs_finished(pairs) && resumed < 1000; ++resumed) {
      ASSERT_EQ(morula_pairs_resume(pairs, 40, -1), MORULA_OK) << morula_message();
      const std::vector<Key> some = keys_of(pairs);
      EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
    }
    EXPECT_GT(resumed, 1);
    EXPECT_EQ(keys_of(pairs), all);
    morula_pairs_destroy(pairs);
  }
}

TEST(CPairs, a_search_is_not_continued_after_a_motion) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12, {0.2, 0.1, 0.1});
  morula_pair_options options;
  morula_pair_options_init(&options);
  options.distance = 0.1, options.box_tests = 5;
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  ASSERT_EQ(morula_pairs_near(limb.body, torus.body, &options, pairs), MORULA_OK);
  std::size_t count = 0;
  ASSERT_EQ(morula_self_crossings(limb.body, nullptr, 0, &count), MORULA_OK) << "another query with the same surface";
  EXPECT_EQ(morula_pairs_resume(pairs, 5, -1), MORULA_OK) << morula_message();
  torus.move({0.2, 0.1, 0.2});
  EXPECT_EQ(morula_pairs_resume(pairs, -1, -1), MORULA_REFUSED);
  const std::string words = morula_message();
  EXPECT_EQ(words, "a body has moved since the search began: begin it again");
  EXPECT_FALSE(morula_pairs_finished(pairs));
  morula_contact_options few;
  morula_contact_options_init(&few);
  few.pair_tests = 5;
  morula_contacts* contacts = nullptr;
  ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
  ASSERT_EQ(morula_collide(limb.body, torus.body, &few, contacts), MORULA_OK);
  torus.move({0.2, 0.1, 0.1});
  EXPECT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_REFUSED);
  EXPECT_EQ(words, morula_message());
  morula_pairs_destroy(pairs);
  morula_contacts_destroy(contacts);
}

TEST(CPairs, contacts_continue_to_those_of_a_complete_search) {
  using Nodes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  const auto nodes_of = [](const morula_contacts* contacts) {
    Nodes nodes;
    for (std::size_t i = 0; i < morula_contacts_count(contacts); ++i)
      nodes.emplace_back(morula_contacts_data(contacts)[i].node_a, morula_contacts_data(contacts)[i].node_b);
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  PairBody* limb = new PairBody("limb", 16);
  PairBody* torus = new PairBody("torus", 16);
  torus->move({0.2, 0.1, 0.1});
  morula_contacts* contacts = nullptr;
  ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
  EXPECT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_BAD_ARGUMENT) << "nothing was searched";
  ASSERT_EQ(morula_collide(limb->body, torus->body, nullptr, contacts), MORULA_OK);
  const Nodes all = nodes_of(contacts);
  ASSERT_GT(all.size(), 20u);
  EXPECT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_BAD_ARGUMENT) << "the search is complete";
  EXPECT_EQ(nodes_of(contacts), all);
  morula_contact_options options;
  morula_contact_options_init(&options);
  options.pair_tests = 100;
  ASSERT_EQ(morula_collide(limb->body, torus->body, &options, contacts), MORULA_OK);
  EXPECT_FALSE(morula_contacts_finished(contacts));
  delete limb;
  delete torus;
  int resumed = 0;
  for (; !morula_contacts_finished(contacts) && resumed < 1000; ++resumed)
    ASSERT_EQ(morula_contacts_resume(contacts, 200, -1), MORULA_OK) << morula_message();
  EXPECT_GT(resumed, 1);
  EXPECT_EQ(nodes_of(contacts), all);
  morula_contacts_destroy(contacts);
}

TEST(CPairs, a_rejected_search_for_contacts_leaves_the_one_before_to_be_continued) {
  const PairBody limb("limb", 16), plate("plate", 16);
  PairBody torus("torus", 16, {0.2, 0.1, 0.1});
  morula_contacts* contacts = nullptr;
  ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
  ASSERT_EQ(morula_collide(limb.body, torus.body, nullptr, contacts), MORULA_OK);
  const std::size_t all = morula_contacts_count(contacts);
  morula_contact_options options;
  morula_contact_options_init(&options);
  options.pair_tests = 100;
  morula_contact_options bad = options;
  bad.level = 50;
  EXPECT_EQ(morula_collide(limb.body, torus.body, &bad, contacts), MORULA_BAD_ARGUMENT) << "no level of either tree";
  EXPECT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_BAD_ARGUMENT) << "nothing is left to be continued";
  ASSERT_EQ(morula_collide(limb.body, torus.body, &options, contacts), MORULA_OK);
  const std::size_t some = morula_contacts_count(contacts);
  ASSERT_LT(some, all);
  EXPECT_EQ(morula_collide(plate.body, torus.body, &bad, contacts), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_contacts_count(contacts), some);
  EXPECT_FALSE(morula_contacts_finished(contacts));
  ASSERT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_contacts_count(contacts), all);
  // A search that is not rejected takes its place.
  ASSERT_EQ(morula_collide(plate.body, torus.body, &options, contacts), MORULA_OK);
  ASSERT_EQ(morula_collide(limb.body, torus.body, &options, contacts), MORULA_OK);
  ASSERT_EQ(morula_contacts_resume(contacts, -1, -1), MORULA_OK);
  EXPECT_EQ(morula_contacts_count(contacts), all);
  morula_contacts_destroy(contacts);
}

bool are_equal(const morula_contact& x, const morula_contact& y) {
  return x.node_a == y.node_a && x.node_b == y.node_b && x.finished == y.finished &&
         std::equal(x.point, x.point + 3, y.point) && std::equal(x.normal, x.normal + 3, y.normal) &&
         x.depth == y.depth && x.error_bound == y.error_bound;
}

// A resume copies new results alone. A search that is not resumed copies all, so it judges every part of one that is.
TEST(CPairs, lists_are_the_same_however_a_budget_is_divided) {
  const PairBody limb("limb", 16);
  PairBody torus("torus", 16, {0.2, 0.1, 0.1});
  morula_contacts *whole = nullptr, *parts = nullptr;
  ASSERT_EQ(morula_contacts_create(&whole), MORULA_OK);
  ASSERT_EQ(morula_contacts_create(&parts), MORULA_OK);
  morula_contact_options options;
  morula_contact_options_init(&options);
  ASSERT_EQ(morula_collide(limb.body, torus.body, nullptr, whole), MORULA_OK);
  const auto node_pairs = [](const morula_contacts* list) {
    std::vector<morula_contact> contacts(morula_contacts_data(list),
                                         morula_contacts_data(list) + morula_contacts_count(list));
    std::sort(contacts.begin(), contacts.end(), [](const morula_contact& x, const morula_contact& y) {
      return std::tie(x.node_a, x.node_b) < std::tie(y.node_a, y.node_b);
    });
    return contacts;
  };
  const std::vector<morula_contact> all = node_pairs(whole);
  for (const std::int64_t budget : {1, 100, 1000, 3000}) {
    options.pair_tests = budget;
    ASSERT_EQ(morula_collide(limb.body, torus.body, &options, parts), MORULA_OK);
    std::vector<morula_contact> finished;
    for (std::int64_t step = 1;; ++step) {
      const morula_contact* const now = morula_contacts_data(parts);
      const std::size_t count = morula_contacts_count(parts);
      // Finished contacts are first, and stay where they were.
      ASSERT_GE(count, finished.size());
      for (std::size_t i = 0; i < finished.size(); ++i) EXPECT_TRUE(are_equal(finished[i], now[i]));
      finished.clear();
      for (std::size_t i = 0; i < count && now[i].finished != 0; ++i) finished.push_back(now[i]);
      for (std::size_t i = finished.size(); i < count; ++i) EXPECT_EQ(now[i].finished, 0);
      if (morula_contacts_finished(parts) != 0) break;
      ASSERT_LT(step, 20000);
      ASSERT_EQ(morula_contacts_resume(parts, step % 3 == 0 ? 2 * budget : budget, -1), MORULA_OK);
    }
    const std::vector<morula_contact> same = node_pairs(parts);
    ASSERT_EQ(same.size(), all.size());
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_TRUE(are_equal(same[i], all[i])) << i;
  }
  morula_contacts_destroy(whole);
  morula_contacts_destroy(parts);
}

TEST(CPairs, lists_of_pairs_are_the_same_however_a_budget_is_divided) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12, {0.2, 0.1, 0.1});
  morula_pair_options options;
  morula_pair_options_init(&options);
  options.distance = 0.05;
  const auto place = [](const morula_pair& pair) { return std::tie(pair.kind, pair.a, pair.b); };
  for (const auto search : {&morula_pairs_near, &morula_pairs_crossing}) {
    morula_pairs *whole = nullptr, *parts = nullptr;
    ASSERT_EQ(morula_pairs_create(&whole), MORULA_OK);
    ASSERT_EQ(morula_pairs_create(&parts), MORULA_OK);
    options.box_tests = -1;
    ASSERT_EQ(search(limb.body, torus.body, &options, whole), MORULA_OK);
    for (const std::int64_t budget : {-1, 1, 2000, 20000}) {
      // The list has as many pairs of another search.
      options.box_tests = -1;
      ASSERT_EQ(search(torus.body, limb.body, &options, parts), MORULA_OK);
      ASSERT_EQ(morula_pairs_count(parts), morula_pairs_count(whole));
      options.box_tests = budget;
      ASSERT_EQ(search(limb.body, torus.body, &options, parts), MORULA_OK);
      for (std::int64_t steps = 0; morula_pairs_finished(parts) == 0; ++steps) {
        ASSERT_LT(steps, 20000);
        ASSERT_EQ(morula_pairs_resume(parts, budget, -1), MORULA_OK);
        const morula_pair* const now = morula_pairs_data(parts);
        for (std::size_t i = 1; i < morula_pairs_count(parts); ++i) ASSERT_LT(place(now[i - 1]), place(now[i]));
      }
      ASSERT_EQ(morula_pairs_count(parts), morula_pairs_count(whole));
      for (std::size_t i = 0; i < morula_pairs_count(whole); ++i) {
        const morula_pair &x = morula_pairs_data(parts)[i], &y = morula_pairs_data(whole)[i];
        EXPECT_TRUE(place(x) == place(y) && x.distance == y.distance &&
                    std::equal(x.vertices_a, x.vertices_a + 3, y.vertices_a) &&
                    std::equal(x.point_b, x.point_b + 3, y.point_b));
      }
    }
    morula_pairs_destroy(whole);
    morula_pairs_destroy(parts);
  }
}

// The least budget: every call makes progress, so the search ends.
TEST(CPairs, searches_end_with_a_budget_of_one_test) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12, {0.2, 0.1, 0.1});
  morula_contacts* contacts = nullptr;
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_contacts_create(&contacts), MORULA_OK);
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  morula_contact_options options;
  morula_contact_options_init(&options);
  morula_pair_options pair_options;
  morula_pair_options_init(&pair_options);
  pair_options.distance = 0.05;
  ASSERT_EQ(morula_collide(limb.body, torus.body, nullptr, contacts), MORULA_OK);
  const std::size_t all_contacts = morula_contacts_count(contacts);
  ASSERT_GT(all_contacts, 20u);
  for (const bool in_time : {false, true}) {
    (in_time ? options.nanoseconds : options.pair_tests) = 1;
    (in_time ? options.pair_tests : options.nanoseconds) = -1;
    ASSERT_EQ(morula_collide(limb.body, torus.body, &options, contacts), MORULA_OK);
    int calls = 0;
    for (; !morula_contacts_finished(contacts); ++calls) {
      ASSERT_LT(calls, 20000) << "it never ends";
      ASSERT_EQ(morula_contacts_resume(contacts, in_time ? -1 : 1, in_time ? 1 : -1), MORULA_OK);
    }
    EXPECT_GT(calls, 3);
    EXPECT_EQ(morula_contacts_count(contacts), all_contacts);
    for (const auto search : {&morula_pairs_near, &morula_pairs_crossing}) {
      pair_options.box_tests = pair_options.nanoseconds = -1;
      ASSERT_EQ(search(limb.body, torus.body, &pair_options, pairs), MORULA_OK);
      const std::vector<Key> all = keys_of(pairs);
      ASSERT_GT(all.size(), 5u);
      (in_time ? pair_options.nanoseconds : pair_options.box_tests) = 1;
      ASSERT_EQ(search(limb.body, torus.body, &pair_options, pairs), MORULA_OK);
      for (calls = 0; !morula_pairs_finished(pairs); ++calls) {
        ASSERT_LT(calls, 20000) << "it never ends";
        ASSERT_EQ(morula_pairs_resume(pairs, in_time ? -1 : 1, in_time ? 1 : -1), MORULA_OK);
      }
      EXPECT_EQ(keys_of(pairs), all);
    }
  }
  morula_contacts_destroy(contacts);
  morula_pairs_destroy(pairs);
}

}  // namespace
}  // namespace morula
