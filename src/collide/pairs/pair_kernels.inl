// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of the pair kernels, on registers of wide.inl.

constexpr std::size_t most_spheres = 64;

struct WideSpheres {
  Wide x, y, z, r;
};

inline Wide absolute(Wide x) {
  return max(x, -x);
}

constexpr std::uint32_t in_order[16]{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

// Spheres [first, first + lanes) of a list, as columns, in order. Spheres from `readable` on are not read.
inline WideSpheres load_spheres(const Spheref* list, std::size_t first, std::size_t readable) {
  alignas(64) float copy[4 * lanes];
  const Spheref* p = list + first;
  if (first + lanes > readable) {
    const std::size_t left = readable - first;
    for (std::size_t i = 0; i < 4 * lanes; ++i) copy[i] = 0;
    __builtin_memcpy(copy, p, 16 * left);
    p = reinterpret_cast<const Spheref*>(copy);
  }
  const Rows rows = gather(reinterpret_cast<const LocalPoint*>(p), in_order);
  const WidePoints centers = columns(rows);
  return {centers.x, centers.y, centers.z, last_column(rows)};
}

template <bool measured>
float test_pairs(const NarrowPair& f, const PairBlock& block, std::uint64_t* masks) {
  // Moves all spheres of b, as many at once as there are lanes.
  alignas(64) float moved_x[most_spheres], moved_y[most_spheres], moved_z[most_spheres], radius[most_spheres];
  for (std::size_t j = 0; j < block.count_b; j += lanes) {
    const WideSpheres b = load_spheres(block.b, j, block.readable_b);
    *reinterpret_cast<Wide*>(moved_x + j) =
        (f.rows[0][0] * b.x + f.rows[0][1] * b.y) + (f.rows[0][2] * b.z + f.translation[0]);
    *reinterpret_cast<Wide*>(moved_y + j) =
        (f.rows[1][0] * b.x + f.rows[1][1] * b.y) + (f.rows[1][2] * b.z + f.translation[1]);
    *reinterpret_cast<Wide*>(moved_z + j) =
        (f.rows[2][0] * b.x + f.rows[2][1] * b.y) + (f.rows[2][2] * b.z + f.translation[2]);
    const Wide size = (absolute(b.x) + absolute(b.y)) + absolute(b.z);
    *reinterpret_cast<Wide*>(radius + j) = b.r * grown_b + (size * center_share + f.pad);
  }

  Wide least = all(infinity);
  for (std::size_t i = 0; i < block.count_a; i += lanes) {
    const WideSpheres a = load_spheres(block.a, i, block.readable_a);
    const Wide grown = a.r * grown_a;
    const std::size_t left = block.count_a - i;
    const std::uint64_t counted = left < lanes ? (std::uint64_t{1} << left) - 1 : (std::uint64_t{1} << lanes) - 1;
    Wide unmeasured{};  // infinity in unused lanes
    if constexpr (measured)
      // mutant pair-kernel-unmeasured: `infinity` -> `0`
      for (std::size_t lane = left; lane < lanes; ++lane) unmeasured[lane] = infinity;
    for (std::size_t j = 0; j < block.count_b; ++j) {
      const Wide dx = a.x - moved_x[j], dy = a.y - moved_y[j], dz = a.z - moved_z[j];
      const Wide squared = (dx * dx + dy * dy) + dz * dz;
      const Wide sum = grown + radius[j];
      const Wide square = sum * sum;
      // mutant pair-kernel-tail: `(lanes_at_most ... ) & counted)` -> `std::uint64_t{lanes_at_most(squared, square)}`
      const std::uint64_t mask = (lanes_at_most(squared, square) & counted) << i;
      masks[j] = i == 0 ? mask : masks[j] | mask;
      if constexpr (measured) {
        const Wide t = squared - square;
        least = min(max(t * (t / ((squared + square) + tiny)), unmeasured), least);
      }
    }
  }
  return least_lane(least);
}

// Half of a register of sixteen would be empty where a node has at most eight children.
inline void test(const NarrowPair& f, const PairBlock& block, std::uint64_t* masks) {
#if MORULA_LANES == 16
  if (block.count_a <= 8) return avx2::test(f, block, masks);
#endif
  test_pairs<false>(f, block, masks);
}
inline float test_and_measure(const NarrowPair& f, const PairBlock& block, std::uint64_t* masks) {
#if MORULA_LANES == 16
  if (block.count_a <= 8) return avx2::test_and_measure(f, block, masks);
#endif
  return test_pairs<true>(f, block, masks);
}

constexpr PairKernels kernels{test, test_and_measure};
