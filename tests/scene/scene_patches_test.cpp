// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of a scene: those of boxes by hand, those of a query, or contacts that bound all crossings.
#include <gtest/gtest.h>

#include <chrono>
#include <morula/collide/contact_patches.hpp>
#include <set>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using test::Crossed;
using test::Crowd;
using test::Thing;
using namespace std::chrono_literals;

/// The volume that two boxes with their edges along the axes share.
double common_volume(const Vec3& extent, const Vec3& shift) {
  double volume = 1;
  for (int axis = 0; axis < 3; ++axis) volume *= std::max(0.0, extent[axis] - std::abs(shift[axis]));
  return volume;
}

TEST(ScenePatches, of_boxes_are_those_by_hand) {
  const Mesh box = test::box_mesh({-0.7, -0.4, -0.3}, {0.7, 0.4, 0.3}, 2);
  std::vector<std::unique_ptr<Thing>> things;
  Scene scene({.patches = true});
  Random random(4);
  for (int i = 0; i < 12; ++i) {
    things.push_back(std::make_unique<Thing>(box));
    things.back()->id = scene.add(things.back()->collider, {.user_data = static_cast<std::uint64_t>(i)});
  }
  std::size_t overlapping = 0;
  for (int frame = 0; frame < 20; ++frame) {
    for (const auto& thing : things) thing->collider.set_transform({.translation = test::random_point(random, 1.5)});
    ASSERT_TRUE(scene.update());
    for (std::size_t i = 0; i < things.size(); ++i)
      for (std::size_t j = i + 1; j < things.size(); ++j) {
        const double volume = common_volume(
            {1.4, 0.8, 0.6}, things[i]->collider.transform().translation - things[j]->collider.transform().translation);
        const ScenePair* const pair = scene.find(things[i]->id, things[j]->id);
        if (pair == nullptr) {
          EXPECT_EQ(volume, 0);
          continue;
        }
        ASSERT_TRUE(pair->has_patches);
        double sum = 0;
        for (const ContactPatch& patch : pair->patches) {
          sum += patch.volume;
          EXPECT_LE(patch.points.size(), 4u);
          EXPECT_GT(patch.depth, 0);
        }
        EXPECT_NEAR(sum, volume, 1e-14);
        overlapping += volume > 0;
      }
  }
  EXPECT_GT(overlapping, 50u);
}

/// Checks all pairs of a scene: patches are those of a query for these bodies, or contacts hold all crossings.
struct Checked {
  std::size_t with_patches = 0, bounded = 0, open = 0;
  void check(const Scene& scene, const Crowd& crowd) {
    for (std::size_t i = 0; i < crowd.things.size(); ++i)
      for (std::size_t j = i + 1; j < crowd.things.size(); ++j) {
        const bool swapped = crowd.things[j]->id.place < crowd.things[i]->id.place;
        const Thing &x = *crowd.things[swapped ? j : i], &y = *crowd.things[swapped ? i : j];
        if (!crowd.may_meet(x, y)) continue;
        check(scene.find(x.id, y.id), x, y);
      }
  }
  void check(const ScenePair* pair, const Thing& x, const Thing& y) {
    const std::vector<Crossed> crossed = test::crossings_by_force(x.collider, y.collider);
    if (pair == nullptr) {
      EXPECT_TRUE(crossed.empty());
      return;
    }
    for (const Crossed& point : crossed) EXPECT_TRUE(test::is_within(point, *pair, x.collider, y.collider));
    const bool is_open = x.mesh.facets.size() == 32 || y.mesh.facets.size() == 32;  // a plate
    if (!pair->has_patches) {
      EXPECT_TRUE(pair->patches.empty());
      (is_open ? open : bounded) += !crossed.empty();
      return;
    }
    ++with_patches;
    ContactPatchQuery query(x.collider, y.collider);
    ASSERT_TRUE(query.run());
    std::multiset<double> volumes, expected;
    std::size_t nodes = 0;
    for (const ContactPatch& patch : pair->patches) volumes.insert(patch.volume), nodes += patch.crossing_count;
    for (const ContactPatch& patch : query.patches()) expected.insert(patch.volume);
    EXPECT_EQ(volumes, expected);
    EXPECT_EQ(nodes > 0, !crossed.empty());
  }
};

