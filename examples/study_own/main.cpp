// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A study of one's own: a rule, a generator and a metric beside those of Morula, in one plan.
#include <cstdio>

#include "own.hpp"

using namespace morula;

int main() {
  study::Plan plan{.bodies = {{"limb", sample_body("limb", 12)}}};
  plan.sources = study::sources_of(plan.bodies, {Method::grid});
  plan.motions = study::paper_motions();
  plan.rules = {Rule::traditional, Rule::approach2, Rule::exact};
  plan.samples = 5;
  plan.resolution = 48;
  example::add_own(plan);
  const study::Study done = study::make_study(plan);
  for (const char* id : {"drift-below-traditional", "drift-tighter-than-exact", "mine-below-generators"})
    if (const study::Claim* claim = study::find_claim(done.claims, id))
      std::printf("%s: %s. %s\n", claim->claim.c_str(), std::string(word(*claim)).c_str(), claim->numbers.c_str());
  return study::faults(plan, done.result).empty() ? 0 : 1;
}
