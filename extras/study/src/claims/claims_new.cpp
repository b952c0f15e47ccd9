// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims beyond the paper: cover, and what it costs.
#include <map>

#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

struct Bare {
  std::size_t bare = 0;   // cases with uncovered surface in some sample
  std::size_t total = 0;  // cases
  double worst = 0;
  double worst_uncovered_distance = 0;
  Case where;
};

Bare bare_of(const Evidence& evidence, const RuleKey& rule) {
  Bare found;
  for (const Case& c : evidence.cases()) {
    const MotionRun* cell = evidence.cell(c, rule);
    if (cell == nullptr) continue;
    double worst = 0;
    for (const Sample& s : cell->samples) {
      worst = std::max(worst, cell->at(s.sample, c.level)->uncovered_area());
      found.worst_uncovered_distance =
          std::max(found.worst_uncovered_distance, cell->at(s.sample, c.level)->uncovered_distance());
    }
    ++found.total;
    found.bare += worst > 0 ? 1 : 0;
    if (worst > found.worst) found.worst = worst, found.where = c;
  }
  return found;
}

std::vector<Claim> cover_claims(const Evidence& evidence) {
  std::vector<Claim> claims;
  for (const RuleKey& rule :
       {RuleKey(Rule::traditional), RuleKey(Rule::weighted), RuleKey(Rule::approach1), RuleKey(Rule::approach2)}) {
    const Bare found = bare_of(evidence, rule);
    Claim claim{name(rule) + "-bare",
                ClaimOrigin::ours,
                fmt::format("{} leaves surface bare", title(rule)),
                verdict_of(found.bare, found.total),
                "",
                {"fig2a-bare", "fig2b-bare"}};
    claim.adverse = true;
    if (found.total > 0) {
      claim.numbers = fmt::format("In {} of {} cases, up to {} of the surface{}, with gaps up to {} of the diagonal.",
                                  found.bare, found.total, percent(found.worst),
                                  found.worst > 0 ? fmt::format(" ({})", evidence.text(found.where)) : "",
                                  percent(found.worst_uncovered_distance));
    }
    claims.push_back(std::move(claim));
  }
  for (const RuleKey& rule : {RuleKey(Rule::exact), RuleKey(rebuilt)}) {
    const Bare found = bare_of(evidence, rule);
    Claim claim{name(rule) + "-covers",
                ClaimOrigin::ours,
                fmt::format("{} leaves nothing bare", title(rule)),
                verdict_of(found.total - found.bare, found.total),
                "",
                {"fig2a-bare", "fig2b-bare"}};
    claim.guarantee = true;
    if (found.total > 0)
      claim.numbers =
          fmt::format("Nothing is bare in {} of {} cases, in every sample.", found.total - found.bare, found.total);
    claims.push_back(std::move(claim));
  }
  return claims;
}

/// The looseness of one rule relative to another, case by case.
Claim ratio_claim(const Evidence& evidence, Claim claim, const RuleKey& rule, const RuleKey& other, double most,
                  bool at_the_end, const std::vector<std::size_t>& levels) {
  std::size_t count = 0;
  std::map<std::size_t, std::vector<double>> by_motion;
  std::vector<double> all;
  for (const Case& c : evidence.cases()) {
    if (std::find(levels.begin(), levels.end(), c.level) == levels.end()) continue;
    const auto mine = at_the_end ? evidence.error_at(c, rule, evidence.last()) : evidence.mean_error(c, rule);
    const auto theirs = at_the_end ? evidence.error_at(c, other, evidence.last()) : evidence.mean_error(c, other);
    if (!mine || !theirs || *theirs <= 0) continue;
    all.push_back(*mine / *theirs);
    by_motion[c.motion].push_back(all.back());
    count += all.back() <= most ? 1 : 0;
  }
  claim.verdict = verdict_of(count, all.size());
  if (all.empty()) return claim;
  std::string text;
  for (const std::size_t motion : evidence.motions()) {
    if (by_motion[motion].empty()) continue;
    const auto [low, high] = std::minmax_element(by_motion[motion].begin(), by_motion[motion].end());
    text += fmt::format("{}{} {} ({} to {})", text.empty() ? "" : ", ", evidence.motion(motion),
                        figure(median(by_motion[motion])), figure(*low), figure(*high));
  }
  claim.numbers = fmt::format("In {} of {} cases; ratio in the median (least to most): {}.", count, all.size(), text);
  return claim;
}

