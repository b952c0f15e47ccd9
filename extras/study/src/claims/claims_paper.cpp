// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The claims of the paper.
#include "claims/evidence.hpp"
#include "claims/fit.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

Claim loss_claim(const Evidence& evidence, const RuleKey& rule, std::vector<std::string> figures) {
  Claim claim{name(rule) + "-below-traditional",
              ClaimOrigin::paper,
              fmt::format("{}: lower loss of accuracy than in traditional update techniques", title(rule)),
              Verdict::untested,
              "",
              std::move(figures)};
  std::size_t lower = 0;
  std::size_t total = 0;
  std::vector<double> ratios;
  Case worst;
  for (const Case& c : evidence.cases()) {
    const auto mine = evidence.mean_error(c, rule);
    const auto other = evidence.mean_error(c, Rule::traditional);
    if (!mine || !other) continue;
    // The loss: the increase of the error over that at rest.
    const double my_loss = *mine - evidence.errors(c, rule).front();
    const double other_loss = *other - evidence.errors(c, Rule::traditional).front();
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
        times(median(ratios)), times(*std::max_element(ratios.begin(), ratios.end())), evidence.text(worst));
  }
  return claim;
}

Claim exponential_claim(const Evidence& evidence) {
  Claim claim{"approach1-exponential",
              ClaimOrigin::paper,
              "Approach 1's error grows exponentially when the medial tree is stretched",
              Verdict::untested,
              "",
              {"fig2a", "fig2b"}};
  std::size_t count = 0;
  std::size_t faster = 0;  // growth far above a straight line
  std::size_t total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    const std::optional<Case> c = evidence.medial_stretch(level);
    if (!c) continue;
    const std::vector<double> e = evidence.errors(*c, Rule::approach1);
    if (e.size() < 4) continue;
    std::vector<double> t;
    for (const Sample& sample : evidence.cell(*c, Rule::approach1)->samples) t.push_back(sample.parameter);
    const ExponentialFit fit = fit_exponential(t, e);
    ++total;
    const bool bends_up = fit.b >= 1 && fit.r2 >= 0.98;
    faster += bends_up ? 1 : 0;
    count += bends_up && fit.r2 > fit.r2_parabola ? 1 : 0;  // which has as many free numbers
    text += fmt::format(
        "{}level {}: from {} to {}, best fit c + a·exp(b t) with b = {} (R² {}; a straight line {}, a parabola {})",
        text.empty() ? "" : "; ", level, figure(e.front()), figure(e.back()), figure(fit.b),
        fmt::format("{:.4f}", fit.r2), fmt::format("{:.4f}", fit.r2_line), fmt::format("{:.4f}", fit.r2_parabola));
  }
  claim.verdict = total == 0       ? Verdict::untested
                  : count == total ? Verdict::holds
                  : faster > 0     ? Verdict::partly
                                   : Verdict::fails;
  if (total > 0)
    claim.numbers = fmt::format("Exponential means b ≥ 1 with R² ≥ 0.98, and no parabola fits better; {}.", text);
  return claim;
}

Claim largely_better_claim(const Evidence& evidence) {
  Claim claim{"approach2-largely-better",
              ClaimOrigin::paper,
              "Approach 2 is largely better than Approach 1 when the medial tree is stretched",
              Verdict::untested,
              "",
              {"fig2a", "fig2b"}};
  std::size_t twice = 0;
  std::size_t better = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    const std::optional<Case> c = evidence.medial_stretch(level);
    if (!c) continue;
    const auto first = evidence.mean_error(*c, Rule::approach1);
    const auto second = evidence.mean_error(*c, Rule::approach2);
    if (!first || !second || *second <= 0) continue;
    const double ratio = *first / *second;
    ++total;
    twice += ratio >= 2 ? 1 : 0;
    better += ratio > 1 ? 1 : 0;
    double bare = 0;
    const MotionRun& cell = *evidence.cell(*c, Rule::approach2);
    for (const Sample& s : cell.samples) bare = std::max(bare, cell.at(s.sample, level)->uncovered_area());
    text += fmt::format("{}level {}: {} as loose in the mean, while Approach 2 leaves up to {} of the surface bare",
                        text.empty() ? "" : "; ", level, times(ratio), percent(bare));
  }
  claim.verdict = total == 0       ? Verdict::untested
                  : twice == total ? Verdict::holds
                  : better > 0     ? Verdict::partly
                                   : Verdict::fails;
  if (total > 0) claim.numbers = fmt::format("Largely means Approach 1 is at least twice as loose; {}.", text);
  return claim;
}

