// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A build while it runs: its options, its clock, its stop token and its progress.
#pragma once

#include <chrono>
#include <morula/generators/build.hpp>

#include "parallel/interruption.hpp"

namespace morula::detail {

/// Copies are cheap: they share the clock and the progress callback.
class BuildRun : public BuildOptions {
 public:
  /// Starts the clock of the time limit. Reported progress never decreases.
  BuildRun(const BuildOptions& options, const MeshView& mesh);

  /// Levels below the root: the requested or the automatic depth. A flat set has the depth that its measures are chosen
  /// for.
  int depth;
  /// Requested spheres of a flat set; 0: not requested.
  std::size_t spheres;
  double max_protrusion;  ///< of a leaf before the tolerance reduces it; 0: not requested
  /// Box of the mesh; its largest |coordinate|, which radii are padded by.
  const Box& box() const { return box_; }
  double largest_coordinate() const { return morula::largest_coordinate(box_); }

  /// Throws BuildStopped when the stop was requested. Called between steps of a few ten milliseconds.
  void throw_if_stopped() const {
    if (stop.stop_requested()) throw BuildStopped();
  }
  bool out_of_time() const { return Clock::now() >= deadline_; }
  /// Seconds since the build began.
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  /// For a generator that makes several trees: a run whose progress 0…1 is reported as from…to of this run's.
  BuildRun pass(double from, double to) const;
  /// For one level of `children` children instead of the requested tree.
  BuildRun one_level(std::size_t children) const;
  /// Reports progress, on the calling thread only. seconds_left: of this pass.
  void tell(double share, int level, std::optional<double> seconds_left = {}) const;

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
  Clock::time_point deadline_ = Clock::time_point::max();
  double from_ = 0, to_ = 1;
  Box box_;
};

/// Makes checks for interruption of this thread and its helpers also throw BuildStopped, once the stop of the run is
/// requested. Checks of the caller's Interrupt go on. A token without a source changes nothing.
class StopChecks {
 public:
  explicit StopChecks(const BuildRun& run);
  ~StopChecks();
  StopChecks(const StopChecks&) = delete;
  StopChecks& operator=(const StopChecks&) = delete;

 private:
  Interruption state_;
  bool checks_;
};

/// Seconds that the rest of a level-by-level build takes. Dividing all nodes of a level costs A + B × nodes: every
/// level processes the whole surface once, and every node has a price of its own. The last two levels give A and B.
class TimeEstimate {
 public:
  /// patches: number of the whole surface.
  TimeEstimate(int depth, int branching, std::size_t patches, unsigned threads);
  void begin_level(std::size_t nodes);
  /// Adds the division of more nodes of the level. seconds: summed over the nodes.
  void add(std::size_t nodes, std::size_t children, double seconds);
  /// Empty before the root is divided.
  std::optional<double> seconds_left() const;

 private:
  struct Level {
    double nodes = 0, done = 0, children = 0, seconds = 0;
    double all_seconds() const { return done > 0 ? seconds * nodes / done : 0; }
  };
  double wall(double seconds, double nodes) const;

  int depth_;
  double branching_, patches_, threads_;
  std::vector<Level> levels_;
};

}  // namespace morula::detail
