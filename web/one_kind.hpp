// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Included ahead of the kernels of the modules with SIMD128: the rows of their tables name the kernels for vectors alone, so the
// linker leaves out the plain loops, which such a module would never run.
#pragma once

#include "simd/processors.hpp"

#undef MORULA_EVERY_KIND
#define MORULA_EVERY_KIND(name) \
  { baseline::name, baseline::name }
