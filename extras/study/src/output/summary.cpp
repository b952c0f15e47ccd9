// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The study in three sentences, from its claims and its cells.
#include "output/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <morula/study/study.hpp>
#include <toolbox/numbers.hpp>

namespace morula::study {

using namespace toolbox;

namespace {

/// Looseness of one rule over the deformed samples of all trees and levels, and its largest uncovered share.
struct RuleTotal {
  double sum = 0;
  double count = 0;
  double uncovered = 0;
  std::map<std::size_t, std::pair<double, double>> of_motions;  // sum and count

  double mean() const { return count > 0 ? sum / count : 0; }
  double mean(std::size_t motion) const {
    const auto found = of_motions.find(motion);
    return found == of_motions.end() || found->second.second == 0 ? 0 : found->second.first / found->second.second;
  }
};

RuleTotal total_of(const Plan& plan, const Result& result, std::size_t rule) {
  RuleTotal total;
  for (const MotionRun& cell : result.cells) {
    if (cell.key.rule != rule) continue;
    for (const Sample& sample : cell.samples) {
      for (const LevelFigures& level : sample.levels) {
        total.uncovered = std::max(total.uncovered, level.uncovered_area());
        const std::optional<double> error = level.error(plan.unit);
        if (sample.sample == 0 || !error) continue;
        auto& [sum, count] = total.of_motions[cell.key.motion];
        sum += *error, count += 1;
        total.sum += *error, total.count += 1;
      }
    }
  }
  return total;
}

std::string quoted(const Study& study, std::initializer_list<std::string_view> ids) {
  std::string text;
  for (const std::string_view id : ids)
    if (const Claim* claim = find_claim(study.claims, id))
      text += fmt::format("{}“{}”", text.empty() ? ", among them " : " and ", claim->claim);
  return text;
}

std::string claims_sentence(const Study& study) {
  const auto count = std::count_if(study.claims.begin(), study.claims.end(),
                                   [](const Claim& claim) { return claim.origin == ClaimOrigin::paper; });
  return fmt::format("The paper makes {}{}.", counted(static_cast<std::size_t>(count), "claim"),
                     quoted(study, {"approach2-below-traditional", "approach2-largely-better"}));
}

/// "3 hold", "1 is not decided": the words after the number.
std::string verdict_phrase(const std::string& word, std::size_t count) {
  if (word == name(Verdict::holds)) return count == 1 ? "holds" : "hold";
  if (word == name(Verdict::partly)) return count == 1 ? "holds partly" : "hold partly";
  if (word == name(Verdict::fails)) return count == 1 ? "fails" : "fail";
  return fmt::format("{} {}", count == 1 ? "is" : "are", word);
}

std::string verdicts_sentence(const Study& study) {
  std::vector<std::pair<std::string, std::size_t>> counts;
  for (const Verdict verdict : {Verdict::holds, Verdict::partly, Verdict::fails}) counts.emplace_back(name(verdict), 0);
  for (const Claim& claim : study.claims) {
    if (claim.origin != ClaimOrigin::paper) continue;
    const auto same = std::find_if(counts.begin(), counts.end(), [&](const auto& c) { return c.first == word(claim); });
    if (same != counts.end()) ++same->second;
    if (same == counts.end()) counts.emplace_back(word(claim), 1);
  }
  std::erase_if(counts, [](const auto& c) { return c.second == 0; });
  std::string text;
  for (std::size_t i = 0; i < counts.size(); ++i)
    text += fmt::format("{}{} {}",
                        i == 0                   ? ""
                        : i + 1 == counts.size() ? " and "
                                                 : ", ",
                        counts[i].second, verdict_phrase(counts[i].first, counts[i].second));
  const std::size_t bodies = study.plan.bodies.size();
  return fmt::format("On {} {}.", bodies == 1 ? study.plan.bodies.front().name : counted(bodies, "body", "bodies"),
                     text);
}

std::string motion_text(const Plan& plan, std::size_t motion) {
  return motion < plan.motions.size() ? describe_all(plan.motions[motion]) : fmt::format("motion {}", motion + 1);
}

/// Ratios of the mean looseness, in all and for each motion.
std::string ratios(const Plan& plan, const RuleTotal& rule, const RuleTotal& other) {
  std::string parts;
  for (const auto& [motion, sums] : rule.of_motions)
    if (other.mean(motion) > 0)
      parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", figure(rule.mean(motion) / other.mean(motion)),
                           motion_text(plan, motion));
  return fmt::format("{} times its mean looseness ({})", figure(rule.mean() / other.mean()), parts);
}

std::string truth_sentence(const Study& study) {
  const Plan& plan = study.plan;
  std::optional<std::size_t> tightest;
  RuleTotal best;
  for (std::size_t rule = 0; rule < plan.rules.size(); ++rule) {
    const RuleTotal total = total_of(plan, study.result, rule);
    if (plan.rules[rule].kind != RuleKey::Kind::update || total.count == 0 || total.uncovered == 0) continue;
    if (!tightest || total.mean() < best.mean()) tightest = rule, best = total;
  }
  const std::optional<std::size_t> exact = plan.find_rule(Rule::exact);
  const RuleTotal covers = exact ? total_of(plan, study.result, *exact) : RuleTotal{};
  if (!tightest) return "None of the rules leaves surface uncovered here.";
  std::string text = fmt::format(
      "Looseness alone rewards rules that leave surface uncovered: {} is the tightest of them and leaves up to {} of "
      "the "
      "surface uncovered",
      plan.rules[*tightest].title(), percent(best.uncovered));
  if (covers.count == 0 || best.mean() <= 0) return text + ".";
  return text + fmt::format("; exact leaves {} uncovered, at {}.",
                            covers.uncovered == 0 ? "nothing" : "up to " + percent(covers.uncovered),
                            ratios(plan, covers, best));
}

}  // namespace

