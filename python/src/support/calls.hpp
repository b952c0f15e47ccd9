// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Messages of TypeErrors for calls of the module.
#pragma once

#include <nanobind/nanobind.h>

namespace morula::python {

/// For nb::class_ of objects that only functions make: a call of the class is a TypeError that names the functions.
/// Instances of classes that have __setstate__ are unpickled all the same.
nanobind::type_slots only_returned();
/// The same in parts, for a class that has more slots.
PyType_Slot rejecting_call();
PyType_Slot rejecting_new();
PyType_Slot rejecting_init();

/// Makes TypeErrors of functions and methods of the module and its submodules name the function and the argument, by
/// morula._calls. To be called once, after all are bound.
void name_arguments(nanobind::module_& m);

}  // namespace morula::python
