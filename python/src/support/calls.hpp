// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a TypeError says of a call of the module.
#pragma once

#include <nanobind/nanobind.h>

namespace morula::python {

/// From now on a TypeError of a function or method of the module and its submodules names the function and the
/// argument, in words of morula._calls. To be called once all are bound.
void name_arguments(nanobind::module_& m);

}  // namespace morula::python
