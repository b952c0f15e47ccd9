// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches within a budget: all patches, or contacts within which all edges pass through the other body's
// facets, wherever the budget ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/collide/contact_patches.hpp>
#include <optional>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/meshes.hpp>

#include "clipped_overlap.hpp"
#include "placed_bodies.hpp"

namespace morula {
namespace {

using std::chrono::nanoseconds;
using test::PlacedBody;

/// A point where an edge of one body's facet passes through a facet of the other.
struct EdgePoint {
  std::uint32_t facet_a, facet_b;
  Vec3 point;
};

/// The common point of a segment and a triangle, in long double; none near a border of either.
std::optional<Vec3> common_point(const Vec3& from, const Vec3& to, const Triangle& t) {
  using Wide = Vector3<long double>;
  const Wide p(from), d = Wide(to) - p, u = Wide(t[1]) - Wide(t[0]), v = Wide(t[2]) - Wide(t[0]), w = p - Wide(t[0]);
  const long double across = dot(cross(u, v), d);
  if (across == 0) return {};
  const long double at = -dot(cross(u, v), w) / across;
  const Wide x = w + d * at;
  const long double square = dot(cross(u, v), cross(u, v));
  const long double s = dot(cross(x, v), cross(u, v)) / square, r = dot(cross(u, x), cross(u, v)) / square;
  constexpr long double border = 1e-9L;
  if (at < border || at > 1 - border || s < border || r < border || s + r > 1 - border) return {};
  const Wide q = p + d * at;
  return Vec3{static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z)};
}

std::vector<EdgePoint> edge_points(const Collider& a, const Collider& b) {
  std::vector<EdgePoint> points;
  for (std::uint32_t f = 0; f < a.mesh_facets().size(); ++f)
    for (std::uint32_t g = 0; g < b.mesh_facets().size(); ++g) {
      const Triangle t = a.triangle(f), u = b.triangle(g);
      for (std::size_t k = 0; k < 3; ++k) {
        if (const auto p = common_point(t[k], t[(k + 1) % 3], u)) points.push_back({f, g, *p});
        if (const auto p = common_point(u[k], u[(k + 1) % 3], t)) points.push_back({f, g, *p});
      }
    }
  return points;
}

bool owns(const Collider& body, std::uint32_t node, std::uint32_t facet) {
  const auto list = body.facets(node);
  return std::find(list.begin(), list.end(), facet) != list.end();
}

/// The number of points that lie in no contact.
std::size_t missed(const std::vector<EdgePoint>& points, const Collider& a, const Collider& b,
                   std::span<const Contact> contacts) {
  return static_cast<std::size_t>(std::count_if(points.begin(), points.end(), [&](const EdgePoint& x) {
    return std::none_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
      return distance(x.point, c.point) <= c.error_bound + 1e-12 && owns(a, c.node_a, x.facet_a) &&
             owns(b, c.node_b, x.facet_b);
    });
  }));
}

struct Twins : ::testing::Test {
  PlacedBody a{test::icosphere(2)}, b{test::uv_sphere(14, 10, 0.9)};
  ContactPatchQuery query{a.collider, b.collider}, unlimited{a.collider, b.collider};
  Random random{17};

