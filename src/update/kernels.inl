// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of all kernels. Included by kernels.cpp once per kind of processor, in a namespace of its own and under
// its instructions; MORULA_LANES floats fill a register. Everything that these loops call is defined here: an inline
// function of a header would be compiled for one kind and could end up in the program for all.

constexpr int lanes = MORULA_LANES;
typedef float Wide __attribute__((vector_size(4 * lanes)));
typedef float LooseWide __attribute__((vector_size(4 * lanes), aligned(4), may_alias));
typedef float Four __attribute__((vector_size(16), may_alias));

inline Wide all(float x) {
  return x - Wide{};
}
inline Wide larger(Wide a, Wide b) {
  return a > b ? a : b;
}
inline Four load_point(const LocalPoint& p) {
  return *reinterpret_cast<const Four*>(&p);
}

// Points i, i + 4, i + 8 … of a list, one after the other.
inline Wide every_fourth(const LocalPoint* points, const std::uint32_t* index) {
#if MORULA_LANES == 4
  return load_point(points[index[0]]);
#else
  typedef float Eight __attribute__((vector_size(32)));
  const Four a = load_point(points[index[0]]), b = load_point(points[index[4]]);
  const Eight ab = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#if MORULA_LANES == 8
  return ab;
#else
  const Four c = load_point(points[index[8]]), d = load_point(points[index[12]]);
  const Eight cd = __builtin_shufflevector(c, d, 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}

struct WidePoints {
  Wide x, y, z;
};

// Within each quarter of a register: four points' rows become columns.
#if MORULA_LANES == 4
#define MORULA_PICK(a, b, i, j, k, l) __builtin_shufflevector(a, b, i, j, (k) + 4, (l) + 4)
#elif MORULA_LANES == 8
#define MORULA_PICK(a, b, i, j, k, l) \
  __builtin_shufflevector(a, b, i, j, (k) + 8, (l) + 8, (i) + 4, (j) + 4, (k) + 12, (l) + 12)
#else
#define MORULA_PICK(a, b, i, j, k, l)                                                                            \
  __builtin_shufflevector(a, b, i, j, (k) + 16, (l) + 16, (i) + 4, (j) + 4, (k) + 20, (l) + 20, (i) + 8, (j) + 8, \
                          (k) + 24, (l) + 24, (i) + 12, (j) + 12, (k) + 28, (l) + 28)
#endif
inline WidePoints columns(Wide a, Wide b, Wide c, Wide d) {
  // x and y of a and b in turn, then of c and d.
#if MORULA_LANES == 4
  const Wide ab = __builtin_shufflevector(a, b, 0, 4, 1, 5), cd = __builtin_shufflevector(c, d, 0, 4, 1, 5);
#elif MORULA_LANES == 8
  const Wide ab = __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13);
  const Wide cd = __builtin_shufflevector(c, d, 0, 8, 1, 9, 4, 12, 5, 13);
#else
  const Wide ab = __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
  const Wide cd = __builtin_shufflevector(c, d, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
#endif
  const Wide z_ab = MORULA_PICK(a, b, 2, 3, 2, 3), z_cd = MORULA_PICK(c, d, 2, 3, 2, 3);
  return {MORULA_PICK(ab, cd, 0, 1, 0, 1), MORULA_PICK(ab, cd, 2, 3, 2, 3), MORULA_PICK(z_ab, z_cd, 0, 2, 0, 2)};
}
#undef MORULA_PICK

// As many points as there are lanes, in the order of the list.
inline WidePoints gather(const LocalPoint* points, const std::uint32_t* index) {
  return columns(every_fourth(points, index), every_fourth(points, index + 1), every_fourth(points, index + 2),
                 every_fourth(points, index + 3));
}

// Points that lie one after the other, in any order.
inline WidePoints load_run(const LocalPoint* points) {
  const LooseWide* rows = reinterpret_cast<const LooseWide*>(points);
  return columns(rows[0], rows[1], rows[2], rows[3]);
}

inline Wide squared_distance(const WidePoints& p, Wide x, Wide y, Wide z) {
  const Wide dx = p.x - x, dy = p.y - y, dz = p.z - z;
  return dx * dx + dy * dy + dz * dz;
}

inline float largest_lane(Wide wide) {
#if MORULA_LANES == 16
  wide = larger(wide, __builtin_shufflevector(wide, wide, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1, 6, 7, 4, 5, 10, 11, 8, 9, 14, 15, 12, 13));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2, 5, 4, 7, 6, 9, 8, 11, 10, 13, 12, 15, 14));
#elif MORULA_LANES == 8
  wide = larger(wide, __builtin_shufflevector(wide, wide, 4, 5, 6, 7, 0, 1, 2, 3));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1, 6, 7, 4, 5));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2, 5, 4, 7, 6));
#else
  wide = larger(wide, __builtin_shufflevector(wide, wide, 2, 3, 0, 1));
  wide = larger(wide, __builtin_shufflevector(wide, wide, 1, 0, 3, 2));
#endif
  return wide[0];
}

template <int count>
struct Centers {
  Wide x[count], y[count], z[count];
};
template <int count>
[[gnu::always_inline]] inline void measure(const WidePoints& p, const Centers<count>& c, Wide (&farthest)[count]) {
  for (int k = 0; k < count; ++k) farthest[k] = larger(squared_distance(p, c.x[k], c.y[k], c.z[k]), farthest[k]);
}

