// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// In place of src/update/rules/paper_rules.cpp in the small modules, whose bodies follow `exact` and `skinned`.
#include <stdexcept>

#include "update/rules/engine_table.hpp"

namespace morula::detail {

std::unique_ptr<RuleEngine> bind_paper_rules(const Binding& /*binding*/) {
  throw std::invalid_argument("rules: this module has exact and skinned alone: load the variant \"full\"");
}

}  // namespace morula::detail
