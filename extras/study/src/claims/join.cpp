// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims over trials: counts, intervals, effects, and what a verdict depends on.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <morula/study/claims.hpp>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

namespace morula::study {

using namespace toolbox;

namespace {

constexpr std::size_t bootstrap_samples = 2000;
constexpr std::uint64_t bootstrap_seed = 20050901;

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::size_t draw(Random& random, std::size_t count) {
  return std::min(count - 1, static_cast<std::size_t>(random.uniform() * static_cast<double>(count)));
}

/// Nine tenths, in whole numbers.
bool is_nearly_all(std::size_t count, std::size_t total) {
  return 10 * count >= 9 * total;
}

Verdict joined_verdict(const Claim& claim) {
  const std::size_t decided = claim.decided();
  if (decided == 0) return Verdict::undecided;
  const std::size_t holds = claim.count(Verdict::holds), fails = claim.count(Verdict::fails);
  if (claim.guarantee ? holds == decided : is_nearly_all(holds, decided)) return Verdict::holds;
  return is_nearly_all(fails, decided) ? Verdict::fails : Verdict::partly;
}

/// The share of pairs of decided trials with different verdicts, among those that `is_pair` names.
template <class IsPair>
std::optional<double> differing_share(const std::vector<TrialVerdict>& trials, const IsPair& is_pair) {
  std::size_t pairs = 0, differ = 0;
  for (std::size_t a = 0; a < trials.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (trials[a].verdict == Verdict::undecided || trials[b].verdict == Verdict::undecided) continue;
      if (!is_pair(trials[a], trials[b])) continue;
      ++pairs;
      differ += trials[a].verdict != trials[b].verdict ? 1 : 0;
    }
  }
  return pairs == 0 ? std::nullopt : std::optional(static_cast<double>(differ) / static_cast<double>(pairs));
}

/// The share of trials whose verdict differs from `other`.
std::optional<double> flipped_share(const std::vector<TrialVerdict>& trials,
                                    std::optional<Verdict> TrialVerdict::*other) {
  std::size_t compared = 0, differ = 0;
  for (const TrialVerdict& trial : trials) {
    if (trial.verdict == Verdict::undecided || !(trial.*other) || *(trial.*other) == Verdict::undecided) continue;
    ++compared;
    differ += trial.verdict != *(trial.*other) ? 1 : 0;
  }
  return compared == 0 ? std::nullopt : std::optional(static_cast<double>(differ) / static_cast<double>(compared));
}

std::optional<Effect> effect_of(const Claim& claim) {
  Effect effect;
  std::vector<double> values;
  for (const TrialVerdict& trial : claim.trials) {
    effect.cases_true += trial.cases_true;
    effect.cases += trial.cases;
    if (trial.value) values.push_back(*trial.value);
  }
  if (effect.cases == 0) return std::nullopt;
  effect.cliffs_delta = 2 * static_cast<double>(effect.cases_true) / static_cast<double>(effect.cases) - 1;
  if (claim.quantity.is_ratio && !values.empty()) effect.median_ratio = median(values);
  return effect;
}

/// "limb", "limb (1 of 3 seeds)": bodies with trials of this verdict.
std::string bodies_with(const Claim& claim, Verdict verdict) {
  std::vector<std::string> order;
  std::map<std::string, std::pair<std::size_t, std::size_t>> of_body;
  for (const TrialVerdict& trial : claim.trials) {
    if (trial.verdict == Verdict::undecided) continue;
    if (of_body.count(trial.body) == 0) order.push_back(trial.body);
    auto& [with, all] = of_body[trial.body];
    with += trial.verdict == verdict ? 1 : 0;
    ++all;
  }
  std::string text;
  for (const std::string& body : order) {
    const auto [with, all] = of_body[body];
    if (with == 0) continue;
    text += (text.empty() ? "" : ", ") + body;
    if (with < all) text += fmt::format(" ({} of {} seeds)", with, all);
  }
  return text;
}

std::string counts_text(const Claim& claim) {
  std::string text =
      fmt::format("Holds in {} of {} trials (bodies × seeds)", claim.count(Verdict::holds), claim.decided());
  for (const Verdict verdict : {Verdict::partly, Verdict::fails}) {
    const std::size_t count = claim.count(verdict);
    if (count == 0) continue;
    text += fmt::format("; {} ", verdict == Verdict::partly ? "partly on" : "fails on");
    text += count == claim.decided() ? std::string("all bodies") : bodies_with(claim, verdict);
  }
  return text + '.';
}

std::string value_text(const Claim& claim) {
  std::string text;
  if (claim.value)
    text += fmt::format(" Mean {}: {} (95 %: {} to {}).", claim.quantity.name, figure(claim.value->mean),
                        figure(claim.value->low), figure(claim.value->high));
  if (claim.effect && claim.effect->cases > claim.decided())
    text += fmt::format(" True in {} of {} cases.", claim.effect->cases_true, claim.effect->cases);
  return text;
}

}  // namespace

