// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body that stays tight: when its tree has grown loose, another is built in the background and swapped in.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/update/body.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <optional>
#include <string>
#include <vector>

namespace morula {

/// Runs rebuilds: our own thread, the calling one, or the host's.
enum class RebuildThread : std::uint8_t {
  background,  ///< a thread that the body owns
  caller,      ///< inside update(), which then takes as long as a build: the same bits on every run
  host,        ///< RebuildOptions::executor
  none,        ///< nothing is rebuilt: there are the home tree and those for known poses
};

/// Work per update.
enum class RebuildEffort : std::uint8_t {
  standard,  ///< the rule `exact`
  high,      ///< then moves the centers of leaves to where they fit the surface better, for a third more time
};

struct RebuildOptions {
  // How to rebuild; branching and depth are those of the home tree.
  Method method = Method::optimized;
  Quality quality = Quality::draft;      ///< of Method::optimized, while the body moves
  Quality rest_quality = Quality::fast;  ///< once it stands still away from rest

  /// A rebuild is wanted when any level is this many times as loose as when the present tree was built, and when the
  /// body stops in a pose that the present tree was not built for; above 1.
  double rebuild_threshold = 1.25;
  /// Frames between estimates of looseness; at least 1.
  int check_every = 4;
  /// Frames between rebuilds, whatever the looseness; at least 1. With RebuildThread::caller, fixed frames.
  std::optional<int> rebuild_every{};
  /// A new tree replaces the present one only where its expected score is lower by this share; below 1. The score is
  /// the sum over levels of looseness divided by that of the home tree at rest. Very negative: always, for tests.
  double min_improvement = 0.05;
  /// Rebuilds for the pose expected when the result is in use, extrapolated from three frames, straight or rotating.
  /// false: for the pose at the start.
  bool look_ahead = true;
  /// Largest share of wall time that goes into rebuilding: a pause follows each; 0 < share ≤ 1. Not for
  /// RebuildThread::caller.
  double processor_share = 1.0;

  /// high: tighter leaves while the body is away from the poses that it has trees for. Cover, ownership, numbering, the
  /// nodes above leaves, and the spheres at rest and after rigid motion are the same. Pays on smooth bodies of many
  /// facets per leaf.
  RebuildEffort effort = RebuildEffort::standard;

  RebuildThread thread = RebuildThread::background;
  /// For RebuildThread::host: must run the job once, on any thread, at any time. A job that is late, or never run,
  /// costs tightness, not cover. Called inside update(). Must not throw: after an
  /// exception, which RebuildReport::failed counts, the body is not rebuilt again. The job may outlive the body.
  std::function<void(std::function<void()> job)> executor{};
};

/// What has happened so far.
struct RebuildReport {
  std::size_t checks = 0;                ///< estimates made
  std::size_t started = 0;               ///< rebuilds
  std::size_t finished = 0;              ///< of these, to the end
  std::size_t stopped = 0;               ///< given up because the body came to rest, or stopped in another pose
  std::size_t failed = 0;                ///< ended by an exception; `failure` is the last one's message
  std::size_t swapped = 0;               ///< taken over
  std::size_t refused = 0;               ///< not better than what there was
  std::size_t returned_home = 0;         ///< changes back to the home tree, at rest or because it was tighter
  std::size_t pose_switches = 0;         ///< changes to a tree made for a known pose
  std::size_t candidates_evaluated = 0;  ///< updates of trees that did not serve, to see whether they are tighter
  double rebuild_seconds = 0;            ///< wall time of the last one finished
  std::size_t rebuild_frames = 0;        ///< from the last pose that it was given to its end; 20 before any has ended
  std::string failure;
  /// Per level set, from the root: estimated at the last check, and when the present tree was built.
  std::vector<double> looseness, looseness_at_build;
};

struct [[nodiscard]] RebuildStatus {
  UpdateStatus update;   ///< of the spheres that are current now
  bool swapped = false;  ///< body() is another one than before: nodes have other numbers
  explicit operator bool() const { return static_cast<bool>(update); }
};

/// Holds a Body by the rule `exact` over the home tree, one over the tree of each known pose, and up to two over
/// rebuilt trees while it is away from rest. Each is updated from the caller's positions before it serves. So every
/// level covers in every frame, whatever happens in the background; swaps change only how tightly.
///
/// At rest exactly, the home tree serves: the spheres are then those of rest bit for bit, whatever came before.
/// Memory: the mesh and these bodies; a rebuilt tree that was replaced is freed by the next rebuild.
class RebuiltBody {
 public:
  /// The body starts at rest. Throws as Body does, and std::invalid_argument for options out of range, a host without
  /// an executor, and RebuildThread::background in a library built without threads.
  RebuiltBody(const MeshView& mesh, const CoveredTree& model, RebuildOptions options = {},
              Workers& workers = serial_workers());
  /// Stops a rebuild and waits for our own thread: at most as long as one node of a build, or the making of a Body.
  ~RebuiltBody();
  RebuiltBody(RebuiltBody&&) noexcept;
  RebuiltBody& operator=(RebuiltBody&&) noexcept;

  /// As Body::update. Never waits for a rebuild. Bad positions change nothing at all.
  ///
  /// No allocation, except in frames where a rebuild starts or its result comes in. Each
  /// frame updates the serving tree, and one other tree (up to eight for small bodies) that may be tighter. Besides
  /// that it costs a share of an estimate, which takes `check_every` frames, and a copy of the positions when a rebuild
  /// starts.
  RebuildStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  /// The present one: spheres, tree, cover. The reference is good until the next update.
  const Body& body() const;
  /// Number of swaps so far: as long as it stays the same, so does the numbering of nodes.
  std::uint64_t tree_version() const;
  bool is_home() const;
  bool is_rebuilding() const;
  const RebuildReport& report() const;
  const RebuildOptions& options() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
