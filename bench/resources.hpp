// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What the process has used.
#pragma once

#include <cstddef>
#include <optional>

namespace morula::bench {

/// Of all threads, spent in the program itself: waiting and the kernel's work are not in it.
double user_seconds();

/// Processor time of the calling thread; where that is not known, wall time.
double thread_seconds();

/// Bytes that the program holds of the heap. glibc only: nothing elsewhere.
std::optional<std::size_t> allocated_bytes();

/// Bytes of memory at most in use since it was made, beyond those before. Linux only: nothing elsewhere.
class PeakMemory {
 public:
  PeakMemory();
  std::optional<std::size_t> bytes() const;

 private:
  std::optional<std::size_t> before_;
};

}  // namespace morula::bench
