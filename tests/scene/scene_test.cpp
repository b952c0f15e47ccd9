// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenes: no crossing outside the contacts, whatever comes, goes, moves and runs out of budget.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <morula/generators/build.hpp>
#include <morula/scene/scene.hpp>
#include <set>
#include <stdexcept>
#include <support/allocations.hpp>
#include <support/meshes.hpp>
#include <support/placements.hpp>

namespace morula {
namespace {

using namespace std::chrono_literals;

/// A body with all that a collider borrows, at an address that stays.
struct Thing {
  explicit Thing(Mesh m)
      : mesh(std::move(m)),
        built(build(mesh, {.method = Method::octree, .branching = 8, .depth = 2})),
        body(mesh, built),
        positions(mesh.positions),
        collider(mesh, body) {}
  void deform(Random& random, double amount) {
    const Vec3 stretch{random.uniform(0.8, 1.3), random.uniform(0.8, 1.3), random.uniform(0.8, 1.3)};
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3 p = mesh.positions[v];
      positions[v] = Vec3{p.x * stretch.x, p.y * stretch.y, p.z * stretch.z} + test::random_point(random, amount);
    }
    ASSERT_TRUE(body.update(positions));
  }
  // The middle, and the farthest vertex from it, where it is now.
  Sphere around() const {
    Vec3 sum{};
    for (std::uint32_t v = 0; v < positions.size(); ++v) sum = sum + collider.vertex(v);
    Sphere sphere{sum / static_cast<double>(positions.size()), 0};
    for (std::uint32_t v = 0; v < positions.size(); ++v)
      sphere.radius = std::max(sphere.radius, distance(sphere.center, collider.vertex(v)));
    return sphere;
  }

  Mesh mesh;
  CoveredTree built;
  Body body;
  std::vector<Vec3> positions;
  Collider collider;
  SceneBodyOptions options{};
  BodyId id{};
};

std::unique_ptr<Thing> make_thing(std::size_t i) {
  if (i % 3 == 0) return std::make_unique<Thing>(test::icosphere(1, 0.6));
  if (i % 3 == 1) return std::make_unique<Thing>(test::box_mesh({-0.7, -0.4, -0.3}, {0.7, 0.4, 0.3}, 2));
  return std::make_unique<Thing>(test::grid_plate(4, 1.4, 1.0));
}

/// Where the edge from p to q goes through t.
std::optional<Vec3> pierced(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double hp = dot(n, p - t[0]), hq = dot(n, q - t[0]);
  if (!(hp * hq < 0)) return {};
  const Vec3 x = p + (q - p) * (hp / (hp - hq));
  for (std::size_t k = 0; k < 3; ++k)
    if (dot(n, cross(t[(k + 1) % 3] - t[k], x - t[k])) < 0) return {};
  return x;
}

struct Crossed {
  std::uint32_t facet_a, facet_b;
  Vec3 point;
};
std::vector<Crossed> crossings_by_force(const Thing& a, const Thing& b) {
  std::vector<Crossed> found;
  const Sphere sphere_a = a.around(), sphere_b = b.around();
  if (distance(sphere_a.center, sphere_b.center) > sphere_a.radius + sphere_b.radius + 1e-9) return found;
  for (std::uint32_t f = 0; f < a.mesh.facets.size(); ++f)
    for (std::uint32_t g = 0; g < b.mesh.facets.size(); ++g) {
      const Triangle t = a.collider.triangle(f), u = b.collider.triangle(g);
      for (std::size_t k = 0; k < 3; ++k) {
        if (const auto x = pierced(t[k], t[(k + 1) % 3], u)) found.push_back({f, g, *x});
        if (const auto x = pierced(u[k], u[(k + 1) % 3], t)) found.push_back({f, g, *x});
      }
    }
  return found;
}

bool is_within(const Crossed& crossed, const ScenePair& pair, const Collider& a, const Collider& b) {
  const auto has = [](std::span<const std::uint32_t> facets, std::uint32_t f) {
    return std::find(facets.begin(), facets.end(), f) != facets.end();
  };
  for (const Contact& c : pair.contacts)
    if (distance(c.point, crossed.point) <= c.error_bound + 1e-9 && has(a.facets(c.node_a), crossed.facet_a) &&
        has(b.facets(c.node_b), crossed.facet_b))
      return true;
  return false;
}

/// Bodies that come, go, move, deform, sleep and wake.
class Crowd {
 public:
  explicit Crowd(std::uint64_t seed) : random(seed) {
    for (std::size_t i = 0; i < 14; ++i) spare_.push_back(make_thing(i));
  }
  void step(Scene& scene, bool with_sleep) {
    for (std::uint64_t k = random.next() % 4; k-- > 0 && !spare_.empty();) add(scene);
    if (random.next() % 4 == 0 && things.size() > 6) {
      const auto gone = things.begin() + static_cast<std::ptrdiff_t>(random.next() % things.size());
      scene.remove((*gone)->id);
      EXPECT_THROW(scene.remove((*gone)->id), std::invalid_argument);
      spare_.push_back(std::move(*gone));
      things.erase(gone);
      // Its place is not taken before the scene knows.
      if (random.next() % 2 == 0 && !spare_.empty()) add(scene);
    }
    for (const auto& thing : things) {
      const std::uint64_t what = random.next() % 6;
      if (with_sleep && what == 5) scene.sleep(thing->id);
      if (thing->options.is_static && what != 0) continue;
      if (scene.is_asleep(thing->id) || thing->options.is_static) {
        if (what > 1) continue;
        scene.wake(thing->id);
      }
      if (what == 0) thing->collider.place(test::random_placement(random, 1.2));
      if (what == 1) thing->deform(random, 0.05);
      if (what == 2) {
        RigidTransform nudged = thing->collider.placement();
        nudged.translation = nudged.translation + test::random_point(random, 0.02);
        thing->collider.place(nudged);
      }
    }
  }
  bool may_meet(const Thing& a, const Thing& b) const {
    return !(a.options.is_static && b.options.is_static) && (a.options.of & b.options.with) != 0 &&
           (b.options.of & a.options.with) != 0;
  }

