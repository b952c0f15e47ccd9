// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Includes MORULA_KERNELS, a file, once per kind of processor: in a namespace of its own and under its instructions.
// Everything that the loops of that file call is defined in it or in wide.inl: an inline function of a header would be
// compiled for one kind and could be linked into the program for all. Include it in namespace morula or in one inside
// it, after processors.hpp and float4.hpp, and after namespace plain, which has the plain loops whose results the
// others have to reproduce. A KernelTable is then filled by MORULA_EVERY_KIND(name).

#ifdef MORULA_VECTORS
namespace baseline {
#define MORULA_LANES 4
#include "simd/wide.inl"
#include MORULA_KERNELS
#undef MORULA_LANES
}  // namespace baseline
#endif

#ifdef MORULA_DISPATCH

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
namespace avx2 {
#define MORULA_LANES 8
#include "simd/wide.inl"
#include MORULA_KERNELS
#undef MORULA_LANES
}  // namespace avx2

#ifdef __clang__
#pragma clang attribute pop
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,avx512bw"))), apply_to = function)
#else
#pragma GCC pop_options
#pragma GCC push_options
#pragma GCC target("avx512f,avx512dq,avx512vl,avx512bw,prefer-vector-width=512")
#endif
namespace avx512 {
#define MORULA_LANES 16
#include "simd/wide.inl"
#include MORULA_KERNELS
#undef MORULA_LANES
}  // namespace avx512

#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#endif
