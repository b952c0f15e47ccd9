// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Tables, and their values.
#pragma once

#include <morula/study/figures.hpp>

namespace morula::study {

/// Nothing for none.
inline TableValue value_of(const std::optional<double>& value) {
  return value ? TableValue(*value) : TableValue();
}

/// The seed of a tree; nothing for a tree without one.
inline TableValue seed_value(const Source& source) {
  return source.seed ? TableValue(static_cast<std::size_t>(*source.seed)) : TableValue();
}

/// Every press. Without rows when there is none.
Table make_press_table(const Plan& plan, const Result& result);

}  // namespace morula::study
