// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Claims of the paper and of Morula, each with its criterion: extras/study/docs/study.md.
#pragma once

#include <cstdint>
#include <morula/study/cost.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// A case is a tree, a motion and a level. A claim about cases holds if it holds in all of them, fails if it holds in
/// none, and holds partly in between; it is untested without cases.
enum class Verdict : std::uint8_t { untested, fails, partly, holds };
std::string_view name(Verdict verdict);

enum class ClaimOrigin : std::uint8_t { paper, ours };
/// The name: "paper", "new".
std::string_view name(ClaimOrigin origin);

struct Claim {
  std::string id{};  ///< stable identifier, such as "exact-covers"
  ClaimOrigin origin = ClaimOrigin::ours;
  std::string claim{};  ///< one sentence
  Verdict verdict = Verdict::untested;
  std::string numbers{};               ///< figures behind the verdict, as text
  std::vector<std::string> figures{};  ///< ids of the figures that show it
  bool timed = false;                  ///< depends on times, which differ from run to run
  bool adverse = false;    ///< states a weakness of a rule or a generator; a failed claim is then better than claimed
  bool guarantee = false;  ///< holds for every body and setting, so a quick study can decide it too
};

/// The verdict for readers: like name(), but "better" for an adverse claim that fails.
std::string_view word(const Claim& claim);

/// Claims about one body. cost: of the first body, or nullptr.
std::vector<Claim> make_claims(const Plan& plan, const Result& result, std::size_t body, const Cost* cost);
/// Claims about all bodies: a claim holds if it holds on all of them, fails if it fails on all, and holds partly in
/// between.
std::vector<Claim> join_claims(const std::vector<std::vector<Claim>>& of_bodies);
/// The claim with this id; nullptr if there is none.
const Claim* find_claim(std::span<const Claim> claims, std::string_view id);

}  // namespace morula::study
