// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims beyond the paper: cover, and what it costs.
#include <map>

#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

struct Uncovered {
  std::size_t cases = 0;  // cases with uncovered surface in some sample
  std::size_t total = 0;  // cases
  double worst = 0;
  double worst_distance = 0;
  Case where;
};

Uncovered uncovered_by(const Evidence& evidence, const RuleKey& rule) {
  Uncovered found;
  for (const Case& c : evidence.cases()) {
    const MotionRun* cell = evidence.cell(c, rule);
    if (cell == nullptr) continue;
    double worst = 0;
    for (const Sample* s : evidence.samples(*cell)) {
      const LevelFigures& figures = *cell->at(s->sample, c.level);
      worst = std::max(worst, figures.uncovered_area());
      found.worst_distance = std::max(found.worst_distance, figures.uncovered_distance());
    }
    ++found.total;
    found.cases += worst > 0 ? 1 : 0;
    if (worst > found.worst) found.worst = worst, found.where = c;
  }
  return found;
}

const std::vector<std::string>& cover_figures() {
  static const std::vector<std::string> figures{"fig2a-uncovered", "fig2b-uncovered"};
  return figures;
}

std::vector<Claim> cover_claims(const Evidence& evidence) {
  std::vector<Claim> claims;
  for (const RuleKey& rule :
       {RuleKey(Rule::traditional), RuleKey(Rule::weighted), RuleKey(Rule::approach1), RuleKey(Rule::approach2)}) {
    const Uncovered found = uncovered_by(evidence, rule);
    Claim claim = make_claim(name(rule) + "-uncovered", ClaimOrigin::ours,
                             fmt::format("{} leaves surface uncovered", title(rule)), cover_figures());
    claim.adverse = true;
    claim.quantity = {.name = "largest uncovered share of the surface", .of_motion = true};
    evidence.decide(claim, found.cases, found.total, found.worst,
                    fmt::format("In {} of {} cases, up to {} of the surface{}, at distances up to {} of the diagonal.",
                                found.cases, found.total, percent(found.worst),
                                found.worst > 0 ? fmt::format(" ({})", evidence.text(found.where)) : "",
                                percent(found.worst_distance)));
    claims.push_back(std::move(claim));
  }
  for (const RuleKey& rule : {RuleKey(Rule::exact), RuleKey(rebuilt)}) {
    const Uncovered found = uncovered_by(evidence, rule);
    Claim claim = make_claim(name(rule) + "-covers", ClaimOrigin::ours,
                             fmt::format("{} leaves no surface uncovered", title(rule)), cover_figures());
    claim.guarantee = true;
    claim.quantity = {.name = "largest uncovered share of the surface", .of_motion = true};
    evidence.decide(claim, found.total - found.cases, found.total, found.worst,
                    fmt::format("No surface is uncovered in {} of {} cases, in every sample.",
                                found.total - found.cases, found.total));
    claims.push_back(std::move(claim));
  }
  return claims;
}

/// The looseness of one rule relative to another, case by case.
Claim ratio_claim(const Evidence& evidence, Claim claim, const RuleKey& rule, const RuleKey& other, double most,
                  bool at_the_end, const std::vector<std::size_t>& levels) {
  claim.quantity.is_ratio = claim.quantity.of_grid = true;
  claim.quantity.of_motion = !at_the_end;
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
  if (all.empty() || (at_the_end && evidence.view().half_amount)) return claim;
  std::string text;
  for (const std::size_t motion : evidence.motions()) {
    if (by_motion[motion].empty()) continue;
    const auto [low, high] = std::minmax_element(by_motion[motion].begin(), by_motion[motion].end());
    text += fmt::format("{}{} {} ({} to {})", text.empty() ? "" : ", ", evidence.motion(motion),
                        figure(median(by_motion[motion])), figure(*low), figure(*high));
  }
  evidence.decide(claim, count, all.size(), median(all),
                  fmt::format("In {} of {} cases; ratio in the median (least to most): {}.", count, all.size(), text));
  return claim;
}

