// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// No update allocates: every one is counted.
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <morula/update/kdop_tree.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <support/allocations.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::allocations;

TEST(Allocation, no_update_allocates_good_or_bad) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens()) {
    const std::vector<Vec3> good = test::noisy(b.mesh.positions, 0.1, 1);
    std::vector<Vec3> bad = good;
    bad[b.mesh.facets[0][0]].x = std::numeric_limits<double>::infinity();
    const std::vector<Vec3> short_one(2);
    std::vector<UpdateOptions> all_options;
    for (const Rule rule : position_rules()) all_options.push_back({.rules = {rule}, .details = {}});
    all_options.push_back({.rules = {Rule::approach1, Rule::exact, Rule::approach2}, .details = {}});
    all_options.push_back({.rules = {Rule::approach2}, .conservative = true, .details = {}});
    for (const UpdateOptions& options : all_options) {
      const Body made(b.mesh, b.model, options);
      Body body = made;  // a copy has the same room
      for (Workers* workers : {&serial_workers(), &three}) {
        const VertexRange range{1, 3};
        const std::size_t before = allocations;
        const bool ok = body.update(good, *workers) && body.update(good, std::span(&range, 1), *workers) &&
                        body.update_lazily(good, 0, *workers) && body.refresh_children(0) <= b.model.tree.branching;
        const bool refused = !body.update(bad, *workers) && !body.update(short_one, *workers);
        const std::size_t after = allocations;
        EXPECT_TRUE(ok && refused);
        EXPECT_EQ(after - before, 0u) << b.name;
      }
    }
  }
  EXPECT_GT(allocations, 0u) << "the counter counts";
}

// A crowd of copies has one set of modes, skin and training poses.
TEST(Allocation, copies_of_a_body_share_their_options) {
  const test::Specimen& b = test::specimens()[0];
  const Skin skin = sample_skin(b.mesh.positions);
  auto made = std::make_unique<Body>(
      b.mesh, b.model,
      UpdateOptions{
          .rules = {Rule::skinned}, .details = {}, .skin = skin, .training = sample_bones(b.mesh.positions, 100)});
  Body copy = *made;
  EXPECT_EQ(copy.options().training.data(), made->options().training.data());
  const AffineTransform* training = copy.options().training.data();
  made.reset();
  EXPECT_EQ(copy.options().training.data(), training);
  EXPECT_EQ(copy.options().training, sample_bones(b.mesh.positions, 100));
  EXPECT_TRUE(copy.update_skinned(std::vector<AffineTransform>(skin.bone_count)));
}

TEST(Allocation, no_estimate_of_looseness_allocates) {
  std::vector<test::Specimen> bodies = test::specimens();
  const Mesh blob = sample_body("blob", 40);
  bodies.push_back({"blob of many spheres", blob, build(blob, {.method = Method::octree, .depth = 5})});
  for (const test::Specimen& b : bodies) {
    const Body body(b.mesh, b.model);
    LoosenessEstimator estimator(b.mesh);
    estimator.reserve(b.model.tree.node_count());
    std::vector<double> figures(b.model.tree.level_count());
    const std::size_t before = allocations;
    estimator.pose(b.mesh.positions);
    estimator.estimate(body, figures);
    estimator.begin(b.mesh.positions, body, 3);
    while (!estimator.step(figures)) {
    }
    const std::size_t after = allocations;
    EXPECT_EQ(after - before, 0u) << b.name;
  }
}

TEST(Allocation, no_modal_update_allocates_good_or_bad) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens()) {
    const Modes modes = test::smooth_modes(b.mesh, 4);
    const std::vector<double> good{0.3, -0.2, 0.0, 0.1}, bad{0.3, std::numeric_limits<double>::infinity(), 0.0, 0.1};
    for (const std::vector<Rule>& rules : {std::vector{Rule::modal}, std::vector{Rule::exact, Rule::modal},
                                           std::vector{Rule::approach2, Rule::modal}, std::vector{Rule::exact}}) {
      Body body(b.mesh, b.model, {.rules = rules, .modes = modes});
      for (Workers* workers : {&serial_workers(), &three}) {
        const std::size_t before = allocations;
        const bool ok = static_cast<bool>(body.update_modal(good, *workers));
        const bool refused =
            !body.update_modal(bad, *workers) && !body.update_modal(std::span(good).first(3), *workers);
        body.modal_sphere(static_cast<std::uint32_t>(body.spheres().size() - 1), good);
        const std::size_t after = allocations;
        EXPECT_TRUE(ok && refused);
        EXPECT_EQ(after - before, 0u) << b.name;
      }
    }
  }
}

