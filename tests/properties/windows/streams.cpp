// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "streams.hpp"

#include <io.h>

#include <cstring>

namespace morula::properties {

bool are_errors_seen() {
  return _isatty(2) != 0;
}

void write_at_end(const char* text) {
  _write(1, text, static_cast<unsigned>(std::strlen(text)));
}

}  // namespace morula::properties
