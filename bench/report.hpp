// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Results for people and for programs.
#pragma once

#include <string>

#include "baseline.hpp"
#include "scenario.hpp"

namespace morula::bench {

/// Two lines or more: times; figures; what is wrong.
void print(const Result& result);

/// Medians and maxima over the meshes, as a table; nothing for no rows.
void print(std::span<const SummaryRow> rows);

/// Everything, times in seconds, as one JSON object.
std::string to_json(std::span<const Input> inputs, std::span<const Result> results, std::span<const SummaryRow> summary,
                    const Settings& settings);

}  // namespace morula::bench
