// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario: its settings, and its results: times, the work done, and faults of the answers.
#pragma once

#include <chrono>
#include <cstddef>
#include <morula/generators/build.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/status.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <scenes/median.hpp>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace morula::bench {

struct Input {
  std::string name;
  Mesh mesh;
};

class Baseline;

struct Settings {
  int repeats;            ///< at least 1
  double patience;        ///< seconds; an item that takes longer gets fewer repeats, but never fewer than two
  std::size_t questions;  ///< points asked about by `query`
  Workers* workers;
  std::vector<Method> methods{};  ///< of `build`: which; where it is just one: what makes the tree of other scenarios
  std::optional<int> depth = 3;   ///< of trees that are built for a mesh; nothing: automatic_depth
  // For `build`.
  std::uint64_t seeds = 1;             ///< trees of so many seeds, for the spread of their looseness
  const Baseline* baseline = nullptr;  ///< what looseness is divided by
};

/// Something counted or derived; the same on every run, unless it has a time in it.
struct Figure {
  std::string name;
  double value;
};

/// One line of the report.
struct Result {
  std::string scenario;
  std::string item;
  std::string mesh;
  /// One per repeat (update, volumes, peers: per repeat and frame), in the order they were taken; none when there was
  /// nothing to time, which the note explains.
  std::vector<double> seconds{};
  std::vector<Figure> figures{};
  std::string note{};
  std::vector<std::string> faults{};  ///< what is wrong with the answers; empty: verified

  /// A fast wrong answer is not a result.
  void expect(bool holds, std::string_view fault) {
    if (!holds) faults.emplace_back(fault);
  }
};

using Run = std::vector<Result> (*)(const Input&, const Settings&);
std::vector<Result> run_build(const Input& input, const Settings& settings);
/// Bodies of ten thousand to a million facets: time and memory per facet. Not for an input.
std::vector<Result> run_build_scaling(const Settings& settings);
/// So many small bodies for so many frames: memory that grows, cover that is lost. Not for an input.
std::vector<Result> run_load(std::size_t bodies, std::size_t frames, const Settings& settings);
/// An arm among boxes in so many random configurations, collisions and clearances; only where robots are built. Not for
/// an input.
std::vector<Result> run_planning(std::size_t configurations, const Settings& settings);
/// Bodies of ten thousand facets, ten times as many, … up to so many: time and memory of all that is done to them, each
/// in a process of its own. Not for an input; nothing on Windows.
std::vector<Result> run_growth(std::size_t most_facets, const Settings& settings);
std::vector<Result> run_update(const Input& input, const Settings& settings);
std::vector<Result> run_modal(const Input& input, const Settings& settings);
std::vector<Result> run_skinned(const Input& input, const Settings& settings);
std::vector<Result> run_skinned_pick(const Input& input, const Settings& settings);
std::vector<Result> run_rebuild(const Input& input, const Settings& settings);
std::vector<Result> run_measure(const Input& input, const Settings& settings);
std::vector<Result> run_query(const Input& input, const Settings& settings);
std::vector<Result> run_collide(const Input& input, const Settings& settings);
std::vector<Result> run_volumes(const Input& input, const Settings& settings);
/// Bodies pressed together: depths, normals and forces of Morula and Bullet, compared with known values.
std::vector<Result> run_pressed(const Input& input, const Settings& settings);
std::vector<Result> run_patches(const Input& input, const Settings& settings);
std::vector<Result> run_distance(const Input& input, const Settings& settings);
std::vector<Result> run_haptic(const Input& input, const Settings& settings);
std::vector<Result> run_peers(const Input& input, const Settings& settings);
std::vector<Result> run_crossings(const Input& input, const Settings& settings);
std::vector<Result> run_self(const Input& input, const Settings& settings);
std::vector<Result> run_proximity(const Input& input, const Settings& settings);
std::vector<Result> run_layers(const Input& input, const Settings& settings);
std::vector<Result> run_swept(const Input& input, const Settings& settings);
std::vector<Result> run_filters(const Input& input, const Settings& settings);
std::vector<Result> run_scene(const Input& input, const Settings& settings);
std::vector<Result> run_scene_patches(const Input& input, const Settings& settings);
std::vector<Result> run_scene_queries(const Input& input, const Settings& settings);
std::vector<Result> run_skin_bounds(const Input& input, const Settings& settings);

/// For calls that the rest of a scenario depends on. Throws std::runtime_error with the message of a refused one. It is
/// one comparison otherwise, so it may stand inside what is timed.
inline void require(const Status& status) {
  if (!status) throw std::runtime_error(message(status));
}

/// Wall-clock seconds of one call.
template <class F>
double seconds_of(const F& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One entry per repeat of f.
template <class F>
std::vector<double> timed(const Settings& settings, const F& f) {
  std::vector<double> seconds;
  double total = 0;
  for (int i = 0; i < settings.repeats && (i < 2 || total < settings.patience); ++i) {
    seconds.push_back(seconds_of(f));
    total += seconds.back();
  }
  return seconds;
}

/// Branching 8, by the one method that was asked for or else by the default one.
inline BuildOptions tree_options(const Settings& settings) {
  BuildOptions options{.branching = 8, .depth = settings.depth};
  if (settings.methods.size() == 1) options.method = settings.methods.front();
  return options;
}

using scenes::median;

}  // namespace morula::bench
