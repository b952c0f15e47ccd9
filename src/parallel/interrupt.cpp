// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/parallel/interrupt.hpp>
#include <stdexcept>
#include <utility>

#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

thread_local WhomToAsk asked;

}  // namespace

WhomToAsk detail::exchange_asked(const WhomToAsk& next) noexcept {
  return std::exchange(asked, next);
}

Interruption* detail::asked_now() noexcept {
  return asked.whom;
}

void detail::ask_to_go_on() {
  if (asked.whom == nullptr) return;
  Interruption& whom = *asked.whom;
  if (whom.has_ended.load(std::memory_order_acquire)) std::rethrow_exception(whom.cause);
  if (!asked.is_owner) return;
  // The callback may itself call the library.
  const Uninterrupted alone;
  try {
    whom.ask();
  } catch (...) {
    whom.cause = std::current_exception();
    whom.has_ended.store(true, std::memory_order_release);
    throw;
  }
}

Interrupt::Interrupt(std::function<void()> ask) {
  if (!ask) throw std::invalid_argument("Interrupt: the function is empty");
  state_ = std::make_unique<Interruption>();
  state_->ask = std::move(ask);
  state_->outer = exchange_asked({state_.get(), true});
}

Interrupt::~Interrupt() {
  exchange_asked(state_->outer);
}

}  // namespace morula
