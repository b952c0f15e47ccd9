// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Resources that the process has used.
#pragma once

#include <cstddef>
#include <optional>

namespace morula::bench {

/// Of all threads, spent in the program itself: waiting and the kernel's work are not in it.
double user_seconds();
/// The same and the kernel's work, finer than a microsecond where the system allows: for single frames.
double processor_seconds();
/// What one call takes of them. Neither waiting nor other programs count; other threads of this one do, so that nobody
/// gains by starting some.
template <class F>
double processor_seconds_of(const F& f) {
  const double start = processor_seconds();
  f();
  return processor_seconds() - start;
}

/// Processor time of the calling thread; where that is not known, wall time.
double thread_seconds();

/// Bytes that the program holds of the heap. glibc only: nothing elsewhere.
std::optional<std::size_t> allocated_bytes();

/// Bytes of memory in use by the process now. Linux only: nothing elsewhere.
std::optional<std::size_t> resident_bytes();

/// Bytes of memory at most in use since it was made, beyond those before. Linux only: nothing elsewhere.
class PeakMemory {
 public:
  PeakMemory();
  std::optional<std::size_t> bytes() const;

 private:
  std::optional<std::size_t> before_;
};

}  // namespace morula::bench
