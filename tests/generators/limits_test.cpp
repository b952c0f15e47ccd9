// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Stopping, time limits and progress.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/parallel/interrupt.hpp>
#include <numeric>
#include <optional>
#include <thread>
#include <vector>

namespace morula {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

TEST(BuildStop, ends_the_build_soon_after_it_is_requested_from_the_progress_callback) {
  const Mesh mesh = sample_body("limb", 24);
  for (const Method method : {Method::octree, Method::grid, Method::hubbard, Method::medial})
    for (const unsigned threads : {1u, 3u})
      for (const std::optional<std::size_t> spheres : {std::optional<std::size_t>(), std::optional<std::size_t>(300)}) {
        Workers workers(threads);
        StopSource source;
        int calls_after = 0;
        const BuildOptions options{.method = method,
                                   .depth = 4,
                                   .spheres = spheres,
                                   .stop = source.get_token(),
                                   .progress = [&](const BuildProgress& p) {
                                     calls_after += source.stop_requested();
                                     if (p.share > 0) source.request_stop();
                                   }};
        EXPECT_THROW(build(mesh, options, workers), BuildStopped) << name(method);
        EXPECT_EQ(calls_after, 0) << name(method);
      }
}

TEST(BuildStop, is_noticed_between_nodes_when_requested_by_another_thread) {
  const Mesh mesh = sample_body("limb", 24);
  StopSource source;
  std::chrono::steady_clock::time_point requested;
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(60));
    requested = std::chrono::steady_clock::now();
    source.request_stop();
  });
  // Some ten thousand nodes: minutes, if it were not stopped.
  EXPECT_THROW(build(mesh, {.method = Method::medial, .depth = 5, .stop = source.get_token()}), BuildStopped);
  other.join();
  EXPECT_LT(seconds_since(requested), 2.0);  // a node takes some 20 ms; sanitizers and busy machines are slow
}

// Every loop over nodes or facets checks for a stop, not only the one that divides nodes: exchanges between neighbors
// at depth 6 take minutes. The host's executor sees all loops.
TEST(BuildStop, ends_the_loop_in_which_it_is_requested) {
  const Mesh mesh = sample_body("limb", 8);
  std::size_t loops = 0, stop_in = 0;
  StopSource source;
  const auto executor = [&](std::size_t count, const std::function<void(std::size_t)>& chunk) {
    if (++loops == stop_in) source.request_stop();
    for (std::size_t i = 0; i < count; ++i) chunk(i);
  };
  Workers workers(executor, 2);
  BuildOptions options{.method = Method::medial, .branching = 4, .depth = 3};
  const auto build_one = [&] {
    loops = 0;
    source = StopSource();
    options.stop = source.get_token();
    return build(mesh, options, workers);
  };
  EXPECT_EQ(tree_hash(build_one().tree),
            tree_hash(build(mesh, {.method = Method::medial, .branching = 4, .depth = 3}).tree));
  const std::size_t all = loops;
  ASSERT_GT(all, 12u);
  std::vector<std::size_t> tried{1, all / 4, all / 2};
  for (std::size_t last = all - 8; last <= all; ++last) tried.push_back(last);
  for (const std::size_t loop : tried) {
    stop_in = loop;
    EXPECT_THROW(build_one(), BuildStopped) << "loop " << loop << " of " << all;
    EXPECT_EQ(loops, loop) << "loops began after the request";
  }
}

// The callback may write a file or ask a query after its request.
TEST(BuildStop, does_not_end_calls_of_the_callback_and_an_interrupt_of_the_caller_does_both) {
  const Mesh mesh = sample_body("limb", 8);
  struct Cancelled {};
  for (const bool cancels : {false, true}) {
    StopSource source;
    bool cancelled = false;
    int inner = 0;
    const Interrupt interrupt([&] {
      if (cancelled) throw Cancelled();
    });
    const BuildOptions options{
        .method = Method::medial, .depth = 3, .stop = source.get_token(), .progress = [&](const BuildProgress& p) {
          if (!(p.share > 0)) return;
          if (cancels) cancelled = true;
          source.request_stop();
          build(mesh, {.method = Method::octree, .depth = 2}, serial_workers());
          ++inner;
        }};
    if (cancels) {
      EXPECT_THROW(build(mesh, options, serial_workers()), Cancelled);
    } else {
      EXPECT_THROW(build(mesh, options, serial_workers()), BuildStopped);
    }
    EXPECT_EQ(inner, cancels ? 0 : 1);
  }
}

