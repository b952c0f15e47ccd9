// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// One call of an object that serves many calls. It completes, or is rejected, or resets the object, if an exception
// ends it or a callback moves the data that it reads.
//
// Functions that an object calls may throw (filters, clocks, fields, executors, Interrupt, failed allocations) and may
// call the same object. So every public call that changes an object is an ObjectCall: a second one within it is
// rejected, and an exception that leaves it makes the object discard all results and unfinished work. A callback that
// moves a body or a surface that the call reads has the same effect: results that mix two frames are valid for none.
#pragma once

#include <exception>
#include <morula/geometry/status.hpp>
#include <stdexcept>

namespace morula::detail {

struct CallState {
  bool is_running = false;
  Status ended{};  // reason why the last call left no results; ok if it left results
};

/// Throws std::invalid_argument within a call of the object: for functions that return no status.
inline void require_idle(const CallState& state) {
  if (state.is_running) throw std::invalid_argument(message(Status{.code = Status::Code::in_use}));
}

enum class CallKind {
  begins,   ///< starts again, regardless of earlier calls
  goes_on,  ///< continues at the end of an earlier call
};

/// Object: has `CallState call` and `forget() noexcept`, which leaves neither a result nor unfinished work.
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

  /// ok, or the reason why the call is rejected: then it may do no work.
  const Status& status() const { return status_; }
  /// Ends every call that was not rejected. status: ok, a rejection, which has changed nothing, or changed_during_call.
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
