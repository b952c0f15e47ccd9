// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Poses of a body: its positions at every sample of a motion.
#pragma once

#include <morula/study/plan.hpp>
#include <morula/study/run.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::study {

/// A motion, and the positions of one body at each of its samples.
struct MovedFrames {
  std::size_t motion = 0;  // in the plan
  std::string name;
  std::vector<std::vector<Vec3>> frames;
};

/// The plan's motions of the body, recorded ones too, one frame per parameter. Motions that are impossible for it are
/// left out; the reasons go to `skipped` unless that is nullptr.
std::vector<MovedFrames> move_frames(const Plan& plan, std::size_t body, std::span<const double> parameters,
                                     std::vector<Skipped>* skipped);
/// The same for given motions.
std::vector<MovedFrames> move_frames(const Plan& plan, std::size_t body, std::span<const Deformations> motions,
                                     std::span<const double> parameters, std::vector<Skipped>* skipped);

}  // namespace morula::study
