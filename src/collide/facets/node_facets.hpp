// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facets of the nodes that one query looks at, each node's read once: boxes, and corners in the world.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <vector>

#include "collide/facets/box_kernels.hpp"

namespace morula::detail {

class NodeFacets {
 public:
  /// Forgets all facets, not the memory. origin: what boxes are about.
  void start(const Collider& collider, const Vec3& origin);

  struct Range {
    std::uint32_t begin = 0, size = 0;  ///< of slots; their number without filling
    FloatBox box;                       ///< of them all
  };
  /// A node's facets, read if they have not been. The reference is good until the next call.
  const Range& read(std::uint32_t node);

  /// Boxes of a range, filled up. Good until the next read.
  BoxList boxes(const Range& range) const {
    BoxList list;
    for (std::size_t k = 0; k < 6; ++k) list.column[k] = bounds_[k].data() + range.begin;
    list.count = filled(range.size);
    return list;
  }
  std::uint32_t facet(std::uint32_t slot) const { return facet_[slot]; }
  /// Corners in the world: few are asked for, so they are placed when they are. Good until the next call.
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
  // Of a node: in which query it was read last, and what was found.
  std::vector<std::uint32_t> stamp_;
  std::vector<Range> range_;
  std::uint32_t now_ = 0;
  // Of a slot.
  std::vector<float> bounds_[6];
  std::vector<std::uint32_t> facet_;
  static constexpr std::uint32_t unread = 0xffffffffu;
  std::vector<std::uint32_t> triangle_of_;  // in triangles_
  std::vector<Triangle> triangles_;
  std::size_t used_ = 0, facets_read_ = 0;
};

}  // namespace morula::detail
