// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario rebuild: one second of motion at 60 frames a second and one of rest at its end, with rebuilds on a second
// core or a share of one as they come, with trees for principal strains, or with trees made beforehand for poses of the
// motion and nothing rebuilt, each with standard and high effort; leaf looseness beside a fresh build's at the same
// pose, and beside approach 2, which may leave surface uncovered; and how long the longest frame takes beside the
// median one.
#include <algorithm>
#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/update/known_poses.hpp>
#include <morula/update/rebuilt_body.hpp>

#include "paced_thread.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr int frames_per_second = 60;
constexpr std::size_t frame_count = 2 * frames_per_second;

// A fresh build takes longer than all else. Runs of few repeats are for checking, not for figures.
std::size_t compared_every(const Settings& settings) {
  return settings.repeats < 5 ? 20 : 4;
}

struct NamedMotion {
  std::string name;
  Deformation deformation;
};

struct Setting {
  std::string name;
  const CoveredTree* home;  // with the trees that were made beforehand
  double core;              // share of a second core that rebuilds get; 0: nothing is rebuilt
};

std::vector<Vec3f> frame_at(const Mesh& mesh, const Deformation& deformation, std::size_t frame) {
  const double t = std::min(1.0, static_cast<double>(frame) / frames_per_second);
  std::vector<Vec3f> positions;
  for (const Vec3& p : deform(mesh, {deformation}, t)) positions.emplace_back(p);
  return positions;
}

Mesh mesh_at(const Mesh& mesh, const std::vector<Vec3f>& positions) {
  Mesh moved{{}, mesh.facets};
  for (const Vec3f& p : positions) moved.positions.emplace_back(p);
  return moved;
}

struct RebuiltFrame {
  std::vector<Vec3f> positions;
  SphereTree tree{};
  double estimate = 0;  // of the leaf level
};

class Comparison {
 public:
  Comparison(const Input& input, const CoveredTree& home, const BuildOptions& build_options, const Settings& settings)
      : input_(input),
        build_(build_options),
        meter_(input.mesh),
        paper_(input.mesh, home, {.rules = {Rule::approach2}}, *settings.workers),
        workers_(*settings.workers) {}

  /// The last frame is the one a second after the motion.
  void report(const std::vector<RebuiltFrame>& frames, Result& result) {
    std::vector<double> over_fresh, over_paper;
    double uncovered = 0, error = 0;
    for (const RebuiltFrame& frame : frames) {
      const Figures now = measured(frame);
      over_fresh.push_back(now.ours / now.fresh);
      over_paper.push_back(now.ours / now.paper);
      uncovered = std::max(uncovered, now.paper_uncovered);
      if (now.ours < 1.5) error = std::max(error, std::abs(frame.estimate / now.ours - 1));
    }
    const double after = over_fresh.back();
    over_fresh.pop_back();
    const auto tighter = std::count_if(over_paper.begin(), over_paper.end(), [](double ratio) { return ratio < 1; });
    result.figures = {{"over fresh, median", median(over_fresh)},
                      {"over fresh, worst", *std::max_element(over_fresh.begin(), over_fresh.end())},
                      {"over fresh, 1 s after", after},
                      {"over approach 2, median", median(over_paper)},
                      {"over approach 2, worst", *std::max_element(over_paper.begin(), over_paper.end())},
                      {"frames tighter than approach 2", static_cast<double>(tighter)},
                      {"frames compared", static_cast<double>(over_paper.size())},
                      {"approach 2 uncovered area, largest", uncovered},
                      {"estimate off by, largest", error}};
  }

 private:
  struct Figures {
    double ours, fresh, paper, paper_uncovered;
  };

  double leaf_looseness(const Mesh& mesh, const SphereTree& tree) const {
    const auto leaves = level_set_spheres(tree, tree.level_count() - 1);
    return meter_.measure(mesh.positions, leaves, {.resolution = 192}, workers_).looseness.value_or(NAN);
  }

