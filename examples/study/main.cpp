// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study from C++: how loose two update rules leave a limb, level by level, and a page that shows it.
#include <cstdio>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/study/study.hpp>

using namespace morula;

int main() {
  study::Plan plan{.bodies = {{"limb", sample_body("limb", 12)}}};
  plan.sources = study::sources_of(plan.bodies, {Method::grid});
  plan.motions = study::paper_motions();
  plan.rules = {Rule::approach2, Rule::exact};
  plan.samples = 5;
  plan.resolution = 64;
  const study::Study done = study::make_study(plan);
  for (const study::Run& cell : done.result.cells)
    for (const study::LevelFigures& level : cell.samples[2].levels)  // half way
      std::printf("%s, %s, level %zu: looseness %.3f, bare %.2f %%\n", plan.rules[cell.key.rule].name.c_str(),
                  study::describe_all(plan.motions[cell.key.motion]).c_str(), level.level, level.looseness().value(),
                  100 * level.uncovered_area());
  if (has_page()) write_whole("study.html", make_page(study::study_page(done)));
  return study::faults(plan, done.result).empty() ? 0 : 1;  // exact covered, and everything came back to rest
}
