// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One call of an object that is asked again and again: whole, refused, or, where an exception ends it or a callback
// moves what it reads, as if the object were new.
//
// What an object calls may throw (filters, clocks, fields, executors, Interrupt, memory that is not there) and may call
// the same object. So every public call that changes an object is an ObjectCall: a second one within it is refused, and
// an exception that leaves it makes the object forget what it had found and begun. So does a callback that moves a body
// or a surface that the call reads: results of two frames are results of none.
#pragma once

#include <exception>
#include <morula/geometry/status.hpp>
#include <stdexcept>

namespace morula::detail {

struct CallState {
  bool is_running = false;
  Status ended{};  // reason for which the last call left no results; ok where it left some
};

/// Throws std::invalid_argument within a call of the object: for functions that return no status.
inline void require_idle(const CallState& state) {
  if (state.is_running) throw std::invalid_argument(message(Status{.code = Status::Code::in_use}));
}

enum class CallKind {
  begins,   ///< anew: whatever was before is of no account
  goes_on,  ///< from where an earlier call ended
};

/// Object: has `CallState call` and `forget() noexcept`, which leaves no result, and nothing to go on from.
template <class Object>
class ObjectCall {
 public:
  ObjectCall(Object& object, CallKind kind)
      : object_(object), status_(status_of(object.call, kind)), exceptions_(std::uncaught_exceptions()) {
    if (status_) object_.call.is_running = true;
  }
  ~ObjectCall() {
    if (!status_) return;
    object_.call.is_running = false;
    if (std::uncaught_exceptions() <= exceptions_) return;
    end({.code = Status::Code::ended_by_exception});
  }
  ObjectCall(const ObjectCall&) = delete;
  ObjectCall& operator=(const ObjectCall&) = delete;

  /// ok, or why the call is refused: nothing may be done then.
  const Status& status() const { return status_; }
  /// Every call that was not refused ends with it. status: ok, a refusal, which has changed nothing, or
  /// changed_during_call.
  void finish(const Status& status) {
    if (status) object_.call.ended = {};
    // mutant call-changed: `if (status.code == Status::Code::changed_during_call) end(status)` -> ``
    if (status.code == Status::Code::changed_during_call) end(status);
  }

 private:
  void end(const Status& why) {
    // mutant call-ended: `object_.call.ended = why` -> ``
    object_.call.ended = why;
    // mutant call-forgets: `object_.forget()` -> ``
    object_.forget();
  }
  static Status status_of(const CallState& state, CallKind kind) {
    // mutant call-within-call: `if (state.is_running) return {.code = Status::Code::in_use}` -> ``
    if (state.is_running) return {.code = Status::Code::in_use};
    return kind == CallKind::goes_on ? state.ended : Status{};
  }

  Object& object_;
  Status status_;
  int exceptions_;
};

}  // namespace morula::detail
