// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// References of holders to Python objects, for the collector of reference cycles. The collector counts references, so a
// holder reports each object once for each reference that it owns, and nothing that it shares with another holder.
//
// Arrays are not among them: nanobind owns their references. A cycle through an attribute of an array stays.
#pragma once

#include <atomic>
#include <memory>
#include <type_traits>

#include "calls.hpp"
#include "casters.hpp"

namespace morula::python {

/// Reports the references of one holder.
class References {
 public:
  References(visitproc visit, void* arg) : visit_(visit), arg_(arg) {}
  void operator()(nb::handle object) {
    if (result_ == 0 && object.is_valid()) result_ = visit_(object.ptr(), arg_);
  }
  /// Reports the Python object of a pointer that was made from one; nothing for a pointer that the library made.
  template <class T>
  void operator()(const std::shared_ptr<T>& pointer) {
    if (const auto* owner = std::get_deleter<nb::detail::py_deleter>(pointer)) operator()(nb::handle(owner->o));
  }
  int result() const { return result_; }

 private:
  visitproc visit_;
  void* arg_;
  int result_ = 0;
};

/// A pointer to the same with a reference of its own, so that two holders can both report theirs.
template <class T>
std::shared_ptr<T> again(const std::shared_ptr<T>& pointer) {
  const auto* owner = std::get_deleter<nb::detail::py_deleter>(pointer);
  return owner ? nb::cast<std::shared_ptr<std::remove_const_t<T>>>(nb::handle(owner->o)) : pointer;
}

/// The base of holders that exchange their references without the GIL. The collector reads references
/// twice and needs them unchanged in between, so a holder reports none while a call runs: its references then
/// stay alive.
class Exchanging {
 public:
  bool is_idle() const { return calls_.load() == 0; }

  /// Made and destroyed with the GIL.
  class Call {
   public:
    explicit Call(const Exchanging& holder) : calls_(holder.calls_) { ++calls_; }
    ~Call() { --calls_; }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;

   private:
    std::atomic<int>& calls_;
  };

 private:
  mutable std::atomic<int> calls_{0};
};

/// A holder has visit(References&), which reports what it keeps. One that can be given a function of Python's when it
/// is made or later also has forget(), which drops it: nothing else may break a cycle.
template <class Holder>
int traverse_holder(PyObject* self, visitproc visit, void* arg) {
  Py_VISIT(Py_TYPE(self));
  if (!nb::inst_ready(self)) return 0;
  const Holder& holder = *nb::inst_ptr<Holder>(self);
  if constexpr (std::is_base_of_v<Exchanging, Holder>)
    if (!holder.is_idle()) return 0;
  References references(visit, arg);
  holder.visit(references);
  return references.result();
}

template <class Holder>
int clear_holder(PyObject* self) {
  if constexpr (requires(Holder & holder) { holder.forget(); })
    if (nb::inst_ready(self)) nb::inst_ptr<Holder>(self)->forget();
  return 0;
}

/// For nb::class_: the collector's part of a holder's type.
template <class Holder>
nb::type_slots collected() {
  static PyType_Slot slots[]{{Py_tp_traverse, reinterpret_cast<void*>(&traverse_holder<Holder>)},
                             {Py_tp_clear, reinterpret_cast<void*>(&clear_holder<Holder>)},
                             {0, nullptr}};
  return nb::type_slots(slots);
}

/// The same of a holder that only functions make.
template <class Holder>
nb::type_slots collected_and_only_returned() {
  static PyType_Slot slots[]{{Py_tp_traverse, reinterpret_cast<void*>(&traverse_holder<Holder>)},
                             {Py_tp_clear, reinterpret_cast<void*>(&clear_holder<Holder>)},
                             rejecting_call(),
                             rejecting_new(),
                             rejecting_init(),
                             {0, nullptr}};
  return nb::type_slots(slots);
}

}  // namespace morula::python
