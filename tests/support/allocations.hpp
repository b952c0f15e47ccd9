// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Counts every allocation of a program, and lets one fail: whoever names a counter links an operator new that counts.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

namespace morula::test {

extern std::atomic<std::size_t> allocations;
/// The bytes asked for by all of them together, freed or not.
extern std::atomic<std::size_t> allocated_bytes;
/// Not negative: so many more are granted. The next one, and all after it, throw std::bad_alloc until this is set anew.
extern std::atomic<std::int64_t> allocations_granted;
/// The bytes that are allocated now, as the allocator rounds them up.
extern std::atomic<std::size_t> live_bytes;
/// n: the n-th allocation from now on fails, once. 0: none does.
extern std::atomic<std::size_t> allocation_to_fail;

/// What a call allocates after two like it.
template <class Call>
std::size_t allocations_once_warm(const Call& call) {
  call();
  call();
  const std::size_t before = allocations;
  call();
  return allocations - before;
}

}  // namespace morula::test
