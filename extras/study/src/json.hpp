// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// JSON of the study's files. Only sources include it: results do not depend on it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace morula::study {

/// Keys stay in the order they were written in.
using Json = nlohmann::ordered_json;

/// Null for none.
template <class Value>
Json json_of(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

template <class Value = double>
std::optional<Value> value_from(const Json& json) {
  return json.is_null() ? std::nullopt : std::optional(json.get<Value>());
}

/// Names need not be text in UTF-8: what is not is replaced.
inline std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace morula::study
