// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Linear blend skinning: each vertex of a mesh moves by the weighted mean of the transforms of a few bones.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

namespace morula {

/// The map x ↦ x_0 columns[0] + x_1 columns[1] + x_2 columns[2] + translation; the identity by default.
struct AffineTransform {
  std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 translation{};

  /// The image of a direction: the map without the translation.
  Vec3 linear(const Vec3& v) const { return columns[0] * v.x + columns[1] * v.y + columns[2] * v.z; }
  /// The image of a point.
  Vec3 operator()(const Vec3& p) const { return linear(p) + translation; }
  bool operator==(const AffineTransform&) const = default;
};
/// The composition of a and b, which applies b first.
AffineTransform operator*(const AffineTransform& a, const AffineTransform& b);
/// True if all twelve numbers are finite.
bool is_finite(const AffineTransform& t);

/// The weights w_ib with which vertex i of a mesh follows bone b. An influence is one such weight that is stored; a
/// vertex has a few.
///
/// T_b is the transform of bone b relative to rest: the identity if the bone has not moved. Vertex i is then at rest_i
/// + sum_b w_ib (T_b rest_i - rest_i), which is sum_b w_ib T_b rest_i if its weights add up to 1.
struct Skin {
  std::size_t bone_count = 0;  ///< 0: no skin
  /// Vertex i has the influences begin[i] to begin[i + 1] - 1; one entry more than vertices, ascending from 0.
  std::vector<std::uint32_t> begin{};
  std::vector<std::uint32_t> bones{};  ///< bone of each influence, below bone_count
  /// Weight of each influence. The weights of a vertex that facets use add up to 1 within 1e-6; single weights may be
  /// negative.
  std::vector<double> weights{};

  bool empty() const { return bone_count == 0; }
  std::size_t vertex_count() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// A number per vertex: two vertices have the same number only if they have the same influences, bones and weights, in
/// the same order, and so move alike from one rest position. For weld_vertices() and RepairOptions::labels. Throws
/// std::invalid_argument, naming the vertex, for a weight that is NaN. Cost: O(V log V).
std::vector<std::uint32_t> skin_labels(const Skin& skin);
/// The skin of some vertices, in the given order: MeshWeld::old_vertex gives the skin of the welded mesh. Throws
/// std::invalid_argument for a vertex that the skin does not have.
Skin skin_of_vertices(const Skin& skin, std::span<const std::uint32_t> vertices);

/// Writes the position of each vertex under these transforms to `positions`, computed in double, with influences added
/// in order. Body::update_skinned() uses the same positions.
///
/// transforms: one per bone, relative to rest. rest, positions: one per vertex of the skin. If all transforms are the
/// identity, the positions equal `rest` bit for bit. Allocates nothing. The result has the same bits for any number of
/// workers. Cost: linear in influences.
void move_by_skin(const Skin& skin, std::span<const Vec3> rest, std::span<const AffineTransform> transforms,
                  std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

}  // namespace morula
