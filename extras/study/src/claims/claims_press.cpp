// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of a press, against exact triangles. A case is a tree, an axis and an amount.
#include <cmath>

#include "claims/evidence.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

std::size_t body_of(const Evidence& evidence, const PressCell& cell) {
  return evidence.plan().pressed(cell.source).body;
}

/// Trees without a seed are pressed once, in the trial of the first seed.
bool is_of(const Evidence& evidence, const PressCell& cell) {
  const Source& source = evidence.plan().pressed(cell.source);
  return source.body == evidence.body() && source.seed.value_or(evidence.plan().seeds.front()) == evidence.trial().seed;
}

std::vector<const PressCell*> presses_of(const Evidence& evidence, Rule rule) {
  std::vector<const PressCell*> list;
  for (const PressCell& cell : evidence.result().presses)
    if (is_of(evidence, cell) && evidence.plan().press_rules[cell.rule].key() == rule) list.push_back(&cell);
  return list;
}

/// The figures of the first body, which are drawn.
std::vector<std::string> rule_figures(const Evidence& evidence, const std::string& measure) {
  std::vector<std::string> list;
  for (const PressCell& cell : evidence.result().presses) {
    if (body_of(evidence, cell) != 0) continue;
    for (const PressFigures& f : cell.figures) {
      std::string id = fmt::format("press-rules-{}{}", name(f.axis), measure);
      if (std::find(list.begin(), list.end(), id) == list.end()) list.push_back(std::move(id));
    }
  }
  return list;
}

/// The figures of all leaves, without a budget: the last query of each axis and amount.
std::vector<const PressFigures*> leaf_figures(const PressCell& cell) {
  std::vector<const PressFigures*> list;
  for (const PressFigures& f : cell.figures) {
    if (!list.empty() && list.back()->amount == f.amount && list.back()->axis == f.axis) {
      list.back() = &f;
    } else {
      list.push_back(&f);
    }
  }
  return list;
}

double lost_share(const PressFigures& f) {
  return static_cast<double>(f.lost) / static_cast<double>(std::max<std::size_t>(f.crossings, 1));
}

std::string where_text(const Evidence& evidence, const PressCell& cell, const PressFigures& f) {
  return fmt::format("{}, along {}, by {}", evidence.method(cell.source), name(f.axis),
                     percent(evidence.plan().press_amounts[f.amount]));
}

/// A claim without any measurement yet.
Claim new_claim(std::string id, std::string claim, std::vector<std::string> figures) {
  return make_claim(std::move(id), ClaimOrigin::ours, std::move(claim), std::move(figures));
}

Claim lost_claim(const Evidence& evidence, Rule rule) {
  Claim claim =
      new_claim(std::string(name(rule)) + "-loses-crossings",
                fmt::format("Contacts of {} lose facets that cross", title(rule)), rule_figures(evidence, "-lost"));
  claim.adverse = true;
  std::size_t with = 0;
  std::size_t total = 0;
  double worst = 0;
  std::string where;
  for (const PressCell* cell : presses_of(evidence, rule)) {
    for (const PressFigures* f : leaf_figures(*cell)) {
      ++total;
      with += f->lost > 0 ? 1 : 0;
      if (lost_share(*f) > worst) worst = lost_share(*f), where = where_text(evidence, *cell, *f);
    }
  }
  claim.quantity.name = "largest lost share of the pairs of facets that cross";
  evidence.decide(claim, with, total, worst,
                  fmt::format("At the leaves in {} of {} cases, up to {} of the pairs of facets that cross{}.", with,
                              total, percent(worst), where.empty() ? "" : fmt::format(" ({})", where)));
  return claim;
}

Claim complete_claim(const Evidence& evidence) {
  Claim claim =
      new_claim("exact-keeps-crossings", "Contacts of exact lose no facets that cross, at any level and budget",
                rule_figures(evidence, "-lost"));
  claim.guarantee = true;
  std::size_t kept = 0;
  std::size_t total = 0;
  std::size_t crossings = 0;
  for (const PressCell* cell : presses_of(evidence, Rule::exact)) {
    for (const PressFigures& f : cell->figures) {
      ++total;
      kept += f.lost == 0 ? 1 : 0;
      crossings += f.crossings;
    }
  }
  evidence.decide(
      claim, kept, total, std::nullopt,
      fmt::format("In {} of {} queries, which had to find {} pairs of facets in all.", kept, total, crossings));
  return claim;
}

Claim depth_claim(const Evidence& evidence) {
  Claim claim =
      new_claim("corrected-depth",
                "The largest corrected depth of leaf contacts of exact is nearer to the truth than that of spheres",
                rule_figures(evidence, ""));
  std::size_t nearer = 0;
  std::vector<double> spheres, surfaces;
  for (const PressCell* cell : presses_of(evidence, Rule::exact)) {
    for (const PressFigures* f : leaf_figures(*cell)) {
      nearer += std::abs(f->depth_surfaces - 1) < std::abs(f->depth_spheres - 1) ? 1 : 0;
      spheres.push_back(f->depth_spheres);
      surfaces.push_back(f->depth_surfaces);
    }
  }
  claim.quantity = {.name = "largest corrected depth over the true depth (median of cases)", .is_ratio = true};
  if (spheres.empty()) return claim;
  const auto [low, high] = std::minmax_element(spheres.begin(), spheres.end());
  const auto [least, most] = std::minmax_element(surfaces.begin(), surfaces.end());
  evidence.decide(
      claim, nearer, spheres.size(), median(surfaces),
      fmt::format("In {} of {} cases; {} the true depth in the median ({} to {}), of spheres {} ({} to {}).", nearer,
                  spheres.size(), times(median(surfaces)), figure(*least), figure(*most), times(median(spheres)),
                  figure(*low), figure(*high)));
  return claim;
}

Claim refine_claim(const Evidence& evidence) {
  Claim claim = new_claim("budgets-refine", "More budget never finishes fewer contacts", rule_figures(evidence, ""));
  claim.guarantee = true;
  std::size_t refined = 0;
  std::size_t total = 0;
  const std::vector<PressQuery> queries = press_queries(evidence.plan());
  for (const PressCell& cell : evidence.result().presses) {
    if (!is_of(evidence, cell)) continue;
    for (std::size_t i = 1; i < cell.figures.size(); ++i) {
      const PressFigures& before = cell.figures[i - 1];
      const PressFigures& now = cell.figures[i];
      if (before.axis != now.axis || before.amount != now.amount || !queries[before.query].leaves) continue;
      ++total;
      refined += now.finished >= before.finished ? 1 : 0;
    }
  }
  evidence.decide(claim, refined, total, std::nullopt,
                  fmt::format("From a budget to the next in {} of {} steps.", refined, total));
  return claim;
}

}  // namespace

std::vector<Claim> press_claims(const Evidence& evidence) {
  std::vector<Claim> claims;
  for (const Rule rule : {Rule::traditional, Rule::approach2}) claims.push_back(lost_claim(evidence, rule));
  claims.push_back(complete_claim(evidence));
  claims.push_back(depth_claim(evidence));
  claims.push_back(refine_claim(evidence));
  return claims;
}

}  // namespace morula::study
