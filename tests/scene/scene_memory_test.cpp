// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene holds: a little for each near pair beside the contacts that it lists, and nothing of pairs long apart.
#include <gtest/gtest.h>

#include <map>
#include <support/allocations.hpp>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using namespace test;

constexpr std::size_t kilobyte = 1024;

/// Copies of one body in a cube, each turned and pushed about its place.
class Heap {
 public:
  Heap(int cuts, int depth)
      : mesh_(box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, cuts)),
        body_(mesh_, std::make_shared<const CoveredTree>(
                         build(mesh_, {.method = Method::octree, .branching = 8, .depth = depth}))) {
    for (int i = 0; i < 64; ++i) colliders_.push_back(std::make_unique<Collider>(mesh_, body_));
  }
  void fill(Scene& scene) const {
    for (const auto& collider : colliders_) scene.add(*collider);
  }
  void place(Random& random, double spacing) {
    for (std::size_t i = 0; i < colliders_.size(); ++i) {
      const Vec3 home{static_cast<double>(i % 4), static_cast<double>(i / 4 % 4), static_cast<double>(i / 16)};
      colliders_[i]->set_transform(random_transform(random, 0.1, home * spacing));
    }
  }
  std::size_t facet_count() const { return mesh_.facets.size(); }

 private:
  Mesh mesh_;
  Body body_;
  std::vector<std::unique_ptr<Collider>> colliders_;
};

std::size_t listed_bytes(const Scene& scene) {
  std::size_t bytes = 0;
  for (const ScenePair& pair : scene.pairs())
    bytes += pair.contacts.size_bytes() + pair.surfaces.size_bytes() + pair.crossings.size_bytes();
  return bytes;
}

/// All that a scene can be asked for, without a budget and with one that cuts.
std::vector<SceneOptions> all_options() {
  std::vector<SceneOptions> all;
  for (const bool surfaces : {false, true})
    for (const bool exact : {false, true})
      for (const std::size_t budget : {std::size_t{0}, std::size_t{5000}}) {
        SceneOptions options{.surfaces = surfaces, .find_crossings = exact};
        if (budget > 0) options.budget = budget;
        all.push_back(options);
      }
  return all;
}

TEST(SceneMemory, a_near_pair_of_small_bodies_holds_less_than_16_kilobytes) {
  Heap heap(2, 2);
  ASSERT_EQ(heap.facet_count(), 48u);
  for (const SceneOptions& options : all_options()) {
    Random random(3);
    const std::size_t before = live_bytes;
    Scene scene(options);
    heap.fill(scene);
    std::size_t near = 0;
    for (int frame = 0; frame < 12; ++frame) {
      heap.place(random, 1.0);
      near = std::max(near, scene.update().near_pairs);
    }
    ASSERT_GT(near, 400u);
    ASSERT_GT(scene.pairs().size(), 200u);
    EXPECT_LT((live_bytes - before) / near, 16 * kilobyte) << options.surfaces << options.find_crossings;
  }
}

// Twice: lists grow by doubling.
TEST(SceneMemory, a_near_pair_of_larger_bodies_holds_twice_what_it_lists_and_a_little) {
  Heap heap(7, 3);
  ASSERT_EQ(heap.facet_count(), 588u);
  for (const bool extras : {false, true}) {
    Random random(3);
    heap.place(random, 1.0);
    const std::size_t before = live_bytes;
    Scene scene({.surfaces = extras, .find_crossings = extras});
    heap.fill(scene);
    const std::size_t near = scene.update().near_pairs, listed = listed_bytes(scene);
    ASSERT_GT(near, 400u);
    ASSERT_GT(listed / near, 8 * kilobyte);
    EXPECT_LT(live_bytes - before, 2 * listed + near * 4 * kilobyte);
  }
}

