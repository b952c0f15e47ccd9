// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/page.hpp"

#include <fmt/format.h>

#include "page/scene.hpp"
#include "shared/experiment.hpp"
#include "study/figures.hpp"

namespace morula::cli {

PageContent study_page(const StudyPlan& plan, const StudyResult& result, Json study, Workers& workers,
                       const std::function<void(double, std::string)>& progress) {
  const NamedMesh& body = plan.bodies.front();
  const std::size_t chosen = shown_tree(plan, result);
  const std::vector<double> parameters = plan.parameters();
  std::vector<std::string> skipped;
  PageContent content{.title = fmt::format("Study of {}", body.name), .motions = {}, .scenes = {}, .study = {}};
  content.study = std::move(study);
  const std::vector<MovedFrames> motions = move_frames(body, plan.motions, parameters, skipped);
  const std::vector<Rule> rules{Rule::approach2, Rule::exact};
  for (std::size_t m = 0; m < motions.size(); ++m) {
    PageMotion& motion = content.motions.emplace_back(PageMotion{.body = body.name,
                                                                 .name = motions[m].name,
                                                                 .facets = body.mesh.facets,
                                                                 .frame_names = {},
                                                                 .frames = motions[m].frames});
    for (const double parameter : parameters) motion.frame_names.push_back(fmt::format("{:.0f} %", 100 * parameter));
    for (std::size_t r = 0; r < rules.size(); ++r) {
      const auto tell = [&](double share) {
        const auto done = static_cast<double>(m * rules.size() + r) + share;
        progress(done / static_cast<double>(motions.size() * rules.size()), "the page");
      };
      content.scenes.push_back(follow_motion(motion, body.mesh, result.shown[chosen], result.trees[chosen].method,
                                             {rules[r]}, true, workers, tell));
      content.scenes.back().motion = m;
    }
  }
  return content;
}

}  // namespace morula::cli
