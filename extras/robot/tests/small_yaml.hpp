// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// As much of YAML 1.1 as robots' files use, read as strictly as its strictest reader: a key twice is an error, 1e-05 is
// a word, 0 is no float.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace morula::test {

/// Throws std::runtime_error for anything else.
nlohmann::json parse_yaml(const std::string& text);

}  // namespace morula::test
