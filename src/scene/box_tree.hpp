// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Box tree: a binary tree over boxes that come, go and move.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <morula/geometry/box.hpp>
#include <new>
#include <vector>

namespace morula::detail {

/// Throws std::bad_alloc for sizes of 2^32 and more: there are no such numbers, and products of sizes would overflow.
inline void require_reservable(std::initializer_list<std::size_t> sizes) {
  for (const std::size_t size : sizes)
    // mutant scene-reserve-overflows: `std::uint64_t{1} << 32` -> `~std::uint64_t{0}`
    if (std::uint64_t{size} >= std::uint64_t{1} << 32) throw std::bad_alloc();
}

/// A box in float, rounded outwards; bounds beyond the range of float are infinite.
struct OuterBox {
  float lower[3], upper[3];
  bool overlaps(const OuterBox& other) const {
    return lower[0] <= other.upper[0] && other.lower[0] <= upper[0] && lower[1] <= other.upper[1] &&
           other.lower[1] <= upper[1] && lower[2] <= other.upper[2] && other.lower[2] <= upper[2];
  }
  bool contains(const OuterBox& other) const {
    return lower[0] <= other.lower[0] && other.upper[0] <= upper[0] && lower[1] <= other.lower[1] &&
           other.upper[1] <= upper[1] && lower[2] <= other.lower[2] && other.upper[2] <= upper[2];
  }
};
OuterBox float_box(const Box& box);
OuterBox joined(const OuterBox& a, const OuterBox& b);

/// A leaf is inserted where the boxes on its path grow least in surface; on the way back up, a node and the child of
/// its sibling change places where that makes the sibling smaller [kopta2012].
class BoxTree {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// Makes room for one more leaf: the next insert() allocates nothing and does not throw.
  void reserve();
  /// Makes room for so many leaves in all; insert(), remove() and visit() then allocate nothing.
  void reserve(std::size_t leaves);
  /// Returns the leaf. Requires room: by reserve(), or by an earlier remove() of another leaf.
  std::uint32_t insert(const OuterBox& box, std::uint32_t item);
  void remove(std::uint32_t leaf);
  const OuterBox& box(std::uint32_t node) const { return nodes_[node].box; }

  /// Calls f(item) for the leaves for which reaches(box) holds, as it does for all boxes above. The order is
  /// unspecified.
  template <class Reaches, class F>
  void visit(const Reaches& reaches, const F& f) const {
    if (root_ == none) return;
    std::vector<std::uint32_t>& stack = stack_;
    stack.clear();
    stack.push_back(root_);
    while (!stack.empty()) {
      const Node& node = nodes_[stack.back()];
      stack.pop_back();
      if (!reaches(node.box)) continue;
      if (node.right == none) {
        f(node.left);
      } else {
        stack.push_back(node.left);
        stack.push_back(node.right);
      }
    }
  }

 private:
  struct Node {
    OuterBox box;
    std::uint32_t left, right;  // children; for a leaf: the item, none
  };

  std::uint32_t take();
  void replace_child(std::uint32_t parent, std::uint32_t before, std::uint32_t after);
  void mend(std::uint32_t node);
  void turn(std::uint32_t node);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint32_t> free_;
  mutable std::vector<std::uint32_t> stack_;
  std::uint32_t root_ = none;
};

}  // namespace morula::detail
