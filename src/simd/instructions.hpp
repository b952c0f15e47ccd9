// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The vector instructions that this compiler supports. MORULA_SCALAR turns them off: everything then runs in plain
// loops.
//
//   MORULA_VECTORS   vector types of GCC and Clang: registers of four floats (SSE2, NEON, SIMD128 of WebAssembly), in
//                    float4.hpp and wide.inl
//   MORULA_DISPATCH  wider registers than the compiler may assume, asked for region by region in every_processor.inl
#pragma once

#if defined(__GNUC__) && !defined(MORULA_SCALAR) && (!defined(__wasm__) || defined(__wasm_simd128__))
#define MORULA_VECTORS 1
#if defined(__x86_64__)
#define MORULA_DISPATCH 1
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#endif
#endif
