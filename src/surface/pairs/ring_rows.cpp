// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/ring_rows.hpp"

#include <algorithm>
#include <array>

namespace morula::detail {
namespace {

constexpr std::uint64_t all_neighbors = ~std::uint64_t{0};

}  // namespace

BlocksOfVertices::BlocksOfVertices(const SurfaceTreeState& s) : begin_(s.mesh.rest.size() + 1) {
  for (const Facet& facet : s.blocks.facets_in_order)
    for (const std::uint32_t v : facet) ++begin_[v + 1];
  for (std::size_t v = 0; v < s.mesh.rest.size(); ++v) begin_[v + 1] += begin_[v];
  blocks_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t i = 0; i < s.blocks.facets_in_order.size(); ++i)
    for (const std::uint32_t v : s.blocks.facets_in_order[i]) blocks_[next[v]++] = static_cast<std::uint32_t>(i / 8);
}

RingRowMaker::RingRowMaker(const SurfaceTreeState& s, std::uint32_t rings, Features features,
                           const BlocksOfVertices& blocks)
    : surface_(s),
      rings_(rings),
      features_(features),
      blocks_of_vertices_(blocks),
      reached_from_(s.mesh.rest.size()),
      fresh_(s.mesh.rest.size()),
      next_(s.mesh.rest.size()),
      is_partner_(s.block_count()) {}

std::optional<RingRow> RingRowMaker::make(std::uint32_t block) {
  forget();
  if (!find_rings(block)) return std::nullopt;
  find_partners(block);
  take(block, in_a_, [&](std::uint32_t v) {
    return std::uint32_t{1} << (std::find(corners_.begin(), corners_.end(), v) - corners_.begin());
  });
  RingRow row;
  for (const std::uint32_t partner : partners_) add_block(row, block, partner);
  row.entries.shrink_to_fit(), row.masks.shrink_to_fit();
  return row;
}

void RingRowMaker::forget() {
  for (const std::uint32_t v : reached_) reached_from_[v] = fresh_[v] = next_[v] = 0;
  reached_.clear(), front_.clear(), next_front_.clear(), corners_.clear();
}

// A search along edges, ring by ring, from all vertices of the block at once.
bool RingRowMaker::find_rings(std::uint32_t block) {
  const SurfaceBlocks& blocks = surface_.blocks;
  for (std::uint32_t i = blocks.corners_begin[block]; i < blocks.corners_begin[block + 1]; ++i) {
    const std::uint32_t v = blocks.vertex_of_slot[blocks.corners[i]];
    if (reached_from_[v] != 0) continue;
    reached_from_[v] = fresh_[v] = std::uint32_t{1} << corners_.size();
    corners_.push_back(v), reached_.push_back(v), front_.push_back(v);
  }
  all_corners_ = static_cast<std::uint32_t>((std::uint64_t{1} << corners_.size()) - 1);
  for (std::uint32_t ring = 0; ring < rings_ && !front_.empty(); ++ring) {
    advance();
    if (reached_.size() > most_vertices) return false;
  }
  return true;
}

void RingRowMaker::advance() {
  const SurfaceMesh& mesh = surface_.mesh;
  next_front_.clear();
  for (const std::uint32_t v : front_) {
    const std::uint32_t bits = fresh_[v];
    fresh_[v] = 0;
    for (std::uint32_t i = mesh.ring_begin[v]; i < mesh.ring_begin[v + 1]; ++i) {
      const std::uint32_t w = mesh.ring[i];
      const std::uint32_t added = bits & ~reached_from_[w];
      if (added == 0) continue;
      if (next_[w] == 0) next_front_.push_back(w);
      next_[w] |= added;
    }
  }
  for (const std::uint32_t w : next_front_) {
    if (reached_from_[w] == 0) reached_.push_back(w);
    reached_from_[w] |= next_[w];
    fresh_[w] = next_[w];
    next_[w] = 0;
  }
  front_.swap(next_front_);
}