TEST(BuildStop, requested_before_the_build_begins_means_no_work) {
  StopSource source;
  source.request_stop();
  int calls = 0;
  EXPECT_THROW(
      build(sample_body("bar", 4), {.stop = source.get_token(), .progress = [&](const BuildProgress&) { ++calls; }}),
      BuildStopped);
  EXPECT_EQ(calls, 0);
}

// One level, and all of those that are the default.
class Unhindered : public testing::TestWithParam<int> {};

TEST_P(Unhindered, by_a_stop_that_is_never_requested) {
  const Mesh mesh = sample_body("blob", 16);
  const StopSource source;
  EXPECT_EQ(tree_hash(build(mesh, {.depth = GetParam(), .stop = source.get_token()}).tree),
            tree_hash(build(mesh, {.depth = GetParam()}).tree));
}

TEST_P(Unhindered, by_a_time_limit_that_is_not_reached) {
  const Mesh mesh = sample_body("blob", 16);
  const CoveredTree model = build(mesh, {.depth = GetParam(), .time_limit_seconds = 1e6});
  EXPECT_TRUE(model.report.complete);
  EXPECT_EQ(tree_hash(model.tree), tree_hash(build(mesh, {.depth = GetParam()}).tree));
}

INSTANTIATE_TEST_SUITE_P(Quick, Unhindered, testing::Values(1), testing::PrintToStringParamName());
INSTANTIATE_TEST_SUITE_P(Long, Unhindered, testing::Values(3), testing::PrintToStringParamName());

TEST(BuildTimeLimit, leaves_nodes_undivided_and_covers) {
  const Mesh mesh = sample_body("limb", 24);
  for (const Method method : {Method::grid, Method::medial})
    for (const std::optional<std::size_t> spheres : {std::optional<std::size_t>(), std::optional<std::size_t>(2000)}) {
      const auto start = std::chrono::steady_clock::now();
      const CoveredTree model =
          build(mesh, {.method = method, .depth = 6, .spheres = spheres, .time_limit_seconds = 0.1});
      EXPECT_LT(seconds_since(start), 3.0) << name(method);
      EXPECT_TRUE(validate(mesh, model).empty()) << name(method);
      EXPECT_FALSE(model.report.complete) << name(method);
      const auto& notes = model.report.notes;
      EXPECT_TRUE(std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
        return note.find("the time limit of 0.1 s was over") == 0 && note.find("undivided") != std::string::npos;
      })) << name(method);
    }
}

TEST(BuildTimeLimit, of_next_to_nothing_gives_the_root) {
  const Mesh mesh = sample_body("bar", 8);
  for (const std::optional<std::size_t> spheres : {std::optional<std::size_t>(), std::optional<std::size_t>(20)}) {
    const CoveredTree model = build(mesh, {.spheres = spheres, .time_limit_seconds = 1e-9});
    EXPECT_EQ(model.tree.node_count(), 1u);
    EXPECT_TRUE(validate(mesh, model).empty());
    EXPECT_FALSE(model.report.complete);
  }
}

class BuildReported : public testing::TestWithParam<Quality> {};

TEST_P(BuildReported, progress_names_levels_in_order_and_guesses_the_time_left) {
  const Mesh mesh = sample_body("limb", 16);
  for (const std::optional<std::size_t> spheres : {std::optional<std::size_t>(), std::optional<std::size_t>(100)}) {
    std::vector<BuildProgress> seen;
    const CoveredTree model = build(
        mesh,
        {.spheres = spheres, .quality = GetParam(), .progress = [&](const BuildProgress& p) { seen.push_back(p); }});
    ASSERT_GE(seen.size(), 3u);
    EXPECT_EQ(seen.front().share, 0);
    EXPECT_EQ(seen.back().share, 1);
    EXPECT_EQ(seen.back().seconds_left, 0.0);
    // Of a flat set, levels may be pruned again.
    EXPECT_GE(seen.back().level, static_cast<int>(model.tree.level_count()) - 1);
    for (std::size_t i = 1; i < seen.size(); ++i) {
      EXPECT_GE(seen[i].share, seen[i - 1].share);
      EXPECT_GE(seen[i].level, seen[i - 1].level);
      EXPECT_GE(seen[i].seconds_left.value_or(0), 0);
    }
    EXPECT_TRUE(std::any_of(seen.begin(), seen.end() - 1, [](const BuildProgress& p) { return p.seconds_left > 0.0; }));
  }
}

