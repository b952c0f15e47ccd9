// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body that stays tight: when its tree has become loose, another tree is built in the background and swapped in.
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

/// The thread that runs rebuilds.
enum class RebuildThread : std::uint8_t {
  background,  ///< a thread that the body owns; rejected (std::invalid_argument) without MORULA_THREADS
  caller,      ///< the thread of update(), which then takes as long as a build: the same bits in every run
  host,        ///< RebuildOptions::executor
  none,        ///< no rebuilds: only the home tree and those of known poses serve
};

/// Work per update.
enum class RebuildEffort : std::uint8_t {
  standard,  ///< the rule `exact`
  high,      ///< `exact`, then a better fit of the leaves' centers to the surface, for a third more time
};

struct RebuildOptions {
  // Method of the rebuilds; branching and depth are those of the home tree.
  Method method = Method::optimized;
  Quality quality = Quality::draft;      ///< quality of Method::optimized while the body moves
  Quality rest_quality = Quality::fast;  ///< quality when it stands still away from rest

  /// Ratio of the looseness of a level to its looseness when the present tree was built; above it a rebuild is due, as
  /// it is when the body stops in a pose that the present tree was not built for. Above 1.
  double rebuild_threshold = 1.25;
  /// Frames between estimates of looseness; at least 1.
  int check_every = 4;
  /// Frames between rebuilds, at any looseness; at least 1. With RebuildThread::caller, at fixed frames.
  std::optional<int> rebuild_every{};
  /// Relative improvement of the expected score that a new tree must reach to replace the present one; below 1. The
  /// score is the sum over levels of looseness divided by that of the home tree at rest. A large negative value always
  /// replaces it, for tests.
  double min_improvement = 0.05;
  /// true: rebuild for the pose that is expected when the result is used, extrapolated from three frames, straight or
  /// rotating. false: for the pose at the start.
  bool look_ahead = true;
  /// Largest share of wall time for rebuilds, which pauses enforce; 0 < share ≤ 1. Without effect for
  /// RebuildThread::caller.
  double processor_share = 1.0;

  /// high: tighter leaves while the body is away from the poses of its trees. Cover, regions, numbering, the nodes
  /// above leaves, and the spheres at rest and after rigid motion are the same. It pays off on smooth bodies with many
  /// facets per leaf.
  RebuildEffort effort = RebuildEffort::standard;

  RebuildThread thread = RebuildThread::background;
  /// Executor for RebuildThread::host: must run the job once, on any thread, at any time. A job that is late, or never
  /// run, costs tightness, not cover. Called inside update(). It must not throw: after an exception, which
  /// RebuildReport::failed counts, the body is not rebuilt again. The job may outlive the body.
  std::function<void(std::function<void()> job)> executor{};

  /// Builder of the rebuilt trees, on the thread of the rebuild; empty: build(). It returns a tree of the posed mesh
  /// with these options. An exception, or a tree in which validate(posed, tree) finds a fault, fails the rebuild
  /// (RebuildReport::failed). Bodies that share a builder may call it at the same time. It must not use the body.
  std::function<CoveredTree(const MeshView& posed, const BuildOptions& options)> builder{};
};

/// Counts since construction.
struct RebuildReport {
  std::size_t checks = 0;                ///< estimates of looseness
  std::size_t started = 0;               ///< rebuilds started
  std::size_t finished = 0;              ///< rebuilds completed
  std::size_t stopped = 0;               ///< rebuilds stopped, because the body came to rest or stopped in another pose
  std::size_t failed = 0;                ///< rebuilds ended by an exception; `failure` is the last one's message
  std::size_t swapped = 0;               ///< rebuilt trees put into use
  std::size_t refused = 0;               ///< rebuilt trees rejected, because they were not better than the present tree
  std::size_t returned_home = 0;         ///< changes back to the home tree, at rest or because it was tighter
  std::size_t pose_switches = 0;         ///< changes to a tree made for a known pose
  std::size_t candidates_evaluated = 0;  ///< updates of candidate trees that do not serve, to compare their tightness
  double rebuild_seconds = 0;            ///< wall time of the last completed rebuild, seconds
  /// Frames of the last rebuild, from its pose to its end; 20 until the first has ended.
  std::size_t rebuild_frames = 0;
  std::string failure;
  /// Per level set, from the root: estimate of the last check, and at the build of the present tree.
  std::vector<double> looseness, looseness_at_build;
};

struct [[nodiscard]] RebuildStatus {
  UpdateStatus update;   ///< status of the current spheres
  bool swapped = false;  ///< body() has changed in this update: nodes have other numbers
  explicit operator bool() const { return static_cast<bool>(update); }
};

/// A rebuilt body owns a Body with the rule `exact` over the home tree, one over the tree of each known pose, and up to
/// two over rebuilt trees while it is away from rest. A body is updated from the caller's positions before it serves.
/// So every level covers in every frame, independent of the background; swaps affect only tightness.
///
/// Exactly at rest the home tree serves: the spheres then equal the rest spheres bit for bit, after any motion. Memory:
/// the mesh and these bodies; the next rebuild frees a replaced tree.
class RebuiltBody {
 public:
  /// The body starts at rest. Throws like Body, and std::invalid_argument for options out of range, for a host without
  /// an executor, and for RebuildThread::background in a library built without threads.
  RebuiltBody(const MeshView& mesh, const CoveredTree& model, RebuildOptions options = {},
              Workers& workers = serial_workers());
  /// Stops a rebuild and waits for the body's own thread: at most as long as one node of a build, or the construction
  /// of a Body.
  ~RebuiltBody();
  RebuiltBody(RebuiltBody&&) noexcept;
  RebuiltBody& operator=(RebuiltBody&&) noexcept;

  /// Updates like Body::update, and never waits for a rebuild. Bad positions change nothing.
  ///
  /// Allocates nothing, except in frames in which a rebuild starts or its result arrives. Each frame updates the
  /// serving tree, and one other tree (up to eight for small bodies) that may be tighter. It also costs a share of an
  /// estimate, which takes `check_every` frames, and a copy of the positions when a rebuild starts.
  RebuildStatus update(const PositionView& positions, Workers& workers = serial_workers()) noexcept;

  /// The present body: spheres, tree, cover. The reference is valid until the next update.
  const Body& body() const;
  /// Number of swaps: the numbering of nodes changes only with it.
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
