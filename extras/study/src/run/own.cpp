// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/own.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

namespace morula::study {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
}

void check_name(const char* kind, const std::string& name) {
  if (name.empty() || name.front() == '.' || !std::all_of(name.begin(), name.end(), is_plain))
    throw std::invalid_argument(
        fmt::format("study: {} '{}': a name has letters, digits, '_', '-' and '.' only", kind, name));
}

[[noreturn]] void refuse_taken(const char* kind, const std::string& name) {
  throw std::invalid_argument(fmt::format("study: {} '{}': the name is taken", kind, name));
}

}  // namespace

void check_own(const Plan& plan) {
  std::set<std::string> rules;
  for (const std::vector<FollowRule>* list : {&plan.rules, &plan.mixes}) {
    for (const FollowRule& rule : *list) {
      if ((rule.kind == RuleKey::Kind::own) != (rule.own != nullptr) || (rule.own && !rule.own->make))
        throw std::invalid_argument("study: rule '" + rule.name + "': one's own rules come from own_rule()");
      if (!rule.own) continue;
      check_name("rule", rule.name);
      if (rule_key_from_name(rule.name) || !rules.insert(rule.name).second) refuse_taken("rule", rule.name);
    }
  }
  std::set<std::pair<std::size_t, std::string>> generators;
  for (const Source& source : plan.sources) {
    if (!source.own) continue;
    check_name("generator", source.method);
    if (source.named() || !generators.insert({source.body, source.method}).second)
      refuse_taken("generator", source.method);
  }
  std::set<std::string> metrics{"uncovered", "uncovered-distance", "protrusion"};
  for (const OwnMetric& metric : plan.metrics) {
    check_name("metric", metric.name);
    if (!metric.value) throw std::invalid_argument("study: metric '" + metric.name + "' has no function");
    if (!metrics.insert(metric.name).second) refuse_taken("metric", metric.name);
  }
}

CoveredTree make_own_tree(const OwnGenerator& generator, const Mesh& mesh) {
  CoveredTree model = generator.build(mesh);
  if (const std::vector<std::string> faults = validate(mesh, model); !faults.empty())
    throw std::invalid_argument(fmt::format("study: generator '{}': {}", generator.name, faults.front()));
  return model;
}

void require_sound(const OwnRule& rule, const SphereTree& tree, std::size_t nodes) {
  if (const std::vector<std::string> faults = validate(tree); !faults.empty())
    throw std::invalid_argument(fmt::format("study: rule '{}': {}", rule.name, faults.front()));
  if (tree.node_count() == nodes) return;
  throw std::invalid_argument(
      fmt::format("study: rule '{}': a tree of {} nodes, not of {}", rule.name, tree.node_count(), nodes));
}

bool has_version(const Plan& plan, const Source& source, const FollowRule& rule) {
  if (rule.own && rule.own->version.empty()) return false;
  if (rule.kind == fresh && source.own && source.own->version.empty()) return false;  // other cells name their tree
  return std::none_of(plan.metrics.begin(), plan.metrics.end(), [](const OwnMetric& m) { return m.version.empty(); });
}

Json metrics_json(const Plan& plan) {
  Json json = Json::array();
  for (const OwnMetric& metric : plan.metrics) json.push_back({metric.name, metric.version});
  return json;
}

}  // namespace morula::study
