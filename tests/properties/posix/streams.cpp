// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "streams.hpp"

#include <unistd.h>

#include <cstring>

namespace morula::properties {

bool are_errors_seen() {
  return isatty(STDERR_FILENO) != 0;
}

void write_at_end(const char* text) {
  const ssize_t written = write(STDOUT_FILENO, text, std::strlen(text));
  static_cast<void>(written);
}

}  // namespace morula::properties
