// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skin poser: the transforms and morph targets that can move a body with a skin, and the origin that follows them.
#pragma once

#include <algorithm>
#include <morula/geometry/mesh.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Throws std::invalid_argument unless the skin has the mesh's vertices, its influences name its bones, and the weights
/// of every vertex that facets use are finite and add up to 1 within 1e-6.
void require_skin(const Skin& skin, const MeshView& mesh);

/// (T - 1) p: displacement of a point by a transform. Exactly zero if T is the identity.
inline Vec3 displacement(const AffineTransform& t, const Vec3& p) {
  return (t.columns[0] - Vec3{1, 0, 0}) * p.x + (t.columns[1] - Vec3{0, 1, 0}) * p.y +
         (t.columns[2] - Vec3{0, 0, 1}) * p.z + t.translation;
}

/// Position of vertex i by its modes, before the bones move it: the sums of move_by_modes(), bit for bit.
inline Vec3 morphed_vertex(const Modes& modes, std::size_t i, const Vec3& rest, std::span<const double> morphs) {
  Vec3 moved = rest;
  for (std::size_t j = 0; j < morphs.size(); ++j)
    if (morphs[j] != 0) moved += morphs[j] * modes.displacements[j * modes.vertex_count + i];
  return moved;
}

/// Position of vertex i: all code that moves it calls this routine. rest: with morph targets, its morphed_vertex().
inline Vec3 skinned_vertex(const Skin& skin, std::size_t i, const Vec3& rest,
                           std::span<const AffineTransform> transforms) {
  Vec3 moved = rest;
  for (std::uint32_t k = skin.begin[i]; k < skin.begin[i + 1]; ++k)
    moved += skin.weights[k] * displacement(transforms[skin.bones[k]], rest);
  return moved;
}

/// The body moved by morph targets alone, before its bones.
struct MorphedRest {
  Vec3 guide;                        ///< the vertex that guides the origin
  double motion = 0;                 ///< at least the largest |component| of a vertex' displacement
  std::span<const double> morphs{};  ///< one coordinate per mode; empty if all are 0
  std::size_t active = 0;            ///< number of coordinates that are not 0
};

/// Values that all nodes share at some transforms.
struct BonePose {
  std::span<const AffineTransform> transforms;
  Vec3 origin;     ///< origin of the spheres, as LocalPoints computes it for the moved positions, bit for bit
  double pad = 0;  ///< length that radii are rounded up by (skin_poser.cpp)
  std::span<const double> morphs{};  ///< one coordinate per mode; empty if all are 0
};

class SkinPoser {
 public:
  /// used_vertices: vertices of facets; the lowest guides the origin. rest_origin, size: as in LocalPoints.
  SkinPoser(const MeshView& mesh, const CoveredTree& model, const Skin& skin,
            std::span<const std::uint32_t> used_vertices, const Vec3& rest_origin, double size);

  /// Whether the transforms are finite and move nothing farther than spheres in single precision can follow. If not,
  /// first_bad is the lowest bone that is not finite or, when all are, the lowest that moves too far.
  bool accepts(std::span<const AffineTransform> transforms, const MorphedRest& rest,
               std::size_t& first_bad) const noexcept;
  /// transforms must be accepted; they are not copied.
  BonePose pose(const Skin& skin, std::span<const AffineTransform> transforms, const MorphedRest& rest) const noexcept;
  BonePose pose(const Skin& skin, std::span<const AffineTransform> transforms) const noexcept {
    return pose(skin, transforms, unmorphed());
  }
  MorphedRest unmorphed() const noexcept { return {guide_rest_}; }

  /// The largest |coordinate| at rest, of vertices and centers.
  double rest_reach() const { return rest_reach_; }
  /// Pads pay for the rounding of sums with these factors and as many terms (SkinBlend).
  void add_blend(double factor_sum, std::size_t most_terms) {
    factor_sum_ = std::max(factor_sum_, factor_sum);
    most_terms_ = std::max(most_terms_, most_terms);
  }
  /// Likewise for the sums of SkinMorphs.
  void add_morphs(double factor_sum, std::size_t most_terms) {
    morph_factor_sum_ = std::max(morph_factor_sum_, factor_sum);
    morph_terms_ = std::max(morph_terms_, most_terms);
  }

 private:
  double motion_of(const AffineTransform& t, const MorphedRest& rest) const noexcept;

  std::uint32_t guide_;
  Vec3 guide_rest_, rest_origin_;
  double size_;
  std::vector<std::uint32_t> used_bones_;  // those with a weight other than 0 in a vertex of a facet
  double rest_reach_ = 0;                  // largest |coordinate| at rest, of vertices and centers
  double largest_weights_ = 1;             // largest sum of |weights| of a vertex
  double factor_sum_ = 0, morph_factor_sum_ = 0;
  std::size_t most_terms_ = 0;   // largest number of terms of a node, or of influences of a vertex
  std::size_t morph_terms_ = 0;  // largest number of bones of a node
  double cut_slack_ = 0;         // largest |1 - sum of weights| of a cut point
  double skin_slack_ = 0;        // largest |1 - sum of weights| of a vertex
};

}  // namespace morula::detail
