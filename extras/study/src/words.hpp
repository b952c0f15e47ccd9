// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Words of motions.
#pragma once

#include <string>

namespace morula::study {

/// "stretch" of "stretch 2".
inline std::string first_word(const std::string& text) {
  return text.substr(0, text.find(' '));
}

}  // namespace morula::study
