// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Evidence: the figures of one body, as claims use them.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <morula/study/claims.hpp>
#include <toolbox/numbers.hpp>
#include <toolbox/stopwatch.hpp>

#include "words.hpp"

namespace morula::study {

/// holds in all, fails in none, partly in between; untested when there is nothing to test.
inline Verdict verdict_of(std::size_t count, std::size_t total) {
  return total == 0       ? Verdict::untested
         : count == total ? Verdict::holds
         : count == 0     ? Verdict::fails
                          : Verdict::partly;
}

inline std::string times(double ratio) {
  return toolbox::figure(ratio) + " times";
}

/// A tree, a motion and a level. Sources and motions are places in the plan.
struct Case {
  std::size_t source = 0, motion = 0, level = 0;
};

class Evidence {
 public:
  Evidence(const Plan& plan, const Result& result, std::size_t body) : plan_(plan), result_(result), body_(body) {
    for (std::size_t s = 0; s < plan.sources.size(); ++s)
      if (plan.sources[s].body == body) sources_.push_back(s);
    for (std::size_t m = 0; m < plan.motions.size(); ++m) motions_.push_back(m);
  }

  const Plan& plan() const { return plan_; }
  const Result& result() const { return result_; }
  std::size_t body() const { return body_; }
  const std::vector<std::size_t>& sources() const { return sources_; }
  const std::vector<std::size_t>& motions() const { return motions_; }
  const std::string& method(std::size_t source) const { return plan_.pressed(source).method; }
  std::string motion(std::size_t motion) const { return describe_all(plan_.motions[motion]); }
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

  /// The medial tree during a stretch, which several claims need; none without it.
  std::optional<Case> medial_stretch(std::size_t level) const {
    const std::optional<std::size_t> medial = plan_.find_source(body_, Method::medial);
    for (const std::size_t m : motions_) {
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
  /// One per sample; empty when there is none, or no value.
  std::vector<double> errors(const Case& c, const RuleKey& rule) const {
    std::vector<double> list;
    const MotionRun* found = cell(c, rule);
    if (found == nullptr) return list;
    for (const Sample& sample : found->samples) {
      const LevelFigures* figures = found->at(sample.sample, c.level);
      if (figures == nullptr || !figures->error(plan_.unit)) return {};
      list.push_back(*figures->error(plan_.unit));
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
    const LevelFigures* figures = found == nullptr ? nullptr : found->at(sample, c.level);
    return figures == nullptr ? std::nullopt : figures->error(plan_.unit);
  }

 private:
  const Plan& plan_;
  const Result& result_;
  std::size_t body_;
  std::vector<std::size_t> sources_, motions_;
};

/// The claims of the paper. cost may be nullptr.
std::vector<Claim> paper_claims(const Evidence& evidence, const Cost* cost);
/// Claims on figures that the paper did not measure.
std::vector<Claim> new_claims(const Evidence& evidence);
/// Claims on one's own rules and generators; none without them.
std::vector<Claim> own_claims(const Evidence& evidence);
/// Claims on contacts.
std::vector<Claim> press_claims(const Evidence& evidence);

}  // namespace morula::study
