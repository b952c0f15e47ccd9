// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Edges of facets and rest areas of edges, made once per surface; and present positions of the vertices of some facets.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/geometry/triangle.hpp>
#include <span>
#include <vector>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

class LayerMesh {
 public:
  /// Makes the tables, unless they are those of the surface already.
  void start(const SurfaceTreeState& surface);
  bool is_of(const SurfaceTreeState& surface) const { return surface_ == &surface; }
  /// Reads the vertices of a facet, about an origin.
  void read(std::uint32_t facet, const Vec3& origin) {
    for (const std::uint32_t v : corners(facet)) at_[v] = surface_->from_of(v) - origin;
  }

  const Facet& corners(std::uint32_t facet) const { return surface_->mesh.facets[facet]; }
  /// A facet with a repeated vertex has no area and no edges here.
  bool is_usable(std::uint32_t facet) const { return edges_[facet][0] != none; }
  /// Edge k of a facet joins its corners k and k + 1.
  const std::array<std::uint32_t, 3>& edges(std::uint32_t facet) const { return edges_[facet]; }
  const std::array<std::uint32_t, 2>& ends(std::uint32_t edge) const { return surface_->mesh.edges[edge]; }
  std::span<const std::uint32_t> facets_of_edge(std::uint32_t edge) const {
    return std::span(facets_).subspan(facets_begin_[edge], facets_begin_[edge + 1] - facets_begin_[edge]);
  }
  /// A third of the rest area of the facets that have the edge.
  double rest_area(std::uint32_t edge) const { return rest_area_[edge]; }
  std::size_t vertex_count() const { return at_.size(); }
  std::size_t facet_count() const { return edges_.size(); }

  /// Position as read() left it.
  const Vec3& at(std::uint32_t vertex) const { return at_[vertex]; }
  Triangle triangle(std::uint32_t facet) const {
    const Facet& f = corners(facet);
    return {at_[f[0]], at_[f[1]], at_[f[2]]};
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  const SurfaceTreeState* surface_ = nullptr;
  std::shared_ptr<const SurfaceTreeState> kept_;  // so that no other surface has its address
  std::vector<std::array<std::uint32_t, 3>> edges_;
  std::vector<std::uint32_t> facets_begin_, facets_;
  std::vector<double> rest_area_;
  std::vector<Vec3> at_;
};

/// Unit normal of a triangle with a longest edge of length > 0; none, of length 0, if its height is less than about
/// 1e-8 of that edge: such a triangle counts as its longest edge.
struct LayerNormal {
  Vec3 normal;
  int longest = 0;  ///< the edge from corner `longest` to the next one
  double double_area = 0;

  explicit LayerNormal(const Triangle& t);
  bool is_segment() const { return double_area == 0; }
};

}  // namespace morula::detail
