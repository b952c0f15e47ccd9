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

std::vector<MovedFrames> move_frames(const Plan& plan, std::size_t body, std::span<const double> parameters,
                                     std::vector<Skipped>* skipped) {
  std::vector<MovedFrames> moved = move_frames(plan, body, plan.motions, parameters, skipped);
  for (std::size_t r = 0; r < plan.recorded.size(); ++r) {
    const RecordedMotion& recorded = plan.recorded[r];
    if (recorded.body != body) continue;
    MovedFrames motion{plan.motions.size() + r, recorded.name, {}};
    for (const double t : parameters) {
      // The nearest of rest and the recorded frames, which are at equal steps.
      const auto at = static_cast<std::size_t>(t * static_cast<double>(recorded.frames.size()) + 0.5);
      motion.frames.push_back(at == 0 ? plan.bodies[body].mesh.positions : recorded.frames[at - 1]);
    }
    moved.push_back(std::move(motion));
  }
  return moved;
}

}  // namespace morula::study