template <int count>
void farthest_of_few(const LocalPoint* points, const PointRun* run, const PointRun* runs_end,
                     const std::uint32_t* index, const std::uint32_t* index_end, const Vec3f* centers,
                     float* squared) {
  Centers<count> c;
  Wide farthest[count];
  for (int k = 0; k < count; ++k) {
    c.x[k] = all(centers[k].x), c.y[k] = all(centers[k].y), c.z[k] = all(centers[k].z);
    farthest[k] = Wide{};
  }
  for (; run != runs_end; ++run)
    for (std::uint32_t i = run->begin; i != run->end; i += lanes) measure(load_run(points + i), c, farthest);
  for (; index != index_end; index += lanes) measure(gather(points, index), c, farthest);
  for (int k = 0; k < count; ++k) squared[k] = largest_lane(farthest[k]);
}

void farthest(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
              std::span<const Vec3f> centers, float* squared) {
  const PointRun *run = runs.data(), *runs_end = run + runs.size();
  const std::uint32_t *i = index.data(), *index_end = i + index.size();
  switch (centers.size()) {
    case 4:
      return farthest_of_few<4>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 3:
      return farthest_of_few<3>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 2:
      return farthest_of_few<2>(points, run, runs_end, i, index_end, centers.data(), squared);
    case 1:
      return farthest_of_few<1>(points, run, runs_end, i, index_end, centers.data(), squared);
    default:
      return;
  }
}

// One bit for each lane that is equal to x.
inline unsigned lanes_equal(Wide a, float x) {
#if MORULA_LANES == 16
  return _mm512_cmp_ps_mask(a, all(x), _CMP_EQ_OQ);
#elif MORULA_LANES == 8
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, all(x), _CMP_EQ_OQ)));
#elif defined(__SSE2__)
  return static_cast<unsigned>(_mm_movemask_ps(_mm_cmpeq_ps(a, all(x))));
#else
  unsigned bits = 0;
  for (int k = 0; k < lanes; ++k) bits |= static_cast<unsigned>(a[k] == x) << k;
  return bits;
#endif
}

Vec3f pull(const LocalPoint* points, const Pull& pull, const Vec3f& center) {
  constexpr int packs = static_cast<int>(core_size) / lanes;
  WidePoints core[packs];
  for (int k = 0; k < packs; ++k) core[k] = gather(points, pull.core + k * lanes);

  float cx = center.x, cy = center.y, cz = center.z;
  Vec3f best = center;
  float least = 0;
  for (int step = 0;; ++step) {
    const Wide x = all(cx), y = all(cy), z = all(cz);
    Wide distances[packs];
    Wide farthest{};
    for (int k = 0; k < packs; ++k) {
      distances[k] = squared_distance(core[k], x, y, z);
      farthest = larger(distances[k], farthest);
    }
    const float squared = largest_lane(farthest);
    if (step == 0 || squared < least) least = squared, best = {cx, cy, cz};
    if (squared <= pull.enough || step == pull_steps) return best;
    // The first in the list among equals, on every processor.
    unsigned equal = 0;
    for (int k = 0; k < packs; ++k) equal |= lanes_equal(distances[k], squared) << (k * lanes);
    const LocalPoint& far = points[pull.core[__builtin_ctz(equal)]];
    const float distance = __builtin_sqrtf(squared);
    const float along = 0.15f * distance / static_cast<float>(step + 1);
    const float excess = 0.8f * (__builtin_sqrtf(least) - pull.rest_radius);
    const float share = (along < excess ? along : excess) / distance;
    cx += share * (far.x - cx), cy += share * (far.y - cy), cz += share * (far.z - cz);
  }
}

std::uint32_t narrow_floats(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out) {
  typedef std::int32_t WideInt __attribute__((vector_size(4 * lanes)));
  constexpr std::size_t at_once = lanes / 4;
  const Four one{origin.x, origin.y, origin.z, 0};
#if MORULA_LANES == 16
  const Wide at = __builtin_shufflevector(one, one, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3);
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 16, 3, 4, 5, 16, 6, 7, 8, 16, 9, 10, 11, 16)
#elif MORULA_LANES == 8
  const Wide at = __builtin_shufflevector(one, one, 0, 1, 2, 3, 0, 1, 2, 3);
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 8, 3, 4, 5, 8)
#else
  const Wide at = one;
#define MORULA_SPREAD(v) __builtin_shufflevector(v, Wide{}, 0, 1, 2, 4)
#endif
  const WideInt without_sign = WideInt{} + 0x7fffffff;
  WideInt most{};
  // A load reads beyond its points: at_once floats, so not in front of the last of them.
  std::size_t i = 0;
  for (; i + 2 * at_once <= count; i += at_once) {
    const Wide loaded = *reinterpret_cast<const LooseWide*>(packed + 3 * i);
    const Wide p = MORULA_SPREAD(loaded) - at;
    *reinterpret_cast<LooseWide*>(out + i) = p;
    const WideInt magnitude = __builtin_bit_cast(WideInt, p) & without_sign;
    most = magnitude > most ? magnitude : most;
  }
#undef MORULA_SPREAD
  std::int32_t largest = 0;
  for (int k = 0; k < lanes; ++k) largest = most[k] > largest ? most[k] : largest;
  for (; i < count; ++i) {
    const Four p = Four{packed[3 * i], packed[3 * i + 1], packed[3 * i + 2], 0} - one;
    *reinterpret_cast<Four*>(out + i) = p;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t magnitude = __builtin_bit_cast(std::int32_t, p[k]) & 0x7fffffff;
      largest = magnitude > largest ? magnitude : largest;
    }
  }
  return static_cast<std::uint32_t>(largest);
}