  Figures measured(const RebuiltFrame& frame) {
    const Mesh mesh = mesh_at(input_.mesh, frame.positions);
    require(paper_.update(frame.positions, workers_));
    const SphereTree paper = paper_.current_tree();
    return {leaf_looseness(mesh, frame.tree), leaf_looseness(mesh, build(mesh, build_, workers_).tree),
            leaf_looseness(mesh, paper),
            coverage(mesh, level_set_spheres(paper, paper.level_count() - 1), workers_).uncovered_area};
  }

  const Input& input_;
  BuildOptions build_;
  LoosenessMeter meter_;
  Body paper_;
  Workers& workers_;
};

CoveredTree with_poses_of(const NamedMotion& motion, const Input& input, CoveredTree home, const Settings& settings) {
  std::vector<NamedPose> poses;
  for (int frame = 1; frame <= frames_per_second; ++frame)
    poses.push_back({std::to_string(frame),
                     deform(input.mesh, {motion.deformation}, static_cast<double>(frame) / frames_per_second)});
  add_known_poses(input.mesh, home, poses, {.quality = Quality::fast}, *settings.workers);
  return home;
}

// Frame by frame the least time of some rounds, where every round does the same: what others on the machine cost is not
// meant.
std::vector<double> least_times(RebuiltBody& body, const Input& input, const NamedMotion& motion,
                                const Settings& settings) {
  std::vector<double> least(frame_count, INFINITY);
  for (int round = 0; round < 5; ++round) {
    require(body.update(frame_at(input.mesh, motion.deformation, 0), *settings.workers).update);
    for (std::size_t frame = 1; frame <= frame_count; ++frame) {
      const std::vector<Vec3f> positions = frame_at(input.mesh, motion.deformation, frame);
      const double before = thread_seconds();
      require(body.update(positions, *settings.workers).update);
      least[frame - 1] = std::min(least[frame - 1], thread_seconds() - before);
    }
  }
  return least;
}

CoveredTree with_strains(const Input& input, CoveredTree home, const Settings& settings) {
  add_known_poses(input.mesh, home, principal_strains(input.mesh), {.quality = Quality::fast}, *settings.workers);
  return home;
}

Result rebuilt_over(const NamedMotion& motion, const Setting& setting, RebuildEffort effort, const Input& input,
                    const BuildOptions& build_options, const Settings& settings) {
  const CoveredTree& home = *setting.home;
  Result result{.scenario = "rebuild",
                .item = motion.name + setting.name + (effort == RebuildEffort::high ? ", high effort" : ""),
                .mesh = input.name};
  std::vector<RebuiltFrame> compared;  // afterwards: the second core must not gain from what takes long here
  PacedThread second_core;
  std::size_t started_at = 0, frame = 0;
  RebuildOptions options{.effort = effort, .thread = setting.core > 0 ? RebuildThread::host : RebuildThread::none};
  options.executor = [&](const std::function<void()>& job) {
    started_at = frame;
    second_core.run(job);
  };
  RebuiltBody body(input.mesh, home, options, *settings.workers);
  const std::vector<Vec3f> rest = frame_at(input.mesh, motion.deformation, 0);
  require(body.update(rest, *settings.workers).update);
  const std::uint64_t rest_hash = body.body().hash();

  bool covered = true;
  std::vector<Sphere> spheres;
  for (frame = 1; frame <= frame_count; ++frame) {
    const std::vector<Vec3f> positions = frame_at(input.mesh, motion.deformation, frame);
    if (body.is_rebuilding())
      second_core.wait_for(setting.core * static_cast<double>(frame - started_at) / frames_per_second);
    RebuildStatus status;
    const double before = thread_seconds();
    status = body.update(positions, *settings.workers);
    result.seconds.push_back(thread_seconds() - before);
    result.expect(static_cast<bool>(status), "an update was rejected");
    body.body().copy_spheres(spheres);
    covered = covered && certify(body.body().cover(), positions, spheres, *settings.workers).covered;
    if (frame == frame_count || (frame <= frames_per_second && frame % compared_every(settings) == 0))
      compared.push_back({positions, body.body().current_tree(), body.report().looseness.back()});
  }
  result.expect(covered, "surface outside the spheres");
  require(body.update(rest, *settings.workers).update);
  result.expect(body.body().hash() == rest_hash, "back at rest the spheres are not those of rest");

  if (options.thread == RebuildThread::none) result.seconds = least_times(body, input, motion, settings);
  const double usual = median(result.seconds);
  const auto slow =
      std::count_if(result.seconds.begin(), result.seconds.end(), [&](double seconds) { return seconds > 2 * usual; });
  Comparison(input, home, build_options, settings).report(compared, result);
  result.figures.push_back(
      {"longest frame over median", *std::max_element(result.seconds.begin(), result.seconds.end()) / usual});
  result.figures.push_back({"frames above twice the median", static_cast<double>(slow)});
  result.figures.push_back({"known poses", static_cast<double>(home.poses.size())});
  const RebuildReport& report = body.report();
  result.figures.push_back({"pose switches", static_cast<double>(report.pose_switches)});
  result.figures.push_back({"rebuilds", static_cast<double>(report.finished)});
  result.figures.push_back({"swaps", static_cast<double>(report.swapped)});
  result.figures.push_back({"rebuild frames", static_cast<double>(report.rebuild_frames)});
  return result;
}

