// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The life of a rebuild, event by event, as the drawing in rebuild_cycle.hpp has it.
#include "update/rebuild/rebuild_cycle.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <vector>

#include "limb.hpp"

namespace morula {
namespace {

using namespace detail;
using namespace test;
using Event = RebuildCycle::Event;

class Cycle : public testing::Test {
 protected:
  Cycle() {
    options.thread = RebuildThread::host;
    options.executor = [this](std::function<void()> job) { jobs.push_back(std::move(job)); };
  }
  RebuildCycle make() {
    const BuildOptions build{.method = Method::octree, .depth = 2};
    return {options, report, std::make_shared<RebuildJob>(limb(), build, 3, false)};
  }
  void step(RebuildCycle& cycle, Event event) { cycle.step(event, {++frame, limb().positions, Quality::draft}); }
  RebuildJob::Result collect(RebuildCycle& cycle) { return cycle.collect({++frame, limb().positions, Quality::draft}); }

  RebuildOptions options;
  RebuildReport report;
  std::vector<std::function<void()>> jobs;
  std::uint64_t frame = 0;
};

TEST_F(Cycle, takes_three_poses_builds_and_is_collected) {
  RebuildCycle cycle = make();
  step(cycle, Event::frame);
  EXPECT_FALSE(cycle.is_under_way()) << "nothing was wanted";
  step(cycle, Event::wanted);
  EXPECT_TRUE(cycle.is_under_way());
  EXPECT_FALSE(cycle.may_start());
  step(cycle, Event::frame);
  EXPECT_EQ(jobs.size(), 0u);
  step(cycle, Event::frame);
  ASSERT_EQ(jobs.size(), 1u);
  EXPECT_EQ(report.started, 1u);
  step(cycle, Event::frame);
  EXPECT_EQ(jobs.size(), 1u) << "one at a time";
  EXPECT_FALSE(cycle.is_done());
  jobs[0]();
  EXPECT_TRUE(cycle.is_done());
  EXPECT_FALSE(cycle.is_under_way());
  EXPECT_FALSE(cycle.may_start()) << "the result waits";
  EXPECT_NE(cycle.result(), nullptr);
  EXPECT_NE(collect(cycle).tree, nullptr);
  EXPECT_TRUE(cycle.may_start());
  EXPECT_EQ(report.finished, 1u);
  EXPECT_EQ(report.rebuild_frames, 2u) << "the fourth frame has the last pose, the sixth collects";
}

TEST_F(Cycle, takes_one_pose_where_it_does_not_look_ahead) {
  options.look_ahead = false;
  RebuildCycle cycle = make();
  step(cycle, Event::wanted);
  EXPECT_EQ(jobs.size(), 1u);
}

TEST_F(Cycle, forgets_poses_of_a_motion_that_came_to_rest) {
  RebuildCycle cycle = make();
  step(cycle, Event::wanted);
  step(cycle, Event::frame);
  step(cycle, Event::at_rest);
  EXPECT_FALSE(cycle.is_under_way());
  EXPECT_TRUE(cycle.may_start());
  step(cycle, Event::frame);
  EXPECT_EQ(jobs.size(), 0u);
}

TEST_F(Cycle, stops_a_build_at_rest_and_where_the_body_has_stopped) {
  options.look_ahead = false;
  for (const Event event : {Event::at_rest, Event::body_stopped}) {
    RebuildCycle cycle = make();
    report = {};
    step(cycle, Event::wanted);
    step(cycle, event);
    EXPECT_TRUE(cycle.is_under_way()) << "the job has to notice";
    jobs.back()();
    EXPECT_EQ(cycle.result(), nullptr);
    EXPECT_EQ(collect(cycle).tree, nullptr);
    EXPECT_EQ(report.stopped, 1u);
    EXPECT_EQ(report.failed, 0u);
    EXPECT_TRUE(cycle.may_start());
  }
}

TEST_F(Cycle, a_stop_of_one_build_is_not_one_of_the_next) {
  options.look_ahead = false;
  RebuildCycle cycle = make();
  step(cycle, Event::at_rest);
  step(cycle, Event::wanted);
  jobs.back()();
  EXPECT_NE(cycle.result(), nullptr);
}

TEST_F(Cycle, pauses_by_the_share_and_never_starts_without_a_thread) {
  options.look_ahead = false;
  options.processor_share = 1e-9;
  RebuildCycle cycle = make();
  step(cycle, Event::wanted);
  jobs.back()();
  collect(cycle);
  EXPECT_FALSE(cycle.may_start());
  options.thread = RebuildThread::none;
  EXPECT_FALSE(make().may_start());
}

}  // namespace
}  // namespace morula