std::size_t Claim::count(Verdict wanted) const {
  return static_cast<std::size_t>(
      std::count_if(trials.begin(), trials.end(), [&](const TrialVerdict& t) { return t.verdict == wanted; }));
}

std::optional<Interval> interval_of(const std::vector<std::vector<double>>& of_bodies, bool is_ratio) {
  std::vector<std::vector<double>> groups;
  std::vector<double> all;
  for (const std::vector<double>& values : of_bodies) {
    std::vector<double> group;
    for (const double value : values) {
      if (is_ratio && !(value > 0)) return std::nullopt;
      group.push_back(is_ratio ? std::log(value) : value);
    }
    all.insert(all.end(), group.begin(), group.end());
    if (!group.empty()) groups.push_back(std::move(group));
  }
  if (all.size() < 2) return std::nullopt;
  Random random(bootstrap_seed);
  std::vector<double> means;
  for (std::size_t i = 0; i < bootstrap_samples; ++i) {
    double sum = 0, count = 0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::vector<double>& group = groups[draw(random, groups.size())];
      for (std::size_t k = 0; k < group.size(); ++k) sum += group[draw(random, group.size())], count += 1;
    }
    means.push_back(sum / count);
  }
  std::sort(means.begin(), means.end());
  const auto back = [&](double value) { return is_ratio ? std::exp(value) : value; };
  return Interval{back(mean_of(all)), back(means[bootstrap_samples / 40]),
                  back(means[bootstrap_samples - 1 - bootstrap_samples / 40]), all.size()};
}

std::vector<Claim> join_claims(const std::vector<std::vector<Claim>>& of_trials) {
  std::vector<Claim> joined = of_trials.front();
  for (std::size_t i = 0; i < joined.size(); ++i) {
    Claim& claim = joined[i];
    claim.trials.clear();
    for (const std::vector<Claim>& claims : of_trials) {
      claim.trials.insert(claim.trials.end(), claims[i].trials.begin(), claims[i].trials.end());
      for (const std::string& id : claims[i].figures)
        if (std::find(claim.figures.begin(), claim.figures.end(), id) == claim.figures.end())
          claim.figures.push_back(id);
    }
    claim.verdict = joined_verdict(claim);
    std::vector<std::string> bodies;
    std::vector<std::vector<double>> values;
    for (const TrialVerdict& trial : claim.trials) {
      if (!trial.value) continue;
      if (bodies.empty() || bodies.back() != trial.body) bodies.push_back(trial.body), values.emplace_back();
      values.back().push_back(*trial.value);
    }
    claim.value = interval_of(values, claim.quantity.is_ratio);
    claim.effect = effect_of(claim);
    claim.dependence = {
        differing_share(claim.trials, [](const auto& a, const auto& b) { return a.body == b.body; }),
        differing_share(claim.trials,
                        [](const auto& a, const auto& b) { return a.seed == b.seed && a.body != b.body; }),
        flipped_share(claim.trials, &TrialVerdict::at_half_amount),
        flipped_share(claim.trials, &TrialVerdict::at_half_resolution)};
    const std::size_t decided = claim.decided();
    if (decided == 0) continue;
    const auto first = std::find_if(claim.trials.begin(), claim.trials.end(),
                                    [](const TrialVerdict& t) { return t.verdict != Verdict::undecided; });
    claim.numbers = decided == 1 ? first->numbers
                                 : fmt::format("{}{} {}, seed {}: {}", counts_text(claim), value_text(claim),
                                               first->body, first->seed, first->numbers);
  }
  return joined;
}

std::optional<Stability> stability_of(const Plan& plan, const std::vector<std::vector<Claim>>& of_trials) {
  if (plan.seeds.size() < 2) return std::nullopt;
  Stability stability;
  for (std::size_t i = 0; i < plan.seeds.size(); ++i) stability.seeds[i % 2].push_back(plan.seeds[i]);
  std::array<std::vector<std::vector<Claim>>, 2> halves;
  for (const std::vector<Claim>& claims : of_trials) {
    const std::uint64_t seed = claims.front().trials.front().seed;
    const auto& first = stability.seeds[0];
    halves[std::find(first.begin(), first.end(), seed) != first.end() ? 0 : 1].push_back(claims);
  }
  if (halves[0].empty() || halves[1].empty()) return std::nullopt;
  const std::vector<Claim> a = join_claims(halves[0]), b = join_claims(halves[1]);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i].verdict == Verdict::undecided || b[i].verdict == Verdict::undecided) continue;
    ++stability.compared;
    if (a[i].verdict == b[i].verdict) {
      ++stability.same;
    } else {
      stability.differing.push_back(a[i].id);
    }
  }
  return stability;
}

}  // namespace morula::study
