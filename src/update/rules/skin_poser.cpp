// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_poser.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "update/points/narrow.hpp"

namespace morula::detail {
namespace {

// Like the limit for modes: with a rest body within largest_local_coordinate, all computed values stay far inside the
// range of float.
constexpr double largest_displacement = 0x1p55;

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
    constexpr double tolerance = 1e-6;
    if (used[v] != 0 && !(std::abs(sum - 1) <= tolerance))
      throw std::invalid_argument("the skin's weights of vertex " + std::to_string(v) + " add up to " +
                                  std::to_string(sum) + ", not to 1");
  }
}

SkinPoser::SkinPoser(const MeshView& mesh, const CoveredTree& model, const Skin& skin,
                     std::span<const std::uint32_t> used_vertices, const Vec3& rest_origin, double size)
    : guide_(*std::min_element(used_vertices.begin(), used_vertices.end())), rest_origin_(rest_origin), size_(size) {
  guide_rest_ = mesh.positions[guide_];
  for (const std::uint32_t v : used_vertices) {
    rest_reach_ = std::max(rest_reach_, max_norm(mesh.positions[v]));
    double sum = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) sum += std::abs(skin.weights[k]);
    largest_weights_ = std::max(largest_weights_, sum);
  }
  for (const Sphere& s : model.tree.spheres) rest_reach_ = std::max(rest_reach_, max_norm(s.center));
}

bool SkinPoser::accepts(std::span<const AffineTransform> transforms, std::size_t& first_bad) const noexcept {
  for (first_bad = 0; first_bad < transforms.size(); ++first_bad)
    if (!is_finite(transforms[first_bad])) return false;
  for (first_bad = 0; first_bad < transforms.size(); ++first_bad) {
    const AffineTransform& t = transforms[first_bad];
    const double across = max_norm(t.columns[0] - Vec3{1, 0, 0}) + max_norm(t.columns[1] - Vec3{0, 1, 0}) +
                          max_norm(t.columns[2] - Vec3{0, 0, 1});
    if (!(largest_weights_ * (across * rest_reach_ + max_norm(t.translation)) <= largest_displacement)) return false;
  }
  first_bad = 0;
  return true;
}

BonePose SkinPoser::pose(const Skin& skin, std::span<const AffineTransform> transforms) const noexcept {
  const Vec3 guide = skinned_vertex(skin, guide_, guide_rest_, transforms);
  return {transforms, origin_near(rest_origin_ + (guide - guide_rest_), size_)};
}

}  // namespace morula::detail
