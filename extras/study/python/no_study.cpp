// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The study needs the command, whose options a plan is made of.
#include "module.hpp"

namespace morula::python {

void bind_study_extra(nanobind::module_&) {}

}  // namespace morula::python
