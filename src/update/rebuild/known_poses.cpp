// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/update/known_poses.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <optional>
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "update/rebuild/relative_looseness.hpp"

namespace morula {
using namespace detail;
namespace {

void require_in_range(const Mesh& mesh, const CoveredTree& built, std::span<const NamedPose> poses,
                      const KnownPoseOptions& options) {
  if (!(options.looser_by > 1)) throw std::invalid_argument("known poses: looser_by must be above 1");
  if (built.cover.vertex_count != mesh.vertex_count())
    throw std::invalid_argument("known poses: the tree is for another number of vertices");
  for (const NamedPose& pose : poses)
    if (pose.positions.size() != mesh.vertex_count())
      throw std::invalid_argument("known poses: \"" + pose.name + "\" has " + std::to_string(pose.positions.size()) +
                                  " positions for " + std::to_string(mesh.vertex_count()) + " vertices");
}

// How every pose is served by the trees that there are.
class Service {
 public:
  Service(const Mesh& mesh, const CoveredTree& built, std::span<const NamedPose> poses, Workers& workers)
      : poses_(poses),
        workers_(workers),
        estimator_(mesh),
        home_(built.tree.level_count()),
        score_(poses.size(), std::numeric_limits<double>::infinity()),
        growth_(poses.size(), 1) {
    Body body(mesh, CoveredTree{built.tree, built.cover, built.report}, {}, workers);
    estimator_.pose(mesh.positions);
    estimator_.estimate(body, home_);
    serve(body, home_);
    for (const KnownPose& pose : built.poses) add({pose.positions, mesh.facets}, pose.built);
  }

  void add(const Mesh& posed, std::shared_ptr<const CoveredTree> built) {
    Body body(posed, std::move(built), {}, workers_);
    std::vector<double> at_build(home_.size());
    estimator_.pose(posed.positions);
    estimator_.estimate(body, at_build);
    serve(body, at_build);
  }

  /// The pose served worst, and how badly.
  std::pair<std::size_t, double> worst() const {
    const auto found = std::max_element(growth_.begin(), growth_.end());
    return {static_cast<std::size_t>(found - growth_.begin()), *found};
  }

 private:
  // By the tightest tree, and how much looser that is than where it was made.
  void serve(Body& body, std::span<const double> at_build) {
    std::vector<double> looseness(home_.size());
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (const UpdateStatus status = body.update(poses_[i].positions, workers_); !status)
        throw std::invalid_argument("known poses: \"" + poses_[i].name + "\": " + message(status));
      estimator_.pose(poses_[i].positions);
      estimator_.estimate(body, looseness);
      const double score = relative_looseness(looseness, home_);
      if (!(score < score_[i])) continue;
      score_[i] = score;
      growth_[i] = largest_growth(looseness, at_build);
    }
  }

  std::span<const NamedPose> poses_;
  Workers& workers_;
  LoosenessEstimator estimator_;
  std::vector<double> home_, score_, growth_;
};

}  // namespace

KnownPosesReport add_known_poses(const Mesh& mesh, CoveredTree& built, std::span<const NamedPose> poses,
                                 const KnownPoseOptions& options, Workers& workers) {
  const StandardFloats standard;
  require_in_range(mesh, built, poses, options);
  KnownPosesReport report;
  if (poses.empty()) return report;
  const BuildOptions build_options{.method = options.method,
                                   .branching = static_cast<int>(built.tree.branching),
                                   .depth = static_cast<int>(built.tree.level_count()) - 1,
                                   .seed = options.seed,
                                   .quality = options.quality,
                                   .stop = options.stop};
  Service service(mesh, built, poses, workers);
  std::vector<KnownPose> added;
  std::vector<std::uint8_t> has_own(poses.size());
  while (true) {
    const auto [pose, growth] = service.worst();
    report.worst = growth;
    if (options.progress) options.progress(added.size(), growth);
    // A pose that its own tree serves no better is hard to cover.
    if (!(growth > options.looser_by) || added.size() == options.most || has_own[pose] != 0) break;
    has_own[pose] = 1;
    const Mesh posed{poses[pose].positions, mesh.facets};
    auto tree = std::make_shared<const CoveredTree>(build(posed, build_options, workers));
    service.add(posed, tree);
    added.push_back({poses[pose].name, poses[pose].positions, std::move(tree)});
  }
  report.added = added.size();
  std::move(added.begin(), added.end(), std::back_inserter(built.poses));
  return report;
}

std::vector<NamedPose> principal_strains(const Mesh& mesh, double most) {
  const StandardFloats standard;
  if (!(most > 1 && most <= 10)) throw std::invalid_argument("principal strains: 1 < most ≤ 10");
  constexpr double step = 1.1;
  const Box box = bounding_box(mesh);
  const std::array<Axis, 3> axes{Axis::x, Axis::y, Axis::z};
  std::vector<NamedPose> poses;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!(box.extent()[static_cast<int>(axis)] > 0)) continue;
    double factor = 1;
    while (factor < most) {
      factor = std::min(most, factor * step);
      const Deformation stretch = Stretch{.factor = factor, .axis = axes[axis]};
      poses.push_back({describe(stretch), deform(mesh, {stretch}, 1)});
    }
  }
  return poses;
}

}  // namespace morula
