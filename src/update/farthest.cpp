// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/farthest.hpp"

// Wider registers than the compiler may assume are asked for function by function and chosen at run time. Nothing else
// is compiled for them: an inline function of a header that was could end up in the program for all processors.
#if defined(__GNUC__) && defined(__x86_64__) && !defined(MORULA_SCALAR)
#define MORULA_HAS_AVX2 1
#include <immintrin.h>
#endif

namespace morula {
namespace {

#ifdef MORULA_HAS_AVX2

#define MORULA_AVX2 __attribute__((target("avx2")))

// Points i and j in the two halves of a register.
MORULA_AVX2 inline __m256 load_two(const LocalPoint& i, const LocalPoint& j) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&i.x)), _mm_load_ps(&j.x), 1);
}

template <std::size_t count>
MORULA_AVX2 void farthest_of_few_avx2(const LocalPoint* points, std::span<const std::uint32_t> index,
                                      const Vec3f* centers, float* squared) {
  __m256 x[count], y[count], z[count], farthest[count];
  for (std::size_t k = 0; k < count; ++k) {
    x[k] = _mm256_set1_ps(centers[k].x);
    y[k] = _mm256_set1_ps(centers[k].y);
    z[k] = _mm256_set1_ps(centers[k].z);
    farthest[k] = _mm256_setzero_ps();
  }
  const std::uint32_t* const end = index.data() + index.size();
  for (const std::uint32_t* i = index.data(); i != end; i += 8) {
    const __m256 a = load_two(points[i[0]], points[i[4]]), b = load_two(points[i[1]], points[i[5]]);
    const __m256 c = load_two(points[i[2]], points[i[6]]), d = load_two(points[i[3]], points[i[7]]);
    // Rows become columns; which lane a point ends in does not matter to a maximum.
    const __m256 xy_ab = _mm256_unpacklo_ps(a, b), xy_cd = _mm256_unpacklo_ps(c, d);
    const __m256 z_ab = _mm256_unpackhi_ps(a, b), z_cd = _mm256_unpackhi_ps(c, d);
    const __m256 px = _mm256_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(1, 0, 1, 0));
    const __m256 py = _mm256_shuffle_ps(xy_ab, xy_cd, _MM_SHUFFLE(3, 2, 3, 2));
    const __m256 pz = _mm256_shuffle_ps(z_ab, z_cd, _MM_SHUFFLE(1, 0, 1, 0));
    for (std::size_t k = 0; k < count; ++k) {
      const __m256 dx = _mm256_sub_ps(px, x[k]), dy = _mm256_sub_ps(py, y[k]), dz = _mm256_sub_ps(pz, z[k]);
      const __m256 squares =
          _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(dx, dx), _mm256_mul_ps(dy, dy)), _mm256_mul_ps(dz, dz));
      farthest[k] = _mm256_max_ps(squares, farthest[k]);
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    alignas(32) float lanes[8];
    _mm256_store_ps(lanes, farthest[k]);
    squared[k] = lanes[0];
    for (const float lane : lanes) squared[k] = lane > squared[k] ? lane : squared[k];
  }
}

void farthest_avx2(const LocalPoint* points, std::span<const std::uint32_t> index, std::span<const Vec3f> centers,
                   float* squared) {
  switch (centers.size()) {
    case 4:
      return farthest_of_few_avx2<4>(points, index, centers.data(), squared);
    case 3:
      return farthest_of_few_avx2<3>(points, index, centers.data(), squared);
    case 2:
      return farthest_of_few_avx2<2>(points, index, centers.data(), squared);
    case 1:
      return farthest_of_few_avx2<1>(points, index, centers.data(), squared);
    default:
      return;
  }
}

#endif

}  // namespace

std::span<const FarthestKernel> farthest_kernels() {
  static constexpr FarthestKernel kernels[]{
      farthest<ScalarFloat4>,
      farthest<Float4>,
#ifdef MORULA_HAS_AVX2
      farthest_avx2,
#endif
  };
#ifdef MORULA_HAS_AVX2
  if (!__builtin_cpu_supports("avx2")) return std::span(kernels).first(2);
#endif
  return kernels;
}

}  // namespace morula
