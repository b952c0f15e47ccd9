// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The error of readers of our own formats for a version that they do not know.
#pragma once

#include <cstdint>
#include <morula/version.hpp>
#include <string>

namespace morula::detail {

/// newest: the newest version that this library reads; it reads all from 1 on.
inline std::string unknown_format_version(std::uint64_t given, std::uint64_t newest, const std::string& remedy) {
  if (given == 0) return "format version 0 does not exist; " + remedy;
  return "format version " + std::to_string(given) + " is newer than Morula " + std::string(version) +
         ", which reads versions up to " + std::to_string(newest) + "; update Morula, or " + remedy;
}

}  // namespace morula::detail
