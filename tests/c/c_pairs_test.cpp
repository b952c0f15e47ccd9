// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features, and searches that a budget ends, of the C interface: all pairs of features judge them.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <morula/geometry/vector.hpp>
#include <string>
#include <tuple>
#include <vector>

namespace morula {
namespace {

constexpr double no_rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

struct PairBody {
  morula_mesh* mesh = nullptr;
  morula_body* body = nullptr;
  Vec3 offset{};

  explicit PairBody(const char* sample, int resolution = 6) {
    morula_model* model = nullptr;
    morula_build_options options;
    morula_build_options_init(&options);
    options.method = "octree";
    EXPECT_EQ(morula_mesh_sample(sample, resolution, &mesh), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_build(mesh, &options, &model), MORULA_OK) << morula_message();
    EXPECT_EQ(morula_body_create(mesh, model, nullptr, &body), MORULA_OK) << morula_message();
    morula_model_destroy(model);
  }
  ~PairBody() {
    morula_mesh_destroy(mesh);
    morula_body_destroy(body);
  }
  PairBody(const PairBody&) = delete;
  PairBody& operator=(const PairBody&) = delete;

  void move(const Vec3& to) {
    offset = to;
    const double translation[3] = {to.x, to.y, to.z};
    EXPECT_EQ(morula_body_set_transform(body, no_rotation, translation), MORULA_OK);
  }
  Vec3 corner(std::uint32_t vertex) const {
    const double* p = morula_mesh_positions(mesh) + 3 * std::size_t{vertex};
    return Vec3{p[0], p[1], p[2]} + offset;
  }
  std::size_t vertex_count() const { return morula_mesh_vertex_count(mesh); }
  std::vector<std::vector<std::uint32_t>> facets() const {
    const std::uint32_t* list = morula_mesh_facets(mesh);
    std::vector<std::vector<std::uint32_t>> all;
    for (std::size_t f = 0; f < morula_mesh_facet_count(mesh); ++f, list += 3)
      all.push_back({list[0], list[1], list[2]});
    return all;
  }
  std::vector<std::vector<std::uint32_t>> edges() const {
    std::vector<std::vector<std::uint32_t>> all;
    for (const auto& facet : facets())
      for (std::size_t i = 0; i < 3; ++i)
        all.push_back({std::min(facet[i], facet[(i + 1) % 3]), std::max(facet[i], facet[(i + 1) % 3])});
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
};

double squared(const Vec3& v) {
  return dot(v, v);
}

/// Distance of two convex hulls of few points, by descending along one weight at a time: slow, and free of cases.
double hull_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  // Frank-Wolfe with exact steps between pairs of corners: the difference of two corners of the least and the largest
  // slope takes weight from one another.
  struct Corner {
    Vec3 at;
    double weight;
  };
  std::vector<Corner> corners;
  for (const Vec3& p : a)
    for (const Vec3& q : b) corners.push_back({p - q, 0});
  corners[0].weight = 1;
  Vec3 now = corners[0].at;
  for (int step = 0; step < 20000; ++step) {
    std::size_t low = 0, high = corners.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (dot(corners[i].at, now) < dot(corners[low].at, now)) low = i;
      if (corners[i].weight > 0 && (high == corners.size() || dot(corners[i].at, now) > dot(corners[high].at, now)))
        high = i;
    }
    const Vec3 way = corners[low].at - corners[high].at;
    const double slope = -dot(way, now);
    if (slope <= 1e-16 || squared(way) == 0) break;
    const double amount = std::min(slope / squared(way), corners[high].weight);
    corners[low].weight += amount, corners[high].weight -= amount;
    now = now + way * amount;
  }
  return std::sqrt(squared(now));
}

using Key = std::tuple<int, std::vector<std::uint32_t>, std::vector<std::uint32_t>>;

std::vector<std::uint32_t> vertices_of(const std::uint32_t* vertices) {
  std::vector<std::uint32_t> list;
  for (int i = 0; i < 3 && vertices[i] != UINT32_MAX; ++i) list.push_back(vertices[i]);
  std::sort(list.begin(), list.end());
  return list;
}

std::vector<Key> keys_of(const morula_pairs* pairs) {
  std::vector<Key> keys;
  for (std::size_t i = 0; i < morula_pairs_count(pairs); ++i) {
    const morula_pair& pair = morula_pairs_data(pairs)[i];
    keys.push_back({pair.kind, vertices_of(pair.vertices_a), vertices_of(pair.vertices_b)});
  }
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<Vec3> corners_of(const PairBody& body, const std::vector<std::uint32_t>& vertices) {
  std::vector<Vec3> corners;
  for (const std::uint32_t vertex : vertices) corners.push_back(body.corner(vertex));
  return corners;
}

struct Found {
  std::vector<Key> surely, perhaps;  // within the distance, and within it up to rounding
};

void collect(int kind, const PairBody& a, const std::vector<std::vector<std::uint32_t>>& of_a, const PairBody& b,
             const std::vector<std::vector<std::uint32_t>>& of_b, double distance, Found& found) {
  for (const auto& first : of_a)
    for (const auto& second : of_b) {
      const bool share = a.body == b.body && std::any_of(first.begin(), first.end(), [&](std::uint32_t vertex) {
                           return std::find(second.begin(), second.end(), vertex) != second.end();
                         });
      if (share || (a.body == b.body && kind == MORULA_EDGE_EDGE && first > second)) continue;
      Key key{kind, first, second};
      std::sort(std::get<1>(key).begin(), std::get<1>(key).end());
      std::sort(std::get<2>(key).begin(), std::get<2>(key).end());
      const double d = hull_distance(corners_of(a, first), corners_of(b, second));
      if (d < distance - 1e-5) found.surely.push_back(key);
      if (d < distance + 1e-5) found.perhaps.push_back(key);
    }
}

Found all_within(const PairBody& a, const PairBody& b, double distance) {
  std::vector<std::vector<std::uint32_t>> points_a, points_b;
  for (std::uint32_t v = 0; v < a.vertex_count(); ++v) points_a.push_back({v});
  for (std::uint32_t v = 0; v < b.vertex_count(); ++v) points_b.push_back({v});
  Found found;
  collect(MORULA_VERTEX_FACET, a, points_a, b, b.facets(), distance, found);
  if (a.body != b.body) collect(MORULA_FACET_VERTEX, a, a.facets(), b, points_b, distance, found);
  collect(MORULA_EDGE_EDGE, a, a.edges(), b, b.edges(), distance, found);
  std::sort(found.surely.begin(), found.surely.end());
  std::sort(found.perhaps.begin(), found.perhaps.end());
  return found;
}

void expect_found(const Found& expected, const morula_pairs* pairs) {
  const std::vector<Key> keys = keys_of(pairs);
  EXPECT_TRUE(std::includes(keys.begin(), keys.end(), expected.surely.begin(), expected.surely.end()));
  EXPECT_TRUE(std::includes(expected.perhaps.begin(), expected.perhaps.end(), keys.begin(), keys.end()));
}

/// The points of a pair are combinations of its vertices, and as far apart as it says.
void expect_points(const PairBody& a, const PairBody& b, const morula_pair& pair) {
  Vec3 of_a{}, of_b{};
  for (int i = 0; i < 3; ++i) {
    if (pair.vertices_a[i] != UINT32_MAX) of_a = of_a + a.corner(pair.vertices_a[i]) * pair.weights_a[i];
    if (pair.vertices_b[i] != UINT32_MAX) of_b = of_b + b.corner(pair.vertices_b[i]) * pair.weights_b[i];
  }
  const Vec3 point_a{pair.point_a[0], pair.point_a[1], pair.point_a[2]};
  const Vec3 point_b{pair.point_b[0], pair.point_b[1], pair.point_b[2]};
  EXPECT_LT(squared(of_a - point_a), 1e-20);
  EXPECT_LT(squared(of_b - point_b), 1e-20);
  EXPECT_NEAR(std::sqrt(squared(point_a - point_b)), pair.distance, 1e-9);
}

TEST(CPairs, near_pairs_are_those_of_all_features) {
  const PairBody limb("limb");
  PairBody torus("torus", 8);
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  morula_pair_options options;
  morula_pair_options_init(&options);
  options.distance = 0.2;
  std::size_t seen = 0;
  for (const double height : {0.0, 0.45, 5.0}) {
    torus.move({0.3, 0.05, height});
    ASSERT_EQ(morula_pairs_near(limb.body, torus.body, &options, pairs), MORULA_OK) << morula_message();
    EXPECT_TRUE(morula_pairs_finished(pairs));
    expect_found(all_within(limb, torus, options.distance), pairs);
    for (std::size_t i = 0; i < morula_pairs_count(pairs); ++i) expect_points(limb, torus, morula_pairs_data(pairs)[i]);
    seen += morula_pairs_count(pairs);
  }
  EXPECT_GT(seen, 100u);
  // One body with itself, by both ways of saying so.
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  const std::vector<Key> keys = keys_of(pairs);
  expect_found(all_within(limb, limb, options.distance), pairs);
  EXPECT_GT(keys.size(), 10u);
  ASSERT_EQ(morula_pairs_near(limb.body, limb.body, &options, pairs), MORULA_OK);
  EXPECT_EQ(keys_of(pairs), keys);
  options.rings = 1;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_LT(morula_pairs_count(pairs), keys.size());
  options.rings = 0, options.rest_distance = 0.2;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_EQ(morula_pairs_count(pairs), 0u) << "at rest";
  options.rest_distance = 0, options.same_component = 1;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_EQ(morula_pairs_count(pairs), 0u) << "one component";
  morula_pairs_destroy(pairs);
}

TEST(CPairs, crossing_pairs_are_the_crossings) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12);
  torus.move({0.2, 0.1, 0.1});
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  ASSERT_EQ(morula_pairs_crossing(limb.body, torus.body, nullptr, pairs), MORULA_OK) << morula_message();
  std::size_t count = 0;
  std::vector<std::uint32_t> list(1 << 16);
  ASSERT_EQ(morula_crossings(limb.body, torus.body, list.data(), list.size() / 2, &count), MORULA_OK);
  ASSERT_EQ(morula_pairs_count(pairs), count);
  EXPECT_GT(count, 5u);
  const auto facets = limb.facets();
  for (std::size_t i = 0; i < count; ++i) {
    const morula_pair& pair = morula_pairs_data(pairs)[i];
    EXPECT_EQ(pair.kind, MORULA_FACET_FACET);
    EXPECT_EQ(pair.a, list[2 * i]);
    EXPECT_EQ(pair.b, list[2 * i + 1]);
    auto vertices = facets[pair.a];
    std::sort(vertices.begin(), vertices.end());
    EXPECT_EQ(vertices_of(pair.vertices_a), vertices);
  }
  morula_pairs_destroy(pairs);
}

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
  PairBody torus("torus", 12);
  torus.move({0.2, 0.1, 0.1});
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
  PairBody torus("torus", 16);
  torus.move({0.2, 0.1, 0.1});
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
  PairBody torus("torus", 16);
  torus.move({0.2, 0.1, 0.1});
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
  PairBody torus("torus", 12);
  torus.move({0.2, 0.1, 0.1});
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
  PairBody torus("torus", 12);
  torus.move({0.2, 0.1, 0.1});
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

