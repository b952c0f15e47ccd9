// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "support/allocations.hpp"

#include <malloc.h>

#include <cstdlib>
#include <new>

namespace morula::test {

std::atomic<std::size_t> allocations{0};
std::atomic<std::size_t> allocated_bytes{0};
std::atomic<std::int64_t> allocations_granted{-1};
std::atomic<std::size_t> live_bytes{0};
std::atomic<std::size_t> allocation_to_fail{0};

}  // namespace morula::test

namespace {

using namespace morula::test;

bool is_to_fail() {
  if (allocations_granted == 0) return true;
  if (allocations_granted > 0) --allocations_granted;
  return allocation_to_fail != 0 && --allocation_to_fail == 0;
}

// None where there is no memory, or is to be none.
void* taken(std::size_t size) {
  ++allocations;
  allocated_bytes += size;
  void* const p = is_to_fail() ? nullptr : std::malloc(size == 0 ? 1 : size);
  live_bytes += malloc_usable_size(p);
  return p;
}
void* taken(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  allocated_bytes += size;
  const auto a = static_cast<std::size_t>(alignment);
  void* const p = is_to_fail() ? nullptr : std::aligned_alloc(a, (size + a - 1) / a * a);
  live_bytes += malloc_usable_size(p);
  return p;
}

void* or_throw(void* p) {
  return p != nullptr ? p : throw std::bad_alloc();
}

void give_back(void* p) noexcept {
  live_bytes -= malloc_usable_size(p);
  std::free(p);
}

}  // namespace

void* operator new(std::size_t size) {
  return or_throw(taken(size));
}
void* operator new[](std::size_t size) {
  return or_throw(taken(size));
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return or_throw(taken(size, alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return or_throw(taken(size, alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return taken(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return taken(size);
}
void operator delete(void* p) noexcept {
  give_back(p);
}
void operator delete[](void* p) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept {
  give_back(p);
}