  Random random;
  std::vector<std::unique_ptr<Thing>> things;

 private:
  void add(Scene& scene) {
    things.push_back(std::move(spare_.front()));
    spare_.erase(spare_.begin());
    Thing& thing = *things.back();
    thing.options = {.is_static = random.next() % 5 == 0,
                     .of = 1u << (random.next() % 3),
                     .with = static_cast<std::uint32_t>(random.next() % 7 + 1) | 1u,
                     .weight = random.uniform(0, 3),
                     .user_data = random.next()};
    thing.collider.place(test::random_placement(random, 1.2));
    thing.id = scene.add(thing.collider, thing.options);
    EXPECT_EQ(scene.user_data(thing.id), thing.options.user_data);
  }
  std::vector<std::unique_ptr<Thing>> spare_;
};

TEST(Scene, no_pair_waits_for_ever_not_even_one_whose_roots_only_touch) {
  Thing a(test::grid_plate(8, 1.4, 1.0)), b(test::grid_plate(8, 1.4, 1.0));
  Thing c(test::icosphere(2, 0.6)), d(test::icosphere(2, 0.6));
  const double apart = (c.body.sphere(0).radius + d.body.sphere(0).radius) * (1 + 1e-8);
  c.collider.place({.translation = {0, 0, 50}});
  d.collider.place({.translation = {apart, 0, 50}});
  Scene scene({.budget = 72});
  scene.add(a.collider), scene.add(b.collider);
  const BodyId id_c = scene.add(c.collider), id_d = scene.add(d.collider);
  ASSERT_TRUE(scene.update());
  const auto is_open = [&] {
    const ScenePair* pair = scene.find(id_c, id_d);
    return pair != nullptr && !pair->finished;
  };
  ASSERT_TRUE(is_open());
  int frame = 0;
  for (; frame < 5000 && is_open(); ++frame) {
    a.collider.place({.translation = {0.1 * (frame % 3), 0, 0}});
    ASSERT_TRUE(scene.update());
  }
  EXPECT_LT(frame, 5000);
}

// Time may end a pair's surfaces, by the clock that was given. A pair that rests gets them as soon as there is time.
TEST(Scene, surfaces_that_time_has_ended_come_later_where_bodies_rest) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.3, 0.1, 0}));
  std::chrono::nanoseconds time{0};
  SceneOptions options{.budget = 60us, .surfaces = true, .clock = [&] { return time += 2us; }};
  Scene scene(options);
  scene.add(a.collider), scene.add(b.collider);
  std::size_t contacts = 0, surfaces = 0;
  for (int frame = 0; frame < 20; ++frame) {
    ASSERT_TRUE(scene.update());
    ASSERT_EQ(scene.pairs().size(), 1u);
    const ScenePair& pair = scene.pairs()[0];
    if (pair.finished) contacts = pair.contacts.size(), surfaces = pair.surfaces.size();
  }
  ASSERT_GT(contacts, 40u);
  EXPECT_GT(surfaces, 0u);
  EXPECT_LT(surfaces, contacts);
  options.budget = 10ms;
  scene.set_options(options);
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs()[0].surfaces.size(), contacts);
}