TEST(CPairs, bounds_contain_the_distance) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12);
  torus.move({0.2, 0.1, 1.5});
  morula_distance exact;
  ASSERT_EQ(morula_distance_of(limb.body, torus.body, &exact), MORULA_OK);
  const auto bounds = [&](const auto& set, int& complete) {
    morula_distance_options options;
    morula_distance_options_init(&options);
    set(options);
    morula_distance result;
    EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_OK)
        << morula_message();
    EXPECT_LE(result.lower, exact.upper);
    EXPECT_GE(result.upper, exact.lower);
    return result;
  };
  int complete = 0;
  const morula_distance same = bounds([](auto&) {}, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_EQ(same.lower, exact.lower);
  EXPECT_EQ(same.upper, exact.upper);
  EXPECT_EQ(same.facet_a, exact.facet_a);
  const morula_distance none = bounds([](auto& o) { o.pair_tests = 0; }, complete);
  EXPECT_EQ(complete, 0);
  EXPECT_GT(none.upper - none.lower, exact.upper - exact.lower);
  const morula_distance rough = bounds([](auto& o) { o.tolerance = 0.5; }, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_LE(rough.upper - rough.lower, 0.5);
  const morula_distance far = bounds([](auto& o) { o.stop_above = 0.01; }, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_GT(far.lower, 0.01);
  bounds([](auto& o) { o.stop_below = 100; }, complete);
  EXPECT_EQ(complete, 1);

  morula_distance_options options;
  morula_distance_options_init(&options);
  morula_distance result;
  options.tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, nullptr, &result, nullptr), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_distance_bounds(limb.body, nullptr, nullptr, &result, &complete), MORULA_BAD_ARGUMENT);
  options.tolerance = 0, options.pair_tests = 1, options.nanoseconds = 1;
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_BAD_ARGUMENT);
}

}  // namespace
}  // namespace morula
