// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whether calls of this thread are to go on: what loops and searches ask between two pieces of work.
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

/// Whom this thread asks: nobody, or an Interruption, as its owner or as a helper of its owner.
struct WhomToAsk {
  Interruption* whom = nullptr;
  bool is_owner = false;
};

/// Of an Interrupt. Threads that help its owner ask it, too.
struct Interruption {
  std::function<void()> ask;
  WhomToAsk outer{};           // whom the owner asked before
  std::exception_ptr cause{};  // written before has_ended, by the owner
  std::atomic<bool> has_ended{false};
};

/// Returns what was there before.
WhomToAsk exchange_asked(const WhomToAsk& next) noexcept;
Interruption* asked_now() noexcept;

/// Returns when the call is to go on, and throws what ends it.
void ask_to_go_on();

/// Asks at every so many-th call: for pieces of work that take no longer than asking.
class AskNowAndThen {
 public:
  explicit AskNowAndThen(std::uint32_t calls) : calls_(calls), left_(calls) {}
  void operator()() {
    if (--left_ != 0) return;
    left_ = calls_;
    ask_to_go_on();
  }

 private:
  std::uint32_t calls_, left_;
};

/// values.resize(count), in stretches between which it asks: to fill fresh memory takes its time.
template <class Value>
void resize_asking(std::vector<Value>& values, std::size_t count) {
  constexpr std::size_t stretch = (std::size_t{1} << 20) / sizeof(Value);
  values.reserve(count);
  while (values.size() < count) {
    ask_to_go_on();
    values.resize(std::min(count, values.size() + stretch));
  }
}

/// Before so many values are added to a vector that may become very long: a vector that grows copies all that it has.
/// This copies it in stretches between which it asks.
template <class Value>
void make_room(std::vector<Value>& values, std::size_t more = 1) {
  constexpr std::size_t stretch = (std::size_t{1} << 20) / sizeof(Value);
  if (values.capacity() - values.size() >= more || values.size() < stretch) return;
  std::vector<Value> longer;
  longer.reserve(values.size() + std::max(values.size(), more));
  for (auto left = values.begin(); left != values.end();) {
    ask_to_go_on();
    const auto next = left + std::min(values.end() - left, static_cast<std::ptrdiff_t>(stretch));
    longer.insert(longer.end(), left, next);
    left = next;
  }
  values.swap(longer);
}

/// While it lives this thread asks as a helper of the owner of `of`, unless it is the owner itself.
class HelpsOwner {
 public:
  explicit HelpsOwner(Interruption* of) noexcept : joined_(of != asked_now()) {
    if (joined_) before_ = exchange_asked({of, false});
  }
  ~HelpsOwner() {
    if (joined_) exchange_asked(before_);
  }
  HelpsOwner(const HelpsOwner&) = delete;
  HelpsOwner& operator=(const HelpsOwner&) = delete;

 private:
  bool joined_;
  WhomToAsk before_{};
};

/// While it lives this thread asks nobody: for what is noexcept, and for what an exception would leave half done.
class Uninterrupted {
 public:
  Uninterrupted() noexcept : before_(exchange_asked({})) {}
  ~Uninterrupted() { exchange_asked(before_); }
  Uninterrupted(const Uninterrupted&) = delete;
  Uninterrupted& operator=(const Uninterrupted&) = delete;

 private:
  WhomToAsk before_;
};

}  // namespace morula::detail