TEST(Scene, has_every_crossing_within_a_contact_wherever_a_budget_ends) {
  std::size_t crossed = 0, interrupted = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Crowd crowd(seed);
    Scene scene;
    Workers workers(2);
    std::chrono::nanoseconds time{0};
    std::map<std::uint64_t, std::pair<BodyId, BodyId>> touching;
    for (int step = 0; step < 60; ++step) {
      crowd.step(scene, true);
      SceneOptions options{.level = crowd.random.next() % 4 == 0 ? std::optional<std::uint32_t>(1) : std::nullopt};
      const std::uint64_t how = crowd.random.next() % 8;
      const std::size_t tests = std::array<std::size_t, 6>{0, 1, 64, 700, 3000, 100000}[how % 6];
      if (how < 6) options.budget = tests;
      if (how == 6) options.budget = 40us, options.clock = [&] { return time += 3us; };
      scene.set_options(options);
      const SceneStatus status = scene.update(workers);
      ASSERT_TRUE(status) << message(status);
      if (how < 6) {
        ASSERT_LE(status.pair_tests, tests);
      }
      if (how == 7) {
        ASSERT_TRUE(status.finished);
      }
      interrupted += !status.finished;
      for (const EndedPair& ended : scene.ended()) {
        ASSERT_EQ(touching.count(ended.id), 1u);
        ASSERT_EQ(touching[ended.id], std::pair(ended.a, ended.b));
        touching.erase(ended.id);
      }
      for (const ScenePair& pair : scene.pairs()) {
        ASSERT_EQ(pair.began, touching.count(pair.id) == 0);
        touching[pair.id] = {pair.a, pair.b};
        ASSERT_FALSE(pair.contacts.empty());
      }
      ASSERT_EQ(touching.size(), scene.pairs().size()) << "a touch has neither stayed nor ended";
      for (const auto& a : crowd.things)
        for (const auto& b : crowd.things) {
          if (!(a->id.place < b->id.place)) continue;
          const ScenePair* pair = scene.find(b->id, a->id);
          if (!crowd.may_meet(*a, *b)) {
            ASSERT_EQ(pair, nullptr);
            continue;
          }
          for (const Crossed& crossing : crossings_by_force(*a, *b)) {
            ++crossed;
            ASSERT_NE(pair, nullptr) << "seed " << seed << ", step " << step;
            ASSERT_TRUE(is_within(crossing, *pair, a->collider, b->collider)) << "seed " << seed << ", step " << step;
          }
        }
    }
  }
  EXPECT_GT(crossed, 20000u);
  EXPECT_GT(interrupted, 50u);
}

