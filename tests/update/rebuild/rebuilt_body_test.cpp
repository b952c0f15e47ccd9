// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whatever happens to trees, every level covers in every frame; and the figures get better for it.
#include <gtest/gtest.h>

#include <chrono>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <stdexcept>
#include <thread>

#include "../bodies.hpp"
#include "limb.hpp"
#include "support/allocations.hpp"

namespace morula {
namespace {

using namespace test;
using Job = std::function<void()>;

constexpr double always = -1e9;  // min_improvement

// A rebuild in every frame, run by the test, and every result taken.
RebuildOptions hosted(std::function<void(Job)> executor) {
  RebuildOptions options{
      .rebuild_every = 1, .min_improvement = always, .look_ahead = false, .thread = RebuildThread::host};
  options.executor = std::move(executor);
  return options;
}

void expect_cover(const RebuiltBody& body, const PositionView& positions, const std::string& where) {
  std::vector<Sphere> spheres;
  body.body().copy_spheres(spheres);
  const Certificate c = certify(body.body().cover(), positions, spheres);
  EXPECT_TRUE(c.covered) << where << ": node " << c.worst_node << " by " << c.worst_excess;
}

TEST(RebuiltBody, covers_in_every_frame_when_every_frame_swaps) {
  for (const Specimen& b : test::specimens()) {
    RebuiltBody body(b.mesh, b.model, {.rebuild_every = 1, .min_improvement = always, .thread = RebuildThread::caller});
    std::uint64_t version = body.tree_version();
    for (const test::Motion& motion : test::motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      const RebuildStatus status = body.update(positions);
      ASSERT_TRUE(status);
      EXPECT_EQ(status.swapped, body.tree_version() != version);
      version = body.tree_version();
      expect_cover(body, positions, b.name + ", " + motion.name);
    }
    EXPECT_GE(body.report().swapped, test::motions().size() - 1) << b.name << ": " << body.report().failure;
  }
}

// In the frame that takes a rebuilt tree, every allocation fails once.
TEST(RebuiltBody, covers_when_memory_runs_out_anywhere_in_a_swap) {
  std::size_t failures = 0;
  for (std::size_t n = 1; n < 1000; ++n) {
    Job job;
    RebuiltBody body(limb(), limb_tree(), hosted([&](Job next) { job = std::move(next); }));
    ASSERT_TRUE(body.update(stretched_limb(0.4)));
    ASSERT_TRUE(job);
    job();
    const std::vector<Vec3> positions = stretched_limb(0.5), later = stretched_limb(0.6);
    const std::size_t failed_before = body.report().failed;
    allocation_to_fail = n;
    const RebuildStatus status = body.update(positions);
    allocation_to_fail = 0;
    ASSERT_TRUE(status);
    expect_cover(body, positions, "allocation " + std::to_string(n));
    const bool has_failed = body.report().failed != failed_before;
    failures += has_failed ? 1 : 0;
    ASSERT_TRUE(body.update(later));
    expect_cover(body, later, "after allocation " + std::to_string(n));
    if (!has_failed) break;
    EXPECT_FALSE(body.report().failure.empty());
  }
  EXPECT_GT(failures, 0u) << "no allocation of a swap failed";
}

TEST(RebuiltBody, covers_under_random_vertex_noise_while_rebuilding) {
  RebuiltBody body(limb(), limb_tree(), {.check_every = 1, .thread = RebuildThread::caller});
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    const auto positions = test::noisy(limb().positions, 0.02 * static_cast<double>(frame % 5), frame);
    ASSERT_TRUE(body.update(positions));
    expect_cover(body, positions, "frame " + std::to_string(frame));
  }
}

TEST(RebuiltBody, is_much_tighter_than_a_fixed_tree_after_a_stretch) {
  RebuiltBody body(limb(), limb_tree(), {.thread = RebuildThread::caller});
  Body fixed(limb(), limb_tree());
  for (int frame = 1; frame <= 24; ++frame) {
    const std::vector<Vec3> positions = stretched_limb(frame / 24.0);
    ASSERT_TRUE(body.update(positions));
    ASSERT_TRUE(fixed.update(positions));
    expect_cover(body, positions, "frame " + std::to_string(frame));
  }
  EXPECT_GT(body.report().swapped, 0u);
  EXPECT_FALSE(body.is_home());
  const double ours = estimate_looseness(limb(), body.body(), stretched_limb(1)).back();
  EXPECT_LT(ours, 0.5 * estimate_looseness(limb(), fixed, stretched_limb(1)).back());
  EXPECT_NEAR(body.report().looseness.back(), ours, 1e-6 * ours);
}

TEST(RebuiltBody, has_the_same_bits_on_every_run_on_the_callers_thread) {
  for (const std::optional<int> every : {std::optional<int>(), std::optional<int>(5)}) {
    std::vector<std::uint64_t> hashes[2];
    for (auto& run : hashes) {
      Workers workers(&run == hashes ? 1 : 3);
      RebuiltBody body(limb(), limb_tree(), {.rebuild_every = every, .thread = RebuildThread::caller});
      for (int frame = 0; frame < 20; ++frame) {
        ASSERT_TRUE(body.update(deform(limb(), {Twist{180}}, frame / 20.0), workers));
        run.push_back(body.body().hash());
      }
      EXPECT_GT(body.report().swapped, 0u);
    }
    EXPECT_EQ(hashes[0], hashes[1]);
  }
}

TEST(RebuiltBody, is_home_at_rest_bit_for_bit_after_any_excursion) {
  std::vector<Vec3f> narrow_rest, narrow_away;
  for (const Vec3& p : limb().positions) narrow_rest.emplace_back(p);
  for (const Vec3& p : stretched_limb(1)) narrow_away.emplace_back(p);
  Body plain(limb(), limb_tree());
  RebuiltBody body(limb(), limb_tree(),
                   {.rebuild_every = 1, .min_improvement = always, .thread = RebuildThread::caller});
  for (const bool narrow : {false, true}) {
    const PositionView rest = narrow ? PositionView(narrow_rest) : PositionView(limb().positions);
    ASSERT_TRUE(plain.update(rest));
    for (int excursion = 0; excursion < 2; ++excursion) {
      ASSERT_TRUE(body.update(narrow_away));
      EXPECT_FALSE(body.is_home());
      const RebuildStatus status = body.update(rest);
      EXPECT_TRUE(status.swapped);
      EXPECT_TRUE(body.is_home());
      EXPECT_EQ(body.body().hash(), plain.hash());
    }
  }
  EXPECT_EQ(body.report().returned_home, 4u);
}

TEST(RebuiltBody, returns_home_near_rest_when_home_is_tighter) {
  RebuiltBody body(limb(), limb_tree(), {.check_every = 1, .thread = RebuildThread::caller});
  for (int frame = 1; frame <= 8; ++frame) ASSERT_TRUE(body.update(stretched_limb(1)));
  ASSERT_FALSE(body.is_home());
  for (int frame = 0; frame < 3; ++frame) ASSERT_TRUE(body.update(stretched_limb(0.001)));
  EXPECT_LT(body.report().looseness.back(),
            1.3 * estimate_looseness(limb(), Body(limb(), limb_tree()), limb().positions).back());
}

TEST(RebuiltBody, keeps_the_last_good_spheres_when_positions_are_bad_also_during_a_rebuild) {
  Job waiting;
  RebuiltBody body(limb(), limb_tree(), hosted([&](Job job) { waiting = std::move(job); }));
  ASSERT_TRUE(body.update(stretched_limb(0.5)));
  ASSERT_TRUE(body.is_rebuilding());
  const std::uint64_t before = body.body().hash();
  std::vector<Vec3> bad = stretched_limb(0.6);
  bad[7].y = std::numeric_limits<double>::quiet_NaN();
  for (const bool finished : {false, true}) {
    if (finished) waiting();
    const RebuildStatus status = body.update(bad);
    EXPECT_EQ(status.update.code, UpdateStatus::Code::non_finite_position);
    EXPECT_EQ(status.update.index, 7u);
    EXPECT_FALSE(status.swapped);
    EXPECT_FALSE(body.update(std::vector<Vec3>(3)));
    EXPECT_EQ(body.body().hash(), before);
  }
  EXPECT_TRUE(body.update(stretched_limb(0.6)).swapped);
  expect_cover(body, stretched_limb(0.6), "after bad positions");
}

TEST(RebuiltBody, hosts_may_run_the_job_late_never_twice_or_after_the_body_is_gone) {
  std::vector<Job> jobs;
  const RebuildOptions options = hosted([&](Job job) { jobs.push_back(std::move(job)); });
  {
    RebuiltBody first(limb(), limb_tree(), options);
    ASSERT_TRUE(first.update(stretched_limb(0.5)));
    RebuiltBody body = std::move(first);
    ASSERT_TRUE(body.update(stretched_limb(0.6)));
    ASSERT_EQ(jobs.size(), 1u) << "one at a time";
    jobs[0]();
    jobs[0]();
    EXPECT_TRUE(body.update(stretched_limb(0.7)).swapped);
    EXPECT_EQ(body.report().rebuild_frames, 2u);
    expect_cover(body, stretched_limb(0.7), "late");
    ASSERT_EQ(jobs.size(), 2u);
  }
  jobs[1]();  // stops at once
}

TEST(RebuiltBody, a_rebuild_that_is_no_longer_wanted_is_given_up) {
  Job waiting;
  RebuiltBody body(limb(), limb_tree(), hosted([&](Job job) { waiting = std::move(job); }));
  ASSERT_TRUE(body.update(stretched_limb(0.5)));
  ASSERT_TRUE(body.update(limb().positions));
  waiting();
  ASSERT_TRUE(body.update(stretched_limb(0.1)));
  EXPECT_EQ(body.report().stopped, 1u);
  EXPECT_EQ(body.report().finished, 0u);
}

RebuildOptions in_every_frame() {
  return {.rebuild_every = 1, .min_improvement = always, .look_ahead = false, .thread = RebuildThread::caller};
}

TEST(RebuiltBody, trees_of_a_builder_that_builds_serve_like_its_own) {
  std::size_t calls = 0;
  RebuildOptions options = in_every_frame();
  options.builder = [&](const MeshView& posed, const BuildOptions& how) {
    ++calls;
    EXPECT_EQ(how.method, Method::optimized);
    EXPECT_EQ(how.quality, Quality::draft);
    return build(posed, how, serial_workers());
  };
  RebuiltBody body(limb(), limb_tree(), options), plain(limb(), limb_tree(), in_every_frame());
  for (int frame = 1; frame <= 5; ++frame) {
    const std::vector<Vec3> positions = stretched_limb(frame / 5.0);
    ASSERT_TRUE(body.update(positions));
    ASSERT_TRUE(plain.update(positions));
    EXPECT_EQ(body.body().hash(), plain.body().hash());
  }
  EXPECT_GT(calls, 0u);
  EXPECT_EQ(calls, body.report().finished);
}

// A tree that does not cover its pose would not break cover in other frames, but its figures would be wrong.
TEST(RebuiltBody, a_builder_that_fails_costs_the_rebuild_alone) {
  const auto failure_of = [](const auto& builder) {
    RebuildOptions options = in_every_frame();
    options.builder = builder;
    RebuiltBody body(limb(), limb_tree(), options);
    const std::vector<Vec3> positions = stretched_limb(0.7);
    EXPECT_TRUE(body.update(positions));
    expect_cover(body, positions, "after a failed rebuild");
    EXPECT_TRUE(body.is_home());
    EXPECT_EQ(body.report().failed, 1u);
    EXPECT_EQ(body.report().swapped, 0u);
    return body.report().failure;
  };
  EXPECT_EQ(
      failure_of([](const MeshView&, const BuildOptions&) -> CoveredTree { throw std::runtime_error("no tree"); }),
      "no tree");
  EXPECT_EQ(failure_of([](const MeshView&, const BuildOptions&) -> CoveredTree { throw 7; }),
            "an exception of another type than std::exception");
  EXPECT_EQ(failure_of([](const MeshView&, const BuildOptions&) {
              return limb_tree();
            }).rfind("rebuild: the builder's tree: ", 0),
            0u)
      << "it is of the limb at rest";
}

// To look ahead takes three poses. A motion that is over after one of them leaves nothing behind that the next waits
// for.
TEST(RebuiltBody, poses_of_a_motion_that_came_to_rest_are_not_waited_for) {
  std::size_t jobs = 0;
  RebuildOptions options{.rebuild_every = 1, .thread = RebuildThread::host};
  options.executor = [&](const Job&) { ++jobs; };
  RebuiltBody body(limb(), limb_tree(), options);
  for (const int frames : {1, 2}) {
    for (int frame = 1; frame <= frames; ++frame) ASSERT_TRUE(body.update(stretched_limb(frame / 10.0)));
    EXPECT_TRUE(body.is_rebuilding());
    EXPECT_EQ(jobs, 0u);
    ASSERT_TRUE(body.update(limb().positions));
    EXPECT_FALSE(body.is_rebuilding());
    ASSERT_TRUE(body.update(limb().positions));
  }
  for (int frame = 1; frame <= 5; ++frame) {
    ASSERT_TRUE(body.update(stretched_limb(frame / 10.0)));
    EXPECT_EQ(jobs, frame < 3 ? 0u : 1u) << "poses at frames 1, 2 and 3";
  }
}

TEST(RebuiltBody, pauses_between_rebuilds_as_long_as_the_share_says) {
  RebuildOptions options{.rebuild_every = 1, .look_ahead = false, .processor_share = 1e-9};
  options.thread = RebuildThread::host;
  options.executor = [](const Job& job) { job(); };
  RebuiltBody body(limb(), limb_tree(), options);
  for (int frame = 1; frame <= 10; ++frame) ASSERT_TRUE(body.update(stretched_limb(frame / 10.0)));
  EXPECT_EQ(body.report().started, 1u);
  EXPECT_EQ(body.report().finished, 1u);
}

TEST(RebuiltBody, looks_ahead_to_where_the_motion_will_be) {
  double off[2];
  for (const bool ahead : {false, true}) {
    Job waiting;
    RebuildOptions options{.check_every = 1, .look_ahead = ahead, .thread = RebuildThread::host};
    options.executor = [&](Job job) { waiting = std::move(job); };
    RebuiltBody body(limb(), limb_tree(), options);
    for (int frame = 1; frame <= 17; ++frame) ASSERT_TRUE(body.update(stretched_limb(frame / 40.0)));
    ASSERT_TRUE(waiting);
    waiting();
    ASSERT_TRUE(body.update(stretched_limb(18 / 40.0)));
    EXPECT_EQ(body.report().swapped, 1u);
    off[ahead ? 1 : 0] = body.report().looseness.back();
  }
  EXPECT_LT(off[1], off[0]);
}

TEST(RebuiltBody, settles_once_where_the_motion_ends_and_then_leaves_it_be) {
  RebuiltBody body(limb(), limb_tree(), {.rebuild_threshold = 100, .check_every = 1, .thread = RebuildThread::caller});
  for (int frame = 0; frame < 10; ++frame) ASSERT_TRUE(body.update(stretched_limb(1)));
  EXPECT_EQ(body.report().started, 1u);
  EXPECT_EQ(body.report().swapped, 1u);
}

TEST(RebuiltBody, refuses_options_out_of_range) {
  for (const RebuildOptions& bad :
       {RebuildOptions{.rebuild_threshold = 1}, RebuildOptions{.check_every = 0}, RebuildOptions{.rebuild_every = 0},
        RebuildOptions{.min_improvement = 1}, RebuildOptions{.processor_share = 0},
        RebuildOptions{.processor_share = 1.1}, RebuildOptions{.thread = RebuildThread::host}})
    EXPECT_THROW(RebuiltBody(limb(), limb_tree(), bad), std::invalid_argument);
}

#ifdef MORULA_THREADS

TEST(RebuiltBodyThreads, swaps_in_what_the_background_built_and_covers_all_along) {
  RebuiltBody body(limb(), limb_tree(), {.check_every = 1});
  bool seen = false;
  for (int frame = 1; frame <= 4000 && !seen; ++frame) {
    const std::vector<Vec3> positions = stretched_limb(std::min(1.0, frame / 50.0));
    const RebuildStatus status = body.update(positions);
    ASSERT_TRUE(status);
    expect_cover(body, positions, "frame " + std::to_string(frame));
    seen = status.swapped;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_TRUE(seen);
  EXPECT_GT(body.report().finished, 0u);
}

TEST(RebuiltBodyThreads, a_body_may_die_at_any_moment_of_a_rebuild) {
  const Mesh mesh = sample_body("limb", 40);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  const std::vector<Vec3> away = deform(mesh, {Stretch{2}}, 1);
  for (const int milliseconds : {0, 1, 5, 20, 60, 150}) {
    RebuiltBody body(mesh, model, {.rebuild_every = 1, .look_ahead = false});
    ASSERT_TRUE(body.update(away));
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  }
}

#else

TEST(RebuiltBodyThreads, are_refused_where_there_are_none) {
  EXPECT_THROW(RebuiltBody(limb(), limb_tree()), std::invalid_argument);
}

#endif

}  // namespace
}  // namespace morula