Claim uncovered_gain_claim(const Evidence& evidence) {
  Claim claim =
      make_claim("approach2-gain-is-uncovered", ClaimOrigin::ours,
                 "Where Approach 2 is tighter than exact, it leaves surface uncovered", {"fig2a", "fig2a-uncovered"});
  claim.quantity = {.name = "share of the samples in which Approach 2 is tighter", .of_motion = true, .of_grid = true};
  std::size_t tighter = 0;
  std::size_t uncovered = 0;
  std::size_t total = 0;
  for (const Case& c : evidence.cases()) {
    const MotionRun* cell = evidence.cell(c, Rule::approach2);
    const auto second = evidence.errors(c, Rule::approach2);
    const auto exact = evidence.errors(c, Rule::exact);
    if (cell == nullptr || second.size() != exact.size()) continue;
    const std::vector<const Sample*> samples = evidence.samples(*cell);
    for (std::size_t i = 1; i < exact.size(); ++i) {
      ++total;
      if (second[i] >= exact[i]) continue;
      ++tighter;
      uncovered += cell->at(samples[i]->sample, c.level)->uncovered_area() > 0 ? 1 : 0;
    }
  }
  const double share = static_cast<double>(tighter) / static_cast<double>(std::max<std::size_t>(total, 1));
  evidence.decide(
      claim, uncovered, tighter, share,
      fmt::format("It is tighter in {} of {} deformed samples, and leaves surface uncovered in {} of these.", tighter,
                  total, uncovered));
  return claim;
}

Claim void_claim(const Evidence& evidence) {
  Claim claim = make_claim("void-spheres", ClaimOrigin::ours,
                           "Generators make void spheres, which the traditional update cannot follow", {});
  claim.quantity = {.name = "share of leaves that are void (mean of trees of the body)"};
  double share_sum = 0, on_body = 0;
  std::size_t with = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::vector<TreeFigures>* list : {&evidence.result().trees, &evidence.result().needles}) {
    for (const TreeFigures& tree : *list) {
      const bool is_prism = list == &evidence.result().needles;
      const NamedMesh& body = evidence.plan().body_of(tree.source);
      if (!is_prism && !evidence.plan().is_of(evidence.plan().sources[tree.source], evidence.trial())) continue;
      if (tree.levels.empty()) continue;
      const TreeLevel& leaves = tree.levels.back();
      const double share = static_cast<double>(leaves.void_spheres) / static_cast<double>(leaves.nodes);
      if (!is_prism) share_sum += share, on_body += 1;
      ++total;
      with += leaves.void_spheres > 0 ? 1 : 0;
      text += fmt::format("{}{} on {} {}", text.empty() ? "" : ", ", evidence.method(tree.source),
                          is_prism ? "prism" : body.name, percent(share));
    }
  }
  evidence.decide(claim, with, total, on_body > 0 ? std::optional(share_sum / on_body) : std::nullopt,
                  fmt::format("On the last level: {}.", text));
  return claim;
}

}  // namespace

std::vector<Claim> new_claims(const Evidence& evidence) {
  std::vector<Claim> claims = cover_claims(evidence);
  claims.push_back(uncovered_gain_claim(evidence));
  const auto add = [&](const char* id, const char* sentence, const char* quantity, const RuleKey& rule,
                       const RuleKey& other, double most, bool at_the_end) {
    Claim claim = make_claim(id, ClaimOrigin::ours, sentence, {"fig2a", "fig2b"});
    claim.quantity.name = quantity;
    claims.push_back(ratio_claim(evidence, std::move(claim), rule, other, most, at_the_end, evidence.levels()));
  };
  add("exact-cost", "Cover by exact costs at most twice the error of Approach 2",
      "error of exact over that of Approach 2 (median of cases)", Rule::exact, Rule::approach2, 2, false);
  add("exact-below-approach1", "exact is tighter than Approach 1, and covers",
      "error of exact over that of Approach 1 (median of cases)", Rule::exact, Rule::approach1, 1, false);
  add("rebuilt-near-floor", "Rebuilt, exact is at most twice as loose as a fresh tree at the full amount",
      "error of exact, rebuilt, over that of a fresh tree (median of cases)", rebuilt, fresh, 2, true);
  claims.push_back(void_claim(evidence));
  return claims;
}

}  // namespace morula::study