std::vector<NodePair> nodes_of(std::span<const Contact> contacts) {
  std::vector<NodePair> nodes;
  for (const Contact& c : contacts) nodes.push_back({c.node_a, c.node_b});
  std::sort(nodes.begin(), nodes.end(),
            [](NodePair x, NodePair y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  return nodes;
}

// By the clock that was given, which takes its time for whoever reads it: work costs nothing, so what is late is what
// was begun too late.
TEST(Scene, a_budget_in_time_ends_within_a_tenth_of_it) {
  std::vector<std::unique_ptr<Thing>> things;
  std::chrono::nanoseconds time{0};
  Scene scene({.budget = 1ms, .clock = [&] { return time += 20us; }});
  Random random(5);
  for (std::size_t i = 0; i < 24; ++i) {
    things.push_back(make_thing(i));
    things.back()->id = scene.add(things.back()->collider);
  }
  std::size_t late = 0, stopped = 0, finished = 0;
  for (int frame = 0; frame < 10000; ++frame) {
    for (const auto& thing : things) thing->collider.place(test::random_placement(random, frame % 2 == 0 ? 1.0 : 3.0));
    const std::chrono::nanoseconds before = time;
    const SceneStatus status = scene.update();
    ASSERT_TRUE(status);
    late += time - before > 1100us;
    (status.finished ? finished : stopped) += 1;
  }
  EXPECT_EQ(late, 0u);
  EXPECT_GT(stopped, 1000u);
  EXPECT_GT(finished, 1000u);
}

// The clock of a machine that is busy elsewhere for a while, whatever is just being done.
TEST(Scene, a_long_wait_does_not_keep_pairs_from_being_begun_later) {
  std::vector<std::unique_ptr<Thing>> things;
  for (std::size_t i = 0; i < 12; ++i) things.push_back(make_thing(i));
  Random random(6);
  for (int at = 1; at < 12; ++at) {
    std::chrono::nanoseconds time{0};
    int reads = 0, wait_at = 0;
    Scene scene({.budget = 1ms, .clock = [&] { return time += ++reads == wait_at ? 5000us : 1us; }});
    for (const auto& thing : things) thing->id = scene.add(thing->collider);
    const auto update = [&] {
      for (const auto& thing : things) thing->collider.place(test::random_placement(random, 1));
      reads = 0;
      const SceneStatus status = scene.update();
      EXPECT_TRUE(status);
      return status;
    };
    // In the first updates of all, and in later ones.
    for (int waits = 1; waits < 5; ++waits) {
      wait_at = at;
      for (int k = 0; k < waits; ++k) update();
      wait_at = 0;
      int updates = 0;
      while (!update().finished && updates < 1000) ++updates;
      EXPECT_LT(updates, 60) << at << ' ' << waits;
    }
  }
}

TEST(Scene, finished_contacts_are_those_of_every_two_bodies_alone) {
  std::size_t compared = 0;
  for (const double margin : {0.0, 0.15})
    for (const bool limited : {false, true}) {
      Crowd crowd(31);
      SceneOptions options{.margin = margin, .surfaces = true, .exact = true};
      if (limited) options.budget = 1000000;
      Scene scene(options);
      for (int step = 0; step < 60; ++step) {
        crowd.step(scene, true);
        const SceneStatus status = scene.update();
        ASSERT_TRUE(status && status.finished) << message(status);
        ASSERT_EQ(status.open_pairs, 0u);
        for (const auto& a : crowd.things)
          for (const auto& b : crowd.things) {
            if (!(a->id.place < b->id.place) || !crowd.may_meet(*a, *b)) continue;
            const ScenePair* pair = scene.find(a->id, b->id);
            const Contacts alone =
                collide(a->collider, b->collider, {.margin = margin, .surfaces = true, .exact = true});
            ASSERT_EQ(pair == nullptr, alone.contacts.empty());
            if (pair == nullptr) continue;
            ++compared;
            ASSERT_TRUE(pair->finished);
            ASSERT_EQ(nodes_of(pair->contacts), nodes_of(alone.contacts));
            ASSERT_EQ(pair->surfaces.size(), alone.contacts.size());
            ASSERT_TRUE(std::equal(pair->crossings.begin(), pair->crossings.end(), alone.crossings.begin(),
                                   alone.crossings.end()));
          }
      }
    }
  EXPECT_GT(compared, 500u);
}

std::vector<double> digits(const Scene& scene) {
  std::vector<double> all;
  for (const ScenePair& pair : scene.pairs()) {
    for (const double x : {static_cast<double>(pair.a.place), static_cast<double>(pair.b.place),
                           static_cast<double>(pair.id), pair.began ? 1.0 : 0.0, pair.finished ? 1.0 : 0.0})
      all.push_back(x);
    for (const Contact& c : pair.contacts)
      all.insert(all.end(), {static_cast<double>(c.node_a), static_cast<double>(c.node_b), c.point.x, c.depth,
                             c.error_bound, c.finished ? 1.0 : 0.0});
    for (const ContactSurface& s : pair.surfaces) all.insert(all.end(), {s.depth, s.normal.x, s.on_a.point.z});
  }
  for (const EndedPair& pair : scene.ended()) all.push_back(static_cast<double>(pair.id));
  return all;
}

TEST(Scene, has_the_same_bits_for_any_number_of_workers) {
  std::vector<std::vector<double>> first;
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    Crowd crowd(5);
    Scene scene({.budget = 2000, .surfaces = true});
    for (std::size_t step = 0; step < 50; ++step) {
      crowd.step(scene, true);
      ASSERT_TRUE(scene.update(workers));
      if (threads == 1) {
        first.push_back(digits(scene));
      } else {
        ASSERT_EQ(digits(scene), first[step]) << threads << " workers, step " << step;
      }
    }
  }
}

TEST(Scene, goes_on_where_it_ended_while_bodies_rest) {
  Crowd crowd(8);
  Scene scene({.budget = 300});
  for (int step = 0; step < 12; ++step) crowd.step(scene, false);
  std::size_t updates = 0, open = std::numeric_limits<std::size_t>::max();
  for (SceneStatus status{}; !status.finished; ++updates) {
    status = scene.update();
    ASSERT_TRUE(status);
    ASSERT_LE(status.open_pairs, open);
    open = status.open_pairs;
    ASSERT_LT(updates, 1000u);
  }
  EXPECT_GT(updates, 2u);
  EXPECT_EQ(scene.update().pair_tests, 0u);
  EXPECT_TRUE(scene.ended().empty());
  for (const ScenePair& pair : scene.pairs()) EXPECT_FALSE(pair.began);
}

TEST(Scene, gives_a_budget_to_the_important_first_and_leaves_nobody_out_for_ever) {
  std::vector<std::unique_ptr<Thing>> things;
  Scene scene({.budget = 100});
  // Eight pairs far from each other, each as deep as the others; the fourth is important.
  for (int i = 0; i < 16; ++i) {
    things.push_back(std::make_unique<Thing>(test::icosphere(2, 0.6)));
    things.back()->collider.place({.translation = {10.0 * (i / 2) + 0.3 * (i % 2), 0, 0}});
    things.back()->id = scene.add(things.back()->collider, {.weight = i / 2 == 3 ? 10.0 : 1.0});
  }
  std::set<std::uint32_t> refined;
  const auto look = [&] {
    for (const ScenePair& pair : scene.pairs())
      if (pair.contacts.size() > 1) refined.insert(pair.a.place / 2);
  };
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 8u);
  look();
  EXPECT_EQ(refined, std::set<std::uint32_t>{3});
  Random random(1);
  for (int step = 0; step < 30; ++step) {
    for (const auto& thing : things) {
      RigidTransform moved = thing->collider.placement();
      moved.translation = moved.translation + Vec3{0, random.uniform(-0.01, 0.01), 0};
      thing->collider.place(moved);
    }
    ASSERT_TRUE(scene.update());
    look();
  }
  EXPECT_EQ(refined.size(), 8u);
}

