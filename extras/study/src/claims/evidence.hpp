// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Evidence: the figures of one trial, as claims use them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <morula/study/claims.hpp>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

#include "words.hpp"

namespace morula::study {

/// holds in all, fails in none, partly in between; not decided when there is nothing to test.
inline Verdict verdict_of(std::size_t count, std::size_t total) {
  return total == 0       ? Verdict::undecided
         : count == total ? Verdict::holds
         : count == 0     ? Verdict::fails
                          : Verdict::partly;
}

inline std::string times(double ratio) {
  return toolbox::figure(ratio) + " times";
}

/// A claim without any measurement yet.
inline Claim make_claim(std::string id, ClaimOrigin origin, std::string sentence, std::vector<std::string> figures) {
  return {.id = std::move(id), .origin = origin, .claim = std::move(sentence), .figures = std::move(figures)};
}

/// A tree, a motion and a level. Sources and motions are places in the plan.
struct Case {
  std::size_t source = 0, motion = 0, level = 0;
};

/// A part of the figures, to know what a verdict depends on.
struct View {
  bool half_amount = false;  ///< only samples up to half the amount of a motion
  bool half_grid = false;    ///< looseness on the grid of half the resolution
};

class Evidence {
 public:
  Evidence(const Plan& plan, const Result& result, const Trial& trial, const View& view)
      : plan_(plan),
        result_(result),
        trial_(trial),
        view_(view),
        sources_(plan.sources_of(trial)),
        decisive_(plan.decisive_samples()) {
    for (std::size_t m = 0; m < plan.motion_count(); ++m) motions_.push_back(m);
  }

  const Plan& plan() const { return plan_; }
  const Result& result() const { return result_; }
  const Trial& trial() const { return trial_; }
  std::size_t body() const { return trial_.body; }
  const View& view() const { return view_; }
  const std::vector<std::size_t>& sources() const { return sources_; }
  const std::vector<std::size_t>& motions() const { return motions_; }
  const std::string& method(std::size_t source) const { return plan_.pressed(source).method; }
  std::string motion(std::size_t motion) const { return plan_.motion_name(motion); }
  std::string text(const Case& c) const {
    return fmt::format("{}, {}, level {}", method(c.source), motion(c.motion), c.level);
  }
  std::vector<Case> cases() const {
    std::vector<Case> list;
    for (const std::size_t source : sources_)
      for (const std::size_t m : motions_)
        for (const std::size_t level : levels()) list.push_back({source, m, level});
    return list;
  }
  std::vector<std::size_t> levels() const { return plan_.levels(); }
  std::size_t upper() const { return plan_.levels().front(); }
  std::size_t lower() const { return plan_.levels().back(); }
  std::size_t last() const { return plan_.samples - 1; }
  std::optional<std::size_t> find_source(Method method) const { return plan_.find_source(trial_, method); }

  /// The medial tree during a stretch, which several claims need; none without it.
  std::optional<Case> medial_stretch(std::size_t level) const {
    const std::optional<std::size_t> medial = find_source(Method::medial);
    for (std::size_t m = 0; m < plan_.motions.size(); ++m) {
      const Deformations& motion = plan_.motions[m];
      if (medial && !motion.empty() && std::holds_alternative<Stretch>(motion.front())) return Case{*medial, m, level};
    }
    return std::nullopt;
  }
  /// nullptr when there is none. The level of the case is ignored.
  const MotionRun* cell(const Case& c, const RuleKey& rule) const {
    const std::optional<std::size_t> place = plan_.find_rule(rule);
    return place ? result_.find({c.source, c.motion, *place}) : nullptr;
  }
  /// The samples that decide, ascending.
  std::vector<const Sample*> samples(const MotionRun& cell) const {
    std::vector<const Sample*> list;
    for (const Sample& sample : cell.samples) {
      if (view_.half_amount && sample.parameter > 0.5) continue;
      if (std::find(decisive_.begin(), decisive_.end(), sample.sample) != decisive_.end()) list.push_back(&sample);
    }
    return list;
  }
  std::optional<double> error(const LevelFigures* figures) const {
    if (figures == nullptr) return std::nullopt;
    return view_.half_grid ? figures->error_on_half_grid(plan_.unit) : figures->error(plan_.unit);
  }
  /// One per deciding sample; empty when there is none, or no value.
  std::vector<double> errors(const Case& c, const RuleKey& rule) const {
    std::vector<double> list;
    const MotionRun* found = cell(c, rule);
    if (found == nullptr) return list;
    for (const Sample* sample : samples(*found)) {
      const std::optional<double> e = error(found->at(sample->sample, c.level));
      if (!e) return {};
      list.push_back(*e);
    }
    return list;
  }
  /// The mean error over the deformed samples.
  std::optional<double> mean_error(const Case& c, const RuleKey& rule) const {
    const std::vector<double> e = errors(c, rule);
    if (e.size() < 2) return std::nullopt;
    double sum = 0;
    for (std::size_t i = 1; i < e.size(); ++i) sum += e[i];
    return sum / static_cast<double>(e.size() - 1);
  }
  std::optional<double> error_at(const Case& c, const RuleKey& rule, std::size_t sample) const {
    const MotionRun* found = cell(c, rule);
    return found == nullptr ? std::nullopt : error(found->at(sample, c.level));
  }

  /// Writes the verdict of this trial: true in `count` of `total` cases.
  void decide(Claim& claim, std::size_t count, std::size_t total, std::optional<double> value,
              std::string numbers) const {
    decide(claim, verdict_of(count, total), count, total, value, std::move(numbers));
  }
  void decide(Claim& claim, Verdict verdict, std::size_t count, std::size_t total, std::optional<double> value,
              std::string numbers) const {
    claim.verdict = verdict;
    claim.numbers = verdict == Verdict::undecided ? std::string() : std::move(numbers);
    claim.trials = {{.body = plan_.bodies[trial_.body].name,
                     .seed = trial_.seed,
                     .verdict = verdict,
                     .cases_true = count,
                     .cases = total,
                     .value = verdict == Verdict::undecided ? std::nullopt : value,
                     .numbers = claim.numbers}};
  }

 private:
  const Plan& plan_;
  const Result& result_;
  Trial trial_;
  View view_;
  std::vector<std::size_t> sources_, decisive_, motions_;
};

/// The median, if there is one.
inline std::optional<double> median_of(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional(toolbox::median(values));
}

/// The claims of the paper. cost: times of the first body, or nullptr.
std::vector<Claim> paper_claims(const Evidence& evidence, const Cost* cost);
/// Claims on figures that the paper did not measure.
std::vector<Claim> new_claims(const Evidence& evidence);
/// Claims on one's own rules and generators; none without them.
std::vector<Claim> own_claims(const Evidence& evidence);
/// Claims on contacts.
std::vector<Claim> press_claims(const Evidence& evidence);

}  // namespace morula::study