TEST(ScenePatches, are_those_of_a_query_or_contacts_hold_all_crossings) {
  std::int64_t readings = 0;
  const Clock clock = [&] { return std::chrono::nanoseconds(1000 * readings++); };
  const Clock quick_clock = [&] { return std::chrono::nanoseconds(10 * readings++); };
  struct Case {
    SceneOptions options;
    std::size_t some_bounded, some_with_patches;
  };
  const Case cases[] = {{{.patches = true}, 0, 30},
                        {{.budget = 2000, .patches = true}, 10, 30},
                        {{.budget = 300us, .patches = true, .clock = clock}, 10, 30},
                        {{.budget = 6us, .patches = true, .clock = quick_clock}, 10, 10},
                        {{.budget = 3ms, .surfaces = true, .patches = true, .clock = clock}, 0, 30}};
  for (const Case& c : cases) {
    Crowd crowd(5);
    Scene scene(c.options);
    Checked checked;
    for (int frame = 0; frame < 60; ++frame) {
      crowd.step(scene, true);
      ASSERT_TRUE(scene.update());
      checked.check(scene, crowd);
    }
    EXPECT_GE(checked.with_patches, c.some_with_patches);
    EXPECT_GE(checked.bounded, c.some_bounded);
    EXPECT_GT(checked.open, 10u);
  }
}

TEST(ScenePatches, are_the_same_for_any_number_of_workers) {
  const auto run = [](Workers& workers) {
    Crowd crowd(8);
    Scene scene({.budget = 3000, .patches = true});
    std::vector<double> numbers;
    for (int frame = 0; frame < 30; ++frame) {
      crowd.step(scene, true);
      EXPECT_TRUE(scene.update(workers));
      for (const ScenePair& pair : scene.pairs()) {
        numbers.push_back(pair.has_patches);
        for (const ContactPatch& patch : pair.patches)
          numbers.insert(numbers.end(), {patch.volume, patch.depth, patch.normal.x, double(patch.id)});
      }
    }
    return numbers;
  };
  Workers two(2), three(3);
  const std::vector<double> alone = run(serial_workers());
  EXPECT_GT(alone.size(), 100u);
  EXPECT_EQ(alone, run(two));
  EXPECT_EQ(alone, run(three));
}

TEST(ScenePatches, of_bodies_at_rest_stay_and_follow_options) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.9, 0.1, 0})), plate(test::grid_plate(4, 1.4, 1.0));
  Scene scene({.patches = true});
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider), id_plate = scene.add(plate.collider);
  ASSERT_TRUE(scene.update());
  const auto patches = [&] { return scene.find(id_a, id_b)->patches; };
  ASSERT_EQ(patches().size(), 1u);
  const double volume = patches()[0].volume;
  const std::uint32_t id = patches()[0].id;
  EXPECT_FALSE(scene.find(id_a, id_plate)->has_patches) << "an open surface";
  EXPECT_FALSE(scene.find(id_a, id_plate)->contacts.empty());
  scene.sleep(id_a), scene.sleep(id_b);
  for (int frame = 0; frame < 3; ++frame) {
    ASSERT_TRUE(scene.update());
    ASSERT_EQ(patches().size(), 1u);
    EXPECT_EQ(patches()[0].volume, volume);
  }
  scene.wake(id_b);
  b.collider.set_transform({.translation = {-0.05, 0, 0}});
  ASSERT_TRUE(scene.update());
  EXPECT_GT(patches()[0].volume, volume);
  EXPECT_EQ(patches()[0].id, id);
  scene.set_options({.patches = true, .patch_points = 2, .patch_depths = false});
  ASSERT_TRUE(scene.update());
  EXPECT_LE(patches()[0].points.size(), 2u);
  EXPECT_EQ(patches()[0].depth, 0);
  scene.set_options({});
  ASSERT_TRUE(scene.update());
  EXPECT_TRUE(patches().empty());
  EXPECT_FALSE(scene.find(id_a, id_b)->has_patches);
  EXPECT_THROW(scene.set_options({.patch_points = 17}), std::invalid_argument);
  EXPECT_THROW(Scene({.patch_points = 17}), std::invalid_argument);
}

