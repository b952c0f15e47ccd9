// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cores of nodes, laid out for Kernels::pull_many: a core is a few of the outermost points that a node owns.
//
//   group g = lanes 0 … nodes_at_once - 1, one node each, of one level and with about as many points
//   points of group g, n to a core:   p0 of lane 0, p0 of lane 1, … | p1 of lane 0, p1 of lane 1, … | … | pn-1 …
//
// Short cores repeat their first point, which changes no maximum; lanes beyond the last node repeat that one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "update/points/kernels.hpp"

namespace morula::detail {

class PackedCores {
 public:
  /// Nodes are grouped within chunks of so many consecutive ones.
  static constexpr std::size_t nodes_per_chunk = 64;
  static_assert(nodes_per_chunk % nodes_at_once == 0 && nodes_at_once % nodes_per_group == 0);

  PackedCores() = default;
  /// cores: core_size points of each node; a point may occur more than once. radii, levels: of each node.
  PackedCores(std::span<const std::uint32_t> cores, std::span<const float> radii,
              std::span<const std::uint32_t> levels);

  /// The core of node k: point i is first[nodes_at_once * i].
  struct Core {
    const std::uint32_t* first;
    std::size_t count;
  };
  Core of(std::size_t k) const noexcept {
    const std::uint32_t group = lane_[k] / nodes_at_once, begin = begin_[group], end = begin_[group + 1];
    return {&points_[begin + lane_[k] % nodes_at_once], (end - begin) / nodes_at_once};
  }
  /// The largest distance from the center of node k to its core, at rest.
  float rest_radius(std::size_t k) const noexcept { return rest_radius_[lane_[k]]; }

  /// A group in the form that pull_many takes. Groups of a chunk have nodes of that chunk alone.
  struct Group {
    const std::uint32_t* nodes;   ///< nodes of its lanes
    const std::uint32_t* points;  ///< points, count of each lane
    std::size_t count;
    const float* rest_radii;  ///< rest radii of its lanes
  };
  Group group(std::size_t g) const noexcept {
    return {&node_of_lane_[nodes_at_once * g], &points_[begin_[g]], (begin_[g + 1] - begin_[g]) / nodes_at_once,
            &rest_radius_[nodes_at_once * g]};
  }

 private:
  void append_group(std::span<const std::uint32_t> nodes, std::span<const std::vector<std::uint32_t>> core_of,
                    std::span<const float> radii);

  std::vector<std::uint32_t> points_, begin_{0};  // points of groups, and their begins with the end
  std::vector<float> rest_radius_;                // rest radii of lanes, group after group
  std::vector<std::uint32_t> node_of_lane_;
  std::vector<std::uint32_t> lane_;  // lane of each node
};

}  // namespace morula::detail
