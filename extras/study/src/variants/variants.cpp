// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Every reading of the paper's sentences against the paper's claims.
#include <morula/study/variants.hpp>

#include "claims/evidence.hpp"
#include "claims/fit.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

using Approach = Variant::Approach;

/// The tree of the first body that represents it, with traditional, both approaches of the library, and all variants.
Plan plan_of_variants(const Plan& plan, const std::vector<Variant>& variants) {
  Plan own = plan;
  const Source tree = plan.sources[shown_tree(plan)];
  own.sources = {tree};
  own.rules = {Rule::traditional, Rule::approach1, Rule::approach2};
  for (const Variant& variant : variants) own.rules.emplace_back(rule_of(variant));
  own.decisive.clear();
  own.measured.clear();
  own.mixes.clear();
  own.press_rules.clear();
  own.press_sources.clear();
  own.metrics.clear();
  own.needle_sides = 0;
  own.measures = {.lattice = false, .protrusion = false};
  return own;
}

std::optional<double> variant_loss(const Evidence& evidence, const Case& c, const RuleKey& rule) {
  const std::optional<double> mean = evidence.mean_error(c, rule);
  return mean ? std::optional(*mean - evidence.errors(c, rule).front()) : std::nullopt;
}

VariantVerdict below_traditional(const Evidence& evidence, const RuleKey& rule) {
  std::size_t lower = 0, total = 0;
  for (const Case& c : evidence.cases()) {
    const auto mine = variant_loss(evidence, c, rule), other = variant_loss(evidence, c, Rule::traditional);
    if (!mine || !other) continue;
    ++total;
    lower += *mine < *other ? 1 : 0;
  }
  return {"below-traditional", verdict_of(lower, total), fmt::format("{} of {}", lower, total)};
}

/// The criterion of the study: b at least 1, R² at least 0.98, and no parabola fits better.
VariantVerdict exponential(const Evidence& evidence, const RuleKey& rule) {
  std::size_t count = 0, faster = 0, total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    for (const std::size_t motion : evidence.motions()) {
      if (first_word(evidence.motion(motion)) != "stretch") continue;
      const Case c{evidence.sources().front(), motion, level};
      const std::vector<double> e = evidence.errors(c, rule);
      if (e.size() < 4) continue;
      std::vector<double> t;
      for (const Sample* sample : evidence.samples(*evidence.cell(c, rule))) t.push_back(sample->parameter);
      const ExponentialFit fit = fit_exponential(t, e);
      const bool bends_up = fit.b >= 1 && fit.r2 >= 0.98;
      ++total;
      faster += bends_up ? 1 : 0;
      count += bends_up && fit.r2 > fit.r2_parabola ? 1 : 0;
      text += fmt::format("{}b {}, R² {:.4f} (parabola {:.4f})", text.empty() ? "" : "; ", figure(fit.b), fit.r2,
                          fit.r2_parabola);
    }
  }
  const Verdict verdict = total == 0       ? Verdict::undecided
                          : count == total ? Verdict::holds
                          : faster > 0     ? Verdict::partly
                                           : Verdict::fails;
  return {"exponential", verdict, text};
}

/// Approach 1 at least twice as loose as Approach 2 during a stretch, one of both read as this variant, the other as
/// the library does.
VariantVerdict largely_better(const Evidence& evidence, const RuleKey& first, const RuleKey& second) {
  std::size_t twice = 0, better = 0, total = 0;
  std::string text;
  for (const std::size_t level : evidence.levels()) {
    for (const std::size_t motion : evidence.motions()) {
      if (first_word(evidence.motion(motion)) != "stretch") continue;
      const Case c{evidence.sources().front(), motion, level};
      const auto one = evidence.mean_error(c, first), two = evidence.mean_error(c, second);
      if (!one || !two || *two <= 0) continue;
      ++total;
      twice += *one >= 2 * *two ? 1 : 0;
      better += *one > *two ? 1 : 0;
      text += fmt::format("{}{}", text.empty() ? "" : ", ", times(*one / *two));
    }
  }
  const Verdict verdict = total == 0       ? Verdict::undecided
                          : twice == total ? Verdict::holds
                          : better > 0     ? Verdict::partly
                                           : Verdict::fails;
  return {"largely-better", verdict, text};
}

