// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The text of the error that a call throws.
#pragma once

#include <stdexcept>
#include <string>

namespace morula::test {

/// The text of std::invalid_argument; empty if the call throws nothing. Other exceptions pass.
template <class Call>
std::string error_text(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace morula::test
