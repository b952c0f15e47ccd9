// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/study/claims.hpp>

#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

std::vector<Claim> all_claims(const Evidence& evidence, const Cost* cost) {
  std::vector<Claim> claims = paper_claims(evidence, cost);
  for (Claim& claim : new_claims(evidence)) claims.push_back(std::move(claim));
  for (Claim& claim : own_claims(evidence)) claims.push_back(std::move(claim));
  for (Claim& claim : press_claims(evidence)) claims.push_back(std::move(claim));
  return claims;
}

}  // namespace

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names{"not decided", "fails", "partly", "holds"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view word(const Claim& claim) {
  return claim.adverse && claim.verdict == Verdict::fails ? "better" : name(claim.verdict);
}

std::string_view name(ClaimOrigin origin) {
  return origin == ClaimOrigin::paper ? "paper" : "new";
}

std::vector<Claim> make_claims(const Plan& plan, const Result& result, const Trial& trial, const Cost* cost) {
  const Evidence whole(plan, result, trial, {});
  std::vector<Claim> claims = all_claims(whole, cost);
  const std::vector<Claim> half_amount = all_claims({plan, result, trial, {.half_amount = true}}, cost);
  const std::vector<Claim> half_grid = all_claims({plan, result, trial, {.half_grid = true}}, cost);
  for (std::size_t i = 0; i < claims.size(); ++i) {
    Claim& claim = claims[i];
    if (claim.trials.empty()) whole.decide(claim, Verdict::undecided, 0, 0, std::nullopt, "");
    if (claim.quantity.of_motion) claim.trials.front().at_half_amount = half_amount[i].verdict;
    if (claim.quantity.of_grid) claim.trials.front().at_half_resolution = half_grid[i].verdict;
  }
  return claims;
}

const Claim* find_claim(std::span<const Claim> claims, std::string_view id) {
  const auto at = std::find_if(claims.begin(), claims.end(), [&](const Claim& claim) { return claim.id == id; });
  return at == claims.end() ? nullptr : &*at;
}

}  // namespace morula::study
