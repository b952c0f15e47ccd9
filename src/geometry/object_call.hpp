// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One call of an object that is asked again and again: whole, refused, or, where an exception ends it, as if the object
// were new.
//
// What an object calls may throw (filters, clocks, fields, executors, Interrupt, memory that is not there) and may call
// the same object. So every public call that changes an object is an ObjectCall: a second one within it is refused, and
// an exception that leaves it makes the object forget what it had found and begun.
#pragma once

#include <exception>
#include <morula/geometry/status.hpp>
#include <stdexcept>

namespace morula::detail {

struct CallState {
  bool is_running = false;
  bool ended_by_exception = false;  // the last call did, and none has begun anew since
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
    object_.call.ended_by_exception = true;
    object_.forget();
  }
  ObjectCall(const ObjectCall&) = delete;
  ObjectCall& operator=(const ObjectCall&) = delete;

  /// ok, or why the call is refused: nothing may be done then.
  const Status& status() const { return status_; }
  /// The call was not refused, and what was before is gone.
  void begun() { object_.call.ended_by_exception = false; }

 private:
  static Status status_of(const CallState& state, CallKind kind) {
    if (state.is_running) return {.code = Status::Code::in_use};
    if (kind == CallKind::goes_on && state.ended_by_exception) return {.code = Status::Code::ended_by_exception};
    return {};
  }

  Object& object_;
  Status status_;
  int exceptions_;
};

}  // namespace morula::detail
