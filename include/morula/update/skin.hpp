// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Linear blend skinning: the vertices of a mesh follow a few bones, each with a weight for the vertices around it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

namespace morula {

/// x ↦ sum of columns[k] x_k, plus translation.
struct AffineTransform {
  std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 translation{};

  /// The transform of a direction: without the translation.
  Vec3 linear(const Vec3& v) const { return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z; }
  Vec3 operator()(const Vec3& p) const { return linear(p) + translation; }
  bool operator==(const AffineTransform&) const = default;
};
/// a ∘ b: b first.
AffineTransform operator*(const AffineTransform& a, const AffineTransform& b);
bool is_finite(const AffineTransform& t);

/// Weights of a mesh's vertices, a few bones each. With T_b the transform of bone b *relative to rest*, vertex i is at
/// rest_i + sum_b w_ib (T_b rest_i - rest_i). This equals sum_b w_ib T_b rest_i, because the weights add up to 1.
struct Skin {
  std::size_t bone_count = 0;  ///< 0: no skin
  /// Vertex i has the influences [begin[i], begin[i + 1]); vertex count + 1 entries.
  std::vector<std::uint32_t> begin{};
  std::vector<std::uint32_t> bones{};  ///< bone of each influence, below bone_count
  std::vector<double> weights{};       ///< weight of each influence; those of a vertex add up to 1 within 1e-6

  bool empty() const { return bone_count == 0; }
  std::size_t vertex_count() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// positions[i] = position of vertex i, in double, with influences added in order, as Body::update_skinned moves
/// vertices. All sizes must be those of the skin. If all transforms are the identity, the positions equal `rest` bit
/// for bit. Allocates nothing. The result has the same bits for any number of workers. Cost: influences.
void move_by_skin(const Skin& skin, std::span<const Vec3> rest, std::span<const AffineTransform> transforms,
                  std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

}  // namespace morula
