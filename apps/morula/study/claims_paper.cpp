// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The claims of the paper.
#include "study/evidence.hpp"

namespace morula::cli {
namespace {

StudyClaim loss_claim(const Evidence& evidence, const std::string& rule, std::vector<std::string> figures) {
  StudyClaim claim{rule + "-below-traditional",
                   "paper",
                   fmt::format("{}: lower loss of accuracy than in traditional update techniques", rule_title(rule)),
                   "",
                   "",
                   std::move(figures)};
  std::size_t lower = 0;
  std::size_t total = 0;
  std::vector<double> ratios;
  Case worst;
  for (const Case& c : cases(evidence)) {
    const auto mine = evidence.mean_error(c.method, c.motion, rule, c.level);
    const auto other = evidence.mean_error(c.method, c.motion, "traditional", c.level);
    if (!mine || !other) continue;
    // The loss: how much is added to the error at rest.
    const double my_loss = *mine - evidence.errors(c.method, c.motion, rule, c.level).front();
    const double other_loss = *other - evidence.errors(c.method, c.motion, "traditional", c.level).front();
    ++total;
    lower += my_loss < other_loss ? 1 : 0;
    if (other_loss <= 0) continue;
    ratios.push_back(my_loss / other_loss);
    if (ratios.back() >= *std::max_element(ratios.begin(), ratios.end())) worst = c;
  }
  claim.verdict = verdict_of(lower, total);
  if (!ratios.empty()) {
    claim.numbers = fmt::format(
        "Lower in {} of {} cases; its loss is {} that of traditional in the median, {} at most ({}).", lower, total,
        times(median(ratios)), times(*std::max_element(ratios.begin(), ratios.end())), worst.text());
  }
  return claim;
}

StudyClaim exponential_claim(const Evidence& evidence) {
  StudyClaim claim{"approach1-exponential",
                   "paper",
                   "Approach 1's error grows exponentially when the medial tree is stretched",
                   "untested",
                   "",
                   {"fig2a", "fig2b"}};
  std::size_t count = 0;
  std::size_t faster = 0;  // than a straight line, by far
  std::size_t total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    const std::vector<double> e = evidence.errors("medial", evidence.stretch(), "approach1", level);
    if (e.size() < 4) continue;
    const GrowthFit fit = fit_growth(evidence.parameters(), e);
    ++total;
    const bool bends_up = fit.b >= 1 && fit.r2 >= 0.98;
    faster += bends_up ? 1 : 0;
    count += bends_up && fit.r2 > fit.r2_parabola ? 1 : 0;  // which has as many free numbers
    text += fmt::format(
        "{}level {}: from {} to {}, best fit c + a·exp(b t) with b = {} (R² {}; a straight line {}, a parabola {})",
        text.empty() ? "" : "; ", level, figure(e.front()), figure(e.back()), figure(fit.b),
        fmt::format("{:.4f}", fit.r2), fmt::format("{:.4f}", fit.r2_line), fmt::format("{:.4f}", fit.r2_parabola));
  }
  claim.verdict = total == 0 ? "untested" : count == total ? "holds" : faster > 0 ? "partly" : "fails";
  if (total > 0)
    claim.numbers = fmt::format("Exponential means b ≥ 1 with R² ≥ 0.98, and no parabola fits better; {}.", text);
  return claim;
}

StudyClaim largely_better_claim(const Evidence& evidence) {
  StudyClaim claim{"approach2-largely-better",
                   "paper",
                   "Approach 2 is largely better than Approach 1 when the medial tree is stretched",
                   "untested",
                   "",
                   {"fig2a", "fig2b"}};
  std::size_t twice = 0;
  std::size_t better = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    const auto first = evidence.mean_error("medial", evidence.stretch(), "approach1", level);
    const auto second = evidence.mean_error("medial", evidence.stretch(), "approach2", level);
    if (!first || !second || *second <= 0) continue;
    const double ratio = *first / *second;
    ++total;
    twice += ratio >= 2 ? 1 : 0;
    better += ratio > 1 ? 1 : 0;
    double bare = 0;
    for (const StudySample& s : evidence.cell("medial", evidence.stretch(), "approach2")->samples)
      bare = std::max(bare, evidence.cell("medial", evidence.stretch(), "approach2")->at(s.sample, level)->bare_area);
    text += fmt::format("{}level {}: {} as loose in the mean, while Approach 2 leaves up to {} of the surface bare",
                        text.empty() ? "" : "; ", level, times(ratio), percent(bare));
  }
  claim.verdict = total == 0 ? "untested" : twice == total ? "holds" : better > 0 ? "partly" : "fails";
  if (total > 0) claim.numbers = fmt::format("Largely means Approach 1 is at least twice as loose; {}.", text);
  return claim;
}

