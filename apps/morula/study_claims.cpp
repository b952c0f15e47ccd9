// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study_claims.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>

#include "figures.hpp"
#include "study_figures.hpp"

namespace morula::cli {
namespace {

std::string verdict_of(std::size_t count, std::size_t total) {
  return total == 0 ? "untested" : count == total ? "holds" : count == 0 ? "fails" : "partly";
}

std::string times(double ratio) {
  return figure(ratio) + " times";
}

/// The figures of one body, as claims ask for them.
class Evidence {
 public:
  Evidence(const StudyPlan& plan, const StudyResult& result, const std::string& body)
      : plan_(plan), result_(result), body_(body) {
    for (const Deformations& motion : plan.motions) motions_.push_back(describe_all(motion));
    for (const StudyTree& tree : result.trees)
      if (tree.body == body) methods_.push_back(tree.method);
  }

  const std::vector<std::string>& motions() const { return motions_; }
  const std::vector<std::string>& methods() const { return methods_; }
  std::vector<std::size_t> levels() const { return plan_.levels(); }
  std::size_t upper() const { return plan_.levels().front(); }
  std::size_t lower() const { return plan_.levels().back(); }
  std::size_t last() const { return plan_.samples - 1; }
  bool has(std::string_view method) const {
    return std::find(methods_.begin(), methods_.end(), method) != methods_.end();
  }
  std::string stretch() const {
    for (const std::string& motion : motions_)
      if (first_word(motion) == "stretch") return motion;
    return {};
  }
  const StudyCell* cell(const std::string& method, const std::string& motion, const std::string& rule) const {
    return result_.find(body_, method, motion, rule);
  }
  /// One per sample; empty when there is none, or it has no answer.
  std::vector<double> errors(const std::string& method, const std::string& motion, const std::string& rule,
                             std::size_t level) const {
    std::vector<double> list;
    const StudyCell* found = cell(method, motion, rule);
    if (found == nullptr) return list;
    for (const StudySample& sample : found->samples) {
      const StudyLevel* figures = found->at(sample.sample, level);
      if (figures == nullptr || !figures->error(plan_.unit)) return {};
      list.push_back(*figures->error(plan_.unit));
    }
    return list;
  }
  /// Over the deformed samples.
  std::optional<double> mean_error(const std::string& method, const std::string& motion, const std::string& rule,
                                   std::size_t level) const {
    const std::vector<double> e = errors(method, motion, rule, level);
    if (e.size() < 2) return std::nullopt;
    double sum = 0;
    for (std::size_t i = 1; i < e.size(); ++i) sum += e[i];
    return sum / static_cast<double>(e.size() - 1);
  }
  std::optional<double> error_at(const std::string& method, const std::string& motion, const std::string& rule,
                                 std::size_t level, std::size_t sample) const {
    const StudyCell* found = cell(method, motion, rule);
    const StudyLevel* figures = found == nullptr ? nullptr : found->at(sample, level);
    return figures == nullptr ? std::nullopt : figures->error(plan_.unit);
  }
  std::vector<double> parameters() const { return plan_.parameters(); }
  const StudyResult& result() const { return result_; }
  const std::string& body() const { return body_; }

 private:
  const StudyPlan& plan_;
  const StudyResult& result_;
  std::string body_;
  std::vector<std::string> motions_, methods_;
};

struct Case {
  std::string method, motion;
  std::size_t level;
  std::string text() const { return fmt::format("{}, {}, level {}", method, motion, level); }
};

std::vector<Case> cases(const Evidence& evidence) {
  std::vector<Case> list;
  for (const std::string& method : evidence.methods())
    for (const std::string& motion : evidence.motions())
      for (const std::size_t level : evidence.levels()) list.push_back({method, motion, level});
  return list;
}

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

Json claim_json(const StudyClaim& claim) {
  Json json{{"id", claim.id},           {"source", claim.source},   {"claim", claim.claim},
            {"verdict", claim.verdict}, {"numbers", claim.numbers}, {"figures", claim.figures}};
  if (claim.timed) json["timed"] = true;
  return json;
}

std::vector<StudyClaim> make_claims(const StudyPlan& plan, const StudyResult& result, const std::string& body,
                                    const StudyCost* cost) {
  const Evidence evidence(plan, result, body);
  std::vector<StudyClaim> claims{loss_claim(evidence, "approach1", {"fig2a", "fig2b"}),
                                 loss_claim(evidence, "approach2", {"fig2a", "fig2b"}), exponential_claim(evidence),
                                 largely_better_claim(evidence), return_claim(evidence)};
  for (StudyClaim& claim : generator_claims(evidence)) claims.push_back(std::move(claim));
  claims.push_back(cost_claim(cost));
  for (StudyClaim& claim : cover_claims(evidence)) claims.push_back(std::move(claim));
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

std::vector<StudyClaim> join_claims(const std::vector<std::vector<StudyClaim>>& of_bodies) {
  std::vector<StudyClaim> joined = of_bodies.front();
  if (of_bodies.size() == 1) return joined;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    std::map<std::string, std::size_t> count;
    for (const std::vector<StudyClaim>& claims : of_bodies) ++count[claims[i].verdict];
    const std::size_t tested = of_bodies.size() - count["untested"];
    joined[i].verdict = tested == 0                ? "untested"
                        : count["holds"] == tested ? "holds"
                        : count["fails"] == tested ? "fails"
                                                   : "partly";
    if (tested == 0) continue;
    const auto first = static_cast<std::size_t>(
        std::find_if(of_bodies.begin(), of_bodies.end(),
                     [&](const std::vector<StudyClaim>& claims) { return claims[i].verdict != "untested"; }) -
        of_bodies.begin());
    joined[i].numbers =
        fmt::format("Of {} it holds on {}, partly on {}, fails on {}. {}: {}", counted(tested, "body", "bodies"),
                    count["holds"], count["partly"], count["fails"],
                    first == 0 ? "On the first" : fmt::format("On number {}", first + 1), of_bodies[first][i].numbers);
  }
  return joined;
}

}  // namespace morula::cli
