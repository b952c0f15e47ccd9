// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/update/rebuilt_body.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "update/points/narrow.hpp"
#include "update/rebuild/looseness_watch.hpp"
#include "update/rebuild/rebuild_cycle.hpp"
#include "update/rebuild/rebuild_depth.hpp"
#include "update/rebuild/rebuild_job.hpp"
#include "update/rebuild/tree_versions.hpp"

namespace morula {
using namespace detail;
namespace {

RebuildOptions in_range(RebuildOptions o) {
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::invalid_argument(std::string("rebuild: ") + what);
  };
  require(o.rebuild_threshold > 1, "rebuild_threshold must be above 1");
  require(o.check_every >= 1, "check_every must be at least 1");
  require(o.rebuild_every.value_or(1) >= 1, "rebuild_every must be at least 1");
  require(o.min_improvement < 1, "min_improvement must be below 1");
  require(o.processor_share > 0 && o.processor_share <= 1, "processor_share must be above 0 and at most 1");
  require(o.thread != RebuildThread::host || o.executor, "a host's thread needs an executor");
  return o;
}

void require_poses(const MeshView& mesh, const CoveredTree& model) {
  for (const KnownPose& pose : model.poses)
    // mutant known-size-at-use: `pose.model || pose.positions.size() != mesh.vertex_count()` -> `pose.model`
    if (!pose.model || pose.positions.size() != mesh.vertex_count())
      throw std::invalid_argument("rebuild: the known pose \"" + pose.name + "\" is not one of this mesh");
}

std::shared_ptr<RebuildJob> make_job(const MeshView& mesh, const CoveredTree& home, const RebuildOptions& options) {
  const BuildOptions build{
      .method = options.method, .branching = static_cast<int>(home.tree.branching), .depth = depth_of_rebuilds(home)};
  return std::make_shared<RebuildJob>(mesh, build, home.tree.level_count(), fits_leaves(options), options.builder);
}

// Rest positions of the vertices that facets use.
class RestPose {
 public:
  explicit RestPose(const MeshView& mesh) : positions_(mesh.positions.to_vector()) {
    for (const Facet& f : mesh.facets) used_.insert(used_.end(), f.begin(), f.end());
    std::sort(used_.begin(), used_.end());
    used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
  }
  std::size_t size() const { return positions_.size(); }
  // True if every vertex is at its rest position, or at that narrowed to float. Needs positions.size() == size().
  bool is_at(const PositionView& positions) const noexcept {
    if (positions.is_double())
      return std::all_of(used_.begin(), used_.end(), [&](std::uint32_t v) { return positions[v] == positions_[v]; });
    return std::all_of(used_.begin(), used_.end(),
                       [&](std::uint32_t v) { return positions[v] == nearest_floats(positions_[v]); });
  }

 private:
  std::vector<Vec3> positions_;
  std::vector<std::uint32_t> used_;
};

}  // namespace

// Steps of each frame: chooses the tree that serves (TreeVersions), watches how loose it is (LoosenessWatch), and
// rebuilds it (RebuildCycle).
struct RebuiltBody::State {
  State(const MeshView& mesh, const CoveredTree& model, RebuildOptions rebuild_options, Workers& workers);

  RebuildStatus update(const PositionView& positions, Workers& workers) noexcept;

  void note_failure(const char* what) noexcept;
  TreeVersion& chosen_before_update(const PositionView& positions, bool resting, bool arrived) noexcept;
  void activate(TreeVersion& next) noexcept;
  void rest(const PositionView& positions);
  void check(const PositionView& positions);
  void decide(const PositionView& positions);
  void take_result_at_once(const PositionView& positions, Workers& workers);
  void collect(const PositionView& positions, bool taken);
  RebuildCycle::Moment now(const PositionView& positions) const noexcept;

  RebuildOptions options;
  RestPose at_rest;
  RebuildReport report;
  LoosenessWatch watch;
  TreeVersions trees;
  std::uint64_t tree_version = 0, frame = 0;
  RebuildCycle cycle;  // last: its thread ends first
};

RebuiltBody::State::State(const MeshView& mesh, const CoveredTree& model, RebuildOptions rebuild_options,
                          Workers& workers)
    : options((require_poses(mesh, model), in_range(std::move(rebuild_options)))),
      at_rest(mesh),
      watch(mesh, model.tree.level_count(), options, report),
      trees(mesh, model, options, watch.estimator(), workers),
      cycle(options, report, make_job(mesh, model, options)) {
  watch.follow(trees.home());
}

