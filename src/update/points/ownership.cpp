// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/ownership.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

#include "update/points/facet_hull.hpp"

namespace morula::detail {
namespace {

// Position of a corner in the plane of a facet. Nothing for a corner that is not on it, which only an imported cover
// can have, and on a facet with a repeated vertex, whose plane has no such weights: such corners are never left out.
std::optional<FacetPoint> in_facet(const Cover& cover, const Facet& facet, std::uint32_t corner) {
  if (facet[0] == facet[1] || facet[1] == facet[2] || facet[2] == facet[0]) return std::nullopt;
  FacetPoint p{corner, 0, 0};
  bool on_facet = true;
  const auto add = [&](std::uint32_t vertex, double weight) {
    if (vertex == facet[1])
      p.x += weight;
    else if (vertex == facet[2])
      p.y += weight;
    else
      on_facet = on_facet && (vertex == facet[0] || weight == 0);
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
    for (int k = 0; k < 3; ++k) add(cut.vertex[k], cut.weight[k]);
  }
  if (!on_facet) return std::nullopt;
  return p;
}

// Finds the cut corners that a node has to test.
class NeededCuts {
 public:
  NeededCuts(const MeshView& mesh, const Cover& cover, double tolerance)
      : mesh_(mesh), cover_(cover), tolerance_(tolerance) {}

  // owns(v): whether the node owns a vertex. needs(c): whether a cut corner has to be surrounded; the needed ones
  // are among these. Each is listed once.
  template <class Owns, class Needs>
  const std::vector<std::uint32_t>& of(std::uint32_t node, const Owns& owns, const Needs& needs) {
    patches_.clear();
    const auto is_cut = [&](std::uint32_t corner) { return corner >= cover_.vertex_count; };
    for (std::uint32_t p = cover_.region_begin[node]; p < cover_.region_end[node]; ++p)
      if (const auto corners = cover_.patch(p); std::any_of(corners.begin(), corners.end(), is_cut))
        patches_.push_back(p);
    std::sort(patches_.begin(), patches_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(cover_.patch_facet[a], a) < std::tie(cover_.patch_facet[b], b);
    });
    needed_.clear();
    for (std::size_t i = 0; i < patches_.size();) {
      const std::uint32_t f = cover_.patch_facet[patches_[i]];
      const Facet& facet = mesh_.facets[f];
      points_.clear();
      for (; i < patches_.size() && cover_.patch_facet[patches_[i]] == f; ++i)
        for (const std::uint32_t c : cover_.patch(patches_[i])) {
          if (c < cover_.vertex_count || !needs(c)) continue;
          if (const auto p = in_facet(cover_, facet, c))
            points_.push_back(*p);
          else
            needed_.push_back(c);
        }
      // mutant owned-facet-taken-for-whole: `(std::all_of ... && lie_in_facet())` -> `lie_in_facet()`
      if (points_.empty() || (std::all_of(facet.begin(), facet.end(), owns) && lie_in_facet())) continue;
      for (const std::uint32_t v : facet)
        // mutant owned-by-any-leaf: `if (owns(v)) points_.push_back` -> `points_.push_back`
        if (owns(v)) points_.push_back(*in_facet(cover_, facet, v));
      for (const FacetPoint& p : hull_.surround(points_, tolerance_))
        // mutant owned-cut-point-lost: `=` -> ``
        if (p.corner >= cover_.vertex_count) needed_.push_back(p.corner);
    }
    std::sort(needed_.begin(), needed_.end());
    needed_.erase(std::unique(needed_.begin(), needed_.end()), needed_.end());
    return needed_;
  }

 private:
  // Whether all corners of a facet lie within the tolerance of it: if its vertices are owned, no hull has to be
  // computed. A corner outside is off along x or y by as much as each of its weights is negative, and then by the
  // excess of the sum of the two. That computation rounds, so the result is false for a tolerance of 0.
  bool lie_in_facet() const {
    if (!(tolerance_ > 0)) return false;
    return std::all_of(points_.begin(), points_.end(), [&](const FacetPoint& p) {
      const double x = std::max(p.x, 0.0), y = std::max(p.y, 0.0);
      return (x - p.x) + (y - p.y) + std::max(x + y - 1, 0.0) <= tolerance_;
    });
  }

