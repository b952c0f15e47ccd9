// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Linear blend skinning: how the vertices of a mesh follow a few bones, each with a share in the vertices around it.
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

  /// Of a direction: without the translation.
  Vec3 linear(const Vec3& v) const { return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z; }
  Vec3 operator()(const Vec3& p) const { return linear(p) + translation; }
  bool operator==(const AffineTransform&) const = default;
};
/// a ∘ b: b first.
AffineTransform operator*(const AffineTransform& a, const AffineTransform& b);
bool is_finite(const AffineTransform& t);

/// Weights of a mesh's vertices, a few bones each. With T_b the transform of bone b *relative to rest*, vertex i is at
/// rest_i + sum_b w_ib (T_b rest_i - rest_i): as the weights add up to 1, that is sum_b w_ib T_b rest_i.
struct Skin {
  std::size_t bone_count = 0;          ///< 0: no skin
  std::vector<std::uint32_t> begin{};  ///< vertex i has the influences [begin[i], begin[i + 1]): one more than vertices
  std::vector<std::uint32_t> bones{};  ///< of each influence, below bone_count
  std::vector<double> weights{};       ///< of each influence; those of a vertex add up to 1 within 1e-6

  bool empty() const { return bone_count == 0; }
  std::size_t vertex_count() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// positions[i] = where vertex i is, in double, influences added in order: what Body::update_skinned follows. All sizes
/// must be those of the skin. Where all transforms are the identity the positions are `rest` bit for bit. No
/// allocation. Same bits for any number of workers. Cost: influences.
void move_by_skin(const Skin& skin, std::span<const Vec3> rest, std::span<const AffineTransform> transforms,
                  std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

}  // namespace morula
