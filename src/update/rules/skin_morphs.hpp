// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skin morphs: what morph targets add to the spheres of the rule `skinned`. The rest data are computed once per body.
//
// With coordinates q of the morph targets U and the names of skin_blend.hpp, A_b the linear part of T_b, a corner that
// combines vertices v by the factors f_v moves, besides what the bones do to its place at rest, by
//   d = sum_j q_j sum_b A_b h_bj,   h_bj = sum_v f_v w_vb U_vj.
// With any shift s_j per node and morph target, s = sum_j q_j s_j, w_b the corner's weights, which add up to 1, r the
// main bone and W_b any weights, this is
//   d = A_r s + sum_{b != r} W_b (A_b - A_r) s                              the same for all corners
//       + sum_{b != r} (w_b - W_b) (A_b - A_r) s + sum_j q_j sum_b A_b (h_bj - w_b s_j).
// So the sphere around the corners without morph targets, moved by the first line, needs a radius that is larger by
//   sum_{b != r} max |w_b - W_b| |(A_b - A_r) s| + max_b |A_b| sum_j |q_j| Delta_j,
// Delta_j = max over corners of sum_b |h_bj - w_b s_j|; at a vertex with weights of at least 0 that is |U_j - s_j|.
// Rounding: skin_poser.cpp.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

#include "update/rules/skin_poser.hpp"

namespace morula::detail {

/// The rest data of one node.
struct NodeMorphs {
  struct Share {
    std::uint32_t bone = 0;  ///< not the main bone
    double weight = 0;       ///< W_b
    double stray = 0;        ///< at least |w_b - W_b| of every corner
  };
  struct Row {
    std::uint32_t mode = 0;
    Vec3 shift;        ///< s_j
    double stray = 0;  ///< at least Delta_j
  };
  std::uint32_t bone = 0;  ///< main bone: the one with the largest sum of weights
  std::vector<Share> shares{};
  std::vector<Row> rows{};  ///< rows of the modes that move a corner, ascending
};

/// corners: those that the node has to contain, each once. Cost: corners × influences × modes.
NodeMorphs morphs_of_node(const Skin& skin, const Modes& modes, const Cover& cover,
                          std::span<const std::uint32_t> corners);

/// The rest data of all nodes of the rule, and their values in a frame.
class SkinMorphs {
 public:
  SkinMorphs() = default;
  /// nodes: in the order of the numbers that add_to() takes.
  SkinMorphs(std::span<const NodeMorphs> nodes, std::size_t mode_count, std::size_t bone_count);

  /// For the pads of the poser.
  double factor_sum() const { return factor_sum_; }
  std::size_t most_terms() const { return most_terms_; }
  /// The largest coordinate of a shift, or stray, of a row.
  double reach() const;

  /// Begins a frame. Allocates nothing. Cost: bones, plus the rows of the modes whose coordinates are not 0.
  void begin(const BonePose& pose, Workers& workers) noexcept;
  /// Moves and enlarges the sphere around a node's corners without morph targets to one around its corners with them.
  /// Without a coordinate other than 0 the sphere keeps its bits. Cost: bones of the node.
  void add_to(std::size_t node, Sphere& sphere) const noexcept;

 private:
  struct Node {
    std::uint32_t bone, first_share, end_share;
  };
  struct Row {
    std::uint32_t node;
    Vec3 shift;
    double stray;
  };
  struct Bone {
    std::array<Vec3, 3> columns;  // of A_b - 1
    double stretch;               // at least |A_b|
  };
  void sum_rows(std::span<const double> morphs, std::size_t begin, std::size_t end) noexcept;

  std::vector<Node> nodes_;
  std::vector<NodeMorphs::Share> shares_;
  std::vector<Row> rows_;               // mode after mode, by node
  std::vector<std::size_t> row_begin_;  // one per mode, and the end
  double factor_sum_ = 0;
  std::size_t most_terms_ = 0;

  // The current frame:
  bool is_moved_ = false;
  std::vector<Bone> bones_;
  std::vector<Vec3> shifts_;    // s, by node
  std::vector<double> strays_;  // sum of |q_j| Delta_j, by node
};

}  // namespace morula::detail
