// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whether calls of this thread are to go on: what loops and searches ask between two pieces of work.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>

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
