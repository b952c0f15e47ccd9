// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/rest_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "parallel/float_environment.hpp"
#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same bits.
namespace plain {

typedef float Number;
#include "surface/pairs/shape_distance.inl"

LanePoint point(const PointGroup& group, int i) {
  return {group.at[0][i], group.at[1][i], group.at[2][i]};
}

/// squared_distance(i, j): of shape i of a and shape j of b.
template <class SquaredDistance>
std::uint64_t near_bits(std::uint64_t bits, float squared, const SquaredDistance& squared_distance) {
  std::uint64_t near = 0;
  for (int k = 0; k < 64; ++k)
    if ((bits >> k & 1) != 0) near |= std::uint64_t{squared_distance(k / 8, k % 8) <= squared} << k;
  return near;
}

std::uint64_t near_corners(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  return near_bits(bits, squared, [&](int i, int j) {
    const LanePoint apart = point(b[0], j) - point(a[0], i);
    return dot(apart, apart);
  });
}
std::uint64_t near_edges(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  return near_bits(bits, squared, [&](int i, int j) {
    return squared_of_segments(point(a[0], i), point(a[1], i), point(b[0], j), point(b[1], j));
  });
}
std::uint64_t near_vertex_facets(const PointGroup* a, const PointGroup* b, std::uint64_t bits, float squared) {
  return near_bits(bits, squared, [&](int i, int j) {
    return squared_to_facet(point(a[0], i), point(b[0], j), point(b[1], j), point(b[2], j));
  });
}
constexpr NearShapes near_shapes{near_corners, near_edges, near_vertex_facets};

}  // namespace plain

#define MORULA_KERNELS "surface/pairs/rest_shapes.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<NearShapes> near_shapes_table{MORULA_EVERY_KIND(near_shapes)};

/// The largest squared distance of points, as computed in floats, at which shapes are surely near; 0: never.
///
/// Claim: two shapes with points whose computed squared distance is at most this number are at most rest_distance -
/// rounding apart at rest, which excludes the pair (ExclusionTest).
///
/// Proof, in scaled coordinates, which are at most 1; u is 2^-24. The points are p = a + s (b - a) of an edge, or
/// a + v (b - a) + w (c - a) of a facet, for parameters that are in [0, 1] as computed. v and w have a sum of at most
/// 1 + 4 u: each is a product of two rounded numbers. So p is a point of the shape but for 4 u 4 = 16 u an axis. A
/// coordinate is off by u when it is stored, a difference of two by 2 u, and by 2 u more when it is rounded; its
/// product with a parameter is off by another 2 u. The vector between two points consists of at most three such
/// products and differences, whose sums are rounded at sizes of at most 8 three times: it is off by less than 3 (6 u) +
/// 3 (8 u) + 16 u = 58 u an axis, 101 u in length, which is 2^-17.3. Squares and sums are off by 2^-22 of the computed
/// square; those that underflow by 2^-124, which is 2^-76 of it at the limit below. So shapes with a computed square of
/// at most n^2, n = r - rounding - pad, rounded to a float, are at most n (1 + 2^-21) + 2^-17.3 apart, which is below n
/// + pad.
float squared_limit(double rest_distance, double rounding, double scale) {
  // mutant rest-shapes-pad: `0x1p-17 + 0x1p-20 *` -> `0 *`
  const double r = rest_distance * scale, near = r - rounding * scale - (0x1p-17 + 0x1p-20 * r);
  constexpr double least = 0x1p-24, most = 4;
  // Points are never farther apart than the largest number.
  return near > least ? static_cast<float>(std::min(near, most) * std::min(near, most)) : 0;
}

/// Writes shapes, one after the other, to groups of eight.
class ShapeWriter {
 public:
  ShapeWriter(const SurfaceTreeState& s, double scale, PointGroup* first) : s_(s), scale_(scale), next_(first) {}
  template <class Shapes>
  void write(const Shapes& shapes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& corners = shapes(i);
      if (i % 8 == 0) begin(corners.size());
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const Vec3 p = (s_.mesh.rest[corners[c]] - s_.origin) * scale_;
        for (std::size_t k = 0; k < 3; ++k) next_[c - corners.size()].at[k][i % 8] = static_cast<float>(p[k]);
      }
    }
  }

 private:
  void begin(std::size_t corners) {
    for (std::size_t c = 0; c < corners; ++c, ++next_)
      for (auto& axis : next_->at) std::fill(std::begin(axis), std::end(axis), std::numeric_limits<float>::quiet_NaN());
  }

  const SurfaceTreeState& s_;
  double scale_;
  PointGroup* next_;
};

