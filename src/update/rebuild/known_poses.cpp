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
#include "update/rebuild/rebuild_depth.hpp"
#include "update/rebuild/relative_looseness.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t most_side_by_side = 16;  // builds side by side; each has the memory of a whole build

void require_in_range(const MeshView& mesh, const CoveredTree& model, std::span<const NamedPose> poses,
                      const KnownPoseOptions& options) {
  if (!(options.pose_threshold > 1)) throw std::invalid_argument("known poses: pose_threshold must be above 1");
  if (model.cover.vertex_count != mesh.vertex_count())
    throw std::invalid_argument("known poses: the tree is for another number of vertices");
  for (const NamedPose& pose : poses)
    // mutant known-size-when-added: `pose.positions.size() != mesh.vertex_count()` -> `false`
    if (pose.positions.size() != mesh.vertex_count())
      throw std::invalid_argument("known poses: \"" + pose.name + "\" has " + std::to_string(pose.positions.size()) +
                                  " positions for " + std::to_string(mesh.vertex_count()) + " vertices");
}

// How well the present trees serve every pose, compared with a tree built for that pose.
class Service {
 public:
  Service(const MeshView& mesh, const CoveredTree& model, std::span<const NamedPose> poses, Workers& workers)
      : poses_(poses),
        workers_(workers),
        estimator_(mesh),
        home_(model.tree.level_count()),
        own_(poses.size()),
        serving_(poses.size()) {
    Body body(mesh, CoveredTree{model.tree, model.cover, model.report}, {}, workers);
    home_ = looseness_of(body, mesh.positions);
    tightest_ = home_;
    activate(body);
    for (const KnownPose& pose : model.poses) {
      Body known({pose.positions, mesh.facets}, pose.model, {}, workers);
      learn(looseness_of(known, pose.positions));
      activate(known);
    }
  }

  struct Worst {
    std::size_t pose;
    double growth;
  };
  /// The worst served pose of those whose own tree does not serve yet, and the ratio of its looseness to the tightest
  /// possible one.
  Worst worst() const {
    Worst result{0, 1};
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (const double its = growth(i); !own_[i].serves && its > result.growth) result = {i, its};
    return result;
  }

  /// The worst of the poses without a tree whose ratio may exceed the threshold.
  std::vector<std::size_t> worst_without_tree(double pose_threshold, std::size_t max_count) const {
    std::vector<Worst> found;
    for (std::size_t i = 0; i < poses_.size(); ++i)
      if (const double its = growth(i); !has_tree(i) && its > pose_threshold) found.push_back({i, its});
    std::stable_sort(found.begin(), found.end(), [](const Worst& a, const Worst& b) { return a.growth > b.growth; });
    std::vector<std::size_t> poses;
    for (std::size_t k = 0; k < std::min(max_count, found.size()); ++k) poses.push_back(found[k].pose);
    return poses;
  }

  bool has_tree(std::size_t pose) const { return own_[pose].tree != nullptr; }
  std::shared_ptr<const CoveredTree> tree(std::size_t pose) const { return own_[pose].tree; }

  /// Records a tree built for a pose: its tightness at that pose is measured from then on.
  void keep(std::size_t pose, const MeshView& posed, std::shared_ptr<const CoveredTree> model) {
    Body body(posed, model, {}, workers_);
    own_[pose] = {std::move(model), looseness_of(body, posed.positions), false};
    learn(own_[pose].looseness);
  }

  /// The tree serves all poses at which it is tighter.
  void let_serve(std::size_t pose, const MeshView& posed) {
    own_[pose].serves = true;
    Body body(posed, own_[pose].tree, {}, workers_);
    activate(body);
  }

 private:
  struct Own {
    std::shared_ptr<const CoveredTree> tree;
    std::vector<double> looseness;  // looseness at this pose
    bool serves = false;
  };
  struct Serving {
    double score = std::numeric_limits<double>::infinity();
    std::vector<double> looseness;
  };

  // A pose without a tree of its own may be as easy to cover as the easiest one.
  double growth(std::size_t pose) const {
    // mutant known-beside-own-tree: `tightest_` -> `serving_[pose].looseness`
    return largest_growth(serving_[pose].looseness, has_tree(pose) ? own_[pose].looseness : tightest_);
  }