VariantVerdict returns(const Evidence& evidence, const RuleKey& rule) {
  std::size_t count = 0, total = 0;
  for (const std::size_t motion : evidence.motions()) {
    const MotionRun* cell = evidence.cell({evidence.sources().front(), motion}, rule);
    if (cell == nullptr || !cell->returns_to_rest) continue;
    ++total;
    count += *cell->returns_to_rest ? 1 : 0;
  }
  return {"returns-to-rest", verdict_of(count, total), fmt::format("{} of {}", count, total)};
}

VariantVerdict uncovered(const Evidence& evidence, const RuleKey& rule, double& worst) {
  std::size_t count = 0, total = 0;
  for (const Case& c : evidence.cases()) {
    const MotionRun* cell = evidence.cell(c, rule);
    if (cell == nullptr) continue;
    double of_case = 0;
    for (const Sample* s : evidence.samples(*cell))
      of_case = std::max(of_case, cell->at(s->sample, c.level)->uncovered_area());
    ++total;
    count += of_case > 0 ? 1 : 0;
    worst = std::max(worst, of_case);
  }
  return {"uncovered", verdict_of(count, total), fmt::format("{} of {}, up to {}", count, total, percent(worst))};
}

VariantResult judge(const Evidence& evidence, const Variant& variant) {
  VariantResult result{variant};
  const RuleKey key(*rule_of(variant));
  const bool is_first = variant.approach == Approach::first;
  result.verdicts = {
      below_traditional(evidence, key), exponential(evidence, key),
      largely_better(evidence, is_first ? key : RuleKey(Rule::approach1), is_first ? RuleKey(Rule::approach2) : key),
      returns(evidence, key), uncovered(evidence, key, result.uncovered)};
  double count = 0;
  for (const Case& c : evidence.cases()) {
    const auto mean = evidence.mean_error(c, key), rest = evidence.error_at(c, key, 0);
    if (!mean || !rest) continue;
    result.looseness += *mean;
    result.looseness_rest += *rest;
    count += 1;
  }
  if (count > 0) result.looseness /= count, result.looseness_rest /= count;
  return result;
}

}  // namespace

std::vector<std::string_view> variant_claims() {
  return {"below-traditional", "exponential", "largely-better", "returns-to-rest", "uncovered"};
}

std::vector<VariantResult> run_variants(const Plan& plan, Workers& workers, const RunOptions& options) {
  const std::vector<Variant> variants = paper_variants();
  if (plan.sources[shown_tree(plan)].body != 0) return {};
  const Plan own = plan_of_variants(plan, variants);
  const Result result = run(own, workers, options);
  const Evidence evidence(own, result, own.trials().front(), {});
  std::vector<VariantResult> list;
  for (const Variant& variant : variants) list.push_back(judge(evidence, variant));
  return list;
}

Table variants_table(const Plan& plan, const std::vector<VariantResult>& results) {
  const std::size_t tree = shown_tree(plan);
  Table table{"variants",
              "Readings of the paper's sentences against its claims",
              fmt::format("{} tree of {}, all motions, levels {} and {}. Largely better: Approach 1 against Approach 2 "
                          "under stretch, the other approach as in the library. Looseness in {}, means over the "
                          "deformed samples; uncovered: worst share of the surface.",
                          plan.sources[tree].method, plan.bodies.front().name, plan.levels().front(),
                          plan.levels().back(), error_unit(plan.unit)),
              false,
              {"variant", "reading", "lower loss than traditional", "exponential", "largely better", "returns to rest",
               "leaves surface uncovered", "looseness at rest", "looseness", "uncovered, %"},
              {}};
  for (const VariantResult& r : results) {
    std::vector<TableValue> row{r.variant.name, r.variant.text};
    for (const VariantVerdict& v : r.verdicts) row.emplace_back(std::string(name(v.verdict)));
    row.emplace_back(r.looseness_rest);
    row.emplace_back(r.looseness);
    row.emplace_back(100 * r.uncovered);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace morula::study
