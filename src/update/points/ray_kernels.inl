// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The source of ray_kernels.cpp: each of a block's samples has a lane, and so has each of the spheres in a step.

constexpr int registers = static_cast<int>(block_size) / lanes;
static_assert(block_size == spheres_step);

// One of the block's columns.
inline Wide part_of(const SampleBlock::Lanes& column, int q) {
  return load(reinterpret_cast<const float*>(&column) + q * lanes);
}
inline Wide is_positive(Wide value) {
  return min(max(value * all(much), Wide{}), all(1));
}

inline unsigned touching(const RaySpheres& spheres, std::size_t begin, Wide cx, Wide cy, Wide cz, Wide radius) {
  unsigned bits = 0;
  for (int q = 0; q < registers; ++q) {
    const std::size_t at = begin + static_cast<std::size_t>(q * lanes);
    const Wide x = load(spheres.x + at) - cx, y = load(spheres.y + at) - cy, z = load(spheres.z + at) - cz;
    const Wide reach = load(spheres.radius + at) + radius;
    bits |= lanes_at_most(x * x + y * y + z * z, reach * reach) << (q * lanes);
  }
  return bits;
}

void raise(const SampleBlock& block, const Spheref& places, const RaySpheres& spheres, float side, float* heights) {
  const Wide cx = all(places.center.x), cy = all(places.center.y), cz = all(places.center.z);
  const Wide radius = all(places.radius), none{};
  Wide height[registers];
  for (int q = 0; q < registers; ++q) height[q] = load(heights + q * lanes);
  for (std::size_t begin = 0; begin < spheres.count; begin += spheres_step) {
    for (unsigned bits = touching(spheres, begin, cx, cy, cz, radius); bits != 0; bits &= bits - 1) {
      const std::size_t i = begin + static_cast<unsigned>(__builtin_ctz(bits));
      const Wide sx = all(spheres.x[i]), sy = all(spheres.y[i]), sz = all(spheres.z[i]);
      const Wide square = all(spheres.radius[i] * spheres.radius[i]);
      for (int q = 0; q < registers; ++q) {
        const Wide x = part_of(block.x, q) - sx, y = part_of(block.y, q) - sy, z = part_of(block.z, q) - sz;
        const Wide along = side * (x * part_of(block.dx, q) + y * part_of(block.dy, q) + z * part_of(block.dz, q));
        const Wide depth = max(square - (x * x + y * y + z * z), none);
        height[q] = max(height[q], (root(along * along + depth) - along) * is_positive(depth));
      }
    }
  }
  for (int q = 0; q < registers; ++q) store(height[q], heights + q * lanes);
}

inline float largest_of(const Wide (&wide)[registers], float largest) {
  Wide most = wide[0];
  for (int q = 1; q < registers; ++q) most = max(wide[q], most);
  for (int k = 0; k < lanes; ++k) largest = most[k] > largest ? most[k] : largest;
  return largest;
}

float nearness(const FacingRay& ray, const FacingBlocks& facing) {
  const float from[3]{ray.from.x, ray.from.y, ray.from.z};
  const float direction[3]{ray.direction.x, ray.direction.y, ray.direction.z};
  const Wide px = all(from[0]), py = all(from[1]), pz = all(from[2]);
  const Wide dx = all(direction[0]), dy = all(direction[1]), dz = all(direction[2]);
  const Wide twice = all(2 * ray.side), tiny = all(1 / much);
  float middle = ray.side * ray.length, radius = ray.length, found = 0;
  Wide nearest[registers]{};
  for (std::size_t begin = 0; begin < facing.places.count; begin += spheres_step) {
    unsigned bits = touching(facing.places, begin, all(from[0] + direction[0] * middle),
                             all(from[1] + direction[1] * middle), all(from[2] + direction[2] * middle), all(radius));
    if (bits == 0) continue;
    for (; bits != 0; bits &= bits - 1) {
      const SampleBlock& block = facing.blocks[facing.number[begin + static_cast<unsigned>(__builtin_ctz(bits))]];
      for (int q = 0; q < registers; ++q) {
        const Wide x = part_of(block.x, q) - px, y = part_of(block.y, q) - py, z = part_of(block.z, q) - pz;
        const Wide along = x * dx + y * dy + z * dz;
        const Wide cosine = part_of(block.dx, q) * dx + part_of(block.dy, q) * dy + part_of(block.dz, q) * dz;
        const Wide value = twice * along / (x * x + y * y + z * z + tiny);
        nearest[q] = max(nearest[q], value * is_positive(facing_cosine - cosine));
      }
    }
    found = largest_of(nearest, found);
    if (found * ray.length > 1) middle = ray.side / found, radius = kept_around / found;
  }
  return found;
}

constexpr RayKernels kernels{raise, nearness};