  void pose() {
    a.deform(test::rippled(a.mesh.positions, 0.15, 3));
    const auto part = [&] { return random.uniform(-1, 1); };
    b.collider.set_transform(RigidTransform::from_axis({part(), part(), part()}, random.uniform(0, 3),
                                                       Vec3{1.1, part() * 0.5, part() * 0.5}));
    ASSERT_TRUE(unlimited.run());
    ASSERT_TRUE(unlimited.finished());
    ASSERT_TRUE(unlimited.contacts().empty());
  }
  /// The number of tests that a run needs: of spheres, and of facets whose boxes meet.
  std::size_t sphere_tests() const { return collide(a.collider, b.collider, {.budget = 1 << 30}).pair_tests; }
  std::size_t facet_tests() const {
    CrossingQuery crossings;
    EXPECT_TRUE(crossings.run(a.collider, b.collider));
    return crossings.pairs_tested();
  }
  void expect_same_as_unlimited() const {
    EXPECT_TRUE(query.contacts().empty());
    ASSERT_EQ(query.patches().size(), unlimited.patches().size());
    EXPECT_EQ(query.volume(), unlimited.volume());
    for (std::size_t i = 0; i < query.patches().size(); ++i) {
      const ContactPatch &p = query.patches()[i], &q = unlimited.patches()[i];
      EXPECT_EQ(p.volume, q.volume);
      EXPECT_EQ(p.centroid, q.centroid);
      EXPECT_EQ(p.normal, q.normal);
      EXPECT_EQ(p.depth, q.depth);
      EXPECT_EQ(p.crossing_count, q.crossing_count);
      ASSERT_EQ(p.points.size(), q.points.size());
      for (std::size_t k = 0; k < p.points.size(); ++k) EXPECT_EQ(p.points[k].force, q.points[k].force);
      ASSERT_EQ(p.a.gradients.size(), q.a.gradients.size());
      for (std::size_t k = 0; k < p.a.gradients.size(); ++k)
        EXPECT_EQ(p.a.gradients[k].gradient, q.a.gradients[k].gradient);
    }
  }
  void expect_contacts_alone(const std::vector<EdgePoint>& points) const {
    EXPECT_TRUE(query.patches().empty());
    EXPECT_EQ(query.volume(), 0);
    EXPECT_FALSE(query.contacts().empty());
    EXPECT_EQ(missed(points, a.collider, b.collider, query.contacts()), 0u);
  }
};

TEST_F(Twins, have_all_patches_or_contacts_that_bound_them_for_any_number_of_tests) {
  for (int round = 0; round < 4; ++round) {
    pose();
    const std::vector<EdgePoint> points = edge_points(a.collider, b.collider);
    ASSERT_GT(points.size(), 20u);
    const test::ClippedOverlap expected = test::clipped_overlap(a.collider, b.collider);
    const std::size_t spheres = sphere_tests(), all = spheres + facet_tests();
    std::size_t complete = 0, between = 0;
    for (std::size_t budget = 0; budget <= all + 20; budget += budget < 20 ? 1 : budget / 20) {
      ASSERT_TRUE(query.run({.budget = budget}));
      ASSERT_EQ(query.finished(), budget >= all) << budget << " of " << all;
      if (query.finished()) {
        ++complete;
        EXPECT_NEAR(query.volume(), expected.volume, 1e-13);
        expect_same_as_unlimited();
      } else {
        expect_contacts_alone(points);
        // Between the tests of spheres and those of facets all contacts are pairs of leaves.
        between += budget >= spheres;
        EXPECT_EQ(
            std::all_of(query.contacts().begin(), query.contacts().end(), [](const Contact& c) { return c.finished; }),
            budget >= spheres);
      }
    }
    EXPECT_GT(complete, 0u);
    EXPECT_GT(between, 0u);
    // To the test.
    ASSERT_TRUE(query.run({.budget = all}));
    EXPECT_TRUE(query.finished());
    ASSERT_TRUE(query.run({.budget = all - 1}));
    EXPECT_FALSE(query.finished());
  }
}

// Each reading of the clock is a nanosecond later, so limits end the run at each reading in turn.
TEST_F(Twins, have_all_patches_or_contacts_that_bound_them_wherever_time_ends) {
  pose();
  const std::vector<EdgePoint> points = edge_points(a.collider, b.collider);
  std::int64_t readings = 0;
  const Clock clock = [&] { return nanoseconds(readings++); };
  std::size_t ended = 0, after_search = 0;
  std::int64_t limit = 0;
  for (;; ++limit) {
    readings = 0;
    ASSERT_TRUE(query.run({.budget = nanoseconds(limit), .clock = clock}));
    if (query.finished()) break;
    expect_contacts_alone(points);
    ++ended;
    after_search +=
        std::all_of(query.contacts().begin(), query.contacts().end(), [](const Contact& c) { return c.finished; });
    // The readings after the end are few.
    EXPECT_LE(readings, limit + 4);
  }
  expect_same_as_unlimited();
  EXPECT_GT(ended, 50u);
  EXPECT_GT(after_search, 20u);
}

