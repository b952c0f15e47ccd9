// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Memory for short-lived, small allocations: it uses no heap as long as it suffices.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <memory_resource>

namespace morula::detail {

/// A memory resource that allocates from a buffer inside itself, and from the heap when that is full. Memory that is
/// freed last in, first out, as by locals of nested calls, is free again at once; memory freed in another order stays
/// allocated. One thread may use it.
template <std::size_t size>
class StackMemory : public std::pmr::memory_resource {
 public:
  StackMemory() = default;
  StackMemory(const StackMemory&) = delete;
  StackMemory& operator=(const StackMemory&) = delete;
  /// Allocated bytes of the buffer.
  std::size_t used() const { return used_; }

 private:
  static constexpr std::size_t step = alignof(std::max_align_t);
  // An allocation of 0 bytes takes a step as well: otherwise its address could be behind the last byte, outside the
  // buffer.
  static std::size_t rounded(std::size_t bytes) { return bytes == 0 ? step : (bytes + step - 1) / step * step; }
  bool owns(const void* memory) const {
    const std::less<const void*> before;
    return !before(memory, memory_.data()) && before(memory, memory_.data() + size);
  }

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    // The size is compared first: a size that does not fit might be rounded up beyond the largest number.
    if (alignment > step || bytes > size - used_ || rounded(bytes) > size - used_)
      return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    void* const memory = memory_.data() + used_;
    used_ += rounded(bytes);
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    if (!owns(memory)) return std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    const auto begin = static_cast<std::size_t>(static_cast<std::byte*>(memory) - memory_.data());
    // mutant stack-memory-any-order: `if (begin + rounded(bytes) == used_) used_` -> `used_`
    // mutant stack-memory-never-free: `if (begin + rounded(bytes) == used_) used_ = begin` -> ``
    if (begin + rounded(bytes) == used_) used_ = begin;
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  alignas(std::max_align_t) std::array<std::byte, size> memory_;
  std::size_t used_ = 0;
};

}  // namespace morula::detail