// A body that is replaced at the same address, by one with other facets.
TEST(ScenePatches, follow_a_body_that_is_replaced_in_place) {
  Thing a(test::icosphere(2, 0.6)), round(test::icosphere(1, 0.6, {0.9, 0.1, 0})),
      square(test::box_mesh({0.5, -0.4, -0.3}, {1.4, 0.4, 0.3}, 3));
  std::optional<Collider> side;
  side.emplace(round.mesh, round.body);
  Scene scene({.patches = true});
  const BodyId id_a = scene.add(a.collider), id = scene.add(*side);
  for (Thing* const thing : {&square, &round, &square}) {
    side.emplace(thing->mesh, thing->body);
    scene.replace(id, *side);
    ASSERT_TRUE(scene.update());
    ContactPatchQuery query(a.collider, *side);
    ASSERT_TRUE(query.run());
    const ScenePair* const pair = scene.find(id_a, id);
    ASSERT_EQ(pair->patches.size(), 1u);
    EXPECT_EQ(pair->patches[0].volume, query.patches()[0].volume);
  }
}

// Another body of the same model, in the same frame and at the same address.
TEST(ScenePatches, follow_a_body_that_is_replaced_by_one_of_the_same_model) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.9, 0.1, 0}));
  Body other(b.mesh, b.model);
  std::vector<Vec3> near = b.mesh.positions;
  for (Vec3& p : near) p.x -= 0.1;
  ASSERT_TRUE(b.body.update(b.mesh.positions) && other.update(near));
  std::optional<Collider> side;
  side.emplace(b.mesh, b.body);
  Scene scene({.patches = true});
  const BodyId id_a = scene.add(a.collider), id = scene.add(*side);
  ASSERT_TRUE(scene.update());
  const double volume = scene.find(id_a, id)->patches[0].volume;
  side.emplace(b.mesh, other);
  scene.replace(id, *side);
  ASSERT_TRUE(scene.update());
  EXPECT_GT(scene.find(id_a, id)->patches[0].volume, 1.1 * volume);
}

// A body that is moved while it sleeps has contacts of the pose in which it was read, so no patches of another pose.
TEST(ScenePatches, of_a_sleeping_body_that_was_moved_wait_until_it_is_read) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.9, 0.1, 0}));
  Scene scene({.patches = true});
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  scene.sleep(id_b);
  ASSERT_TRUE(scene.update());
  EXPECT_TRUE(scene.find(id_a, id_b)->has_patches);
  b.collider.set_transform({.translation = {-0.3, 0, 0}});
  ASSERT_TRUE(scene.update());
  EXPECT_FALSE(scene.find(id_a, id_b)->has_patches);
  a.collider.set_transform({.translation = {0.001, 0, 0}});
  ASSERT_TRUE(scene.update());
  EXPECT_FALSE(scene.find(id_a, id_b)->has_patches);
  scene.wake(id_b);
  ASSERT_TRUE(scene.update());
  EXPECT_TRUE(scene.find(id_a, id_b)->has_patches);
}

// A body that turns inside out keeps contacts, and gets patches when it turns back.
TEST(ScenePatches, leave_contacts_for_a_body_that_is_inside_out) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.9, 0.1, 0}));
  Scene scene({.patches = true});
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  for (const double sign : {1.0, -1.0, -1.0, 1.0}) {
    std::vector<Vec3> moved = b.mesh.positions;
    for (Vec3& p : moved) p.z *= sign;
    ASSERT_TRUE(b.body.update(moved));
    ASSERT_TRUE(scene.update());
    ASSERT_TRUE(scene.update());
    EXPECT_EQ(scene.find(id_a, id_b)->has_patches, sign > 0);
    EXPECT_FALSE(scene.find(id_a, id_b)->contacts.empty());
  }
}