  std::vector<double> looseness_of(const Body& body, const PositionView& positions) {
    std::vector<double> looseness(home_.size());
    estimator_.pose(positions);
    estimator_.estimate(body, looseness);
    return looseness;
  }

  void learn(std::span<const double> looseness) {
    for (std::size_t level = 0; level < looseness.size(); ++level)
      tightest_[level] = std::min(tightest_[level], looseness[level]);
  }

  void activate(Body& body) {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      if (const UpdateStatus status = body.update(poses_[i].positions, workers_); !status)
        throw std::invalid_argument("known poses: \"" + poses_[i].name + "\": " + message(status));
      std::vector<double> looseness = looseness_of(body, poses_[i].positions);
      const double score = relative_looseness(looseness, home_);
      if (score < serving_[i].score) serving_[i] = {score, std::move(looseness)};
    }
  }

  std::span<const NamedPose> poses_;
  Workers& workers_;
  LoosenessEstimator estimator_;
  std::vector<double> home_;
  std::vector<double>
      tightest_;  // looseness of the tightest of all trees, each at the pose that it was built for, level by level
  std::vector<Own> own_;
  std::vector<Serving> serving_;
};

}  // namespace

KnownPosesReport add_known_poses(const MeshView& mesh, CoveredTree& model, std::span<const NamedPose> poses,
                                 const KnownPoseOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  require_in_range(mesh, model, poses, options);
  KnownPosesReport report;
  if (poses.empty()) return report;
  const BuildOptions build_options{.method = options.method,
                                   .branching = static_cast<int>(model.tree.branching),
                                   .depth = depth_of_rebuilds(model),
                                   .seed = options.seed,
                                   .quality = options.quality,
                                   .stop = options.stop};
  Service service(mesh, model, poses, workers);
  const auto posed = [&](std::size_t pose) { return MeshView(poses[pose].positions, mesh.facets); };
  const auto tell = [&] {
    if (options.progress) options.progress(report.trees_built, report.worst);
  };
  std::vector<KnownPose> added;
  while (true) {
    const auto [pose, growth] = service.worst();
    report.worst = growth;
    tell();
    if (!(growth > options.pose_threshold) || added.size() == options.max_trees) break;
    if (service.has_tree(pose)) {
      service.let_serve(pose, posed(pose));
      added.push_back({poses[pose].name, poses[pose].positions, service.tree(pose)});
      continue;
    }
    // Several builds run side by side, since a build keeps few threads busy. A few may turn out not to be needed, if a
    // new tree serves their poses also: so no more than a quarter of the number built already.
    const std::size_t count = std::clamp<std::size_t>(report.trees_built / 4, 1, most_side_by_side);
    const std::vector<std::size_t> next = service.worst_without_tree(options.pose_threshold, count);
    std::vector<std::shared_ptr<const CoveredTree>> trees(next.size());
    workers.run(next.size(), [&](std::size_t i) {
      // mutant known-side-by-side-mixed: `next[i]` -> `next[0]`
      trees[i] = std::make_shared<const CoveredTree>(build(posed(next[i]), build_options, workers));
    });
    for (std::size_t i = 0; i < next.size(); ++i) {
      service.keep(next[i], posed(next[i]), std::move(trees[i]));
      ++report.trees_built;
      if (i + 1 < next.size()) tell();
    }
  }
  report.added = added.size();
  std::move(added.begin(), added.end(), std::back_inserter(model.poses));
  return report;
}

std::vector<NamedPose> principal_strains(const MeshView& mesh, double max_stretch) {
  const StandardFloats standard;
  if (!(max_stretch > 1 && max_stretch <= 10)) throw std::invalid_argument("principal strains: 1 < max_stretch ≤ 10");
  constexpr double step = 1.1;
  const Box box = bounding_box(mesh);
  const std::array<Axis, 3> axes{Axis::x, Axis::y, Axis::z};
  std::vector<NamedPose> poses;
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    if (!(box.extent()[static_cast<int>(axis)] > 0)) continue;
    double factor = 1;
    while (factor < max_stretch) {
      factor = std::min(max_stretch, factor * step);
      const Deformation stretch = Stretch{.factor = factor, .axis = axes[axis]};
      poses.push_back({describe(stretch), deform(mesh, {stretch}, 1)});
    }
  }
  return poses;
}

}  // namespace morula
