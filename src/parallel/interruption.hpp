// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks for interruption of this thread's calls, which loops and searches make between two units of work.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <vector>

namespace morula::detail {

struct Interruption;

/// The Interruption that this thread checks, as its owner or as a helper of its owner, or none.
struct ActiveInterruption {
  Interruption* interruption = nullptr;
  bool is_owner = false;
};

/// The state of an Interrupt. Threads that help its owner also check it.
struct Interruption {
  std::function<void()> callback;
  ActiveInterruption outer{};  // the owner's outer one, restored at the end
  std::exception_ptr cause{};  // the owner writes it, and has_ended after it
  std::atomic<bool> has_ended{false};
};

/// Sets what this thread checks, and returns the preceding value.
ActiveInterruption exchange_active_interruption(const ActiveInterruption& next) noexcept;
Interruption* active_interruption() noexcept;

/// Returns when the call may go on, and throws the exception that ends it.
void check_interrupt();

/// Checks at every n-th call, for units of work that are as short as a check.
class InterruptPoller {
 public:
  explicit InterruptPoller(std::uint32_t calls) : calls_(calls), left_(calls) {}
  void operator()() {
    if (--left_ != 0) return;
    left_ = calls_;
    check_interrupt();
  }

 private:
  std::uint32_t calls_, left_;
};

/// values.resize(count) in steps with a check in between, since filling new memory takes long.
template <class Value>
void resize_interruptibly(std::vector<Value>& values, std::size_t count) {
  constexpr std::size_t stretch = (std::size_t{1} << 20) / sizeof(Value);
  values.reserve(count);
  while (values.size() < count) {
    check_interrupt();
    values.resize(std::min(count, values.size() + stretch));
  }
}

/// Reserves room for so many more values of a vector that may become very long. A growing vector copies all its values;
/// this function copies them in steps with a check in between.
template <class Value>
void make_room(std::vector<Value>& values, std::size_t more = 1) {
  constexpr std::size_t stretch = (std::size_t{1} << 20) / sizeof(Value);
  if (values.capacity() - values.size() >= more || values.size() < stretch) return;
  std::vector<Value> longer;
  longer.reserve(values.size() + std::max(values.size(), more));
  for (auto left = values.begin(); left != values.end();) {
    check_interrupt();
    const auto next = left + std::min(values.end() - left, static_cast<std::ptrdiff_t>(stretch));
    longer.insert(longer.end(), left, next);
    left = next;
  }
  values.swap(longer);
}

/// Makes this thread check as a helper of the owner of `of` as long as it lives, unless the thread is the owner itself.
class HelpsOwner {
 public:
  explicit HelpsOwner(Interruption* of) noexcept : joined_(of != active_interruption()) {
    if (joined_) before_ = exchange_active_interruption({of, false});
  }
  ~HelpsOwner() {
    if (joined_) exchange_active_interruption(before_);
  }
  HelpsOwner(const HelpsOwner&) = delete;
  HelpsOwner& operator=(const HelpsOwner&) = delete;

 private:
  bool joined_;
  ActiveInterruption before_{};
};

/// Disables the checks of this thread as long as it lives: for noexcept functions, and for work that an exception would
/// leave unfinished.
class Uninterrupted {
 public:
  Uninterrupted() noexcept : before_(exchange_active_interruption({})) {}
  ~Uninterrupted() { exchange_active_interruption(before_); }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;

 private:
  ActiveInterruption before_;
};

}  // namespace morula::detail
