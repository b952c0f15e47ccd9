// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// The pad without morph targets: skinned.cpp. Morph targets move points at rest by up to M, the largest |component| of
// sum_j q_j U_j. X and S then bound the morphed points and their displacements, which replaces them in all lines there,
// and these lines are added; k coordinates are not 0, Q' is the sum of the factors of SkinMorphs, n' the bones of a
// node:
//   the caller's own sum rest + sum q_j U_j, moved by the bones         1.8 (k + 1) e L (X + S)
//   s = sum q_j s_j, moved by the bones                                 1.8 (k + n' + 9) e (1 + Q') (X + S)
//   h_b and w_b of Delta_j, times |A_b|                                 3.3 (n + 8) e L (X + S)
// The pad counts k + n' more summands, and adds Q' to Q. The weights of a cut corner that add up to 1 +- s move A_r s
// by 1.8 s (X + S) more; the allowance of 8 s (L + Q) (X + S) contains it.
#include "update/rules/skin_poser.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "update/points/narrow.hpp"
#include "update/rules/skin_blend.hpp"

namespace morula::detail {
namespace {

// Like the limit for modes: with a rest body within largest_local_coordinate, all computed values stay far inside the
// range of float.
constexpr double largest_motion = 0x1p55;

}  // namespace

void require_skin(const Skin& skin, const MeshView& mesh) {
  if (skin.vertex_count() != mesh.vertex_count())
    throw std::invalid_argument("the skin is for " + std::to_string(skin.vertex_count()) +
                                " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  if (skin.bones.size() != skin.weights.size())
    throw std::invalid_argument("the skin has " + std::to_string(skin.bones.size()) + " bones of influences, but " +
                                std::to_string(skin.weights.size()) + " weights");
  if (skin.begin.front() != 0 || skin.begin.back() != skin.bones.size() ||
      !std::is_sorted(skin.begin.begin(), skin.begin.end()))
    throw std::invalid_argument("the skin's list of where influences begin does not go up from 0 to their number");
  for (std::size_t k = 0; k < skin.bones.size(); ++k)
    if (skin.bones[k] >= skin.bone_count)
      throw std::invalid_argument("influence " + std::to_string(k) + " of the skin is of bone " +
                                  std::to_string(skin.bones[k]) + ", but there are " + std::to_string(skin.bone_count));
  std::vector<std::uint8_t> used(mesh.vertex_count());
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t v : facet) used[v] = 1;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    double sum = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) sum += skin.weights[k];
    if (used[v] != 0 && !(std::abs(sum - 1) <= weight_tolerance))
      throw std::invalid_argument("the skin's weights of vertex " + std::to_string(v) + " add up to " +
                                  std::to_string(sum) + ", not to 1");
  }
}

SkinPoser::SkinPoser(const MeshView& mesh, const CoveredTree& model, const Skin& skin,
                     std::span<const std::uint32_t> used_vertices, const Vec3& rest_origin, double size)
    : guide_(*std::min_element(used_vertices.begin(), used_vertices.end())), rest_origin_(rest_origin), size_(size) {
  guide_rest_ = mesh.positions[guide_];
  std::vector<std::uint8_t> is_used(skin.bone_count);
  for (const std::uint32_t v : used_vertices) {
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
      // mutant skinned-used-bones: `skin.weights[k] != 0` -> `false`
      if (skin.weights[k] != 0) is_used[skin.bones[k]] = 1;
    rest_reach_ = std::max(rest_reach_, max_norm(mesh.positions[v]));
    double sum = 0, absolute = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
      sum += skin.weights[k], absolute += std::abs(skin.weights[k]);
    largest_weights_ = std::max(largest_weights_, absolute);
    skin_slack_ = std::max(skin_slack_, std::abs(1 - sum));
    most_terms_ = std::max<std::size_t>(most_terms_, skin.begin[v + 1] - skin.begin[v]);
  }
  for (std::uint32_t b = 0; b < is_used.size(); ++b)
    if (is_used[b] != 0) used_bones_.push_back(b);
  for (const Sphere& s : model.tree.spheres) rest_reach_ = std::max(rest_reach_, max_norm(s.center));
  for (const CutPoint& c : model.cover.cut_points)
    cut_slack_ = std::max(cut_slack_, std::abs(c.weight[0] + c.weight[1] + c.weight[2] - 1));
}

// At least the largest |component| of the displacement of a morphed point.
double SkinPoser::motion_of(const AffineTransform& t, const MorphedRest& rest) const noexcept {
  const double across = max_norm(t.columns[0] - Vec3{1, 0, 0}) + max_norm(t.columns[1] - Vec3{0, 1, 0}) +
                        max_norm(t.columns[2] - Vec3{0, 0, 1});
  // mutant skin-morph-pad-motion: `rest.motion)` -> `0 * rest.motion)`
  return across * (rest_reach_ + rest.motion) + max_norm(t.translation);
}

bool SkinPoser::accepts(std::span<const AffineTransform> transforms, const MorphedRest& rest,
                        std::size_t& first_bad) const noexcept {
  for (first_bad = 0; first_bad < transforms.size(); ++first_bad)
    if (!is_finite(transforms[first_bad])) return false;
  for (first_bad = 0; first_bad < transforms.size(); ++first_bad) {
    // mutant skin-morph-range: `rest.motion + largest_weights_` -> `largest_weights_`
    const double motion = rest.motion + largest_weights_ * motion_of(transforms[first_bad], rest);
    if (!(motion <= largest_motion)) return false;
  }
  first_bad = 0;
  return true;
}

BonePose SkinPoser::pose(const Skin& skin, std::span<const AffineTransform> transforms,
                         const MorphedRest& rest) const noexcept {
  const Vec3 guide = skinned_vertex(skin, guide_, rest.guide, transforms);
  const Vec3 origin = origin_near(rest_origin_ + (guide - guide_rest_), size_);
  const bool is_morphed = rest.active != 0;
  double motion = 0;
  for (const std::uint32_t b : used_bones_) motion = std::max(motion, motion_of(transforms[b], rest));
  const double factors = largest_weights_ + factor_sum_ + (is_morphed ? morph_factor_sum_ : 0);
  // mutant skin-morph-pad-reach: `rest_reach_ + rest.motion` -> `rest_reach_`
  const double all = factors * (rest_reach_ + rest.motion + motion) + max_norm(origin);
  // mutant skin-morph-pad-terms: `rest.active + morph_terms_` -> `0`
  const std::size_t terms = most_terms_ + (is_morphed ? rest.active + morph_terms_ : 0);
  // mutant skinned-pad-of-few-terms: `(static_cast<double>(terms) + 16)` -> `(static_cast<double>(terms) * 0 + 16)`
  // mutant skinned-pad-less: `49` -> `59`
  // mutant skinned-cut-slack: `8 *` -> `0 *`
  const double share = 0x1p-49 * (static_cast<double>(terms) + 16) + 8 * cut_slack_;
  // mutant skinned-pad: `share * all` -> `0 * share * all`
  // mutant skinned-skin-slack: `2 *` -> `0 *`
  return {transforms, origin, share * all + 2 * skin_slack_ * motion, rest.morphs};
}

}  // namespace morula::detail