TEST(Scene, tells_what_it_refuses_and_changes_nothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double margin : {-1.0, nan, std::numeric_limits<double>::infinity()})
    EXPECT_THROW(Scene({.margin = margin}), std::invalid_argument);
  EXPECT_THROW(Scene({.budget = -1}), std::invalid_argument);
  Thing a(test::icosphere(1)), b(test::icosphere(1)), c(test::icosphere(1));
  b.collider.place({.translation = {0.5, 0, 0}});
  Scene scene;
  EXPECT_THROW(scene.set_options({.margin = -1}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.of = 0}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.weight = -1}), std::invalid_argument);
  EXPECT_THROW(scene.add(a.collider, {.weight = nan}), std::invalid_argument);
  EXPECT_EQ(scene.size(), 0u);
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  const std::uint64_t touch = scene.pairs()[0].id;

  // A step that is not finite.
  b.positions[7].y = nan;
  EXPECT_FALSE(b.body.update(b.positions));
  const SceneStatus refused = scene.update();
  EXPECT_EQ(refused.code, Status::Code::body_not_current);
  EXPECT_EQ(refused.offender, id_b);
  EXPECT_NE(message(refused).find("body 1 of generation 1"), std::string::npos) << message(refused);
  EXPECT_THROW(scene.add(b.collider), std::invalid_argument);
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_EQ(scene.pairs()[0].id, touch);
  EXPECT_TRUE(scene.pairs()[0].began) << "as of the last good update";
  b.positions = b.mesh.positions;
  ASSERT_TRUE(b.body.update(b.positions));
  ASSERT_TRUE(scene.update());
  EXPECT_FALSE(scene.pairs()[0].began);

  scene.remove(id_a);
  EXPECT_THROW(scene.remove(id_a), std::invalid_argument);
  EXPECT_THROW(scene.sleep(id_a), std::invalid_argument);
  EXPECT_THROW(scene.wake(id_a), std::invalid_argument);
  EXPECT_THROW(scene.replace(id_a, c.collider), std::invalid_argument);
  EXPECT_THROW(scene.set_masks(id_a, 1, 1), std::invalid_argument);
  EXPECT_THROW(scene.set_masks(id_b, 0, 1), std::invalid_argument);
  EXPECT_FALSE(scene.has(id_a));
  EXPECT_FALSE(scene.has({.place = 99, .generation = 1}));
  const BodyId id_c = scene.add(c.collider);
  EXPECT_NE(id_c.place, id_a.place) << "the touch of the removed body has not ended";
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.ended().size(), 1u);
  EXPECT_EQ(scene.ended()[0].id, touch);
  EXPECT_EQ(scene.ended()[0].a, id_a);
  const BodyId again = scene.add(a.collider);
  EXPECT_EQ(again.place, id_a.place);
  EXPECT_NE(again, id_a);
}

