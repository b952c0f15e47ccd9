// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes over the facets of one surface, for pairs of its own facets and for half lines. Boxes are those of the corners
// without rounding, so no facet is missed; spheres of a body overlap their neighbors too much to find such pairs.
#pragma once

#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <span>
#include <vector>

namespace morula::detail {

class SelfTree {
 public:
  /// Sorts the facets by the given positions. Cost: O(F log F) for F facets.
  SelfTree(std::span<const Facet> facets, std::span<const Vec3> world);
  /// Boxes of the present positions. Cost: linear.
  void update(std::span<const Facet> facets, std::span<const Vec3> world);

  const Box& bounds() const { return nodes_[0].box; }
  /// Calls f(facet, facet) once for every two facets whose boxes have a common point.
  template <class F>
  void each_pair(const F& f) const {
    within(0, f);
  }
  /// Calls f(facet) for every facet whose box the half line from `from` along the axis meets.
  template <class F>
  void each_on_half_line(const Vec3& from, int axis, int sign, const F& f) const {
    on_half_line(0, from, axis, sign, f);
  }

 private:
  // The first child follows its node. Leaves have no second child.
  struct Node {
    Box box;
    std::uint32_t second, begin, end;  // facets: a range of order_
    bool is_leaf() const { return second == 0; }
  };
  static bool meet(const Box& s, const Box& t) {
    return s.lower.x <= t.upper.x && t.lower.x <= s.upper.x && s.lower.y <= t.upper.y && t.lower.y <= s.upper.y &&
           s.lower.z <= t.upper.z && t.lower.z <= s.upper.z;
  }
  static bool meets_half_line(const Box& box, const Vec3& from, int axis, int sign) {
    for (int k = 0; k < 3; ++k)
      if (k != axis && !(box.lower[k] <= from[k] && from[k] <= box.upper[k])) return false;
    return sign > 0 ? box.upper[axis] >= from[axis] : box.lower[axis] <= from[axis];
  }
  void split(std::vector<Vec3>& middles, std::uint32_t begin, std::uint32_t end);

  template <class F>
  void within(std::uint32_t n, const F& f) const {
    const Node& node = nodes_[n];
    if (!node.is_leaf()) {
      within(n + 1, f);
      within(node.second, f);
      between(n + 1, node.second, f);
      return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      for (std::uint32_t j = i + 1; j < node.end; ++j)
        if (meet(boxes_[i], boxes_[j])) f(order_[i], order_[j]);
  }
  template <class F>
  void between(std::uint32_t m, std::uint32_t n, const F& f) const {
    const Node &a = nodes_[m], &b = nodes_[n];
    if (!meet(a.box, b.box)) return;
    if (a.is_leaf() && b.is_leaf()) {
      for (std::uint32_t i = a.begin; i < a.end; ++i) {
        if (!meet(boxes_[i], b.box)) continue;
        for (std::uint32_t j = b.begin; j < b.end; ++j)
          if (meet(boxes_[i], boxes_[j])) f(order_[i], order_[j]);
      }
    } else if (b.is_leaf() || (!a.is_leaf() && a.end - a.begin >= b.end - b.begin)) {
      between(m + 1, n, f);
      between(a.second, n, f);
    } else {
      between(m, n + 1, f);
      between(m, b.second, f);
    }
  }
  template <class F>
  void on_half_line(std::uint32_t n, const Vec3& from, int axis, int sign, const F& f) const {
    const Node& node = nodes_[n];
    if (!meets_half_line(node.box, from, axis, sign)) return;
    if (!node.is_leaf()) {
      on_half_line(n + 1, from, axis, sign, f);
      on_half_line(node.second, from, axis, sign, f);
      return;
    }
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (meets_half_line(boxes_[i], from, axis, sign)) f(order_[i]);
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
  std::vector<Box> boxes_;  // in this order
};

}  // namespace morula::detail