TEST(Allocation, no_update_of_k_dops_allocates_through_an_index_map) {
  Workers three(3);
  for (const test::Specimen& b : test::specimens()) {
    std::vector<std::uint32_t> index(b.mesh.vertex_count());
    for (std::uint32_t i = 0; i < index.size(); ++i) index[i] = i;
    const PositionView view = PositionView::indexed(b.mesh.positions, index);
    Body body(b.mesh, b.model);
    KDopTree boxes(b.mesh, b.model, 6), dops(b.mesh, b.model, 26);
    const std::size_t before = allocations;
    const bool ok = body.update(view, three) && boxes.update(view, three) && dops.update(view);
    const std::size_t after = allocations;
    EXPECT_TRUE(ok);
    EXPECT_EQ(after - before, 0u) << b.name;
  }
}

// Nor does a body that rebuilds, but in the frame that starts a rebuild.
TEST(Allocation, rebuilding_allocates_only_where_a_rebuild_starts) {
  const test::Specimen& b = test::specimens()[2];
  std::function<void()> never_run;
  RebuildOptions options{.check_every = 1, .thread = RebuildThread::host};
  options.executor = [&](std::function<void()> job) { never_run = std::move(job); };
  RebuiltBody body(b.mesh, b.model, options);
  const std::vector<Vec3> away = test::noisy(b.mesh.positions, 0.2, 1);
  std::size_t starts = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const std::vector<Vec3>& positions = frame % 4 == 3 ? b.mesh.positions : away;
    const std::size_t started = body.report().started, before = allocations;
    const bool ok = static_cast<bool>(body.update(positions));
    const std::size_t after = allocations;
    EXPECT_TRUE(ok);
    if (body.report().started == started) {
      EXPECT_EQ(after - before, 0u) << "frame " << frame;
    } else {
      ++starts;
    }
  }
  EXPECT_EQ(starts, 1u);
  EXPECT_GT(body.report().checks, 4u);
}

// Nor do leaves that are fitted.
TEST(Allocation, high_effort_allocates_nothing) {
  for (const test::Specimen& b : test::specimens()) {
    RebuiltBody body(b.mesh, b.model, {.effort = RebuildEffort::high, .thread = RebuildThread::none});
    std::vector<std::vector<Vec3>> frames;
    for (std::uint64_t frame = 0; frame < 12; ++frame)
      frames.push_back(frame == 8 ? b.mesh.positions
                                  : test::noisy(test::motions()[4].apply(b.mesh.positions), 0.1, frame));
    const std::size_t before = allocations;
    bool ok = true;
    for (const auto& positions : frames) ok = body.update(positions) && ok;
    const std::size_t after = allocations;
    EXPECT_TRUE(ok);
    EXPECT_EQ(after - before, 0u) << b.name;
  }
}

// Nor a change to the tree of a known pose and back, nor a look at it.
TEST(Allocation, known_poses_allocate_nothing) {
  const test::Specimen& b = test::specimens()[2];
  CoveredTree model = b.model;
  const std::vector<Vec3> away = test::scaled(b.mesh.positions, 2);
  model.poses.push_back(
      {"twice as large", away,
       std::make_shared<const CoveredTree>(build({away, b.mesh.facets}, {.method = Method::octree, .depth = 2}))});
  RebuiltBody body(b.mesh, model, {.thread = RebuildThread::none});
  const std::vector<Vec3> near = test::noisy(away, 0.01, 1);
  const std::size_t before = allocations;
  bool ok = true;
  for (int frame = 0; frame < 20; ++frame) {
    const int turn = frame % 7;
    ok = body.update(turn == 6 ? b.mesh.positions : turn == 4 ? away : near) && ok;
  }
  const std::size_t after = allocations;
  EXPECT_TRUE(ok);
  EXPECT_EQ(after - before, 0u);
  EXPECT_GT(body.report().pose_switches, 1u);
  EXPECT_GT(body.report().checks, 3u);
}

TEST(Allocation, updates_are_noexcept) {
  EXPECT_TRUE(noexcept(std::declval<Body&>().update_modal({}, std::declval<Workers&>())));
  EXPECT_TRUE(noexcept(std::declval<const Body&>().modal_sphere(0, {})));
  EXPECT_TRUE(noexcept(std::declval<Body&>().update(std::declval<const PositionView&>(), std::declval<Workers&>())));
  EXPECT_TRUE(
      noexcept(std::declval<RebuiltBody&>().update(std::declval<const PositionView&>(), std::declval<Workers&>())));
}

}  // namespace
}  // namespace morula
