// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the update's kernels, on registers of wide.inl.

inline Wide squared_distance(const WidePoints& p, Wide x, Wide y, Wide z) {
  const Wide dx = p.x - x, dy = p.y - y, dz = p.z - z;
  return dx * dx + dy * dy + dz * dz;
}

template <int count>
struct Centers {
  Wide x[count], y[count], z[count];
};
template <int count>
[[gnu::always_inline]] inline void measure(const WidePoints& p, const Centers<count>& c, Wide (&farthest)[count]) {
  for (int k = 0; k < count; ++k) farthest[k] = max(squared_distance(p, c.x[k], c.y[k], c.z[k]), farthest[k]);
}

template <int count>
void farthest_of_few(const LocalPoint* points, const PointRun* run, const PointRun* runs_end,
                     const std::uint32_t* index, const std::uint32_t* index_end, const Vec3f* centers, float* squared) {
  Centers<count> c;
  Wide farthest[count];
  for (int k = 0; k < count; ++k) {
    c.x[k] = all(centers[k].x), c.y[k] = all(centers[k].y), c.z[k] = all(centers[k].z);
    farthest[k] = Wide{};
  }
  for (; run != runs_end; ++run)
    for (std::uint32_t i = run->begin; i != run->end; i += lanes) measure(columns(load_run(points + i)), c, farthest);
  for (; index != index_end; index += lanes) measure(columns(gather(points, index)), c, farthest);
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

Vec3f pull(const LocalPoint* points, const Pull& pull, const Vec3f& center) {
  constexpr int packs = static_cast<int>(core_size) / lanes;
  WidePoints core[packs];
  for (int k = 0; k < packs; ++k) core[k] = columns(gather(points, pull.core + k * lanes));

  float cx = center.x, cy = center.y, cz = center.z;
  Vec3f best = center;
  float least = 0;
  for (int step = 0;; ++step) {
    const Wide x = all(cx), y = all(cy), z = all(cz);
    Wide distances[packs];
    Wide farthest{};
    for (int k = 0; k < packs; ++k) {
      distances[k] = squared_distance(core[k], x, y, z);
      farthest = max(distances[k], farthest);
    }
    const float squared = largest_lane(farthest);
    if (step == 0 || squared < least) least = squared, best = {cx, cy, cz};
    if (squared <= pull.enough || step == pull_steps) return best;
    // The first in the list among equals, on every processor.
    unsigned equal = 0;
    for (int k = 0; k < packs; ++k) equal |= lanes_equal(distances[k], all(squared)) << (k * lanes);
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

constexpr Kernels kernels{farthest, pull, narrow_floats};
