// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/claims.hpp"

#include <map>

#include "study/evidence.hpp"

namespace morula::cli {

Json claim_json(const StudyClaim& claim) {
  Json json{{"id", claim.id},           {"source", claim.source},   {"claim", claim.claim},
            {"verdict", claim.verdict}, {"numbers", claim.numbers}, {"figures", claim.figures}};
  if (claim.timed) json["timed"] = true;
  return json;
}

std::vector<StudyClaim> make_claims(const StudyPlan& plan, const StudyResult& result, const std::string& body,
                                    const StudyCost* cost) {
  const Evidence evidence(plan, result, body);
  std::vector<StudyClaim> claims = paper_claims(evidence, cost);
  for (StudyClaim& claim : new_claims(evidence)) claims.push_back(std::move(claim));
  for (StudyClaim& claim : press_claims(evidence)) claims.push_back(std::move(claim));
  return claims;
}

std::vector<StudyClaim> join_claims(const std::vector<std::vector<StudyClaim>>& of_bodies) {
  std::vector<StudyClaim> joined = of_bodies.front();
  if (of_bodies.size() == 1) return joined;
  for (std::size_t i = 0; i < joined.size(); ++i) {
    std::map<std::string, std::size_t> count;
    for (const std::vector<StudyClaim>& claims : of_bodies) ++count[claims[i].verdict];
    const std::size_t tested = of_bodies.size() - count["untested"];
    joined[i].verdict = tested == 0                ? "untested"
                        : count["holds"] == tested ? "holds"
                        : count["fails"] == tested ? "fails"
                                                   : "partly";
    if (tested == 0) continue;
    const auto first = static_cast<std::size_t>(
        std::find_if(of_bodies.begin(), of_bodies.end(),
                     [&](const std::vector<StudyClaim>& claims) { return claims[i].verdict != "untested"; }) -
        of_bodies.begin());
    joined[i].numbers =
        fmt::format("Of {} it holds on {}, partly on {}, fails on {}. {}: {}", counted(tested, "body", "bodies"),
                    count["holds"], count["partly"], count["fails"],
                    first == 0 ? "On the first" : fmt::format("On number {}", first + 1), of_bodies[first][i].numbers);
  }
  return joined;
}

}  // namespace morula::cli
