// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/study/study.hpp>

#include "run/poses.hpp"

namespace morula::study {
namespace {

/// "Study of limb", "Study of 6 bodies: limb, bar, torus, blob, hand, vessel".
std::string page_title(const Plan& plan) {
  if (plan.bodies.size() == 1) return "Study of " + plan.bodies.front().name;
  constexpr std::size_t most_named = 6;
  std::string names;
  for (std::size_t i = 0; i < std::min(most_named, plan.bodies.size()); ++i)
    names += (i == 0 ? "" : ", ") + plan.bodies[i].name;
  if (plan.bodies.size() > most_named) names += fmt::format(" and {} more", plan.bodies.size() - most_named);
  return fmt::format("Study of {} bodies: {}", plan.bodies.size(), names);
}

}  // namespace

PageContent study_page(const Study& study, Workers& workers, const Progress& progress) {
  const Plan& plan = study.plan;
  const NamedMesh& body = plan.bodies.front();
  const std::size_t chosen = shown_tree(plan);
  const std::vector<double> parameters = plan.parameters();
  PageContent content{.title = page_title(plan), .motions = {}, .scenes = {}, .study = {}};
  content.study = study_json(study);
  std::vector<MovedFrames> motions = move_frames(plan, 0, parameters, nullptr);
  constexpr std::array rules{Rule::approach2, Rule::exact};
  for (std::size_t m = 0; m < motions.size(); ++m) {
    PageMotion& motion = content.motions.emplace_back(PageMotion{.body = body.name,
                                                                 .name = motions[m].name,
                                                                 .facets = body.mesh.facets,
                                                                 .frame_names = {},
                                                                 .frames = std::move(motions[m].frames)});
    for (const double parameter : parameters) motion.frame_names.push_back(fmt::format("{:.0f} %", 100 * parameter));
    for (std::size_t r = 0; r < rules.size(); ++r) {
      const auto tell = [&](double share) {
        const auto done = static_cast<double>(m * rules.size() + r) + share;
        if (progress) progress(done / static_cast<double>(motions.size() * rules.size()), "the page");
      };
      content.scenes.push_back(follow_motion(motion, body.mesh, study.result.model[chosen], plan.sources[chosen].method,
                                             {rules[r]}, true, workers, tell));
      content.scenes.back().motion = m;
    }
  }
  return content;
}

}  // namespace morula::study
