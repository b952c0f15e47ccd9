// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cell of a study: one tree of one body follows one motion by one rule, measured at the samples of the plan.
#pragma once

#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/study/plan.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <vector>

namespace morula::study {

/// Indices in the plan.
struct MotionRunKey {
  std::size_t source = 0;
  std::size_t motion = 0;
  std::size_t rule = 0;  ///< index in Plan::rules or Plan::mixes
  auto operator<=>(const MotionRunKey&) const = default;
};

/// One level set in one pose. Values are empty if an open mesh does not define them, or if the plan does not measure
/// them.
struct LevelFigures {
  std::size_t level = 0;
  std::size_t spheres = 0;
  double diagonal = 0;                 ///< diagonal of the body's box at rest, mesh units
  double box_volume = 0;               ///< volume of that box, mesh units³
  std::optional<Looseness> grid;       ///< looseness on the paper's grid
  std::optional<Looseness> half_grid;  ///< looseness on a grid of half its resolution
  std::optional<Looseness> lattice;    ///< looseness on one lattice for all samples
  Coverage coverage;
  std::optional<Protrusion> protrusion;
  std::vector<std::optional<double>> metrics{};  ///< one per metric of the plan

  /// Looseness on the paper's grid, relative to the object's volume; relative to the volume of the box at rest.
  std::optional<double> looseness() const;
  std::optional<double> looseness_box() const;
  std::optional<double> looseness_fixed() const;
  std::optional<double> missed_volume() const;
  double uncovered_area() const { return coverage.uncovered_area; }
  /// Lengths as shares of the diagonal at rest.
  double uncovered_distance() const { return coverage.uncovered_distance / diagonal; }
  std::optional<double> protrusion_worst() const;
  std::optional<double> protrusion_mean() const;
  std::optional<double> error(ErrorUnit unit) const;
  std::optional<double> error_on_half_grid(ErrorUnit unit) const;
};

struct Sample {
  std::size_t sample = 0;
  double parameter = 0;
  std::vector<LevelFigures> levels;
};

struct MotionRun {
  MotionRunKey key;
  std::optional<bool> returns_to_rest;     ///< the body returns to the same bits; no value for `fresh`
  std::optional<Certificate> certificate;  ///< over all samples: covered in all, the worst excess of any
  std::optional<double> update_seconds;    ///< seconds of one update, median over all samples and repeats, one thread
  std::vector<Sample> samples;

  /// The figures of a sample's level; nullptr if it was not measured.
  const LevelFigures* at(std::size_t sample, std::size_t level) const;
  /// The largest value over all samples and levels; an unknown looseness counts as 0.
  double worst_looseness_fixed() const;
  double worst_uncovered_area() const;
  /// The largest distance, mesh units.
  double worst_uncovered_distance() const;
};

}  // namespace morula::study