Claim bare_gain_claim(const Evidence& evidence) {
  Claim claim{"approach2-gain-is-bare",
              ClaimOrigin::ours,
              "Where Approach 2 is tighter than exact, it leaves surface bare",
              Verdict::untested,
              "",
              {"fig2a", "fig2a-bare"}};
  std::size_t tighter = 0;
  std::size_t bare = 0;
  std::size_t total = 0;
  for (const Case& c : evidence.cases()) {
    const auto second = evidence.errors(c, Rule::approach2);
    const auto exact = evidence.errors(c, Rule::exact);
    if (second.size() != exact.size()) continue;
    for (std::size_t i = 1; i < exact.size(); ++i) {
      ++total;
      if (second[i] >= exact[i]) continue;
      ++tighter;
      bare += evidence.cell(c, Rule::approach2)->at(i, c.level)->uncovered_area() > 0 ? 1 : 0;
    }
  }
  claim.verdict = verdict_of(bare, tighter);
  if (total > 0)
    claim.numbers = fmt::format("It is tighter in {} of {} deformed samples, and leaves surface bare in {} of these.",
                                tighter, total, bare);
  return claim;
}

Claim void_claim(const Evidence& evidence) {
  Claim claim{"void-spheres",
              ClaimOrigin::ours,
              "Generators make void spheres, which the traditional update cannot follow",
              Verdict::untested,
              "",
              {}};
  std::size_t with = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::vector<TreeFigures>* list : {&evidence.result().trees, &evidence.result().needles}) {
    for (const TreeFigures& tree : *list) {
      const bool is_prism = list == &evidence.result().needles;
      const NamedMesh& body = evidence.plan().body_of(tree.source);
      if (!is_prism && evidence.plan().sources[tree.source].body != evidence.body()) continue;
      const TreeLevel& leaves = tree.levels.back();
      ++total;
      with += leaves.void_spheres > 0 ? 1 : 0;
      text += fmt::format("{}{} on {} {}", text.empty() ? "" : ", ", evidence.method(tree.source),
                          is_prism ? "prism" : body.name,
                          percent(static_cast<double>(leaves.void_spheres) / static_cast<double>(leaves.nodes)));
    }
  }
  claim.verdict = verdict_of(with, total);
  if (total > 0) claim.numbers = fmt::format("On the last level: {}.", text);
  return claim;
}

}  // namespace

std::vector<Claim> new_claims(const Evidence& evidence) {
  std::vector<Claim> claims = cover_claims(evidence);
  claims.push_back(bare_gain_claim(evidence));
  claims.push_back(ratio_claim(evidence,
                               {"exact-cost",
                                ClaimOrigin::ours,
                                "Cover by exact costs at most twice the error of Approach 2",
                                Verdict::untested,
                                "",
                                {"fig2a", "fig2b"}},
                               Rule::exact, Rule::approach2, 2, false, evidence.levels()));
  claims.push_back(ratio_claim(evidence,
                               {"exact-below-approach1",
                                ClaimOrigin::ours,
                                "exact is tighter than Approach 1, and covers",
                                Verdict::untested,
                                "",
                                {"fig2a", "fig2b"}},
                               Rule::exact, Rule::approach1, 1, false, evidence.levels()));
  claims.push_back(ratio_claim(evidence,
                               {"rebuilt-near-floor",
                                ClaimOrigin::ours,
                                "Rebuilt, exact is at most twice as loose as a fresh tree at the full amount",
                                Verdict::untested,
                                "",
                                {"fig2a", "fig2b"}},
                               rebuilt, fresh, 2, true, evidence.levels()));
  claims.push_back(void_claim(evidence));
  return claims;
}

}  // namespace morula::study
