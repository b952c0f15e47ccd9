// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/study/claims.hpp>

#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

std::string_view name(Verdict verdict) {
  constexpr std::array<std::string_view, 4> names{"untested", "fails", "partly", "holds"};
  return names[static_cast<std::size_t>(verdict)];
}

std::string_view word(const Claim& claim) {
  return claim.adverse && claim.verdict == Verdict::fails ? "better" : name(claim.verdict);
}

std::string_view name(ClaimOrigin origin) {
  return origin == ClaimOrigin::paper ? "paper" : "new";
}

std::vector<Claim> make_claims(const Plan& plan, const Result& result, std::size_t body, const Cost* cost) {
  const Evidence evidence(plan, result, body);
  std::vector<Claim> claims = paper_claims(evidence, cost);
  for (Claim& claim : new_claims(evidence)) claims.push_back(std::move(claim));
  for (Claim& claim : own_claims(evidence)) claims.push_back(std::move(claim));
  for (Claim& claim : press_claims(evidence)) claims.push_back(std::move(claim));
  return claims;
}

std::vector<Claim> join_claims(const std::vector<std::vector<Claim>>& of_bodies) {
  std::vector<Claim> joined = of_bodies.front();
  if (of_bodies.size() == 1) return joined;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const auto count = [&](Verdict verdict) {
      return static_cast<std::size_t>(
          std::count_if(of_bodies.begin(), of_bodies.end(),
                        [&](const std::vector<Claim>& claims) { return claims[i].verdict == verdict; }));
    };
    const std::size_t tested = of_bodies.size() - count(Verdict::untested);
    joined[i].verdict = tested == 0                       ? Verdict::untested
                        : count(Verdict::holds) == tested ? Verdict::holds
                        : count(Verdict::fails) == tested ? Verdict::fails
                                                          : Verdict::partly;
    if (tested == 0) continue;
    const auto first = static_cast<std::size_t>(
        std::find_if(of_bodies.begin(), of_bodies.end(),
                     [&](const std::vector<Claim>& claims) { return claims[i].verdict != Verdict::untested; }) -
        of_bodies.begin());
    joined[i].numbers =
        fmt::format("Of {} it holds on {}, partly on {}, fails on {}. {}: {}", counted(tested, "body", "bodies"),
                    count(Verdict::holds), count(Verdict::partly), count(Verdict::fails),
                    first == 0 ? "On the first" : fmt::format("On number {}", first + 1), of_bodies[first][i].numbers);
  }
  return joined;
}

const Claim* find_claim(std::span<const Claim> claims, std::string_view id) {
  const auto at = std::find_if(claims.begin(), claims.end(), [&](const Claim& claim) { return claim.id == id; });
  return at == claims.end() ? nullptr : &*at;
}

}  // namespace morula::study
