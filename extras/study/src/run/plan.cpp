// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/geometry/reproducible.hpp>
#include <morula/study/plan.hpp>
#include <numbers>
#include <toolbox/numbers.hpp>

namespace morula::study {

using namespace toolbox;

std::string name(const RuleKey& key) {
  switch (key.kind) {
    case rebuilt:
      return "rebuilt";
    case fresh:
      return "fresh";
    case RuleKey::Kind::own:
      return key.own;
    case RuleKey::Kind::update:
      break;
  }
  return std::string(name(key.rule));
}

std::string title(const RuleKey& key) {
  if (key == Rule::approach1) return "Approach 1";
  if (key == Rule::approach2) return "Approach 2";
  if (key == rebuilt) return "exact, rebuilt";
  if (key == fresh) return "fresh build";
  return name(key);
}

std::vector<RuleKey> all_rule_keys() {
  std::vector<RuleKey> keys(position_rules().begin(), position_rules().end());
  keys.emplace_back(rebuilt);
  keys.emplace_back(fresh);
  return keys;
}

std::optional<RuleKey> rule_key_from_name(std::string_view text) {
  for (const RuleKey& key : all_rule_keys())
    if (name(key) == text) return key;
  return std::nullopt;
}

FollowRule::FollowRule(RuleKey key) : name(study::name(key)), kind(key.kind) {
  if (kind == RuleKey::Kind::update) options.rules = {key.rule};
}

std::optional<RuleKey> FollowRule::key() const {
  if (own) return RuleKey(*own);
  if (kind != RuleKey::Kind::update) return kind;
  if (options.rules.size() != 1 || options.conservative) return std::nullopt;
  return options.rules.front();
}

std::string FollowRule::title() const {
  const std::optional<RuleKey> known = key();
  return known ? study::title(*known) : name;
}

Vec3 SphOrigin::of(const Mesh& mesh) const {
  switch (kind) {
    case Kind::none:
      break;
    case Kind::box_center:
      return bounding_box(mesh).center();
    case Kind::point:
      return point;
  }
  return {0, 0, 0};
}

std::string name(const SphOrigin& origin) {
  switch (origin.kind) {
    case SphOrigin::Kind::none:
      return "none";
    case SphOrigin::Kind::box_center:
      return "bbox-center";
    case SphOrigin::Kind::point:
      break;
  }
  return exact_digits(origin.point.x) + "," + exact_digits(origin.point.y) + "," + exact_digits(origin.point.z);
}

std::vector<double> Plan::parameters() const {
  if (and_back) return frame_parameters(samples);
  std::vector<double> t;
  for (std::size_t i = 0; i < samples; ++i) t.push_back(static_cast<double>(i) / static_cast<double>(samples - 1));
  return t;
}

std::vector<std::size_t> Plan::fresh_samples(const Source& source) const {
  std::vector<std::size_t> list{0};
  const std::size_t poses = source.named() == Method::medial ? fresh_poses : 1;
  const std::vector<double> amounts = parameters();
  const auto full = static_cast<std::size_t>(std::max_element(amounts.begin(), amounts.end()) - amounts.begin());
  for (std::size_t i = 1; i <= poses; ++i) {
    const std::size_t sample = i * full / poses;
    if (sample != list.back()) list.push_back(sample);
  }
  return list;
}

std::vector<std::size_t> Plan::measured_samples() const {
  if (!measured.empty()) return measured;
  std::vector<std::size_t> all(samples);
  for (std::size_t i = 0; i < samples; ++i) all[i] = i;
  return all;
}

std::vector<std::size_t> Plan::measured_samples(const Source& source) const {
  return is_first_seed(source) ? measured_samples() : decisive_samples();
}

std::vector<std::size_t> Plan::decisive_samples() const {
  return decisive.empty() ? measured_samples() : decisive;
}

bool Plan::has_cells(const Source& source, const FollowRule& rule) const {
  if (rule.kind == fresh && !source.can_build()) return false;  // cannot be built again
  if (is_first_seed(source)) return true;
  return rule.kind == fresh ? later.fresh : rule.kind == rebuilt ? later.rebuilt : true;
}

Measures Plan::measures_of(const Source& source) const {
  Measures some = measures;
  if (is_first_seed(source)) return some;
  some.lattice = some.lattice && later.lattice;
  some.protrusion = some.protrusion && later.protrusion;
  some.half_grid = some.half_grid && later.half_grid;
  return some;
}

std::vector<Trial> Plan::trials() const {
  std::vector<Trial> list;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    const bool random =
        std::any_of(sources.begin(), sources.end(), [&](const Source& s) { return s.body == body && s.seed; });
    for (const std::uint64_t seed : seeds)
      if (random || seed == seeds.front()) list.push_back({body, seed});
  }
  return list;
}

