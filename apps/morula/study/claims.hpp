// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The claims of the paper and ours, each with its criterion: docs/study.md.
#pragma once

#include <span>

#include "study/cost.hpp"

namespace morula::cli {

/// A case is a tree, a motion and a level. A claim about cases holds when it does in all of them, fails when in none,
/// and is partly right in between; untested when there is no case. The criteria: docs/study.md.
struct StudyClaim {
  std::string id;
  std::string source;  // paper, new
  std::string claim;
  std::string verdict;  // holds, partly, fails, untested
  std::string numbers;
  std::vector<std::string> figures;
  bool timed = false;  // rests on times, which differ from run to run
};
Json claim_json(const StudyClaim& claim);

/// Of one body. cost: of the first one, or nullptr.
std::vector<StudyClaim> make_claims(const StudyPlan& plan, const StudyResult& result, const std::string& body,
                                    const StudyCost* cost);
/// Over all bodies: a claim holds when it does on all of them, fails when on all, and is partly right in between.
std::vector<StudyClaim> join_claims(const std::vector<std::vector<StudyClaim>>& of_bodies);

/// e(t) = c + a·exp(b t) over t in [0, 1], by least squares: b > 0 grows ever faster, b < 0 ever slower.
struct GrowthFit {
  double a = 0, b = 0, c = 0;
  double r2 = 0;       // share of the variance that the exponential explains
  double r2_line = 0;  // and a straight line
  double r2_parabola = 0;
};
GrowthFit fit_growth(std::span<const double> t, std::span<const double> e);

}  // namespace morula::cli
