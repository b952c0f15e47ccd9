// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims on one's own rules and generators, with the criteria of those on the study's own.
#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

Claim own_claim(std::string id, std::string sentence, std::vector<std::string> figures) {
  return make_claim(std::move(id), ClaimOrigin::ours, std::move(sentence), std::move(figures));
}

/// The loss: the increase of the mean error over that at rest.
std::optional<double> own_loss(const Evidence& evidence, const Case& c, const RuleKey& rule) {
  const std::optional<double> mean = evidence.mean_error(c, rule);
  return mean ? std::optional(*mean - evidence.errors(c, rule).front()) : std::nullopt;
}

Claim own_loss_claim(const Evidence& evidence, const RuleKey& rule) {
  Claim claim = own_claim(name(rule) + "-below-traditional",
                          fmt::format("{}: lower loss of accuracy than in traditional update techniques", title(rule)),
                          {"fig2a", "fig2b"});
  std::size_t lower = 0, total = 0;
  std::vector<double> ratios;
  for (const Case& c : evidence.cases()) {
    const auto mine = own_loss(evidence, c, rule), other = own_loss(evidence, c, Rule::traditional);
    if (!mine || !other) continue;
    ++total;
    lower += *mine < *other ? 1 : 0;
    if (*other > 0) ratios.push_back(*mine / *other);
  }
  if (ratios.empty()) return claim;
  claim.quantity = {
      .name = "loss over that of traditional, median", .is_ratio = true, .of_motion = true, .of_grid = true};
  evidence.decide(claim, lower, total, median(ratios),
                  fmt::format("Lower in {} of {} cases; its loss is {} that of traditional in the median.", lower,
                              total, times(median(ratios))));
  return claim;
}

Claim own_uncovered_claim(const Evidence& evidence, const RuleKey& rule) {
  Claim claim = own_claim(name(rule) + "-uncovered", fmt::format("{} leaves surface uncovered", title(rule)),
                          {"fig2a-uncovered", "fig2b-uncovered"});
  claim.adverse = true;
  std::size_t count = 0, total = 0;
  double worst = 0, distance = 0;
  for (const Case& c : evidence.cases()) {
    const MotionRun* cell = evidence.cell(c, rule);
    if (cell == nullptr) continue;
    double of_case = 0;
    for (const Sample* s : evidence.samples(*cell)) {
      const LevelFigures* figures = cell->at(s->sample, c.level);
      if (figures == nullptr) continue;
      of_case = std::max(of_case, figures->uncovered_area());
      distance = std::max(distance, figures->uncovered_distance());
    }
    ++total;
    count += of_case > 0 ? 1 : 0;
    worst = std::max(worst, of_case);
  }
  if (total == 0) return claim;
  claim.quantity = {.name = "largest uncovered share of the surface", .of_motion = true};
  evidence.decide(claim, count, total, worst,
                  fmt::format("In {} of {} cases, up to {} of the surface, at distances up to {} of the diagonal.",
                              count, total, percent(worst), percent(distance)));
  return claim;
}

Claim own_exact_claim(const Evidence& evidence, const RuleKey& rule) {
  Claim claim = own_claim(name(rule) + "-tighter-than-exact", fmt::format("{} is tighter than exact", title(rule)),
                          {"fig2a", "fig2b"});
  std::size_t tighter = 0;
  std::vector<double> ratios;
  for (const Case& c : evidence.cases()) {
    const auto mine = evidence.mean_error(c, rule), exact = evidence.mean_error(c, Rule::exact);
    if (!mine || !exact || *exact <= 0) continue;
    ratios.push_back(*mine / *exact);
    tighter += ratios.back() < 1 ? 1 : 0;
  }
  if (ratios.empty()) return claim;
  const auto [low, high] = std::minmax_element(ratios.begin(), ratios.end());
  claim.quantity = {
      .name = "mean error over that of exact, median", .is_ratio = true, .of_motion = true, .of_grid = true};
  evidence.decide(claim, tighter, ratios.size(), median(ratios),
                  fmt::format("In {} of {} cases; the ratio of mean errors is {} in the median ({} to {}).", tighter,
                              ratios.size(), figure(median(ratios)), figure(*low), figure(*high)));
  return claim;
}

Claim own_return_claim(const Evidence& evidence, const RuleKey& rule) {
  Claim claim =
      own_claim(name(rule) + "-returns-to-rest", fmt::format("{} returns to the initial condition", title(rule)), {});
  std::size_t count = 0, total = 0;
  for (const std::size_t source : evidence.sources()) {
    for (const std::size_t motion : evidence.motions()) {
      const MotionRun* cell = evidence.cell({source, motion}, rule);
      if (cell == nullptr || !cell->returns_to_rest) continue;
      ++total;
      count += *cell->returns_to_rest ? 1 : 0;
    }
  }
  if (total > 0)
    evidence.decide(claim, count, total, std::nullopt,
                    fmt::format("The spheres are those of rest, bit for bit, after {} of {} motions.", count, total));
  return claim;
}

/// By Approach 2, against the paper's generators. Untested for a body without this tree.
Claim own_generator_claim(const Evidence& evidence, const std::string& own) {
  Claim claim = own_claim(own + "-below-generators",
                          fmt::format("{} is tighter than each of the paper's generators, with Approach 2", own), {});
  const auto source = std::find_if(evidence.sources().begin(), evidence.sources().end(),
                                   [&](std::size_t s) { return evidence.method(s) == own; });
  if (source == evidence.sources().end()) return claim;
  std::size_t below = 0, total = 0;
  std::vector<double> ratios;
  for (const std::size_t motion : evidence.motions()) {
    for (const std::size_t level : evidence.levels()) {
      const auto mine = evidence.mean_error({*source, motion, level}, Rule::approach2);
      std::optional<double> best;
      for (const std::size_t other : evidence.sources()) {
        const std::vector<Method> paper = paper_methods();
        const std::optional<Method> method = evidence.plan().sources[other].named();
        if (!method || std::find(paper.begin(), paper.end(), *method) == paper.end()) continue;
        const auto error = evidence.mean_error({other, motion, level}, Rule::approach2);
        if (error && (!best || *error < *best)) best = error;
      }
      if (!mine || !best || *best <= 0) continue;
      ++total;
      below += *mine < *best ? 1 : 0;
      ratios.push_back(*mine / *best);
    }
  }
  if (total == 0) return claim;
  claim.quantity = {
      .name = "mean error over the best generator's, median", .is_ratio = true, .of_motion = true, .of_grid = true};
  evidence.decide(claim, below, total, median(ratios),
                  fmt::format("In {} of {} cases; its mean error is {} that of the best of them in the median.", below,
                              total, times(median(ratios))));
  return claim;
}

}  // namespace

std::vector<Claim> own_claims(const Evidence& evidence) {
  std::vector<Claim> claims;
  for (const FollowRule& rule : evidence.plan().rules) {
    if (!rule.own) continue;
    const RuleKey key(*rule.own);
    claims.push_back(own_loss_claim(evidence, key));
    claims.push_back(own_uncovered_claim(evidence, key));
    claims.push_back(own_exact_claim(evidence, key));
    claims.push_back(own_return_claim(evidence, key));
  }
  std::vector<std::string> generators;
  for (const Source& source : evidence.plan().sources)
    if (source.own && std::find(generators.begin(), generators.end(), source.method) == generators.end())
      generators.push_back(source.method);
  for (const std::string& generator : generators) claims.push_back(own_generator_claim(evidence, generator));
  return claims;
}

}  // namespace morula::study
