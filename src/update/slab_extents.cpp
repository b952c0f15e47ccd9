// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/slab_extents.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>

// As in farthest.cpp: wider registers are asked for function by function and chosen at run time.
#if defined(__GNUC__) && defined(__x86_64__) && !defined(MORULA_SCALAR)
#define MORULA_HAS_WIDE_REGISTERS 1
// GCC 12 warns of what its own header leaves undefined on purpose (GCC bug 105593).
#ifndef __clang__
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <immintrin.h>
#ifndef __clang__
#pragma GCC diagnostic pop
#endif
#endif

namespace morula {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

#define MORULA_TARGET
namespace plain {
using Wide = ScalarFloat4;
constexpr std::size_t points_per_register = 1;
inline Wide all(float x) {
  return Wide(x);
}
inline Wide load_run(const LocalPoint* points) {
  return Wide::load(*points);
}
inline Wide load_listed(const LocalPoint* points, const std::uint32_t* index) {
  return Wide::load(points[*index]);
}
inline void points_to_columns(Wide& a, Wide& b, Wide& c, const Wide& d) {
  Wide::transpose_points(a, b, c, d);
}
inline std::array<float, 4> lanes_of(const Wide& wide) {
  return wide.lanes();
}
#include "update/slab_extents.inl"
}  // namespace plain
namespace four {
using Wide = Float4;
constexpr std::size_t points_per_register = 1;
inline Wide all(float x) {
  return Wide(x);
}
inline Wide load_run(const LocalPoint* points) {
  return Wide::load(*points);
}
inline Wide load_listed(const LocalPoint* points, const std::uint32_t* index) {
  return Wide::load(points[*index]);
}
inline void points_to_columns(Wide& a, Wide& b, Wide& c, const Wide& d) {
  Wide::transpose_points(a, b, c, d);
}
inline std::array<float, 4> lanes_of(const Wide& wide) {
  return wide.lanes();
}
#include "update/slab_extents.inl"
}  // namespace four
#undef MORULA_TARGET

#ifdef MORULA_HAS_WIDE_REGISTERS

#define MORULA_TARGET __attribute__((target("avx2")))
namespace avx2 {
using Wide = __m256;
MORULA_TARGET inline Wide all(float x) {
  return _mm256_set1_ps(x);
}
MORULA_TARGET inline Wide load_run(const LocalPoint* points) {
  return _mm256_loadu_ps(&points->x);
}
constexpr std::size_t points_per_register = 2;
MORULA_TARGET inline Wide load_listed(const LocalPoint* points, const std::uint32_t* index) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&points[index[0]].x)),
                              _mm_load_ps(&points[index[4]].x), 1);
}
MORULA_TARGET inline void points_to_columns(Wide& a, Wide& b, Wide& c, Wide d) {
  const Wide xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
  const Wide z_ab = _mm256_unpackhi_ps(a, b), z_cd = _mm256_unpackhi_ps(c, d);
  a = _mm256_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(1, 0, 1, 0));
  b = _mm256_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(3, 2, 3, 2));
  c = _mm256_shuffle_ps(z_ab, z_cd, _MM_SHUFFLE(1, 0, 1, 0));
}
MORULA_TARGET inline std::array<float, 4 * points_per_register> lanes_of(Wide wide) {
  std::array<float, 4 * points_per_register> lanes;
  _mm256_storeu_ps(lanes.data(), wide);
  return lanes;
}
MORULA_TARGET inline Wide min(Wide a, Wide b) {
  return _mm256_min_ps(a, b);
}
MORULA_TARGET inline Wide max(Wide a, Wide b) {
  return _mm256_max_ps(a, b);
}
#include "update/slab_extents.inl"
}  // namespace avx2
#undef MORULA_TARGET

#define MORULA_TARGET __attribute__((target("avx512f")))
namespace avx512 {
using Wide = __m512;
MORULA_TARGET inline Wide all(float x) {
  return _mm512_set1_ps(x);
}
MORULA_TARGET inline Wide load_run(const LocalPoint* points) {
  return _mm512_loadu_ps(&points->x);
}
constexpr std::size_t points_per_register = 4;
MORULA_TARGET inline Wide load_listed(const LocalPoint* points, const std::uint32_t* index) {
  const __m512 one = _mm512_castps128_ps512(_mm_load_ps(&points[index[0]].x));
  const __m512 two = _mm512_insertf32x4(one, _mm_load_ps(&points[index[4]].x), 1);
  const __m512 three = _mm512_insertf32x4(two, _mm_load_ps(&points[index[8]].x), 2);
  return _mm512_insertf32x4(three, _mm_load_ps(&points[index[12]].x), 3);
}
MORULA_TARGET inline void points_to_columns(Wide& a, Wide& b, Wide& c, Wide d) {
  const Wide xy_ab = _mm512_unpacklo_ps(a, b), xy_cd = _mm512_unpacklo_ps(c, d);
  const Wide z_ab = _mm512_unpackhi_ps(a, b), z_cd = _mm512_unpackhi_ps(c, d);
  a = _mm512_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(1, 0, 1, 0));
  b = _mm512_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(3, 2, 3, 2));
  c = _mm512_shuffle_ps(z_ab, z_cd, _MM_SHUFFLE(1, 0, 1, 0));
}
MORULA_TARGET inline std::array<float, 4 * points_per_register> lanes_of(Wide wide) {
  std::array<float, 4 * points_per_register> lanes;
  _mm512_storeu_ps(lanes.data(), wide);
  return lanes;
}
MORULA_TARGET inline Wide min(Wide a, Wide b) {
  return _mm512_min_ps(a, b);
}
MORULA_TARGET inline Wide max(Wide a, Wide b) {
  return _mm512_max_ps(a, b);
}
#include "update/slab_extents.inl"
}  // namespace avx512
#undef MORULA_TARGET

#endif

std::size_t supported_kernels() {
#ifdef MORULA_HAS_WIDE_REGISTERS
  if (!__builtin_cpu_supports("avx2")) return 2;
  return __builtin_cpu_supports("avx512f") ? 4 : 3;
#else
  return 2;
#endif
}

template <int k>
std::span<const SlabKernel> kernels_of() {
  static constexpr SlabKernel kernels[]{
      plain::slab_extents<k>,
      four::slab_extents<k>,
#ifdef MORULA_HAS_WIDE_REGISTERS
      avx2::slab_extents<k>,
      avx512::slab_extents<k>,
#endif
  };
  return std::span(kernels).first(supported_kernels());
}

}  // namespace

std::span<const SlabKernel> slab_kernels(int k) {
  switch (k) {
    case 6:
      return kernels_of<6>();
    case 14:
      return kernels_of<14>();
    case 18:
      return kernels_of<18>();
    default:
      assert(k == 26);
      return kernels_of<26>();
  }
}

}  // namespace morula
