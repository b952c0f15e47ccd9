// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study_scenes.hpp"

#include <fmt/format.h>

#include <morula/update/body.hpp>
#include <stdexcept>

#include "study_figures.hpp"

namespace morula::cli {

std::vector<StudyScene> study_scenes(const StudyPlan& plan, const StudyResult& result, const std::vector<Rule>& rules) {
  const NamedMesh& body = plan.bodies.front();
  const std::size_t chosen = shown_tree(plan, result);
  const Built& built = result.shown[chosen];
  std::vector<std::string> skipped;
  std::vector<StudyScene> scenes;
  for (const MovedFrames& motion : move_frames(body, plan.motions, plan.parameters(), skipped)) {
    for (const Rule rule : rules) {
      StudyScene scene;
      scene.title = fmt::format("{}, {}, {}", body.name, motion.name, name(rule));
      scene.body = body.name;
      scene.motion = first_word(motion.name);
      scene.method = result.trees[chosen].method;
      scene.rule = name(rule);
      scene.mesh = body.mesh;
      scene.frames = motion.frames;
      scene.tree = built.tree;
      Body moving(body.mesh, built, {.rules = {rule}, .details = {}, .modes = {}});
      for (const std::vector<Vec3>& positions : motion.frames) {
        if (!moving.update(positions)) throw std::logic_error("the study's own motion was refused by update");
        moving.copy_spheres(scene.spheres.emplace_back());
      }
      scenes.push_back(std::move(scene));
    }
  }
  return scenes;
}

}  // namespace morula::cli
