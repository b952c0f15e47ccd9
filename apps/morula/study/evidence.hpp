// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The figures of one body, as claims ask for them.
#pragma once

#include <fmt/format.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "study/claims.hpp"
#include "study/figures.hpp"

namespace morula::cli {

/// holds in all, fails in none, partly in between; untested when there is nothing to test.
inline std::string verdict_of(std::size_t count, std::size_t total) {
  return total == 0 ? "untested" : count == total ? "holds" : count == 0 ? "fails" : "partly";
}

inline std::string times(double ratio) {
  return figure(ratio) + " times";
}

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
  std::vector<PressQuery> press_queries() const { return cli::press_queries(plan_); }
  double press_amount(std::size_t which) const { return plan_.press_amounts[which]; }
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

inline std::vector<Case> cases(const Evidence& evidence) {
  std::vector<Case> list;
  for (const std::string& method : evidence.methods())
    for (const std::string& motion : evidence.motions())
      for (const std::size_t level : evidence.levels()) list.push_back({method, motion, level});
  return list;
}

/// Those that the paper makes. cost may be nullptr.
std::vector<StudyClaim> paper_claims(const Evidence& evidence, const StudyCost* cost);
/// What it did not measure.
std::vector<StudyClaim> new_claims(const Evidence& evidence);
/// About contacts.
std::vector<StudyClaim> press_claims(const Evidence& evidence);

}  // namespace morula::cli