/// Exchanges bits 8 i + j and 8 j + i.
std::uint64_t transposed(std::uint64_t x) {
  const auto exchange = [&x](int by, std::uint64_t mask) {
    const std::uint64_t different = (x ^ (x >> by)) & mask;
    x ^= different ^ (different << by);
  };
  exchange(7, 0x00aa00aa00aa00aa);
  exchange(14, 0x0000cccc0000cccc);
  exchange(28, 0x00000000f0f0f0f0);
  return x;
}

}  // namespace

std::span<const NearShapes> all_near_shapes() {
  return near_shapes_table.runnable();
}

RestShapes::RestShapes(const SurfaceTreeState& s, Features features, Workers& workers) {
  double largest = 0;
  for (const std::uint32_t v : s.blocks.vertex_of_slot)
    largest = std::max(largest, max_norm(s.mesh.rest[v] - s.origin));
  // Meshes whose facets are all at one point have any scale.
  if (largest > 0) scale_ = std::ldexp(1.0, -std::ilogb(largest) - 1);
  const std::size_t blocks = s.block_count();
  const bool has_all = features == Features::all;
  const auto own = [](const std::vector<std::uint32_t>& begin, std::size_t block) {
    return begin[block + 1] - begin[block];
  };
  first_.resize(blocks), first_edges_.resize(has_all ? blocks : 0);
  std::uint32_t next = 0;
  for (std::size_t block = 0; block < blocks; ++block) {
    first_[block] = next;
    next += 3;
    if (!has_all) continue;
    first_edges_[block] = next += (own(s.blocks.own_vertices, block) + 7) / 8;
    next += 2 * ((own(s.blocks.own_edges_begin, block) + 7) / 8);
  }
  groups_.resize(next);
  parallel_for(workers, blocks, 256, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    for (std::size_t block = begin; block < end; ++block) {
      ShapeWriter writer(s, scale_, &groups_[first_[block]]);
      writer.write([&](std::size_t i) -> const Facet& { return s.blocks.facets_in_order[8 * block + i]; },
                   std::min<std::size_t>(8, s.blocks.order.size() - 8 * block));
      if (!has_all) continue;
      writer.write([&](std::size_t i) { return std::array{s.blocks.vertex_of_slot[s.blocks.own_vertices[block] + i]}; },
                   own(s.blocks.own_vertices, block));
      writer.write([&](std::size_t i) { return s.blocks.ends_of_own_edges[s.blocks.own_edges_begin[block] + i]; },
                   own(s.blocks.own_edges_begin, block));
    }
  });
}

std::size_t RestShapes::bytes() const {
  return groups_.size() * sizeof(PointGroup) + (first_.size() + first_edges_.size()) * sizeof(std::uint32_t);
}

NearAtRest::NearAtRest(std::shared_ptr<const RestShapes> shapes, double rest_distance, double rounding)
    : shapes_(std::move(shapes)),
      kernels_(near_shapes_table.widest()),
      squared_(squared_limit(rest_distance, rounding, shapes_->scale())) {}

std::uint64_t NearAtRest::near(const ShapeGroups& a, std::uint32_t group_a, const ShapeGroups& b, std::uint32_t group_b,
                               std::uint64_t bits) const {
  const PointGroup *const in_a = a[group_a], *const in_b = b[group_b];
  const std::uint64_t near = kernels_.corners(in_a, in_b, bits, squared_), rest = bits & ~near;
  if (rest == 0) return near;
  if (a.corners == 2) return near | kernels_.edges(in_a, in_b, rest, squared_);
  if (b.corners == 1) return near | transposed(kernels_.vertex_facets(in_b, in_a, transposed(rest), squared_));
  return near | (a.corners == 1 ? kernels_.vertex_facets(in_a, in_b, rest, squared_) : near_facets(in_a, in_b, rest));
}

// Facets are near if a corner of one is near the other.
std::uint64_t NearAtRest::near_facets(const PointGroup* a, const PointGroup* b, std::uint64_t bits) const {
  std::uint64_t near = 0;
  for (int c = 0; c < 3 && near != bits; ++c) near |= kernels_.vertex_facets(a + c, b, bits & ~near, squared_);
  for (int c = 0; c < 3 && near != bits; ++c)
    near |= transposed(kernels_.vertex_facets(b + c, a, transposed(bits & ~near), squared_));
  return near;
}

}  // namespace morula::detail
