// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <morula/update/rules.hpp>

namespace morula {
namespace {

// Those that follow positions first.
constexpr std::array rules{Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2,
                           Rule::exact,       Rule::wrapped,  Rule::modal};

}  // namespace

std::string_view name(Rule rule) {
  switch (rule) {
    case Rule::traditional:
      return "traditional";
    case Rule::weighted:
      return "weighted";
    case Rule::approach1:
      return "approach1";
    case Rule::approach2:
      return "approach2";
    case Rule::exact:
      return "exact";
    case Rule::wrapped:
      return "wrapped";
    case Rule::modal:
      return "modal";
  }
  return "unknown";
}

std::optional<Rule> rule_from_name(std::string_view wanted) {
  for (const Rule rule : rules)
    if (name(rule) == wanted) return rule;
  return std::nullopt;
}

std::span<const Rule> all_rules() {
  return rules;
}

std::span<const Rule> position_rules() {
  return std::span(rules).first(rules.size() - 1);
}

}  // namespace morula
