// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/poses.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace morula::study {

std::vector<MovedFrames> move_frames(const Plan& plan, std::size_t body, std::span<const Deformations> motions,
                                     std::span<const double> parameters, std::vector<Skipped>* skipped) {
  const NamedMesh& moving = plan.bodies[body];
  std::vector<MovedFrames> moved;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    MovedFrames motion{m, describe_all(motions[m]), {}};
    try {
      for (const double t : parameters) motion.frames.push_back(deform(moving.mesh, motions[m], t));
    } catch (const std::invalid_argument& error) {
      if (skipped != nullptr)
        skipped->push_back({body, fmt::format("{} cannot {}: {}", moving.name, motion.name, error.what())});
      continue;
    }
    moved.push_back(std::move(motion));
  }
  return moved;
}

}  // namespace morula::study
