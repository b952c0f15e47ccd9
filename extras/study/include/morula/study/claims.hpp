// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims of the paper and ours, each with its criterion: extras/study/docs/study.md.
#pragma once

#include <cstdint>
#include <morula/study/cost.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// A case is a tree, a motion and a level. A claim about cases holds when it does in all of them, fails when in none,
/// and is partly right in between; untested when there is no case.
enum class Verdict : std::uint8_t { untested, fails, partly, holds };
std::string_view name(Verdict verdict);

enum class ClaimOrigin : std::uint8_t { paper, ours };
/// "paper", "new".
std::string_view name(ClaimOrigin origin);

struct Claim {
  std::string id{};  ///< stable: "exact-covers"
  ClaimOrigin origin = ClaimOrigin::ours;
  std::string claim{};  ///< a sentence
  Verdict verdict = Verdict::untested;
  std::string numbers{};               ///< what the verdict rests on, in words
  std::vector<std::string> figures{};  ///< ids of those that show it
  bool timed = false;                  ///< rests on times, which differ from run to run
  bool adverse = false;    ///< says something bad of a rule or a generator: where it fails, that is better than claimed
  bool guarantee = false;  ///< holds for every body and setting, so that a quick study can decide it, too
};

/// The verdict for people: as name(), but "better" for an adverse claim that fails.
std::string_view word(const Claim& claim);

/// Of one body. cost: of the first one, or nullptr.
std::vector<Claim> make_claims(const Plan& plan, const Result& result, std::size_t body, const Cost* cost);
/// Over all bodies: a claim holds when it does on all of them, fails when on all, and is partly right in between.
std::vector<Claim> join_claims(const std::vector<std::vector<Claim>>& of_bodies);
/// nullptr when there is none.
const Claim* find_claim(std::span<const Claim> claims, std::string_view id);

}  // namespace morula::study
