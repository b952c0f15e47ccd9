// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pairs of facets of two bodies that intersect, below given pairs of nodes.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <vector>

#include "collide/facets/box_kernels.hpp"
#include "collide/pairs/meter.hpp"

namespace morula::detail {

/// A set of pairs of indices that is filled, searched and emptied; its memory stays.
class PairSet {
 public:
  /// Returns true when the key was not in the set. The key is not 2^64 - 1.
  bool insert(std::uint64_t key) {
    if (2 * size_ >= slots_.size()) grow();
    if (!put(key)) return false;
    ++size_;
    return true;
  }
  std::size_t size() const { return size_; }
  void clear() {
    std::fill(slots_.begin(), slots_.end(), nothing);
    size_ = 0;
  }

 private:
  static constexpr std::uint64_t nothing = ~std::uint64_t{0};

  bool put(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    const int shift = 64 - std::countr_zero(slots_.size());
    for (std::size_t i = (key * 0x9e3779b97f4a7c15u) >> shift;; i = (i + 1) & mask) {
      if (slots_[i] == key) return false;
      if (slots_[i] != nothing) continue;
      slots_[i] = key;
      return true;
    }
  }
  void grow() {
    std::vector<std::uint64_t> before(std::max<std::size_t>(1024, 4 * slots_.size()), nothing);
    before.swap(slots_);
    for (const std::uint64_t key : before)
      if (key != nothing) put(key);
  }

  std::vector<std::uint64_t> slots_;  // the number of slots is a power of two
  std::size_t size_ = 0;
};

/// The facets of the nodes that one query visits, those of each node read once: boxes, and corners in the world.
class NodeFacets {
 public:
  /// Forgets all facets and keeps the memory. origin: the origin of the boxes' coordinates.
  void start(const Collider& collider, const Vec3& origin);

  struct Range {
    std::uint32_t begin = 0, size = 0;  ///< range of slots; size: number without filling
    FloatBox box;                       ///< box of all facets of the node
  };
  /// The facets of a node; reads them on first use. The reference is valid until the next call.
  const Range& read(std::uint32_t node);

  /// Boxes of a range, filled up. They are valid until the next read.
  BoxList boxes(const Range& range) const {
    BoxList list;
    for (std::size_t k = 0; k < 6; ++k) list.column[k] = bounds_[k].data() + range.begin;
    list.count = filled(range.size);
    return list;
  }
  std::uint32_t facet(std::uint32_t slot) const { return facet_[slot]; }
  /// Corners in the world: few are needed, so they are transformed on first use. The reference is valid until the next
  /// call.
  const Triangle& triangle(std::uint32_t slot) {
    std::uint32_t& place = triangle_of_[slot];
    if (place == unread) {
      place = static_cast<std::uint32_t>(triangles_.size());
      triangles_.push_back(collider_->triangle(facet_[slot]));
    }
    return triangles_[place];
  }
  std::size_t facets_read() const { return facets_read_; }

  static std::size_t filled(std::size_t count) { return (count + box_list_step - 1) / box_list_step * box_list_step; }

 private:
  const Collider* collider_ = nullptr;
  Vec3 origin_;
  // By node: the number of the query that read it last, and the range that was read.
  std::vector<std::uint32_t> stamp_;
  std::vector<Range> range_;
  std::uint32_t now_ = 0;
  // By slot.
  std::vector<float> bounds_[6];
  std::vector<std::uint32_t> facet_;
  static constexpr std::uint32_t unread = 0xffffffffu;
  std::vector<std::uint32_t> triangle_of_;  // place in triangles_
  std::vector<Triangle> triangles_;
  std::size_t used_ = 0, facets_read_ = 0;
};

/// Some boxes of a node, copied next to each other.
class Selection {
 public:
  /// Copies the boxes of the range that meet `box`.
  void select(const NodeFacets& facets, const NodeFacets::Range& range, const FloatBox& box) {
    const BoxList all = facets.boxes(range);
    slots_.resize(std::max(slots_.size(), all.count));
    size_ = box_kernels().select(all, box, slots_.data());
    const std::size_t filled = NodeFacets::filled(size_);
    for (std::size_t k = 0; k < 6; ++k) {
      std::vector<float>& column = bounds_[k];
      column.resize(std::max(column.size(), all.count));
      for (std::size_t i = 0; i < size_; ++i) column[i] = all.column[k][slots_[i]];
      std::fill(column.begin() + static_cast<std::ptrdiff_t>(size_),
                column.begin() + static_cast<std::ptrdiff_t>(filled), FloatBox{}.bound[k]);
    }
    for (std::size_t i = 0; i < size_; ++i) slots_[i] += range.begin;
  }
  std::size_t size() const { return size_; }
  std::uint32_t slot(std::size_t i) const { return slots_[i]; }
  FloatBox box(std::size_t i) const {
    FloatBox b;
    for (std::size_t k = 0; k < 6; ++k) b.bound[k] = bounds_[k][i];
    return b;
  }
  BoxList boxes() const {
    BoxList list;
    for (std::size_t k = 0; k < 6; ++k) list.column[k] = bounds_[k].data();
    list.count = NodeFacets::filled(size_);
    return list;
  }

 private:
  std::vector<std::uint32_t> slots_;
  std::vector<float> bounds_[6];
  std::size_t size_ = 0;
};

/// A facet of a and a facet of b as one number, ordered by a's facet, then by b's.
struct FacetPairKey {
  std::uint64_t value;
  FacetPairKey(std::uint32_t facet_a, std::uint32_t facet_b) : value(std::uint64_t{facet_a} << 32 | facet_b) {}
  std::uint32_t facet_a() const { return static_cast<std::uint32_t>(value >> 32); }
  std::uint32_t facet_b() const { return static_cast<std::uint32_t>(value); }
  auto operator<=>(const FacetPairKey&) const = default;
};

/// Collects the pairs of facets that intersect. Keeps its memory.
class FacetCrossings {
 public:
  void start(const Collider& a, const Collider& b);
  /// Adds the pairs of which the first node owns a part of a's facet, the second a part of b's. meter: limits the tests
  /// of pairs of facets; null: no limit. Returns false, and adds nothing, if the limit forbids the tests of these
  /// nodes.
  bool add(const NodePair& nodes, Meter* meter = nullptr);
  /// Sorts the pairs. Call it after the last add().
  void finish() { std::sort(keys_.begin(), keys_.end()); }

  /// The pairs, each once; after finish() ascending.
  std::span<const FacetPairKey> pairs() const { return keys_; }
  std::size_t facets_read() const { return facets_a_.facets_read() + facets_b_.facets_read(); }
  std::size_t pairs_tested() const { return tested_.size(); }

 private:
  struct Candidate {
    std::uint32_t slot_a, slot_b;
    FacetPairKey key;
  };
  void collect_candidates(const NodePair& nodes);

  NodeFacets facets_a_, facets_b_;
  Selection near_a_, near_b_;
  PairSet tested_;
  std::vector<std::uint32_t> partners_;
  std::vector<Candidate> candidates_;
  std::vector<FacetPairKey> keys_;
};

}  // namespace morula::detail
