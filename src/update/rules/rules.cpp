// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <morula/update/rules.hpp>

namespace morula {
namespace {

// Whether the number is one of Rule's enumerators: compilers print those by name, other values as a cast of a number.
template <Rule rule>
constexpr bool is_enumerator() {
#ifdef _MSC_VER
  constexpr std::string_view text = __FUNCSIG__;
  constexpr std::size_t at = text.find("is_enumerator<") + 14;
#else
  constexpr std::string_view text = __PRETTY_FUNCTION__;
  constexpr std::size_t at = text.find("rule = ") + 7;
#endif
  return text[at] != '(' && text[at] != '-' && !(text[at] >= '0' && text[at] <= '9');
}

// A new enumerator without a row stops the build here.
template <std::size_t... index>
constexpr bool rows_are_rules(std::index_sequence<index...>) {
  return ((rule_table[index].rule == static_cast<Rule>(index) && is_enumerator<static_cast<Rule>(index)>()) && ...);
}
static_assert(rows_are_rules(std::make_index_sequence<rule_table.size()>()), "a row is missing, or in another place");
static_assert(!is_enumerator<static_cast<Rule>(rule_table.size())>(), "the last rule has no row in rule_table");

constexpr bool follows_positions(const RuleTraits& row) {
  return row.follows == RuleTraits::Follows::positions;
}

template <std::size_t count>
constexpr std::array<Rule, count> rules_where(bool (*wanted)(const RuleTraits&)) {
  std::array<Rule, count> rules{};
  std::size_t i = 0;
  for (const RuleTraits& row : rule_table)
    if (wanted(row)) rules[i++] = row.rule;
  return rules;
}
constexpr auto every_rule = rules_where<rule_table.size()>([](const RuleTraits&) { return true; });
constexpr auto rules_of_positions =
    rules_where<std::count_if(rule_table.begin(), rule_table.end(), follows_positions)>(follows_positions);

}  // namespace

std::string_view name(Rule rule) {
  return is_rule(rule) ? traits(rule).name : "unknown";
}

std::optional<Rule> rule_from_name(std::string_view wanted) {
  for (const RuleTraits& row : rule_table)
    if (row.name == wanted) return row.rule;
  return std::nullopt;
}

std::span<const Rule> all_rules() {
  return every_rule;
}

std::span<const Rule> position_rules() {
  return rules_of_positions;
}

bool covers(const UpdateOptions& options) {
  return options.conservative ||
         std::all_of(options.rules.begin(), options.rules.end(), [](Rule rule) { return traits(rule).covers; });
}

bool covers(const UpdateOptions& options, Rule rule) {
  return options.conservative || covers_alone(rule) || (traits(rule).covers && covers(options));
}

}  // namespace morula
