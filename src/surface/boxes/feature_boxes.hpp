// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes of single facets, vertices and edges, of the blocks that a query visits.
#pragma once

#include <cstdint>
#include <vector>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

enum class Features : std::uint8_t { facets, all };

class FeatureBoxes {
 public:
  /// Forgets the boxes made for another frame, surface or choice of features, and keeps the memory. boxes: boxes of the
  /// vertices of the blocks that will be requested.
  void start(const SurfaceTreeState& state, const SurfaceBoxes& boxes, Features features);
  /// Requests the boxes of a block.
  void want(std::uint32_t block);
  /// Makes the boxes of all requested blocks. The boxes stay at their places until the next call.
  void fill(Workers& workers);

  const BoxGroup& facets(std::uint32_t block) const { return groups_[first_[block]]; }
  std::uint32_t vertex_groups(std::uint32_t block) const {
    return (state_->blocks.own_vertices[block + 1] - state_->blocks.own_vertices[block] + 7) / 8;
  }
  std::uint32_t edge_groups(std::uint32_t block) const {
    return (state_->blocks.own_edges_begin[block + 1] - state_->blocks.own_edges_begin[block] + 7) / 8;
  }
  const BoxGroup& vertices(std::uint32_t block, std::uint32_t group) const {
    return groups_[first_[block] + 1 + group];
  }
  const BoxGroup& edges(std::uint32_t block, std::uint32_t group) const {
    return groups_[first_[block] + 1 + vertex_groups(block) + group];
  }
  std::uint32_t facet(std::uint32_t block, std::uint32_t place) const {
    return state_->blocks.order[8 * block + place];
  }
  std::uint32_t vertex(std::uint32_t block, std::uint32_t place) const {
    return state_->blocks.vertex_of_slot[state_->blocks.own_vertices[block] + place];
  }
  std::uint32_t edge(std::uint32_t block, std::uint32_t place) const {
    return state_->blocks.own_edges[state_->blocks.own_edges_begin[block] + place];
  }

  const Facet& facet_corners(std::uint32_t block, std::uint32_t place) const {
    return state_->blocks.facets_in_order[8 * block + place];
  }
  const std::array<std::uint32_t, 2>& edge_ends(std::uint32_t block, std::uint32_t place) const {
    return state_->blocks.ends_of_own_edges[state_->blocks.own_edges_begin[block] + place];
  }

 private:
  void make(std::uint32_t block);

  const SurfaceTreeState* state_ = nullptr;
  const SurfaceBoxes* boxes_ = nullptr;
  std::uint64_t frame_ = 0;
  Features features_ = Features::all;
  // By block: the number of the start() for which its boxes were made, and the place of the first of them.
  std::vector<std::uint32_t> stamp_, first_;
  std::uint32_t now_ = 0;
  std::vector<BoxGroup> groups_;
  std::size_t used_ = 0;
  std::vector<std::uint32_t> wanted_;
};

}  // namespace morula::detail