TEST(ScenePatches, come_again_after_a_clock_that_throws) {
  Thing a(test::icosphere(2, 0.6)), b(test::icosphere(2, 0.6, {0.9, 0.1, 0}));
  int readings = 0, failing = -1;
  const Clock clock = [&] {
    if (readings++ == failing) throw std::runtime_error("no time");
    return std::chrono::nanoseconds(readings);
  };
  Scene scene({.budget = 1ms, .patches = true, .clock = clock});
  const BodyId id_a = scene.add(a.collider), id_b = scene.add(b.collider);
  for (failing = 0; failing < 80; failing += 3) {
    readings = 0;
    a.collider.set_transform({.translation = {0.001 * failing, 0, 0}});
    const bool good = [&] {
      try {
        return static_cast<bool>(scene.update());
      } catch (const std::runtime_error&) {
        return false;
      }
    }();
    EXPECT_EQ(scene.pairs().empty(), !good);
    readings = failing + 1;
    ASSERT_TRUE(scene.update());
    ASSERT_TRUE(scene.find(id_a, id_b)->has_patches);
    EXPECT_EQ(scene.find(id_a, id_b)->patches.size(), 1u);
  }
}

// Another body of the same tree in the same frame, then one with other facets.
TEST(ScenePatches, follow_an_assignment_to_a_collider) {
  const Vec3 half{0.5, 0.5, 0.5}, small{0.4, 0.4, 0.4};
  Thing still(test::box_mesh(-half, half, 2)), moving(test::box_mesh(-half, half, 2)),
      finer(test::box_mesh(-small, small, 6));
  Body narrow(moving.mesh, moving.model);
  ASSERT_TRUE(moving.body.update(moving.mesh.positions));
  std::vector<Vec3> thin = moving.mesh.positions;
  for (Vec3& p : thin) p.x *= 0.5;
  ASSERT_TRUE(narrow.update(thin));
  Scene scene({.patches = true});
  const RigidTransform beside{.translation = {0.7, 0.1, 0.2}};
  moving.collider.set_transform(beside);
  const BodyId a = scene.add(still.collider), b = scene.add(moving.collider);
  const auto volume = [&] {
    EXPECT_TRUE(scene.update());
    const ScenePair* pair = scene.find(a, b);
    return pair != nullptr && pair->has_patches && pair->patches.size() == 1 ? pair->patches[0].volume : -1;
  };
  EXPECT_NEAR(volume(), 0.3 * 0.9 * 0.8, 1e-6);
  const auto assign = [&](Collider other) {
    other.set_transform(beside);
    moving.collider = other;
  };
  assign(Collider(moving.mesh, narrow));
  EXPECT_NEAR(volume(), 0.05 * 0.9 * 0.8, 1e-6);
  assign(finer.collider);
  EXPECT_NEAR(volume(), 0.2 * 0.8 * 0.7, 1e-6);
}

TEST(ScenePatches, a_query_refuses_a_collider_that_another_was_assigned_to) {
  Thing still(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2)), other(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 5));
  Collider moving = still.collider;
  moving.set_transform({.translation = {0.5, 0.3, 0.2}});
  ContactPatchQuery query(still.collider, moving);
  ASSERT_TRUE(query.run());
  moving = other.collider;
  EXPECT_EQ(query.run().code, Status::Code::body_replaced);
}

TEST(ScenePatches, lists_of_pairs_follow_reserve) {
  Thing still(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2)), moving(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2));
  moving.collider.set_transform({.translation = {1.5, 0.3, 0.2}});
  Scene scene({.surfaces = true});
  scene.add(still.collider), scene.add(moving.collider);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  const std::vector<Contact> contacts(scene.pairs()[0].contacts.begin(), scene.pairs()[0].contacts.end());
  const std::size_t surfaces = scene.pairs()[0].surfaces.size();
  ASSERT_GT(surfaces, 0u);
  const Contact* before = scene.pairs()[0].contacts.data();
  scene.reserve({.bodies = 10, .near_pairs = 20, .contacts = 100000});
  const ScenePair& pair = scene.pairs()[0];
  EXPECT_NE(pair.contacts.data(), before) << "the list has not moved, so the test is none";
  ASSERT_EQ(pair.contacts.size(), contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) EXPECT_EQ(pair.contacts[i].point, contacts[i].point);
  EXPECT_EQ(pair.surfaces.size(), surfaces);
}

}  // namespace
}  // namespace morula
