// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The claims of the paper.
#include <limits>
#include <map>
#include <string_view>

#include "claims/evidence.hpp"
#include "claims/fit.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

Claim loss_claim(const Evidence& evidence, const RuleKey& rule, std::vector<std::string> figures) {
  Claim claim = make_claim(name(rule) + "-below-traditional", ClaimOrigin::paper,
                           fmt::format("{}: lower loss of accuracy than in traditional update techniques", title(rule)),
                           std::move(figures));
  claim.quantity = {.name = fmt::format("loss of {} over that of traditional (median of cases)", title(rule)),
                    .is_ratio = true,
                    .of_motion = true,
                    .of_grid = true};
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
  std::string text;
  if (!ratios.empty()) {
    text = fmt::format("Lower in {} of {} cases; its loss is {} that of traditional in the median, {} at most ({}).",
                       lower, total, times(median(ratios)), times(*std::max_element(ratios.begin(), ratios.end())),
                       evidence.text(worst));
  }
  evidence.decide(claim, lower, total, median_of(ratios), std::move(text));
  return claim;
}

Claim exponential_claim(const Evidence& evidence) {
  Claim claim =
      make_claim("approach1-exponential", ClaimOrigin::paper,
                 "Approach 1's error grows exponentially when the medial tree is stretched", {"fig2a", "fig2b"});
  claim.quantity = {.name = "rate b of the fit (mean of levels)", .of_motion = true, .of_grid = true};
  double rates = 0;
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
    for (const Sample* sample : evidence.samples(*evidence.cell(*c, Rule::approach1))) t.push_back(sample->parameter);
    const ExponentialFit fit = fit_exponential(t, e);
    ++total;
    rates += fit.b;
    const bool bends_up = fit.b >= 1 && fit.r2 >= 0.98;
    faster += bends_up ? 1 : 0;
    count += bends_up && fit.r2 > fit.r2_parabola ? 1 : 0;  // which has as many free numbers
    text += fmt::format(
        "{}level {}: from {} to {}, best fit c + a·exp(b t) with b = {} (R² {}; a straight line {}, a parabola {})",
        text.empty() ? "" : "; ", level, figure(e.front()), figure(e.back()), figure(fit.b),
        fmt::format("{:.4f}", fit.r2), fmt::format("{:.4f}", fit.r2_line), fmt::format("{:.4f}", fit.r2_parabola));
  }
  const Verdict verdict = total == 0       ? Verdict::undecided
                          : count == total ? Verdict::holds
                          : faster > 0     ? Verdict::partly
                                           : Verdict::fails;
  evidence.decide(claim, verdict, count, total, rates / static_cast<double>(std::max<std::size_t>(total, 1)),
                  fmt::format("Exponential means b ≥ 1 with R² ≥ 0.98, and no parabola fits better; {}.", text));
  return claim;
}

Claim largely_better_claim(const Evidence& evidence) {
  Claim claim =
      make_claim("approach2-largely-better", ClaimOrigin::paper,
                 "Approach 2 is largely better than Approach 1 when the medial tree is stretched", {"fig2a", "fig2b"});
  claim.quantity = {.name = "error of Approach 1 over that of Approach 2 (median of levels)",
                    .is_ratio = true,
                    .of_motion = true,
                    .of_grid = true};
  std::vector<double> ratios;
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
    ratios.push_back(ratio);
    twice += ratio >= 2 ? 1 : 0;
    better += ratio > 1 ? 1 : 0;
    double uncovered = 0;
    const MotionRun& cell = *evidence.cell(*c, Rule::approach2);
    for (const Sample* s : evidence.samples(cell))
      uncovered = std::max(uncovered, cell.at(s->sample, level)->uncovered_area());
    text += fmt::format("{}level {}: {} as loose on average, while Approach 2 leaves up to {} of the surface uncovered",
                        text.empty() ? "" : "; ", level, times(ratio), percent(uncovered));
  }
  const Verdict verdict = total == 0       ? Verdict::undecided
                          : twice == total ? Verdict::holds
                          : better > 0     ? Verdict::partly
                                           : Verdict::fails;
  evidence.decide(claim, verdict, twice, total, median_of(ratios),
                  fmt::format("Largely means Approach 1 is at least twice as loose; {}.", text));
  return claim;
}