Result estimate_cost(const Input& input, const CoveredTree& home, const Settings& settings) {
  Result result{.scenario = "rebuild", .item = "estimate", .mesh = input.name};
  const Body body(input.mesh, home, {}, *settings.workers);
  LoosenessEstimator estimator(input.mesh);
  std::vector<double> looseness(home.tree.level_count()), again(looseness.size());
  result.seconds = timed(settings, [&] {
    estimator.pose(input.mesh.positions);
    estimator.estimate(body, looseness);
  });
  estimator.pose(input.mesh.positions);
  estimator.estimate(body, again);
  result.expect(looseness == again, "other figures than before");
  result.figures = {{"samples", static_cast<double>(estimator.sample_count())},
                    {"leaves", static_cast<double>(home.tree.leaf_count())}};
  return result;
}

Result tree_cost(const Input& input, const CoveredTree& home, const Settings& settings) {
  Result result{.scenario = "rebuild", .item = "tree", .mesh = input.name};
  const auto before = allocated_bytes();
  result.seconds = {seconds_of([&] {
    const Body body(input.mesh, home, {}, *settings.workers);
    if (const auto after = allocated_bytes(); before && after)
      result.figures.push_back({"bytes", static_cast<double>(*after - *before)});
  })};
  if (!result.figures.empty()) {
    const double allowed = 600.0 * static_cast<double>(home.tree.node_count()) +
                           24.0 * static_cast<double>(input.mesh.vertex_count()) +
                           40.0 * static_cast<double>(home.cover.cut_points.size());
    result.figures.push_back({"of 600 B/node + 24 B/vertex + 40 B/cut", result.figures[0].value / allowed});
  }
  return result;
}

}  // namespace

std::vector<Result> run_rebuild(const Input& input, const Settings& settings) {
  if (!LoosenessMeter(input.mesh).has_volume()) return {};
  const BuildOptions options{.method = Method::optimized, .quality = Quality::fast};
  const CoveredTree home = build(input.mesh, options, *settings.workers);
  std::vector<Result> results{estimate_cost(input, home, settings), tree_cost(input, home, settings)};
  const CoveredTree strained = with_strains(input, home, settings);
  for (const NamedMotion& motion : {NamedMotion{"stretch 2", Stretch{}}, NamedMotion{"twist 180", Twist{}},
                                    NamedMotion{"bend 90", Bend{}}, NamedMotion{"noise", Noise{}}}) {
    const CoveredTree known = with_poses_of(motion, input, home, settings);
    for (const RebuildEffort effort : {RebuildEffort::standard, RebuildEffort::high})
      for (const Setting& setting : {Setting{"", &home, 1}, Setting{", a quarter of a core", &home, 0.25},
                                     Setting{", strains", &strained, 1}, Setting{", known", &known, 0}})
        results.push_back(rebuilt_over(motion, setting, effort, input, options, settings));
  }
  return results;
}

}  // namespace morula::bench