StudyClaim return_claim(const Evidence& evidence) {
  StudyClaim claim{"returns-to-rest", "paper", "Both approaches return to the initial condition", "untested", "", {}};
  std::size_t count = 0;
  std::size_t total = 0;
  for (const std::string rule : {"approach1", "approach2"}) {
    for (const std::string& method : evidence.methods()) {
      for (const std::string& motion : evidence.motions()) {
        const StudyCell* cell = evidence.cell(method, motion, rule);
        if (cell == nullptr || !cell->returns_to_rest) continue;
        ++total;
        count += *cell->returns_to_rest ? 1 : 0;
      }
    }
  }
  claim.verdict = verdict_of(count, total);
  if (total > 0)
    claim.numbers = fmt::format("The spheres are those of rest, bit for bit, after {} of {} motions.", count, total);
  return claim;
}

/// Mean errors of the paper's generators with Approach 2, the best first; empty unless all four are there.
std::vector<std::pair<double, std::string>> ranking(const Evidence& evidence, const std::string& motion,
                                                    const std::vector<std::size_t>& levels, bool with_rest) {
  std::vector<std::pair<double, std::string>> list;
  for (const std::string& method : paper_methods()) {
    double sum = 0;
    double count = 0;
    for (const std::size_t level : levels) {
      const std::vector<double> e = evidence.errors(method, motion, "approach2", level);
      if (e.size() < 2) return {};
      for (std::size_t i = with_rest ? 0 : 1; i < e.size(); ++i) sum += e[i], count += 1;
    }
    list.emplace_back(sum / count, method);
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return list;
}

std::string ranking_text(const std::vector<std::pair<double, std::string>>& list) {
  std::string text;
  for (const auto& [error, method] : list)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", method, figure(error));
  return text;
}

/// A claim about the order of the generators in each motion.
template <class Holds>
StudyClaim order_claim(const Evidence& evidence, StudyClaim claim, const std::vector<std::size_t>& levels,
                       bool with_rest, const Holds& holds) {
  std::size_t count = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::string& motion : evidence.motions()) {
    const auto list = ranking(evidence, motion, levels, with_rest);
    if (list.empty()) continue;
    ++total;
    const bool right = holds(list);
    count += right ? 1 : 0;
    text += fmt::format("{}{} ({}): {}", text.empty() ? "" : "; ", motion, right ? "yes" : "no", ranking_text(list));
  }
  claim.verdict = verdict_of(count, total);
  if (total > 0) claim.numbers = fmt::format("Mean errors. {}.", text);
  return claim;
}

std::vector<std::string> motion_figures(const Evidence& evidence, const std::string& prefix) {
  std::vector<std::string> list;
  for (const std::string& motion : evidence.motions()) list.push_back(prefix + "-" + first_word(motion));
  return list;
}

