// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the paper did not measure: cover, and what it costs.
#include <map>

#include "study/evidence.hpp"

namespace morula::cli {
namespace {

struct Bare {
  std::size_t bare = 0;   // cases with surface bare in some sample
  std::size_t total = 0;  // cases
  double worst = 0;
  double worst_gap = 0;
  Case where;
};

Bare bare_of(const Evidence& evidence, const std::string& rule) {
  Bare found;
  for (const Case& c : cases(evidence)) {
    const StudyCell* cell = evidence.cell(c.method, c.motion, rule);
    if (cell == nullptr) continue;
    double worst = 0;
    for (const StudySample& s : cell->samples) {
      worst = std::max(worst, cell->at(s.sample, c.level)->bare_area);
      found.worst_gap = std::max(found.worst_gap, cell->at(s.sample, c.level)->gap);
    }
    ++found.total;
    found.bare += worst > 0 ? 1 : 0;
    if (worst > found.worst) found.worst = worst, found.where = c;
  }
  return found;
}

std::vector<StudyClaim> cover_claims(const Evidence& evidence) {
  std::vector<StudyClaim> claims;
  for (const std::string rule : {"traditional", "weighted", "approach1", "approach2"}) {
    const Bare found = bare_of(evidence, rule);
    StudyClaim claim{rule + "-bare",
                     "new",
                     fmt::format("{} leaves surface bare", rule_title(rule)),
                     verdict_of(found.bare, found.total),
                     "",
                     {"fig2a-bare", "fig2b-bare"}};
    if (found.total > 0) {
      claim.numbers =
          fmt::format("In {} of {} cases, up to {} of the surface{}, with gaps up to {} of the diagonal.", found.bare,
                      found.total, percent(found.worst),
                      found.worst > 0 ? fmt::format(" ({})", found.where.text()) : "", percent(found.worst_gap));
    }
    claims.push_back(std::move(claim));
  }
  for (const std::string rule : {"exact", "refitted"}) {
    const Bare found = bare_of(evidence, rule);
    StudyClaim claim{rule + "-covers",
                     "new",
                     fmt::format("{} leaves nothing bare", rule_title(rule)),
                     verdict_of(found.total - found.bare, found.total),
                     "",
                     {"fig2a-bare", "fig2b-bare"}};
    if (found.total > 0)
      claim.numbers =
          fmt::format("Nothing is bare in {} of {} cases, in every sample.", found.total - found.bare, found.total);
    claims.push_back(std::move(claim));
  }
  return claims;
}

/// How much looser one rule is than another, case by case.
StudyClaim ratio_claim(const Evidence& evidence, StudyClaim claim, const std::string& rule, const std::string& other,
                       double most, bool at_the_end, const std::vector<std::size_t>& levels) {
  std::size_t count = 0;
  std::map<std::string, std::vector<double>> by_motion;
  std::vector<double> all;
  for (const Case& c : cases(evidence)) {
    if (std::find(levels.begin(), levels.end(), c.level) == levels.end()) continue;
    const auto mine = at_the_end ? evidence.error_at(c.method, c.motion, rule, c.level, evidence.last())
                                 : evidence.mean_error(c.method, c.motion, rule, c.level);
    const auto theirs = at_the_end ? evidence.error_at(c.method, c.motion, other, c.level, evidence.last())
                                   : evidence.mean_error(c.method, c.motion, other, c.level);
    if (!mine || !theirs || *theirs <= 0) continue;
    all.push_back(*mine / *theirs);
    by_motion[c.motion].push_back(all.back());
    count += all.back() <= most ? 1 : 0;
  }
  claim.verdict = verdict_of(count, all.size());
  if (all.empty()) return claim;
  std::string text;
  for (const std::string& motion : evidence.motions()) {
    if (by_motion[motion].empty()) continue;
    const auto [low, high] = std::minmax_element(by_motion[motion].begin(), by_motion[motion].end());
    text += fmt::format("{}{} {} ({} to {})", text.empty() ? "" : ", ", motion, figure(median(by_motion[motion])),
                        figure(*low), figure(*high));
  }
  claim.numbers = fmt::format("In {} of {} cases; ratio in the median (least to most): {}.", count, all.size(), text);
  return claim;
}

StudyClaim bare_gain_claim(const Evidence& evidence) {
  StudyClaim claim{
      "approach2-gain-is-bare", "new", "Where Approach 2 is tighter than exact, it leaves surface bare", "untested", "",
      {"fig2a", "fig2a-bare"}};
  std::size_t tighter = 0;
  std::size_t bare = 0;
  std::size_t total = 0;
  for (const Case& c : cases(evidence)) {
    const auto second = evidence.errors(c.method, c.motion, "approach2", c.level);
    const auto exact = evidence.errors(c.method, c.motion, "exact", c.level);
    if (second.size() != exact.size()) continue;
    for (std::size_t i = 1; i < exact.size(); ++i) {
      ++total;
      if (second[i] >= exact[i]) continue;
      ++tighter;
      bare += evidence.cell(c.method, c.motion, "approach2")->samples[i].levels.empty()       ? 0
              : evidence.cell(c.method, c.motion, "approach2")->at(i, c.level)->bare_area > 0 ? 1
                                                                                              : 0;
    }
  }
  claim.verdict = verdict_of(bare, tighter);
  if (total > 0)
    claim.numbers = fmt::format("It is tighter in {} of {} deformed samples, and leaves surface bare in {} of these.",
                                tighter, total, bare);
  return claim;
}

StudyClaim void_claim(const Evidence& evidence) {
  StudyClaim claim{"void-spheres", "new", "Generators make void spheres, which the traditional update cannot follow",
                   "untested",     "",    {}};
  std::size_t with = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::vector<StudyTree>* list : {&evidence.result().trees, &evidence.result().needles}) {
    for (const StudyTree& tree : *list) {
      if (list == &evidence.result().trees && tree.body != evidence.body()) continue;
      const TreeLevel& leaves = tree.levels.back();
      ++total;
      with += leaves.void_spheres > 0 ? 1 : 0;
      text += fmt::format("{}{} on {} {}", text.empty() ? "" : ", ", tree.method, tree.body,
                          percent(static_cast<double>(leaves.void_spheres) / static_cast<double>(leaves.nodes)));
    }
  }
  claim.verdict = verdict_of(with, total);
  if (total > 0) claim.numbers = fmt::format("On the last level: {}.", text);
  return claim;
}

}  // namespace

std::vector<StudyClaim> new_claims(const Evidence& evidence) {
  std::vector<StudyClaim> claims = cover_claims(evidence);
  claims.push_back(bare_gain_claim(evidence));
  claims.push_back(ratio_claim(
      evidence,
      {"exact-cost", "new", "Cover by exact costs at most twice the error of Approach 2", "", "", {"fig2a", "fig2b"}},
      "exact", "approach2", 2, false, evidence.levels()));
  claims.push_back(ratio_claim(
      evidence,
      {"exact-below-approach1", "new", "exact is tighter than Approach 1, and covers", "", "", {"fig2a", "fig2b"}},
      "exact", "approach1", 1, false, evidence.levels()));
  claims.push_back(ratio_claim(evidence,
                               {"refitted-near-floor",
                                "new",
                                "Re-fitted, exact is at most twice as loose as a fresh tree at the full amount",
                                "",
                                "",
                                {"fig2a", "fig2b"}},
                               "refitted", "fresh", 2, true, evidence.levels()));
  claims.push_back(void_claim(evidence));
  return claims;
}

}  // namespace morula::cli