Claim return_claim(const Evidence& evidence) {
  Claim claim =
      make_claim("returns-to-rest", ClaimOrigin::paper, "Both approaches return to the initial condition", {});
  claim.guarantee = true;
  std::size_t count = 0;
  std::size_t total = 0;
  for (const Rule rule : {Rule::approach1, Rule::approach2}) {
    for (const std::size_t source : evidence.sources()) {
      for (const std::size_t motion : evidence.motions()) {
        const MotionRun* cell = evidence.cell({source, motion, 0}, rule);
        if (cell == nullptr || !cell->returns_to_rest) continue;
        ++total;
        count += *cell->returns_to_rest ? 1 : 0;
      }
    }
  }
  evidence.decide(claim, count, total, std::nullopt,
                  fmt::format("The spheres are those of rest, bit for bit, after {} of {} motions.", count, total));
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
    const std::optional<std::size_t> source = evidence.find_source(method);
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

/// The largest error of the generators that are said to be better over the least error of the others.
double worst_over_best(const Ranking& list, const std::vector<Method>& better) {
  double worst = 0, best = std::numeric_limits<double>::infinity();
  for (const auto& [error, method] : list) {
    if (std::find(better.begin(), better.end(), method) != better.end()) {
      worst = std::max(worst, error);
    } else {
      best = std::min(best, error);
    }
  }
  return worst / best;
}

/// A claim that some generators are the best in each motion.
Claim order_claim(const Evidence& evidence, Claim claim, const std::vector<std::size_t>& levels, bool with_rest,
                  const std::vector<Method>& better) {
  claim.quantity = {.name = "largest error of the generators said to be better over the least of the others",
                    .is_ratio = true,
                    .of_motion = true,
                    .of_grid = true};
  if (better.size() == 1)
    claim.quantity.name = fmt::format("error of {} over the least of the others", name(better[0]));
  std::size_t count = 0;
  std::vector<double> ratios;
  std::string text;
  for (const std::size_t motion : evidence.motions()) {
    const Ranking list = ranking(evidence, motion, levels, with_rest);
    if (list.empty()) continue;
    const bool right = std::all_of(
        list.begin(), list.begin() + static_cast<std::ptrdiff_t>(better.size()),
        [&](const auto& item) { return std::find(better.begin(), better.end(), item.second) != better.end(); });
    count += right ? 1 : 0;
    ratios.push_back(worst_over_best(list, better));
    text += fmt::format("{}{} ({}): {}", text.empty() ? "" : "; ", evidence.motion(motion), right ? "yes" : "no",
                        ranking_text(list));
  }
  evidence.decide(claim, count, ratios.size(), median_of(ratios), fmt::format("Mean errors. {}.", text));
  return claim;
}

std::vector<std::string> motion_figures(const Evidence& evidence, const std::string& prefix) {
  std::vector<std::string> list;
  for (const std::size_t motion : evidence.motions())
    list.push_back(prefix + "-" + first_word(evidence.motion(motion)));
  return list;
}

/// Errors at rest.
Claim rigid_claim(const Evidence& evidence, std::vector<std::string> figures) {
  Claim claim =
      make_claim("level3-grid-rest", ClaimOrigin::paper,
                 fmt::format("On level {} grid is more conservative than the others while rigid", evidence.lower()),
                 std::move(figures));
  claim.quantity = {.name = "error of grid at rest over the largest of the others", .is_ratio = true, .of_grid = true};
  Ranking rest;
  for (const Method method : paper_methods()) {
    const std::optional<std::size_t> source = evidence.find_source(method);
    if (!source || evidence.motions().empty()) continue;
    const auto e = evidence.error_at({*source, evidence.motions().front(), evidence.lower()}, Rule::approach2, 0);
    if (e) rest.emplace_back(*e, method);
  }
  sort(rest);
  if (rest.size() != paper_methods().size()) return claim;
  const auto place = static_cast<std::size_t>(
      std::find_if(rest.begin(), rest.end(), [](const auto& r) { return r.second == Method::grid; }) - rest.begin());
  const double largest = rest[place + 1 == rest.size() ? place - 1 : rest.size() - 1].first;
  evidence.decide(claim, place, rest.size() - 1,
                  largest > 0 ? std::optional(rest[place].first / largest) : std::nullopt,
                  fmt::format("Errors at rest: {}; grid is looser than {} of 3.", ranking_text(rest), place));
  return claim;
}

std::vector<Claim> generator_claims(const Evidence& evidence) {
  const std::vector<std::string> upper = motion_figures(evidence, "fig2c");
  const std::vector<std::string> lower = motion_figures(evidence, "fig2d");
  std::vector<std::string> both = upper;
  both.insert(both.end(), lower.begin(), lower.end());
  std::vector<Claim> claims;
  claims.push_back(order_claim(
      evidence,
      make_claim("level2-hubbard-medial", ClaimOrigin::paper,
                 fmt::format("On level {} hubbard and medial are better than grid and spawn", evidence.upper()), upper),
      {evidence.upper()}, false, {Method::hubbard, Method::medial}));
  claims.push_back(order_claim(
      evidence,
      make_claim("level3-grid", ClaimOrigin::paper,
                 fmt::format("On level {} grid is slightly better than the others", evidence.lower()), lower),
      {evidence.lower()}, false, {Method::grid}));
  claims.push_back(rigid_claim(evidence, lower));
  claims.push_back(order_claim(
      evidence,
      make_claim("medial-best-average", ClaimOrigin::paper,
                 fmt::format("medial has the best average accuracy (mean over levels {}-{} and all samples)",
                             evidence.upper(), evidence.lower()),
                 both),
      evidence.levels(), true, {Method::medial}));
  return claims;
}

/// "Approach 1 18.8 (16.0 to 20.1)": the median and the quartiles of times.
std::string time_text(const UpdateCost& cost) {
  return fmt::format("{} {} ({} to {})", cost.name, figure(cost.nanoseconds_per_vertex), figure(cost.lower_quartile),
                     figure(cost.upper_quartile));
}

bool is_similar(double ratio) {
  return ratio >= 0.5 && ratio <= 2;
}

/// Decided by counts, which are the same on every machine.
Claim cost_claim(const Evidence& evidence, const Cost* cost) {
  Claim claim = make_claim("cost-like-boxes", ClaimOrigin::paper,
                           "The cost is similar to that of updating axis-aligned boxes", {});
  claim.quantity = {.name = "bytes of an update by Approach 1 over those of boxes", .is_ratio = true};
  const std::optional<std::size_t> medial = evidence.find_source(Method::medial);
  const std::vector<std::size_t>& sources = evidence.sources();
  if (sources.empty()) return claim;
  const std::size_t source = medial.value_or(sources.front());
  const TreeFigures& tree = evidence.result().trees[source];
  const UpdateCounts *boxes = tree.find_counts("boxes"), *first = tree.find_counts(name(Rule::approach1)),
                     *second = tree.find_counts(name(Rule::approach2));
  if (boxes == nullptr || first == nullptr || second == nullptr) return claim;
  std::size_t count = 0;
  std::string text;
  for (const UpdateCounts* rule : {first, second}) {
    const double bytes = static_cast<double>(rule->bytes()) / static_cast<double>(boxes->bytes());
    const double points = static_cast<double>(rule->points_read) / static_cast<double>(boxes->points_read);
    count += is_similar(bytes) && is_similar(points) ? 1 : 0;
    text += fmt::format("; {} moves {} the bytes and reads {} the points", rule == first ? "Approach 1" : "Approach 2",
                        times(bytes), times(points));
  }
  evidence.decide(
      claim, count, 2, static_cast<double>(first->bytes()) / static_cast<double>(boxes->bytes()),
      fmt::format("Similar means half to twice the bytes moved and the points read, counted on the {} tree{}.",
                  evidence.method(source), text));
  if (cost == nullptr || cost->source != source) return claim;
  const UpdateCost *box_time = cost->find("boxes"), *first_time = cost->find(name(Rule::approach1)),
                   *second_time = cost->find(name(Rule::approach2));
  if (box_time != nullptr && first_time != nullptr && second_time != nullptr)
    claim.times = fmt::format("Nanoseconds per vertex on this machine, median (quartiles): {}, {}, {}.",
                              time_text(*box_time), time_text(*first_time), time_text(*second_time));
  return claim;
}

/// Sections of the updates, and figures, where the claim is about them; all of these claims are results of the paper.
std::string place_of(std::string_view claim_id) {
  const std::map<std::string_view, std::string_view> known{{"approach1-below-traditional", "the update of section 3.1"},
                                                           {"approach2-below-traditional", "the update of section 3.2"},
                                                           {"approach1-exponential", "Fig. 2 a and b"},
                                                           {"approach2-largely-better", "Fig. 2 a and b"},
                                                           {"returns-to-rest", "the updates of sections 3.1 and 3.2"},
                                                           {"level2-hubbard-medial", "Fig. 2 c"},
                                                           {"level3-grid", "Fig. 2 d"},
                                                           {"level3-grid-rest", "Fig. 2 d"},
                                                           {"medial-best-average", "Fig. 2 c and d"},
                                                           {"cost-like-boxes", "the updates of sections 3.1 and 3.2"}};
  return fmt::format("results, {}", known.at(claim_id));
}

}  // namespace

std::vector<Claim> paper_claims(const Evidence& evidence, const Cost* cost) {
  std::vector<Claim> claims{loss_claim(evidence, Rule::approach1, {"fig2a", "fig2b"}),
                            loss_claim(evidence, Rule::approach2, {"fig2a", "fig2b"}), exponential_claim(evidence),
                            largely_better_claim(evidence), return_claim(evidence)};
  for (Claim& claim : generator_claims(evidence)) claims.push_back(std::move(claim));
  claims.push_back(cost_claim(evidence, cost));
  for (Claim& claim : claims) claim.place = place_of(claim.id);
  return claims;
}

}  // namespace morula::study