Claim return_claim(const Evidence& evidence) {
  Claim claim{"returns-to-rest",
              ClaimOrigin::paper,
              "Both approaches return to the initial condition",
              Verdict::untested,
              "",
              {}};
  claim.guarantee = true;
  std::size_t count = 0;
  std::size_t total = 0;
  for (const Rule rule : {Rule::approach1, Rule::approach2}) {
    for (const std::size_t source : evidence.sources()) {
      for (const std::size_t motion : evidence.motions()) {
        const MotionRun* cell = evidence.cell({source, motion}, rule);
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

/// Errors of generators, the best first.
using Ranking = std::vector<std::pair<double, Method>>;

void sort(Ranking& list) {
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
}

/// Mean errors of the paper's generators with Approach 2; empty unless all four are there.
Ranking ranking(const Evidence& evidence, std::size_t motion, const std::vector<std::size_t>& levels, bool with_rest) {
  Ranking list;
  for (const Method method : paper_methods()) {
    const std::optional<std::size_t> source = evidence.plan().find_source(evidence.body(), method);
    if (!source) return {};
    double sum = 0;
    double count = 0;
    for (const std::size_t level : levels) {
      const std::vector<double> e = evidence.errors({*source, motion, level}, Rule::approach2);
      if (e.size() < 2) return {};
      for (std::size_t i = with_rest ? 0 : 1; i < e.size(); ++i) sum += e[i], count += 1;
    }
    list.emplace_back(sum / count, method);
  }
  sort(list);
  return list;
}

std::string ranking_text(const Ranking& list) {
  std::string text;
  for (const auto& [error, method] : list)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name(method), figure(error));
  return text;
}

/// A claim about the order of the generators in each motion.
template <class Holds>
Claim order_claim(const Evidence& evidence, Claim claim, const std::vector<std::size_t>& levels, bool with_rest,
                  const Holds& holds) {
  std::size_t count = 0;
  std::size_t total = 0;
  std::string text;
  for (const std::size_t motion : evidence.motions()) {
    const Ranking list = ranking(evidence, motion, levels, with_rest);
    if (list.empty()) continue;
    ++total;
    const bool right = holds(list);
    count += right ? 1 : 0;
    text += fmt::format("{}{} ({}): {}", text.empty() ? "" : "; ", evidence.motion(motion), right ? "yes" : "no",
                        ranking_text(list));
  }
  claim.verdict = verdict_of(count, total);
  if (total > 0) claim.numbers = fmt::format("Mean errors. {}.", text);
  return claim;
}

std::vector<std::string> motion_figures(const Evidence& evidence, const std::string& prefix) {
  std::vector<std::string> list;
  for (const std::size_t motion : evidence.motions())
    list.push_back(prefix + "-" + first_word(evidence.motion(motion)));
  return list;
}

std::vector<Claim> generator_claims(const Evidence& evidence) {
  std::vector<Claim> claims;
  const std::vector<std::string> upper = motion_figures(evidence, "fig2c");
  const std::vector<std::string> lower = motion_figures(evidence, "fig2d");
  std::vector<std::string> both = upper;
  both.insert(both.end(), lower.begin(), lower.end());
  claims.push_back(
      order_claim(evidence,
                  {"level2-hubbard-medial", ClaimOrigin::paper,
                   fmt::format("On level {} hubbard and medial are better than grid and spawn", evidence.upper()),
                   Verdict::untested, "", upper},
                  {evidence.upper()}, false, [](const auto& list) {
                    const auto good = [](Method m) { return m == Method::hubbard || m == Method::medial; };
                    return good(list[0].second) && good(list[1].second);
                  }));
  claims.push_back(order_claim(evidence,
                               {"level3-grid", ClaimOrigin::paper,
                                fmt::format("On level {} grid is slightly better than the others", evidence.lower()),
                                Verdict::untested, "", lower},
                               {evidence.lower()}, false,
                               [](const auto& list) { return list[0].second == Method::grid; }));

  Claim rigid{"level3-grid-rest",
              ClaimOrigin::paper,
              fmt::format("On level {} grid is more conservative than the others while rigid", evidence.lower()),
              Verdict::untested,
              "",
              lower};
  Ranking rest;
  for (const Method method : paper_methods()) {
    const std::optional<std::size_t> source = evidence.plan().find_source(evidence.body(), method);
    if (!source || evidence.motions().empty()) continue;
    const auto e = evidence.error_at({*source, evidence.motions().front(), evidence.lower()}, Rule::approach2, 0);
    if (e) rest.emplace_back(*e, method);
  }
  sort(rest);
  if (rest.size() == paper_methods().size()) {
    const auto place = static_cast<std::size_t>(
        std::find_if(rest.begin(), rest.end(), [](const auto& r) { return r.second == Method::grid; }) - rest.begin());
    rigid.verdict = verdict_of(place, rest.size() - 1);
    rigid.numbers = fmt::format("Errors at rest: {}; grid is looser than {} of 3.", ranking_text(rest), place);
  }
  claims.push_back(rigid);

  claims.push_back(
      order_claim(evidence,
                  {"medial-best-average", ClaimOrigin::paper,
                   fmt::format("medial has the best average accuracy (mean over levels {}-{} and all samples)",
                               evidence.upper(), evidence.lower()),
                   Verdict::untested, "", both},
                  evidence.levels(), true, [](const auto& list) { return list[0].second == Method::medial; }));
  return claims;
}

Claim cost_claim(const Evidence& evidence, const Cost* cost) {
  Claim claim{"cost-like-boxes",
              ClaimOrigin::paper,
              "The cost is similar to that of updating axis-aligned boxes",
              Verdict::untested,
              "",
              {},
              true};
  const UpdateCost* boxes = cost == nullptr ? nullptr : cost->find("boxes");
  const UpdateCost* first = cost == nullptr ? nullptr : cost->find(name(Rule::approach1));
  const UpdateCost* second = cost == nullptr ? nullptr : cost->find(name(Rule::approach2));
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
      evidence.method(cost->source), cost->vertices, figure(boxes->nanoseconds_per_vertex),
      figure(first->nanoseconds_per_vertex), times(first->nanoseconds_per_vertex / boxes->nanoseconds_per_vertex),
      figure(second->nanoseconds_per_vertex), times(second->nanoseconds_per_vertex / boxes->nanoseconds_per_vertex));
  return claim;
}

}  // namespace

std::vector<Claim> paper_claims(const Evidence& evidence, const Cost* cost) {
  std::vector<Claim> claims{loss_claim(evidence, Rule::approach1, {"fig2a", "fig2b"}),
                            loss_claim(evidence, Rule::approach2, {"fig2a", "fig2b"}), exponential_claim(evidence),
                            largely_better_claim(evidence), return_claim(evidence)};
  for (Claim& claim : generator_claims(evidence)) claims.push_back(std::move(claim));
  claims.push_back(cost_claim(evidence, cost));
  return claims;
}

}  // namespace morula::study
