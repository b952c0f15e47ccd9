// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Engine table: the engine that serves each rule.
#pragma once

#include <algorithm>
#include <array>

#include "update/rules/engine.hpp"

namespace morula::detail {

/// Binds all nodes that follow the rules which the engine serves, and writes their spheres at rest.
using BindEngine = std::unique_ptr<RuleEngine>(const Binding& binding);
BindEngine bind_exact, bind_modal, bind_paper_rules, bind_skinned;

struct EngineRow {
  Rule rule;
  BindEngine* bind;
};
/// Engines are bound and run in this order: engines whose rules read children come after engines whose spheres they may
/// read.
inline constexpr std::array engine_table{
    EngineRow{Rule::modal, bind_modal},           EngineRow{Rule::skinned, bind_skinned},
    EngineRow{Rule::exact, bind_exact},           EngineRow{Rule::traditional, bind_paper_rules},
    EngineRow{Rule::weighted, bind_paper_rules},  EngineRow{Rule::approach1, bind_paper_rules},
    EngineRow{Rule::approach2, bind_paper_rules}, EngineRow{Rule::wrapped, bind_paper_rules},
};

constexpr bool has_one_engine(Rule rule) {
  return std::count_if(engine_table.begin(), engine_table.end(),
                       [&](const EngineRow& row) { return row.rule == rule; }) == 1;
}
static_assert(std::all_of(rule_table.begin(), rule_table.end(),
                          [](const RuleTraits& row) { return has_one_engine(row.rule); }),
              "every rule needs one engine");

}  // namespace morula::detail
