// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims of the paper and of Morula, each with its criterion: extras/study/docs/study_claims.md. A claim is decided in
// each trial, which is a body with the trees of one seed, and its verdicts are joined over all trials.
#pragma once

#include <array>
#include <cstdint>
#include <morula/study/cost.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// In one trial: a case is a tree, a motion and a level. A claim about cases holds if it holds in all of them, fails if
/// it holds in none, and holds partly in between; it is not decided without cases.
enum class Verdict : std::uint8_t { undecided, fails, partly, holds };
/// The name: "not decided", "fails", "partly", "holds".
std::string_view name(Verdict verdict);

enum class ClaimOrigin : std::uint8_t { paper, ours };
/// The name: "paper", "new".
std::string_view name(ClaimOrigin origin);

/// A claim in one trial.
struct TrialVerdict {
  std::string body{};
  std::uint64_t seed = 0;
  Verdict verdict = Verdict::undecided;
  std::size_t cases_true = 0, cases = 0;
  std::optional<double> value{};  ///< the number behind the verdict: Claim::quantity
  std::string numbers{};          ///< figures behind the verdict, as text
  /// The verdict from the samples up to half the amount of every motion, and from a grid of half the resolution; no
  /// value if they are not measured or do not matter.
  std::optional<Verdict> at_half_amount{}, at_half_resolution{};
};

/// The number behind a claim.
struct Quantity {
  std::string name{};      ///< for example "loss of Approach 1 over that of traditional"
  bool is_ratio = false;   ///< its mean is geometric
  bool of_motion = false;  ///< the verdict uses samples of motions
  bool of_grid = false;    ///< the verdict uses looseness on the grid
};

/// A mean over trials with a 95 % interval: percentiles of 2,000 bootstrap samples, which draw bodies, then trials of
/// each drawn body, with a fixed seed.
struct Interval {
  double mean = 0, low = 0, high = 0;
  std::size_t trials = 0;
};

/// The size of an effect, from all cases of all trials.
struct Effect {
  std::size_t cases_true = 0, cases = 0;
  double cliffs_delta = 0;               ///< share of cases in which the claim is true, minus the share of the others
  std::optional<double> median_ratio{};  ///< median over trials of a ratio
};

/// Shares of pairs of verdicts that differ; no value without pairs.
struct Dependence {
  std::optional<double> seed{};        ///< two trials of one body
  std::optional<double> body{};        ///< two trials of one seed
  std::optional<double> amount{};      ///< a trial, and the same up to half the amount of every motion
  std::optional<double> resolution{};  ///< a trial, and the same on a grid of half the resolution
};

struct Claim {
  std::string id{};  ///< stable identifier, such as "exact-covers"
  ClaimOrigin origin = ClaimOrigin::ours;
  std::string claim{};  ///< one sentence
  std::string place{};  ///< place of a claim of the paper there, such as "results, Fig. 2 c"; otherwise empty
  Verdict verdict = Verdict::undecided;
  std::string numbers{};               ///< figures behind the verdict, as text
  std::vector<std::string> figures{};  ///< ids of the figures that show it
  bool adverse = false;    ///< states a weakness of a rule or a generator; a failed claim is then better than claimed
  bool guarantee = false;  ///< has to hold in every trial, not only in nine of ten
  Quantity quantity{};
  std::vector<TrialVerdict> trials{};  ///< in the order of Plan::trials()
  std::optional<Interval> value{};     ///< of `quantity`
  std::optional<Effect> effect{};
  std::string times{};  ///< measured times, as text: they differ from run to run, and decide nothing
  Dependence dependence{};

  /// Number of trials with the verdict.
  std::size_t count(Verdict verdict) const;
  /// Number of trials that decide it.
  std::size_t decided() const { return trials.size() - count(Verdict::undecided); }
};

/// The verdict for readers: like name(), but "better" for an adverse claim that fails.
std::string_view word(const Claim& claim);

/// The claims in one trial: each has one entry in Claim::trials. cost: of the first body, or nullptr.
std::vector<Claim> make_claims(const Plan& plan, const Result& result, const Trial& trial, const Cost* cost);
/// Claims over trials. A claim holds if it holds in at least nine tenths of the trials that decide it, fails if it
/// fails in at least nine tenths, and holds partly otherwise; a guarantee holds only if it holds in all.
std::vector<Claim> join_claims(const std::vector<std::vector<Claim>>& of_trials);
/// The claim with this id; nullptr if there is none.
const Claim* find_claim(std::span<const Claim> claims, std::string_view id);

/// The mean of values, one list for each body, with its interval. Needs two values. is_ratio: the geometric mean.
std::optional<Interval> interval_of(const std::vector<std::vector<double>>& of_bodies, bool is_ratio);

/// Verdicts of two halves of the seeds, compared.
struct Stability {
  std::array<std::vector<std::uint64_t>, 2> seeds;  ///< seeds at even places, and at odd places
  std::size_t compared = 0;                         ///< claims that both halves decide
  std::size_t same = 0;
  std::vector<std::string> differing;  ///< ids of the others
};
/// No value for fewer than two seeds. of_trials: claims of each trial, in the order of Plan::trials().
std::optional<Stability> stability_of(const Plan& plan, const std::vector<std::vector<Claim>>& of_trials);

}  // namespace morula::study
