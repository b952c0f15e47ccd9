// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cell store: JSON and trees under a hash of all settings that decide them.
#pragma once

#include <morula/study/cache.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <string>

#include "json.hpp"

namespace morula::study {

/// The version of stored figures. Raise it when a change gives other figures for the same settings, or stores them in
/// another form.
inline constexpr int cell_format = 3;

// cache: nullptr finds and keeps nothing. Several threads may find and store at once, for different settings.

/// The JSON stored for exactly these settings; none if there is none, or if it cannot be read.
std::optional<Json> find(const Cache* cache, const std::string& stem, const Json& settings);
/// Stores a result; the write is atomic.
void store(const Cache* cache, const std::string& stem, const Json& settings, const Json& result);

std::optional<CoveredTree> find_tree(const Cache* cache, const std::string& stem, const Json& settings,
                                     const Mesh& mesh);
void store_tree(const Cache* cache, const std::string& stem, const Json& settings, const CoveredTree& model);

}  // namespace morula::study
