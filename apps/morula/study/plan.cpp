// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/plan.hpp"

#include <algorithm>
#include <array>
#include <morula/geometry/trigonometry.hpp>
#include <numbers>

#include "shared/options.hpp"

namespace morula::cli {

std::vector<double> StudyPlan::parameters() const {
  std::vector<double> t;
  for (std::size_t i = 0; i < samples; ++i) t.push_back(static_cast<double>(i) / static_cast<double>(samples - 1));
  return t;
}

std::vector<std::size_t> StudyPlan::fresh_samples(const StudySource& source) const {
  std::vector<std::size_t> list{0};
  const std::size_t poses = source.method == "medial" ? fresh_poses : 1;
  for (std::size_t i = 1; i <= poses; ++i) {
    const std::size_t sample = i * (samples - 1) / poses;
    if (sample != list.back()) list.push_back(sample);
  }
  return list;
}

std::vector<std::size_t> StudyPlan::levels() const {
  const auto last = static_cast<std::size_t>(depth);
  return last == 0 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{last - 1, last};
}

bool StudyPlan::has_method(std::string_view name) const {
  return std::any_of(sources.begin(), sources.end(), [&](const StudySource& s) { return s.method == name; });
}

bool StudyPlan::has_rule(std::string_view name) const {
  return std::any_of(rules.begin(), rules.end(), [&](const StudyRule& r) { return r.name == name; });
}

std::vector<std::string> paper_methods() {
  return {"medial", "grid", "hubbard", "spawn"};
}

std::vector<std::string> study_rule_names() {
  std::vector<std::string> names;
  for (const Rule rule : position_rules()) names.emplace_back(name(rule));
  names.insert(names.end(), {"refitted", "fresh"});
  return names;
}

StudyRule study_rule(const std::string& text) {
  check_name("rule", text, study_rule_names());
  if (text == "refitted") return {text, StudyRule::Kind::refitted, {}};
  if (text == "fresh") return {text, StudyRule::Kind::fresh, {}};
  return {text, StudyRule::Kind::update, {.rules = {*rule_from_name(text)}, .details = {}, .modes = {}}};
}

std::vector<StudyRule> rule_mixes(int depth) {
  constexpr std::array inner{Rule::approach1, Rule::approach2, Rule::wrapped, Rule::exact};
  constexpr std::array leaf{Rule::traditional, Rule::approach1, Rule::approach2, Rule::exact};
  std::vector<StudyRule> mixes;
  for (const bool conservative : {false, true}) {
    for (const Rule above : inner) {
      for (const Rule below : leaf) {
        if (conservative && above == Rule::exact && below == Rule::exact) continue;  // covers as it is
        StudyRule mix;
        mix.name = std::string(name(above)) + "+" + std::string(name(below)) + (conservative ? " covering" : "");
        mix.options.rules.assign(static_cast<std::size_t>(depth), above);
        mix.options.rules.push_back(below);
        mix.options.conservative = conservative;
        mixes.push_back(std::move(mix));
      }
    }
  }
  return mixes;
}

Mesh needle_prism(std::size_t sides) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(sides);
  for (const double x : {-2.0, 2.0}) {
    for (std::size_t i = 0; i < sides; ++i) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sides);
      const SinCos turn = sin_cos(angle);
      mesh.positions.push_back({x, 0.5 * turn.cos, 0.5 * turn.sin});
    }
  }
  mesh.positions.push_back({-2, 0, 0});
  mesh.positions.push_back({2, 0, 0});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t next = (i + 1) % n;
    mesh.facets.push_back({i, n + i, n + next});
    mesh.facets.push_back({i, n + next, next});
    mesh.facets.push_back({2 * n, i, next});
    mesh.facets.push_back({2 * n + 1, n + next, n + i});
  }
  return mesh;
}

Json settings_json(const StudyPlan& plan) {
  Json motions = Json::array();
  for (const Deformations& motion : plan.motions) motions.push_back(describe_all(motion));
  Json rules = Json::array();
  for (const StudyRule& rule : plan.rules) rules.push_back(rule.name);
  Json press_rules = Json::array();
  for (const StudyRule& rule : plan.press_rules) press_rules.push_back(rule.name);
  return {{"samples", plan.samples},
          {"parameters", plan.parameters()},
          {"fresh_poses", plan.fresh_poses},
          {"levels", plan.levels()},
          {"branching", plan.branching},
          {"depth", plan.depth},
          {"seed", plan.seed},
          {"resolution", plan.resolution},
          {"protrusion_tolerance", plan.protrusion_tolerance},
          {"unit", plan.unit == ErrorUnit::volume ? "volume" : "box"},
          {"motions", motions},
          {"rules", rules},
          {"press",
           {{"pose", describe_all(plan.press_pose)},
            {"rules", press_rules},
            {"amounts", plan.press_amounts},
            {"budgets", plan.press_budgets}}},
          {"sph_origin", plan.sph_origin}};
}

}  // namespace morula::cli