  MeshView mesh_;
  const Cover& cover_;
  double tolerance_;
  std::vector<std::uint32_t> patches_, needed_;
  std::vector<FacetPoint> points_;
  FacetHull hull_;
};

}  // namespace

bool is_on_edge(const CutPoint& c) {
  return std::count(c.weight.begin(), c.weight.end(), 0.0) > 0;
}

void require_belonging(const MeshView& mesh, const CoveredTree& model) {
  require_usable(mesh);
  if (const auto faults = validate(model.tree); !faults.empty())
    throw std::invalid_argument("the sphere tree is not usable: " + faults.front());
  const auto differ = [](const std::string& how) {
    throw std::invalid_argument("mesh and tree do not belong together: " + how);
  };
  const auto expect_count = [&](std::uint32_t in_cover, std::size_t in_mesh, const char* what) {
    if (in_cover != in_mesh)
      differ("the cover is for " + std::to_string(in_cover) + what + ", the mesh has " + std::to_string(in_mesh));
  };
  expect_count(model.cover.vertex_count, mesh.vertex_count(), " vertices");
  expect_count(model.cover.facet_count, mesh.facet_count(), " facets");
  if (const auto faults = validate(model.tree, model.cover); !faults.empty()) differ(faults.front());
  // Equal counts are no proof: frames of one body on the tree of another would pass unnoticed.
  if (model.report.mesh_hash != 0 && model.report.mesh_hash != mesh_hash(mesh))
    differ("the tree was made from a mesh of another hash");
}

LeafOrder depth_first_leaves(const SphereTree& tree) {
  LeafOrder order;
  order.begin.resize(tree.node_count());
  order.end.resize(tree.node_count());
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    order.begin[node] = static_cast<std::uint32_t>(order.leaves.size());
    if (tree.is_leaf(node)) order.leaves.push_back(node);
    for (std::uint32_t c = tree.child_count[node]; c-- > 0;) open.push_back(tree.first_child[node] + c);
  }
  // Children have higher numbers than their parent.
  for (auto node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;)
    order.end[node] =
        tree.is_leaf(node) ? order.begin[node] + 1 : order.end[tree.first_child[node] + tree.child_count[node] - 1];
  return order;
}

// Cut points of leaf after leaf join the vertices that the leaves own.
static void add_cuts(std::span<const std::uint32_t> cuts, std::span<const std::uint32_t> cut_begin,
                     Ownership& ownership) {
  std::vector<std::uint32_t> merged, merged_begin{0};
  for (std::size_t k = 0; k + 1 < cut_begin.size(); ++k) {
    const auto owned = ownership.of_leaf(k);
    merged.insert(merged.end(), owned.begin(), owned.end());
    merged.insert(merged.end(), cuts.begin() + cut_begin[k], cuts.begin() + cut_begin[k + 1]);
    std::sort(merged.begin() + merged_begin.back(), merged.end());
    merged_begin.push_back(static_cast<std::uint32_t>(merged.size()));
  }
  ownership.points = std::move(merged);
  ownership.begin = std::move(merged_begin);
}