TEST_P(BuildReported, seconds_add_up_to_no_more_than_the_whole) {
  const Mesh mesh = sample_body("limb", 16);
  for (const std::optional<std::size_t> spheres : {std::optional<std::size_t>(), std::optional<std::size_t>(100)}) {
    const auto start = std::chrono::steady_clock::now();
    const CoveredTree model = build(mesh, {.spheres = spheres, .quality = GetParam()});
    const double whole = seconds_since(start);
    ASSERT_EQ(model.report.level_seconds.size(), model.tree.level_count());
    for (const double s : model.report.level_seconds) EXPECT_GE(s, 0);
    const double sum = std::accumulate(model.report.level_seconds.begin(), model.report.level_seconds.end(), 0.0);
    EXPECT_GT(sum, 0);
    EXPECT_LE(sum, whole);
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, BuildReported, testing::Values(Quality::fast),
                         [](const auto& tested) { return std::string(name(tested.param)); });
INSTANTIATE_TEST_SUITE_P(Long, BuildReported, testing::Values(Quality::standard),
                         [](const auto& tested) { return std::string(name(tested.param)); });

TEST(BuildLimits, a_limit_of_no_time_leaves_the_root_and_covers) {
  const Mesh mesh = sample_body("limb", 12);
  const CoveredTree model = build(mesh, {.method = Method::octree, .time_limit_seconds = 0});
  EXPECT_FALSE(model.report.complete);
  EXPECT_EQ(model.tree.node_count(), 1u);
  EXPECT_TRUE(certify(model.cover, mesh.positions, model.tree.spheres).covered);
}

TEST(BuildLimits, refuses_numbers_that_are_none) {
  const Mesh mesh = sample_body("bar", 3);
  for (const double bad : {-1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(build(mesh, {.time_limit_seconds = bad}), std::invalid_argument);
    EXPECT_THROW(build(mesh, {.max_protrusion = bad}), std::invalid_argument);
  }
  EXPECT_THROW(build(mesh, {.max_protrusion = 0}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.spheres = 0}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.spheres = std::numeric_limits<std::size_t>::max()}), std::invalid_argument);
  EXPECT_THROW(build(mesh, {.method = Method::grid, .quality = Quality::best}), std::invalid_argument);
}

// The definition, tried depth by depth with floating-point numbers.
TEST(AutomaticDepth, is_the_deepest_whose_leaves_the_facets_justify) {
  for (int branching = 2; branching <= 64; ++branching)
    for (const double facets :
         {1.0, 12.0, 31.0, 32.0, 255.0, 256.0, 722.0, 2047.0, 2048.0, 5760.0, 87'796.0, 1e7, 4e9}) {
      const auto allowed = [&](int depth) {
        const double leaves = std::pow(branching, depth);
        return depth <= 8 && leaves <= 512 && leaves <= facets / 4;
      };
      const int depth = automatic_depth(static_cast<std::size_t>(facets), branching);
      EXPECT_TRUE(depth == 1 || allowed(depth)) << branching << ' ' << facets;
      EXPECT_FALSE(allowed(depth + 1)) << branching << ' ' << facets;
    }
  EXPECT_EQ(automatic_depth(255, 8), 1);
  EXPECT_EQ(automatic_depth(256, 8), 2);
  EXPECT_EQ(automatic_depth(2048, 8), 3);
  EXPECT_EQ(automatic_depth(std::numeric_limits<std::size_t>::max(), 2), 8);
  EXPECT_EQ(automatic_depth(std::numeric_limits<std::size_t>::max(), 64), 1);
}

TEST(AutomaticDepth, is_what_build_takes_when_none_is_given) {
  const Mesh mesh = sample_body("limb", 8);
  const int depth = automatic_depth(mesh.facet_count(), 6);
  ASSERT_EQ(depth, 2);
  for (const Method method : {Method::octree, Method::grid, Method::optimized}) {
    const Quality quality = method == Method::optimized ? Quality::fast : Quality::standard;
    const CoveredTree model = build(mesh, {.method = method, .branching = 6, .quality = quality});
    EXPECT_EQ(model.report.depth, 2U);
    EXPECT_EQ(tree_hash(model.tree),
              tree_hash(build(mesh, {.method = method, .branching = 6, .depth = depth, .quality = quality}).tree));
  }
}

TEST(BuildLimits, knows_qualities_by_name) {
  for (const Quality quality : all_qualities()) EXPECT_EQ(quality_from_name(name(quality)), quality);
  EXPECT_EQ(quality_from_name("default"), Quality::standard);
  EXPECT_FALSE(quality_from_name("standard").has_value());
}

}  // namespace
}  // namespace morula
