// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Moving bodies with their spheres: what is worth looking at beside the figures.
#pragma once

#include "study_run.hpp"

namespace morula::cli {

/// A body, its frames, and the spheres of one rule in each of them.
struct StudyScene {
  std::string title;  // "limb, stretch 2, approach2"
  std::string body;
  std::string motion;  // the first word: stretch
  std::string method;
  std::string rule;
  Mesh mesh;                                 // at rest
  std::vector<std::vector<Vec3>> frames;     // the samples of the figures
  SphereTree tree;                           // at rest
  std::vector<std::vector<Sphere>> spheres;  // one per node of the tree, for each frame
};

/// The first body on its medial tree (or its first one): every motion, with each of these rules.
std::vector<StudyScene> study_scenes(const StudyPlan& plan, const StudyResult& result,
                                     const std::vector<Rule>& rules = {Rule::approach2, Rule::exact});

}  // namespace morula::cli
