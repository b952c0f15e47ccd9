// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "support/allocations.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
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

// Stands in front of each block: the system need not say how large its blocks are.
struct Header {
  void* begin;  // of what malloc gave
  std::size_t size;
};

// None where there is no memory, or is to be none.
void* taken(std::size_t size, std::size_t alignment = alignof(std::max_align_t)) {
  ++allocations;
  allocated_bytes += size;
  const std::size_t added = sizeof(Header) + alignment;
  void* const begin = is_to_fail() || size + added < size ? nullptr : std::malloc(size + added);
  if (begin == nullptr) return nullptr;
  void* place = static_cast<char*>(begin) + sizeof(Header);
  std::size_t room = size + alignment;
  std::align(alignment, size, place, room);
  static_cast<Header*>(place)[-1] = {begin, size};
  live_bytes += size;
  return place;
}
void* taken(std::size_t size, std::align_val_t alignment) {
  return taken(size, std::max(static_cast<std::size_t>(alignment), alignof(std::max_align_t)));
}

void* or_throw(void* p) {
  return p != nullptr ? p : throw std::bad_alloc();
}

void give_back(void* p) noexcept {
  if (p == nullptr) return;
  const Header header = static_cast<const Header*>(p)[-1];
  live_bytes -= header.size;
  std::free(header.begin);
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
