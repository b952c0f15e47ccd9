// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cell store: JSON and trees under a hash of all that decides them.
#pragma once

#include <morula/study/cache.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <string>

#include "json.hpp"

namespace morula::study {

/// To be raised when the same settings give other figures than before, or these are stored otherwise.
inline constexpr int cell_format = 2;

// cache: nullptr finds nothing and keeps nothing. Several threads may ask and store at once, for different settings.

/// What was stored for exactly these settings; nothing when there is none, or it cannot be read.
std::optional<Json> find(const Cache* cache, const std::string& stem, const Json& settings);
/// Written whole or not at all.
void store(const Cache* cache, const std::string& stem, const Json& settings, const Json& result);

std::optional<CoveredTree> find_tree(const Cache* cache, const std::string& stem, const Json& settings,
                                     const Mesh& mesh);
void store_tree(const Cache* cache, const std::string& stem, const Json& settings, const CoveredTree& model);

}  // namespace morula::study
