// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/box_tree.hpp"

#include <algorithm>

#include "geometry/rounded_up.hpp"

namespace morula::detail {
namespace {

float surface(const OuterBox& b) {
  const float x = b.upper[0] - b.lower[0], y = b.upper[1] - b.lower[1], z = b.upper[2] - b.lower[2];
  return x * y + y * z + z * x;
}

}  // namespace

OuterBox float_box(const Box& box) {
  OuterBox narrow{};
  for (int axis = 0; axis < 3; ++axis) {
    narrow.lower[axis] = -rounded_up(-box.lower[axis]);
    narrow.upper[axis] = rounded_up(box.upper[axis]);
  }
  return narrow;
}

OuterBox joined(const OuterBox& a, const OuterBox& b) {
  OuterBox both{};
  for (int axis = 0; axis < 3; ++axis) {
    both.lower[axis] = std::min(a.lower[axis], b.lower[axis]);
    both.upper[axis] = std::max(a.upper[axis], b.upper[axis]);
  }
  return both;
}

std::uint32_t BoxTree::take() {
  if (!free_.empty()) {
    const std::uint32_t node = free_.back();
    free_.pop_back();
    return node;
  }
  nodes_.emplace_back();
  parent_.push_back(none);
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

// A leaf takes two nodes: itself and the node above it.
void BoxTree::reserve() {
  const std::size_t needed = nodes_.size() + 2;
  if (needed > nodes_.capacity()) nodes_.reserve(2 * needed);
  parent_.reserve(nodes_.capacity());
  // Reserves room, so that a return allocates nothing.
  free_.reserve(nodes_.capacity());
}

void BoxTree::reserve(std::size_t leaves) {
  nodes_.reserve(2 * leaves);
  parent_.reserve(nodes_.capacity());
  free_.reserve(nodes_.capacity());
  stack_.reserve(nodes_.capacity());
}

void BoxTree::replace_child(std::uint32_t parent, std::uint32_t before, std::uint32_t after) {
  parent_[after] = parent;
  if (parent == none) {
    root_ = after;
  } else {
    (nodes_[parent].left == before ? nodes_[parent].left : nodes_[parent].right) = after;
  }
}

std::uint32_t BoxTree::insert(const OuterBox& box, std::uint32_t item) {
  const std::uint32_t leaf = take();
  nodes_[leaf] = {box, item, none};
  parent_[leaf] = none;
  if (root_ == none) return root_ = leaf;
  std::uint32_t sibling = root_;
  float inherited = 0;
  while (nodes_[sibling].right != none) {
    const Node& node = nodes_[sibling];
    const float whole = surface(joined(node.box, box));
    const float here = whole + inherited, below = inherited + (whole - surface(node.box));
    const auto cost_of = [&](std::uint32_t child) {
      const Node& c = nodes_[child];
      const float grown = surface(joined(c.box, box));
      return below + (c.right == none ? grown : grown - surface(c.box));
    };
    const float left = cost_of(node.left), right = cost_of(node.right);
    // If surface areas are NaN, any place is valid.
    if (here < left && here < right) break;
    inherited = below;
    sibling = right < left ? node.right : node.left;
  }
  const std::uint32_t parent = take();
  const std::uint32_t above = parent_[sibling];
  replace_child(above, sibling, parent);
  nodes_[parent] = {joined(nodes_[sibling].box, box), sibling, leaf};
  parent_[sibling] = parent_[leaf] = parent;
  mend(above);
  return leaf;
}

void BoxTree::remove(std::uint32_t leaf) {
  const std::uint32_t parent = parent_[leaf];
  free_.push_back(leaf);
  if (parent == none) {
    root_ = none;
    return;
  }
  const std::uint32_t sibling = nodes_[parent].left == leaf ? nodes_[parent].right : nodes_[parent].left;
  const std::uint32_t above = parent_[parent];
  replace_child(above, parent, sibling);
  free_.push_back(parent);
  mend(above);
}

void BoxTree::mend(std::uint32_t node) {
  for (; node != none; node = parent_[node]) {
    nodes_[node].box = joined(nodes_[nodes_[node].left].box, nodes_[nodes_[node].right].box);
    turn(node);
  }
}

// Makes the exchange that saves most surface, of the four between a child and a grandchild below the other child.
void BoxTree::turn(std::uint32_t node) {
  const std::uint32_t children[2] = {nodes_[node].left, nodes_[node].right};
  float best = 0;
  std::uint32_t moved_down = none, moved_up = none;
  for (int side = 0; side < 2; ++side) {
    const std::uint32_t down = children[side], opened = children[1 - side];
    if (nodes_[opened].right == none) continue;
    const float before = surface(nodes_[opened].box);
    for (const bool left : {true, false}) {
      const std::uint32_t up = left ? nodes_[opened].left : nodes_[opened].right;
      const std::uint32_t stays = left ? nodes_[opened].right : nodes_[opened].left;
      const float saved = before - surface(joined(nodes_[stays].box, nodes_[down].box));
      if (saved > best) best = saved, moved_down = down, moved_up = up;
    }
  }
  if (moved_down == none) return;
  const std::uint32_t opened = parent_[moved_up];
  replace_child(node, moved_down, moved_up);
  replace_child(opened, moved_up, moved_down);
  nodes_[opened].box = joined(nodes_[nodes_[opened].left].box, nodes_[nodes_[opened].right].box);
}

}  // namespace morula::detail
