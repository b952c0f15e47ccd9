// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/parallel/interrupt.hpp>
#include <stdexcept>
#include <utility>

#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

thread_local ActiveInterruption active;

}  // namespace

ActiveInterruption detail::exchange_active_interruption(const ActiveInterruption& next) noexcept {
  return std::exchange(active, next);
}

Interruption* detail::active_interruption() noexcept {
  return active.interruption;
}

void detail::check_interrupt() {
  if (active.interruption == nullptr) return;
  Interruption& interruption = *active.interruption;
  if (interruption.has_ended.load(std::memory_order_acquire)) std::rethrow_exception(interruption.cause);
  if (!active.is_owner) return;
  // The callback may itself call the library.
  const Uninterrupted alone;
  try {
    interruption.callback();
  } catch (...) {
    interruption.cause = std::current_exception();
    interruption.has_ended.store(true, std::memory_order_release);
    throw;
  }
}

Interrupt::Interrupt(std::function<void()> ask) {
  if (!ask) throw std::invalid_argument("Interrupt: the function is empty");
  state_ = std::make_unique<Interruption>();
  state_->callback = std::move(ask);
  state_->outer = exchange_active_interruption({state_.get(), true});
}

Interrupt::~Interrupt() {
  exchange_active_interruption(state_->outer);
}

}  // namespace morula
