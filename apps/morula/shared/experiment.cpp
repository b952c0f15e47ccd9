// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <scenes/scenes.hpp>
#include <stdexcept>

namespace morula::cli {

std::string describe_all(const Deformations& deformations) {
  std::string text;
  for (const Deformation& deformation : deformations) text += (text.empty() ? "" : ", ") + describe(deformation);
  return text;
}

std::vector<Deformations> paper_motions() {
  std::vector<Deformations> motions;
  for (const scenes::NamedMotion& motion : scenes::standard_motions()) {
    const Deformation& first = motion.deformations.front();
    if (std::holds_alternative<Stretch>(first) || std::holds_alternative<Twist>(first) ||
        std::holds_alternative<Bend>(first)) {
      motions.push_back(motion.deformations);
    }
  }
  return motions;
}

std::vector<MovedFrames> move_frames(const NamedMesh& body, std::span<const Deformations> motions,
                                     std::span<const double> parameters, std::vector<std::string>& skipped) {
  std::vector<MovedFrames> moved;
  for (const Deformations& deformations : motions) {
    MovedFrames motion{describe_all(deformations), {}};
    try {
      for (const double t : parameters) motion.frames.push_back(deform(body.mesh, deformations, t));
    } catch (const std::invalid_argument& error) {
      skipped.push_back(fmt::format("{} cannot {}: {}", body.name, motion.name, error.what()));
      continue;
    }
    moved.push_back(std::move(motion));
  }
  return moved;
}

std::string file_stem(const std::string& body, const std::string& motion) {
  std::string stem = body + '-' + motion;
  std::replace(stem.begin(), stem.end(), ' ', '-');
  return stem;
}

}  // namespace morula::cli