TEST(Scene, masks_and_filters_may_change_while_bodies_touch) {
  Thing a(test::icosphere(1)), b(test::icosphere(1));
  Scene scene;
  const BodyId id_a = scene.add(a.collider, {.of = 2, .with = 4}), id_b = scene.add(b.collider, {.of = 4, .with = 2});
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
  scene.set_masks(id_b, 4, 1);
  ASSERT_TRUE(scene.update());
  EXPECT_TRUE(scene.pairs().empty());
  EXPECT_EQ(scene.ended().size(), 1u);
  scene.set_masks(id_b, 4, 2);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_TRUE(scene.pairs()[0].began);
  EXPECT_TRUE(scene.ended().empty());
  std::size_t asked = 0;
  scene.set_options({.keeps = [&](BodyId x, BodyId y) {
    ++asked;
    EXPECT_EQ(std::pair(x, y), std::pair(id_a, id_b));
    return false;
  }});
  ASSERT_TRUE(scene.update() && scene.update());
  EXPECT_EQ(asked, 1u);
  EXPECT_TRUE(scene.pairs().empty());
}

TEST(Scene, a_pair_that_a_filter_refuses_is_asked_about_once) {
  Thing a(test::icosphere(1)), b(test::icosphere(1));
  std::size_t asked = 0;
  Scene scene({.keeps = [&](BodyId, BodyId) {
    ++asked;
    return false;
  }});
  scene.add(a.collider);
  scene.add(b.collider);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(scene.update());
  EXPECT_EQ(asked, 1u);
  EXPECT_TRUE(scene.pairs().empty());
  scene.set_options({});
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
}