std::string why_of(std::string_view claim_id) {
  constexpr std::string_view loss = "The loss is the mean looseness of the deformed samples minus that at rest. ";
  constexpr std::string_view uncovered =
      "A case counts if the uncovered area is above 0 in some sample. This rule promises no cover.";
  constexpr std::string_view covers =
      "A case counts if the uncovered area is 0 in all samples. Each sphere contains the corners of its patch in every "
      "frame.";
  const std::map<std::string_view, std::string> known{
      {"approach1-below-traditional",
       std::string(loss) +
           "Approach 1 takes the largest ratio of distances, so one stretched link enlarges a whole sphere."},
      {"approach2-below-traditional",
       std::string(loss) + "A sphere that loses part of its surface only becomes tighter in this measure."},
      {"approach1-exponential",
       "The fit c + a·exp(b t) needs b ≥ 1 and R² ≥ 0.98, and must be closer than a parabola. Radii grow with the "
       "stretch, "
       "and volumes with its third power."},
      {"approach2-largely-better",
       "Largely means that Approach 1 is at least twice as loose on average. Looseness does not count the surface that "
       "Approach 2 leaves uncovered."},
      {"returns-to-rest", "Both rules compute spheres from rest and the current frame alone."},
      {"level2-hubbard-medial", "They have to be the best two of the four by mean looseness, in each motion."},
      {"level3-grid", "It has to be the best of the four by mean looseness, in each motion."},
      {"level3-grid-rest", "It has to be looser at rest than each of the other three."},
      {"medial-best-average",
       "It needs the least mean looseness of the four over both levels and all samples, in each motion."},
      {"cost-like-boxes", "Similar means between half and twice the cost of boxes over the same tree, for both rules."},
      {"exact-cost",
       "A case counts if the mean looseness of exact is at most twice that of Approach 2. Cover costs most under "
       "stretch, where patches drift apart."},
      {"exact-below-approach1", "A case counts if the mean looseness of exact is below that of Approach 1."},
      {"rebuilt-near-floor",
       "A case counts if the looseness at the full amount is at most twice that of a tree built for that pose."}};
  const auto found = known.find(claim_id);
  if (found != known.end()) return found->second;
  if (claim_id.ends_with("-uncovered") && !claim_id.ends_with("-gain-is-uncovered")) return std::string(uncovered);
  return claim_id.ends_with("-covers") ? std::string(covers) : std::string();
}

std::vector<std::string> summary_of(const Study& study) {
  return {claims_sentence(study), verdicts_sentence(study), truth_sentence(study)};
}

}  // namespace morula::study
