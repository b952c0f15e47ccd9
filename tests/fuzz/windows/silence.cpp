// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <io.h>

#include "fuzz.hpp"

namespace morula::fuzz {

std::FILE* report() {
  static std::FILE* const stream = _fdopen(_dup(2), "w");
  return stream;
}

void silence() {
  report();
  const int nowhere = _open("NUL", _O_WRONLY);
  _dup2(nowhere, 1);
  _dup2(nowhere, 2);
  _close(nowhere);
}

}  // namespace morula::fuzz