TEST(Scene, finds_what_rays_and_shapes_meet_of_all_bodies) {
  Crowd crowd(17);
  Scene scene;
  for (int step = 0; step < 10; ++step) crowd.step(scene, false);
  EXPECT_EQ(scene.first_hit({}).status.code, Status::Code::other_frame) << "bodies have come since the last update";
  ASSERT_TRUE(scene.update());
  std::size_t hits = 0, touched = 0;
  for (int i = 0; i < 400; ++i) {
    const Ray ray{test::random_point(crowd.random, 3), test::random_point(crowd.random, 1), crowd.random.uniform(1, 9)};
    const SceneRayHit hit = scene.first_hit(ray);
    ASSERT_TRUE(hit.status);
    double nearest = std::numeric_limits<double>::infinity();
    BodyId who{};
    for (const auto& thing : crowd.things)
      if (const RayHit alone = first_hit(thing->collider, ray);
          alone.first && (alone.first->t < nearest || (alone.first->t == nearest && thing->id < who)))
        nearest = alone.first->t, who = thing->id;
    ASSERT_EQ(hit.first.has_value(), nearest < 1e300);
    EXPECT_TRUE(hit.certified);
    if (hit.first) {
      ++hits;
      EXPECT_EQ(hit.first->t, nearest);
      EXPECT_EQ(*hit.body, who);
    }
    const Sphere ball{test::random_point(crowd.random, 2), crowd.random.uniform(0, 0.5)};
    const Capsule capsule{ball.center, test::random_point(crowd.random, 2), 0.2};
    const HalfSpace behind{test::random_point(crowd.random, 3), crowd.random.uniform(-3, 0)};
    const TouchOptions touch_options{.margin = i % 3 == 0 ? 0.2 : 0.0};
    const auto compare = [&](const auto& shape) {
      ASSERT_TRUE(scene.touch(shape, touch_options));
      std::map<BodyId, double> expected, found;
      for (const auto& thing : crowd.things)
        if (const Touch alone = touch(thing->collider, shape, touch_options); alone.touches)
          expected[thing->id] = alone.deepest->depth;
      for (const SceneTouch& t : scene.touches())
        if (t.touch->touches) found[t.body] = t.touch->deepest->depth;
      EXPECT_EQ(found, expected);
      touched += found.size();
    };
    compare(ball), compare(capsule), compare(behind);
    const Vec3 half = Vec3{0.1, 0.2, 0.1} + Vec3{1, 1, 1} * ball.radius;
    compare(ConvexHull::box({half * -1, half}, RigidTransform::from_axis(behind.normal, 0.1 * i, ball.center)));
  }
  EXPECT_GT(hits, 50u);
  EXPECT_GT(touched, 400u);
  const std::size_t kept = scene.touches().size();
  EXPECT_EQ(scene.touch(Sphere{{}, -1}).code, Status::Code::bad_shape);
  EXPECT_EQ(scene.touch(HalfSpace{{0, 0, 0}, 1}).code, Status::Code::bad_shape);
  EXPECT_EQ(scene.touch(Sphere{}, {.nearest = true}).code, Status::Code::bad_option);
  EXPECT_EQ(scene.touch(ConvexHull::box({{0, 0, 0}, {1, 1, 1}}), {.nearest = true}).code, Status::Code::bad_option);
  EXPECT_EQ(scene.first_hit({{}, {}}).status.code, Status::Code::bad_shape);
  EXPECT_EQ(scene.touches().size(), kept);
  crowd.things[0]->collider.place({.translation = {9, 9, 9}});
  scene.wake(crowd.things[0]->id);
  const SceneStatus stale = scene.touch(Sphere{});
  EXPECT_EQ(stale.code, Status::Code::other_frame);
  EXPECT_EQ(stale.offender, crowd.things[0]->id);
  EXPECT_NE(message(stale).find("Scene::update()"), std::string::npos);
}

TEST(Scene, allocates_nothing_once_it_has_seen_the_motion) {
  std::vector<std::unique_ptr<Thing>> things;
  for (std::size_t i = 0; i < 24; ++i) things.push_back(make_thing(i));
  for (const std::size_t budget : {std::size_t{1500}, std::size_t{0}}) {
    SceneOptions options{.surfaces = true};
    Scene scene(options);
    for (const auto& thing : things) thing->id = scene.add(thing->collider);
    bool good = true;
    std::size_t contacts = 0, began = 0;
    const auto go = [&] {
      for (int step = 0; step < 24; ++step) {
        const double t = std::abs(step - 12) / 12.0;
        for (std::size_t i = 0; i < things.size(); ++i) {
          const double x = static_cast<double>(i % 6), y = static_cast<double>(i / 6);
          things[i]->collider.place({.translation = Vec3{x, y, 0} * (0.7 + 0.9 * t)});
        }
        good = good && scene.update();
        for (const ScenePair& pair : scene.pairs()) contacts += pair.contacts.size(), began += pair.began;
        scene.touch(Sphere{{2, 2, 0}, 1});
        scene.first_hit({{-9, 1, 0.1}, {1, 0, 0}});
      }
    };
    go();
    // Under a budget a pair is left where it was never left before, with more waiting than at the end: all such places
    // are seen once.
    for (std::size_t seen = 200; budget > 0 && seen < 200000; seen += seen / 8) {
      options.budget = seen;
      scene.set_options(options);
      go();
    }
    if (budget > 0) options.budget = budget;
    scene.set_options(options);
    go();
    began = 0;
    const std::size_t before = test::allocations;
    go();
    EXPECT_EQ(test::allocations - before, 0u) << "budget " << budget;
    EXPECT_TRUE(good);
    EXPECT_GT(contacts, 1000u);
    EXPECT_GT(began, 10u);
  }
}

}  // namespace
}  // namespace morula
