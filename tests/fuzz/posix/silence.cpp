// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <unistd.h>

#include <cstdint>

#include "fuzz.hpp"

// Of the sanitizers, where the program has them.
extern "C" void __sanitizer_set_report_fd(void* descriptor) __attribute__((weak));

namespace morula::fuzz {

std::FILE* report() {
  static std::FILE* const stream = fdopen(dup(STDERR_FILENO), "w");
  return stream;
}

void silence() {
  std::FILE* const stream = report();
  if (__sanitizer_set_report_fd != nullptr) {
    // The descriptor itself, in the shape of a pointer.
    __sanitizer_set_report_fd(reinterpret_cast<void*>(static_cast<std::intptr_t>(fileno(stream))));
  }
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
  close(nowhere);
}

}  // namespace morula::fuzz