// No frame is like an earlier one.
TEST(SceneMemory, a_scene_with_reserved_memory_allocates_nothing_however_bodies_move) {
  Heap heap(3, 2);
  for (const bool surfaces : {false, true}) {
    Random random(11);
    Scene scene({.surfaces = surfaces});
    scene.reserve({.bodies = 64, .near_pairs = 64 * 63 / 2, .contacts = 512});
    heap.place(random, 1.0);
    const std::size_t before = allocations;
    heap.fill(scene);
    ASSERT_TRUE(scene.update());
    std::size_t warm = allocations, near = 0, contacts = 0, began = 0, ended = 0;
    // A thread reads facets into memory of its own, which grows at first.
    if (!surfaces) {
      EXPECT_EQ(warm - before, 0u);
    }
    for (int frame = 0; frame < 300; ++frame) {
      if (surfaces && frame == 100) warm = allocations;
      // From time to time all are apart for longer than a pair keeps what it holds.
      heap.place(random, frame % 100 < 10 ? 1.0 : frame % 100 < 80 ? 30.0 : random.uniform(0.8, 3.0));
      const SceneStatus status = scene.update();
      ASSERT_TRUE(status);
      if (!surfaces || frame >= 100) {
        ASSERT_EQ(allocations - warm, 0u) << frame;
      }
      near = std::max(near, status.near_pairs), ended += scene.ended().size();
      for (const ScenePair& pair : scene.pairs())
        contacts = std::max(contacts, pair.contacts.size()), began += pair.began;
    }
    EXPECT_GT(near, 400u);
    EXPECT_GT(contacts, 30u);
    EXPECT_LE(contacts, 512u);
    EXPECT_GT(began, 5000u);
    EXPECT_GT(ended, 5000u);
  }
}

// Whatever the large body has per node or facet. A pair under a budget has two lists: of a search that was stopped, and
// of the one that goes on.
TEST(SceneMemory, a_pair_with_a_large_body_holds_less_than_16_kilobytes) {
  const Mesh land = grid_plate(60, 30, 30), small = icosphere(2, 0.6);
  const Body floor(land, build(land, {.method = Method::grid, .branching = 8, .depth = 4}));
  const Body ball(small, build(small, {.method = Method::grid, .branching = 8, .depth = 3}));
  Collider terrain(land, floor);
  ASSERT_GT(terrain.tree().node_count() * 24, 16 * kilobyte);
  std::vector<std::unique_ptr<Collider>> balls;
  for (int i = 0; i < 16; ++i) balls.push_back(std::make_unique<Collider>(small, ball));
  for (const SceneOptions& options : all_options()) {
    Scene scene(options);
    scene.add(terrain, {.is_static = true});
    for (const auto& collider : balls) scene.add(*collider);
    Random random(4);
    const std::size_t before = live_bytes;
    std::map<BodyId, std::size_t> most_listed;
    for (int frame = 0; frame < 12; ++frame) {
      for (std::size_t i = 0; i < balls.size(); ++i)
        balls[i]->set_transform(
            {.translation = Vec3{1.8 * static_cast<double>(i) + 1.5, 2, 0.2} + random_point(random, 0.1)});
      ASSERT_TRUE(scene.update());
      ASSERT_EQ(scene.pairs().size(), balls.size());
      for (const ScenePair& pair : scene.pairs()) {
        std::size_t& most = most_listed[pair.b];
        most = std::max(most, pair.contacts.size_bytes() + pair.surfaces.size_bytes() + pair.crossings.size_bytes());
      }
    }
    std::size_t listed = 0;
    for (const auto& [body, most] : most_listed) listed += most;
    const std::size_t lists = options.budget.is_unlimited() ? 2 : 4;
    EXPECT_LT(live_bytes - before, lists * listed + balls.size() * 16 * kilobyte)
        << options.surfaces << options.find_crossings << !options.budget.is_unlimited();
  }
}

TEST(SceneMemory, pairs_that_are_apart_for_a_while_give_back_what_they_held) {
  Heap heap(2, 2);
  SceneOptions options{.budget = 5000, .surfaces = true, .find_crossings = true};
  Random random(3);
  const std::size_t before = live_bytes;
  Scene scene(options);
  heap.fill(scene);
  std::size_t near = 0;
  for (int frame = 0; frame < 12; ++frame) {
    heap.place(random, 1.0);
    near = std::max(near, scene.update().near_pairs);
  }
  const std::size_t touching = live_bytes - before;
  for (int frame = 0; frame < 70; ++frame) {
    heap.place(random, 30.0);
    ASSERT_TRUE(scene.update());
  }
  ASSERT_TRUE(scene.pairs().empty());
  const std::size_t apart = live_bytes - before;
  EXPECT_LT(apart, touching / 4);
  EXPECT_LT(apart / near, 2 * kilobyte);
  // They come back as what they were.
  heap.place(random, 1.0);
  ASSERT_TRUE(scene.update());
  EXPECT_GT(scene.pairs().size(), 200u);
}

}  // namespace
}  // namespace morula