void RingRowMaker::find_partners(std::uint32_t block) {
  partners_.clear();
  for (const std::uint32_t v : reached_)
    for (const std::uint32_t b : blocks_of_vertices_.of(v)) {
      if (b < block || is_partner_[b] != 0) continue;
      is_partner_[b] = 1;
      partners_.push_back(b);
    }
  for (const std::uint32_t b : partners_) is_partner_[b] = 0;
  std::sort(partners_.begin(), partners_.end());
}

/// The features of a block at the places where FeatureBoxes has them. bits_of(v): the bits of a vertex.
template <class BitsOf>
void RingRowMaker::take(std::uint32_t block, FeatureBits& features, const BitsOf& bits_of) const {
  const SurfaceBlocks& blocks = surface_.blocks;
  features.facets.clear(), features.vertices.clear(), features.edges.clear();
  const std::size_t begin = 8 * std::size_t{block}, end = std::min(blocks.order.size(), begin + 8);
  for (std::size_t i = begin; i < end; ++i) {
    const Facet& f = blocks.facets_in_order[i];
    features.facets.push_back(bits_of(f[0]) | bits_of(f[1]) | bits_of(f[2]));
  }
  if (features_ == Features::facets) return;
  for (std::uint32_t i = blocks.own_vertices[block]; i < blocks.own_vertices[block + 1]; ++i)
    features.vertices.push_back(bits_of(blocks.vertex_of_slot[i]));
  for (std::uint32_t i = blocks.own_edges_begin[block]; i < blocks.own_edges_begin[block + 1]; ++i)
    features.edges.push_back(bits_of(blocks.ends_of_own_edges[i][0]) | bits_of(blocks.ends_of_own_edges[i][1]));
}

// Then every vertex of the row's block is a neighbor of every vertex of the other, or equal to it.
bool RingRowMaker::reaches_all_of(std::uint32_t block) const {
  const SurfaceBlocks& blocks = surface_.blocks;
  std::uint32_t common = all_corners_;
  for (std::uint32_t i = blocks.corners_begin[block]; i < blocks.corners_begin[block + 1]; ++i)
    common &= reached_from_[blocks.vertex_of_slot[blocks.corners[i]]];
  return common == all_corners_;
}

void RingRowMaker::add_block(RingRow& row, std::uint32_t a, std::uint32_t b) {
  const auto exclude_all = [&] {
    if (!row.entries.empty() && row.entries.back().masks == RingRow::no_masks && row.entries.back().last + 1 == b)
      row.entries.back().last = b;
    else
      row.entries.push_back({b, b, RingRow::no_masks});
  };
  if (reaches_all_of(b)) return exclude_all();
  const std::size_t first = row.masks.size();
  take(b, in_b_, [&](std::uint32_t v) { return reached_from_[v]; });
  add_masks(row, a == b);
  const auto are = [&](std::uint64_t bits) {
    return std::all_of(row.masks.begin() + static_cast<std::ptrdiff_t>(first), row.masks.end(),
                       [&](std::uint64_t mask) { return mask == bits; });
  };
  const bool are_all = are(all_neighbors);
  if (!are_all && !are(0)) {
    row.entries.push_back({b, b, static_cast<std::uint32_t>(first)});
    return;
  }
  row.masks.resize(first);
  if (are_all) exclude_all();
}

/// Places without a feature count as excluded, and so do pairs that share a vertex, which no search finds.
void RingRowMaker::add_masks(RingRow& row, bool is_one_block) const {
  const auto add = [&](const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    const std::size_t groups_b = (b.size() + 7) / 8, first = row.masks.size();
    row.masks.resize(first + (a.size() + 7) / 8 * groups_b, all_neighbors);
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size(); ++j)
        row.masks[first + i / 8 * groups_b + j / 8] &= ~(std::uint64_t{(a[i] & b[j]) == 0} << (i % 8 * 8 + j % 8));
  };
  if (features_ == Features::facets) return add(in_a_.facets, in_b_.facets);
  add(in_a_.vertices, in_b_.facets);
  if (!is_one_block) add(in_a_.facets, in_b_.vertices);
  add(in_a_.edges, in_b_.edges);
}

}  // namespace morula::detail