Ownership share_points(const MeshView& mesh, const Cover& cover, const LeafOrder& order,
                       std::span<const std::uint8_t> needs_cut_points, double tolerance) {
  constexpr std::uint32_t none = 0xffffffffu;
  Ownership result;
  result.begin.push_back(0);
  std::vector<std::uint32_t> number(mesh.vertex_count() + cover.cut_points.size(), none);
  std::vector<std::uint32_t> owner(mesh.vertex_count(), none);  // last leaf seen to own a vertex
  NeededCuts needed_cuts(mesh, cover, tolerance);
  std::vector<std::uint32_t> cuts, cut_begin{0};  // cover corners, leaf after leaf
  std::vector<std::uint32_t> vertices;            // vertices of one leaf

  // Vertices come first: cut points get the numbers after the last of them.
  for (std::uint32_t k = 0; k < order.leaves.size(); ++k) {
    vertices.clear();
    const auto corners = cover.region_corners(order.leaves[k]);
    for (const std::uint32_t c : corners)
      if (c < cover.vertex_count && owner[c] != k) owner[c] = k, vertices.push_back(c);
    if (needs_cut_points[k]) {
      const auto& needed = needed_cuts.of(
          order.leaves[k], [&](std::uint32_t v) { return owner[v] == k; }, [](std::uint32_t) { return true; });
      cuts.insert(cuts.end(), needed.begin(), needed.end());
    }
    cut_begin.push_back(static_cast<std::uint32_t>(cuts.size()));
    std::sort(vertices.begin(), vertices.end());
    for (const std::uint32_t v : vertices) {
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.push_back(v);
      }
      result.points.push_back(number[v]);
    }
    result.begin.push_back(static_cast<std::uint32_t>(result.points.size()));
  }
  // Adds vertices of facets that no patch has as a corner: cut points and links may still refer to them.
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f)
      if (number[v] == none) {
        number[v] = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.push_back(v);
      }

  for (const bool on_edge : {true, false}) {
    const auto give_number = [&](std::uint32_t c) {
      if (number[c] != none || is_on_edge(cover.cut_points[c - cover.vertex_count]) != on_edge) return;
      number[c] = static_cast<std::uint32_t>(result.vertices.size() + result.cut_points.size());
      result.cut_points.push_back(c - cover.vertex_count);
    };
    for (const std::uint32_t c : cuts) give_number(c);
  }

  for (std::uint32_t& c : cuts) c = number[c];
  add_cuts(cuts, cut_begin, result);
  return result;
}

std::vector<std::uint32_t> corners_of(const Ownership& ownership, const Cover& cover, std::uint32_t first_leaf,
                                      std::uint32_t end_leaf) {
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = ownership.begin[first_leaf]; i < ownership.begin[end_leaf]; ++i) {
    const std::uint32_t point = ownership.points[i];
    const std::size_t vertices = ownership.vertices.size();
    corners.push_back(point < vertices ? ownership.vertices[point]
                                       : cover.vertex_count + ownership.cut_points[point - vertices]);
  }
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

void share_levels(const MeshView& mesh, const SphereTree& tree, const Cover& cover, const LeafOrder& order,
                  double tolerance, Ownership& ownership) {
  constexpr std::uint32_t none = 0xffffffffu;
  // Points by corner, and the node that has last seen a point.
  std::vector<std::uint32_t> point_of(mesh.vertex_count() + cover.cut_points.size(), none);
  for (std::uint32_t i = 0; i < ownership.vertices.size(); ++i) point_of[ownership.vertices[i]] = i;
  const auto vertex_count = static_cast<std::uint32_t>(ownership.vertices.size());
  for (std::uint32_t i = 0; i < ownership.cut_points.size(); ++i)
    point_of[cover.vertex_count + ownership.cut_points[i]] = vertex_count + i;
  std::vector<std::uint32_t> seen_by(vertex_count + ownership.cut_points.size(), none), needed_by = seen_by;
  NeededCuts needed_cuts(mesh, cover, tolerance);

  std::vector<std::uint32_t>& from = ownership.tested_from;
  from.assign(ownership.points.size(), none);
  // Loops from the deepest level up, so that the uppermost level remains.
  for (auto node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
    const std::uint32_t level = tree.level_of(node);
    const std::uint32_t begin = ownership.begin[order.begin[node]], end = ownership.begin[order.end[node]];
    if (tree.is_leaf(node)) {
      std::fill(&from[begin], &from[end], level);
      continue;
    }
    for (std::uint32_t i = begin; i < end; ++i) seen_by[ownership.points[i]] = node;
    const auto is_seen = [&](std::uint32_t corner) {
      // mutant owned-by-another-node-above: `none && seen_by[point_of[corner]] == node` -> `none`
      return point_of[corner] != none && seen_by[point_of[corner]] == node;
    };
    for (const std::uint32_t c : needed_cuts.of(node, is_seen, is_seen)) needed_by[point_of[c]] = node;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::uint32_t p = ownership.points[i];
      // mutant owned-cuts-forgotten-above: `(p >= vertex_count && needed_by[p] != node)` -> `p >= vertex_count`
      if (seen_by[p] != node || (p >= vertex_count && needed_by[p] != node)) continue;
      from[i] = level;
      seen_by[p] = none;  // a point stays in the first leaf alone
    }
  }
}

}  // namespace morula::detail