RebuildStatus RebuiltBody::State::update(const PositionView& positions, Workers& workers) noexcept {
  const bool whole = positions.size() == at_rest.size(), resting = whole && at_rest.is_at(positions);
  const bool arrived = whole && !resting && cycle.is_done();
  TreeVersion* const present = &trees.present();
  TreeVersion* chosen = whole ? &chosen_before_update(positions, resting, arrived) : present;
  RebuildStatus status{.update = trees.follow(*chosen, positions, workers)};
  if (!status && chosen != present) {
    chosen = present;
    status.update = trees.follow(*chosen, positions, workers);
  }
  if (!status) return status;

  const std::uint64_t before = tree_version;
  ++frame;
  if (chosen == present && !resting) {
    chosen = &trees.tightest_evaluated(frame, positions, workers);
    report.candidates_evaluated = trees.candidates_evaluated();
  }
  // Lack of memory, or an error of the host's executor, costs the rebuild but not the spheres.
  try {
    if (chosen != present) {
      report.returned_home += chosen == &trees.home();
      report.pose_switches += trees.is_known(*chosen);
      activate(*chosen);
    }
    if (arrived) collect(positions, chosen == cycle.result());
    if (resting)
      rest(positions);
    else
      check(positions);
    if (options.thread == RebuildThread::caller && cycle.is_done()) take_result_at_once(positions, workers);
  } catch (const std::exception& error) {
    note_failure(error.what());
  } catch (...) {
    note_failure("an exception of another type than std::exception");
  }
  status.swapped = tree_version != before;
  return status;
}

// The message may need memory that is missing.
void RebuiltBody::State::note_failure(const char* what) noexcept {
  ++report.failed;
  try {
    report.failure = what;
  } catch (...) {
    report.failure.clear();
  }
}

// arrived: the result of a rebuild has arrived.
TreeVersion& RebuiltBody::State::chosen_before_update(const PositionView& positions, bool resting,
                                                      bool arrived) noexcept {
  if (resting) return trees.home();
  trees.measure(positions);
  const bool takes_over = arrived && cycle.result() != nullptr && trees.takes_over(*cycle.result(), positions);
  return takes_over ? *cycle.result() : trees.tree_for_this_pose();
}

void RebuiltBody::State::activate(TreeVersion& next) noexcept {
  trees.activate(next);
  ++tree_version;
  watch.follow(next);
}

RebuildCycle::Moment RebuiltBody::State::now(const PositionView& positions) const noexcept {
  const bool settled = watch.motion() == LoosenessWatch::Motion::settled;
  return {frame, positions, settled ? options.rest_quality : options.quality};
}

void RebuiltBody::State::rest(const PositionView& positions) {
  cycle.step(RebuildCycle::Event::at_rest, now(positions));
  watch.rest(trees.home());
}

void RebuiltBody::State::check(const PositionView& positions) {
  cycle.step(RebuildCycle::Event::frame, now(positions));
  const auto period = static_cast<std::uint64_t>(options.rebuild_every.value_or(options.check_every));
  const bool due = frame % period == 0;
  if (due) watch.begin(positions, trees);
  const bool is_estimated = watch.step(trees);
  if (options.rebuild_every) {
    if (due && cycle.may_start()) cycle.step(RebuildCycle::Event::wanted, now(positions));
  } else if (is_estimated) {
    decide(positions);
  }
}

void RebuiltBody::State::decide(const PositionView& positions) {
  const bool settling = watch.motion() == LoosenessWatch::Motion::stopped &&
                        (!trees.home_serves() || watch.is_off_build(trees.present()));
  if (settling) cycle.step(RebuildCycle::Event::body_stopped, now(positions));
  if (!cycle.may_start() || !(settling || watch.has_grown())) return;
  watch.settle();
  cycle.step(RebuildCycle::Event::wanted, now(positions));
}

void RebuiltBody::State::take_result_at_once(const PositionView& positions, Workers& workers) {
  TreeVersion* const made = cycle.result();
  const bool taken = made != nullptr && trees.takes_over(*made, positions) && made->body.update(positions, workers);
  if (taken) activate(*made);
  collect(positions, taken);
}

// taken: the tree serves already, and was updated.
void RebuiltBody::State::collect(const PositionView& positions, bool taken) {
  RebuildJob::Result result = cycle.collect(now(positions));
  if (!result.tree) return;
  if (taken) {
    ++report.swapped;
    // The tree is kept first: it serves already, and memory may be missing for the rest.
    const std::size_t node_count = result.tree->body.rest_tree().node_count();
    trees.keep(result.tree);
    watch.estimator().reserve(node_count);
  } else {
    // A tree for this pose is no better: wait until the pose changes.
    ++report.refused;
    if (trees.fits_here(*result.tree, options.rebuild_threshold)) watch.raise_thresholds();
  }
  cycle.retire(std::move(result.tree));
}

RebuiltBody::RebuiltBody(const MeshView& mesh, const CoveredTree& model, RebuildOptions options, Workers& workers)
    : state_([&] {
        const StandardFloats standard;
        return std::make_unique<State>(mesh, model, std::move(options), workers);
      }()) {}

RebuiltBody::~RebuiltBody() = default;
RebuiltBody::RebuiltBody(RebuiltBody&&) noexcept = default;
RebuiltBody& RebuiltBody::operator=(RebuiltBody&&) noexcept = default;

RebuildStatus RebuiltBody::update(const PositionView& positions, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->update(positions, workers);
}

const Body& RebuiltBody::body() const {
  return state_->trees.present().body;
}

std::uint64_t RebuiltBody::tree_version() const {
  return state_->tree_version;
}

bool RebuiltBody::is_home() const {
  return state_->trees.home_serves();
}

bool RebuiltBody::is_rebuilding() const {
  return state_->cycle.is_under_way();
}

const RebuildReport& RebuiltBody::report() const {
  return state_->report;
}

const RebuildOptions& RebuiltBody::options() const {
  return state_->options;
}

}  // namespace morula