std::vector<StudyClaim> generator_claims(const Evidence& evidence) {
  std::vector<StudyClaim> claims;
  const std::vector<std::string> upper = motion_figures(evidence, "fig2c");
  const std::vector<std::string> lower = motion_figures(evidence, "fig2d");
  std::vector<std::string> both = upper;
  both.insert(both.end(), lower.begin(), lower.end());
  claims.push_back(order_claim(
      evidence,
      {"level2-hubbard-medial", "paper",
       fmt::format("On level {} hubbard and medial are better than grid and spawn", evidence.upper()), "", "", upper},
      {evidence.upper()}, false, [](const auto& list) {
        const auto good = [](const std::string& m) { return m == "hubbard" || m == "medial"; };
        return good(list[0].second) && good(list[1].second);
      }));
  claims.push_back(
      order_claim(evidence,
                  {"level3-grid", "paper",
                   fmt::format("On level {} grid is slightly better than the others", evidence.lower()), "", "", lower},
                  {evidence.lower()}, false, [](const auto& list) { return list[0].second == "grid"; }));

  StudyClaim rigid{"level3-grid-rest",
                   "paper",
                   fmt::format("On level {} grid is more conservative than the others while rigid", evidence.lower()),
                   "untested",
                   "",
                   lower};
  std::vector<std::pair<double, std::string>> rest;
  for (const std::string& method : paper_methods()) {
    const auto e = evidence.error_at(method, evidence.motions().front(), "approach2", evidence.lower(), 0);
    if (e) rest.emplace_back(*e, method);
  }
  std::stable_sort(rest.begin(), rest.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (rest.size() == paper_methods().size()) {
    const auto place = static_cast<std::size_t>(
        std::find_if(rest.begin(), rest.end(), [](const auto& r) { return r.second == "grid"; }) - rest.begin());
    rigid.verdict = verdict_of(place, rest.size() - 1);
    rigid.numbers = fmt::format("Errors at rest: {}; grid is looser than {} of 3.", ranking_text(rest), place);
  }
  claims.push_back(rigid);

  claims.push_back(
      order_claim(evidence,
                  {"medial-best-average", "paper",
                   fmt::format("medial has the best average accuracy (mean over levels {}-{} and all samples)",
                               evidence.upper(), evidence.lower()),
                   "", "", both},
                  evidence.levels(), true, [](const auto& list) { return list[0].second == "medial"; }));
  return claims;
}

StudyClaim cost_claim(const StudyCost* cost) {
  StudyClaim claim{"cost-like-boxes",
                   "paper",
                   "The cost is similar to that of updating axis-aligned boxes",
                   "untested",
                   "",
                   {},
                   true};
  const UpdateCost* boxes = cost == nullptr ? nullptr : cost->find("boxes");
  const UpdateCost* first = cost == nullptr ? nullptr : cost->find("approach1");
  const UpdateCost* second = cost == nullptr ? nullptr : cost->find("approach2");
  if (boxes == nullptr || first == nullptr || second == nullptr || boxes->nanoseconds_per_vertex <= 0) return claim;
  std::size_t count = 0;
  for (const UpdateCost* rule : {first, second}) {
    const double ratio = rule->nanoseconds_per_vertex / boxes->nanoseconds_per_vertex;
    count += ratio >= 0.5 && ratio <= 2 ? 1 : 0;
  }
  claim.verdict = verdict_of(count, 2);
  claim.numbers = fmt::format(
      "Similar means within a factor of two. Boxes over the same tree ({}, {} vertices) take {} ns per vertex, "
      "Approach 1 {} ({}) and Approach 2 {} ({}).",
      cost->method, cost->vertices, figure(boxes->nanoseconds_per_vertex), figure(first->nanoseconds_per_vertex),
      times(first->nanoseconds_per_vertex / boxes->nanoseconds_per_vertex), figure(second->nanoseconds_per_vertex),
      times(second->nanoseconds_per_vertex / boxes->nanoseconds_per_vertex));
  return claim;
}

}  // namespace

std::vector<StudyClaim> paper_claims(const Evidence& evidence, const StudyCost* cost) {
  std::vector<StudyClaim> claims{loss_claim(evidence, "approach1", {"fig2a", "fig2b"}),
                                 loss_claim(evidence, "approach2", {"fig2a", "fig2b"}), exponential_claim(evidence),
                                 largely_better_claim(evidence), return_claim(evidence)};
  for (StudyClaim& claim : generator_claims(evidence)) claims.push_back(std::move(claim));
  claims.push_back(cost_claim(cost));
  return claims;
}

}  // namespace morula::cli
