// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One cell of the study: one tree of one body follows one motion by one rule, measured at every sample.
#pragma once

#include <memory>
#include <morula/accuracy/looseness.hpp>
#include <morula/query/signed_distance.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "study/plan.hpp"

namespace morula::cli {

/// One level set in one pose. Volumes are shares of the object's volume, lengths of the diagonal at rest. What has no
/// answer on an open mesh is empty.
struct StudyLevel {
  std::size_t level = 0;
  std::size_t spheres = 0;
  std::optional<double> looseness;        // on the paper's grid
  std::optional<double> looseness_box;    // the same volume, over the volume of the box at rest
  std::optional<double> looseness_fixed;  // on one lattice for all samples
  std::optional<double> missed_volume;
  double bare_area = 0;
  double gap = 0;
  std::optional<double> protrusion_worst;
  std::optional<double> protrusion_mean;

  const std::optional<double>& error(ErrorUnit unit) const {
    return unit == ErrorUnit::volume ? looseness : looseness_box;
  }
};

struct StudySample {
  std::size_t sample = 0;
  double parameter = 0;
  std::vector<StudyLevel> levels;
};

struct StudyCell {
  std::string body;
  std::string method;
  std::string motion;
  std::string rule;
  std::optional<bool> returns_to_rest;  // the same bits; nothing for `fresh`
  std::vector<StudySample> samples;

  /// Of a sample's level; nullptr when it was not measured.
  const StudyLevel* at(std::size_t sample, std::size_t level) const;
};

Json cell_json(const StudyCell& cell);
/// Throws nlohmann::json::exception when it is none.
StudyCell cell_from_json(const Json& json);

/// The poses of one motion, with what all cells of it ask.
struct StudyPoses {
  MovedFrames motion;
  std::vector<std::unique_ptr<SignedDistance>> distances;  // one per pose; none of a mesh without inside
};

/// Throws BuildStopped when the stop is requested.
StudyCell run_cell(const StudyPlan& plan, const StudySource& source, const Built& built, const StudyPoses& poses,
                   const StudyRule& rule, bool with_protrusion, const std::stop_token& stop);

}  // namespace morula::cli