std::vector<std::size_t> Plan::sources_of(const Trial& trial) const {
  std::vector<std::size_t> list;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (is_of(sources[i], trial)) list.push_back(i);
  return list;
}

std::string Plan::motion_name(std::size_t motion) const {
  return motion < motions.size() ? describe_all(motions[motion]) : recorded[motion - motions.size()].name;
}

std::vector<std::size_t> Plan::levels() const {
  if (!of_levels.empty()) return of_levels;
  const auto last = static_cast<std::size_t>(depth);
  return last == 0 ? std::vector<std::size_t>{0} : std::vector<std::size_t>{last - 1, last};
}

std::optional<std::size_t> Plan::find_source(std::size_t body, Method method) const {
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (sources[i].body == body && sources[i].named() == method) return i;
  return std::nullopt;
}

std::optional<std::size_t> Plan::find_source(const Trial& trial, Method method) const {
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (is_of(sources[i], trial) && sources[i].named() == method) return i;
  return std::nullopt;
}

std::optional<std::size_t> Plan::find_rule(const RuleKey& key) const {
  for (std::size_t i = 0; i < rules.size(); ++i)
    if (rules[i].key() == key) return i;
  return std::nullopt;
}

std::vector<Method> paper_methods() {
  return {Method::medial, Method::grid, Method::hubbard, Method::spawn};
}

std::vector<Deformations> paper_motions() {
  return {{Stretch{}}, {Twist{}}, {Bend{}}};
}

bool is_random(Method method) {
  return method != Method::octree;
}

Source own_source(std::size_t body, std::shared_ptr<const OwnGenerator> generator) {
  std::string name = generator->name;
  return {.body = body, .method = std::move(name), .generator = {}, .file = {}, .own = std::move(generator)};
}

std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods) {
  std::vector<Source> sources;
  for (std::size_t body = 0; body < bodies.size(); ++body)
    for (const Method method : methods)
      sources.push_back({.body = body, .method = std::string(name(method)), .generator = method});
  return sources;
}

std::vector<Source> sources_of(const std::vector<NamedMesh>& bodies, const std::vector<Method>& methods,
                               const std::vector<std::uint64_t>& seeds) {
  std::vector<Source> sources;
  for (std::size_t body = 0; body < bodies.size(); ++body) {
    for (const std::uint64_t seed : seeds) {
      for (const Method method : methods) {
        if (!is_random(method) && seed != seeds.front()) continue;
        sources.push_back({.body = body, .method = std::string(name(method)), .generator = method});
        if (is_random(method)) sources.back().seed = seed;
      }
    }
  }
  return sources;
}

std::string describe_all(const Deformations& deformations) {
  std::string text;
  for (const Deformation& deformation : deformations) text += (text.empty() ? "" : ", ") + describe(deformation);
  return text;
}

std::vector<FollowRule> rule_mixes(int depth) {
  constexpr std::array inner{Rule::approach1, Rule::approach2, Rule::wrapped, Rule::exact};
  constexpr std::array leaf{Rule::traditional, Rule::approach1, Rule::approach2, Rule::exact};
  std::vector<FollowRule> mixes;
  for (const bool conservative : {false, true}) {
    for (const Rule above : inner) {
      for (const Rule below : leaf) {
        if (conservative && above == Rule::exact && below == Rule::exact) continue;  // covers as it is
        FollowRule mix;
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
    mesh.facets.push_back({i, n + next, n + i});
    mesh.facets.push_back({i, next, n + next});
    mesh.facets.push_back({2 * n, next, i});
    mesh.facets.push_back({2 * n + 1, n + i, n + next});
  }
  return mesh;
}

}  // namespace morula::study