TEST_F(Twins, keep_the_ids_of_patches_over_runs_that_do_not_finish) {
  pose();
  ASSERT_TRUE(query.run());
  std::vector<std::uint32_t> ids;
  for (const ContactPatch& patch : query.patches()) ids.push_back(patch.id);
  ASSERT_FALSE(ids.empty());
  for (int k = 0; k < 3; ++k) {
    ASSERT_TRUE(query.run({.budget = 10}));
    ASSERT_FALSE(query.finished());
  }
  ASSERT_TRUE(query.run({.budget = 1 << 30}));
  ASSERT_EQ(query.patches().size(), ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(query.patches()[i].id, ids[i]);
}

TEST_F(Twins, keep_the_last_result_when_a_run_is_rejected) {
  pose();
  ASSERT_TRUE(query.run({.budget = 30}));
  const std::vector<Contact> contacts(query.contacts().begin(), query.contacts().end());
  EXPECT_EQ(query.run({.budget = -1}).code, Status::Code::bad_option);
  EXPECT_EQ(query.run({.budget = nanoseconds(-1)}).code, Status::Code::bad_option);
  std::vector<Vec3> mirrored = b.mesh.positions;
  for (Vec3& p : mirrored) p.x = -p.x;
  b.deform(mirrored);
  EXPECT_EQ(query.run({.budget = 1 << 30}).code, Status::Code::inside_out);
  ASSERT_EQ(query.contacts().size(), contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) EXPECT_EQ(query.contacts()[i].node_a, contacts[i].node_a);
  EXPECT_FALSE(query.finished());
}

TEST_F(Twins, have_no_result_after_a_clock_that_throws_or_moves_a_body) {
  pose();
  for (int failing = 0; failing < 60; failing += 7) {
    ASSERT_TRUE(query.run());
    int readings = 0;
    const Clock throws = [&] {
      if (readings++ == failing) throw std::runtime_error("no time");
      return nanoseconds(readings);
    };
    EXPECT_THROW(static_cast<void>(query.run({.budget = nanoseconds(1000000), .clock = throws})), std::runtime_error);
    EXPECT_TRUE(query.patches().empty());
    EXPECT_FALSE(query.finished());
    readings = 0;
    const Clock moves = [&] {
      if (readings++ == failing) a.collider.set_transform(a.collider.transform());
      return nanoseconds(readings);
    };
    EXPECT_EQ(query.run({.budget = nanoseconds(1000000), .clock = moves}).code, Status::Code::changed_during_call);
    EXPECT_TRUE(query.patches().empty() && query.contacts().empty());
    std::optional<Status> within;
    const Clock calls = [&] {
      if (!within) within = query.run();
      return nanoseconds(readings++);
    };
    ASSERT_TRUE(query.run({.budget = nanoseconds(1000000), .clock = calls}));
    EXPECT_EQ(within->code, Status::Code::in_use);
    EXPECT_TRUE(query.finished());
    expect_same_as_unlimited();
  }
}

TEST_F(Twins, allocate_nothing_when_they_have_met_like_this_before) {
  const auto run_everything = [&] {
    bool good = true;
    for (int step = 0; step < 12; ++step) {
      b.collider.set_transform({.translation = {2.1 - 0.1 * step, 0.1, 0.2}});
      good = good && query.run() && query.finished();
      good = good && query.run({.budget = 40}) && query.run({.budget = 0}) && !query.finished();
      good = good && query.run({.budget = 1 << 30}) && query.finished();
      good = good && query.run({.budget = std::chrono::hours(1)}) && query.finished();
      good = good && !query.run({.max_points = 99});
    }
    return good;
  };
  EXPECT_TRUE(run_everything() && run_everything());
  const std::size_t before = test::allocations;
  const bool good = run_everything();
  const std::size_t after = test::allocations;
  EXPECT_TRUE(good);
  EXPECT_EQ(after - before, 0u);
}

TEST(PatchBudget, of_bodies_that_are_apart_or_inside_each_other) {
  PlacedBody ball(test::icosphere(1, 0.2)), box(test::box_mesh({-1, -1, -1}, {1, 1, 1}));
  ContactPatchQuery query(ball.collider, box.collider);
  EXPECT_FALSE(query.finished());
  ASSERT_TRUE(query.run({.budget = 1 << 30}));
  EXPECT_TRUE(query.finished());
  EXPECT_EQ(query.patches().size(), 1u);
  ball.collider.set_transform({.translation = {9, 0, 0}});
  ASSERT_TRUE(query.run({.budget = 0}));
  EXPECT_FALSE(query.finished());
  EXPECT_EQ(query.contacts().size(), 1u) << "roots that were not tested";
  ASSERT_TRUE(query.run({.budget = 1}));
  EXPECT_TRUE(query.finished());
  EXPECT_TRUE(query.patches().empty());
}

}  // namespace
}  // namespace morula
