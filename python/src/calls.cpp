// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// nanobind answers a call that fits no overload with a list of signatures, and an error that is thrown within a
// function does not say which one it was. Functions of nanobind are called through a pointer in each of them, as all
// that have Python's vectorcall protocol are: here it is exchanged for one that calls the same and looks at errors.
#include "calls.hpp"

#include <Python.h>
#if PY_VERSION_HEX < 0x030C0000
#include <structmember.h>  // PyMemberDef
#endif

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <string>
#include <string_view>

#include "casters.hpp"

namespace morula::python {

namespace {

using Vectorcall = PyObject* (*)(PyObject*, PyObject* const*, std::size_t, PyObject*);

// nanobind has a few ways to call; all functions that one of them calls share a number.
constexpr std::size_t most_ways = 16;
std::array<Vectorcall, most_ways> ways{};

/// The error that is set, in better words where there are some. An error of Python code has a traceback and is not
/// ours.
void reword(nb::handle function, PyObject* const* args, std::size_t count, nb::handle names) {
  nb::python_error error;
  if (!error.matches(PyExc_TypeError) || error.traceback().is_valid()) return error.restore();
  try {
    nb::list given;
    for (std::size_t i = 0; i < count; ++i) given.append(nb::handle(args[i]));
    nb::dict named;
    if (names.is_valid())
      for (std::size_t i = 0; i < nb::len(names); ++i) named[names[i]] = nb::handle(args[count + i]);
    const bool has_content = count == 0 || !nb::inst_check(args[0]) || nb::inst_ready(args[0]);
    const nb::object text = nb::module_::import_("morula._calls")
                                .attr("reworded")(function, given, named, nb::str(error.value()), has_content);
    PyErr_SetObject(PyExc_TypeError, text.ptr());
  } catch (nb::python_error&) {
    error.restore();
  }
}

template <std::size_t Way>
PyObject* call(PyObject* function, PyObject* const* args, std::size_t flagged_count, PyObject* names) {
  PyObject* const result = ways[Way](function, args, flagged_count, names);
  if (!result) {
    // Flags are in the highest bits; nanobind has one of its own.
    constexpr std::size_t count_bits = ~std::size_t{0} >> 8;
    reword(function, args, flagged_count & count_bits, names);
  }
  return result;
}

template <std::size_t... Way>
constexpr std::array<Vectorcall, most_ways> calls_of(std::index_sequence<Way...>) {
  return {&call<Way>...};
}
constexpr std::array<Vectorcall, most_ways> calls = calls_of(std::make_index_sequence<most_ways>());

/// The offset of the pointer in functions of this type.
Py_ssize_t offset_of_vectorcall(PyTypeObject* type) {
  const auto* member = static_cast<const PyMemberDef*>(PyType_GetSlot(type, Py_tp_members));
  for (; member && member->name; ++member)
    if (std::strcmp(member->name, "__vectorcalloffset__") == 0) return member->offset;
  return 0;
}

void exchange(nb::handle function) {
  const Py_ssize_t offset = offset_of_vectorcall(Py_TYPE(function.ptr()));
  if (offset == 0) return;
  auto& pointer = *reinterpret_cast<Vectorcall*>(reinterpret_cast<char*>(function.ptr()) + offset);
  if (std::find(calls.begin(), calls.end(), pointer) != calls.end()) return;  // it has two names
  auto way = std::find(ways.begin(), ways.end(), pointer);
  if (way == ways.end()) way = std::find(ways.begin(), ways.end(), nullptr);
  if (way == ways.end()) return;
  *way = pointer;
  pointer = calls[static_cast<std::size_t>(way - ways.begin())];
}

bool is_function(nb::handle object) {
  const auto type = nb::cast<std::string>(nb::object(object.type().attr("__name__")));
  return type == "nb_func" || type == "nb_method";
}

void exchange_all(nb::handle scope) {
  // That of a class is no dict, but a view of one.
  const nb::object dict = nb::module_::import_("builtins").attr("dict");
  for (auto [name, value] : nb::borrow<nb::dict>(dict(scope.attr("__dict__")))) {
    if (is_function(value)) {
      exchange(value);
    } else if (PyType_Check(value.ptr()) || PyModule_Check(value.ptr())) {
      // Functions of other modules are also named here.
      const auto module_name = nb::cast<std::string>(nb::str(nb::getattr(value, "__module__", nb::str(""))));
      if (PyModule_Check(value.ptr()) || module_name.starts_with("morula.")) exchange_all(value);
    } else {
      for (const char* part : {"fget", "fset"})
        if (nb::hasattr(value, part) && is_function(value.attr(part))) exchange(value.attr(part));
    }
  }
}

/// Python before 3.14 has no name for this slot; nanobind reads it in all versions.
constexpr int slot_of_vectorcall = 82;

void reject_instance(PyObject* kind) noexcept {
  try {
    const nb::object text = nb::module_::import_("morula._calls").attr("rejected")(nb::handle(kind));
    PyErr_SetObject(PyExc_TypeError, text.ptr());
  } catch (nb::python_error& error) {
    error.restore();
  }
}

PyObject* reject_call(PyObject* kind, PyObject* const*, std::size_t, PyObject*) {
  reject_instance(kind);
  return nullptr;
}

PyObject* reject_new(PyTypeObject* type, PyObject*, PyObject*) {
  auto* const kind = reinterpret_cast<PyObject*>(type);
  if (PyObject_HasAttrString(kind, "__setstate__")) return nb::detail::nb_inst_alloc(type);
  reject_instance(kind);
  return nullptr;
}

int reject_init(PyObject* self, PyObject*, PyObject*) {
  reject_instance(reinterpret_cast<PyObject*>(Py_TYPE(self)));
  return -1;
}

}  // namespace

PyType_Slot rejecting_call() {
  return {slot_of_vectorcall, reinterpret_cast<void*>(&reject_call)};
}
PyType_Slot rejecting_new() {
  return {Py_tp_new, reinterpret_cast<void*>(&reject_new)};
}
PyType_Slot rejecting_init() {
  return {Py_tp_init, reinterpret_cast<void*>(&reject_init)};
}

nb::type_slots only_returned() {
  static PyType_Slot slots[]{rejecting_call(), rejecting_new(), rejecting_init(), {0, nullptr}};
  return nb::type_slots(slots);
}

void name_arguments(nb::module_& m) {
  exchange_all(m);
}

}  // namespace morula::python
