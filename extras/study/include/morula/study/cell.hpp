// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cell of a study: one tree of one body follows one motion by one rule, measured at the samples of the plan.
#pragma once

#include <morula/accuracy/coverage.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/protrusion.hpp>
#include <morula/study/plan.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <vector>

namespace morula::study {

/// Places in the plan.
struct RunKey {
  std::size_t source = 0;
  std::size_t motion = 0;
  std::size_t rule = 0;  ///< in Plan::rules, or in Plan::mixes
  auto operator<=>(const RunKey&) const = default;
};

/// One level set in one pose. What has no answer on an open mesh is empty, and so is what the plan does not measure.
struct LevelFigures {
  std::size_t level = 0;
  std::size_t spheres = 0;
  double diagonal = 0;               ///< of the body's box at rest
  double box_volume = 0;             ///< of that box
  std::optional<Looseness> grid;     ///< on the paper's grid
  std::optional<Looseness> lattice;  ///< on one lattice for all samples
  Coverage coverage;
  std::optional<Protrusion> protrusion;

  /// On the paper's grid, over the object's volume; over the volume of the box at rest.
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
};

struct Sample {
  std::size_t sample = 0;
  double parameter = 0;
  std::vector<LevelFigures> levels;
};

struct Run {
  RunKey key;
  std::optional<bool> returns_to_rest;     ///< the same bits; nothing for `fresh`
  std::optional<Certificate> certificate;  ///< over all samples: covered in all, the worst excess of any
  std::optional<double> update_seconds;    ///< of one update, median over all samples and repeats, one thread
  std::vector<Sample> samples;

  /// Of a sample's level; nullptr when it was not measured.
  const LevelFigures* at(std::size_t sample, std::size_t level) const;
  /// The largest over all samples and levels; an unknown looseness counts as 0.
  double worst_looseness_fixed() const;
  double worst_uncovered_area() const;
  /// In mesh units.
  double worst_gap() const;
};

}  // namespace morula::study
