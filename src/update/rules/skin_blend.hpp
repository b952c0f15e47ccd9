// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skin blend: the rest data from which the rule `skinned` bounds the corners of its nodes. It is computed once per
// body.
//
// A skin moves the corner at c + y, c the center of its node at rest, to sum_b w_b T_b c + A_b m_b: A_b is the linear
// part of T_b, w_b the corner's weight of bone b, and m_b its moment w_b y. A cut corner has the same combination of
// the weights and moments of its facet's vertices. The weights of a corner add up to 1, its moments to y.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <morula/tree/cover.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

#include "update/rules/skin_kernels.hpp"

namespace morula::detail {

/// Largest |1 - sum of weights| of a vertex.
inline constexpr double weight_tolerance = 1e-6;

/// Calls visit(bone, weight) for each influence of a vertex, with weights that add up to 1: the bone with the largest
/// weight gets what is missing.
template <class Visit>
void each_weight(const Skin& skin, std::uint32_t vertex, const Visit& visit) {
  double sum = 0;
  std::uint32_t largest = skin.begin[vertex];
  for (std::uint32_t k = skin.begin[vertex]; k < skin.begin[vertex + 1]; ++k) {
    sum += skin.weights[k];
    if (skin.weights[k] > skin.weights[largest]) largest = k;
  }
  for (std::uint32_t k = skin.begin[vertex]; k < skin.begin[vertex + 1]; ++k)
    visit(skin.bones[k], skin.weights[k] + (k == largest ? 1 - sum : 0));
}

/// A bone b of a node besides its main bone: weights and moments as functions of the corner's place y. For every corner
/// |w_b - (weight + slope . y)| <= weight_stray and |m_b - (moment + scale y)| <= moment_stray.
struct BlendTerm {
  std::uint32_t bone = 0;
  double weight = 0, scale = 0;
  Vec3 slope, moment;
  double weight_stray = 0, moment_stray = 0;
};

/// A ball around the places m_b / w_b of bone b, over the corners with a weight above 0.
struct BoneBall {
  std::uint32_t bone = 0;
  Vec3 center;  ///< about the node's center
  double radius = 0;
};
/// An ellipsoid around the places y of a node's corners: y = center + axes u with |u| <= 1.
struct PatchShape {
  Vec3 center;
  std::array<Vec3, 3> axes{};  ///< columns of a lower triangular matrix
};

struct BlendNode {
  std::uint32_t node = 0;
  std::uint32_t bone = 0;  ///< main bone: the one with the largest sum of weights
  Sphere rest{};           ///< contains the corners
};

/// The rest data of one node, ahead of its place in a SkinBlend.
struct NodeBlend {
  BlendNode node;
  std::vector<BlendTerm> terms{};  ///< by bone, ascending; none if one bone moves the node
  std::vector<BoneBall> balls{};   ///< one per bone, ascending; none if a weight is negative
  PatchShape shape{};
  double factor_sum = 0;  ///< sum of the factors that multiply transforms of points or, over `reach`, linear parts
};

/// corners: those that the node has to contain, each once. center: of the node's sphere; the result has it, or the
/// middle of the corners if the sphere about that one is smaller. reach: the largest |coordinate| of vertices and
/// centers. Cost: linear in the influences of the corners, which are sorted by bone.
NodeBlend blend_of_node(const Skin& skin, const PositionView& positions, const Cover& cover,
                        std::span<const std::uint32_t> corners, const Vec3& center, double reach);

/// The rest data of all nodes of the rule. Cost of making it: linear in terms.
struct SkinBlend {
  SkinBlend() = default;
  /// least_unit: a length in mesh units; a moved center has to be below 2^127 of it.
  explicit SkinBlend(std::span<const NodeBlend> from, double least_unit = 0);

  std::vector<BlendNode> nodes{};
  std::vector<NodeGroup> groups{};  ///< every node is in one of them
  std::vector<GroupTerm> terms{};
  std::vector<BonePair> pairs{};
  Vec3 pivot;                  ///< a place amid the nodes
  double unit = 1;             ///< a power of two, mesh units: the unit of lengths in groups and terms
  double factor_sum = 0;       ///< largest NodeBlend::factor_sum
  std::size_t most_terms = 0;  ///< largest number of terms of a node
};

}  // namespace morula::detail
