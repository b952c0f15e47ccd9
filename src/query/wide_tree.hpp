// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tree inside TriangleBvh: nodes of four children whose boxes lie side by side, so one pass of the same arithmetic
// tests all four.
#pragma once

#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/parallel/workers.hpp>
#include <vector>

#include "query/oriented_boxes.hpp"

namespace morula::detail::wide {

inline constexpr int width = 4;
/// A child with at most this many facets is a leaf. Larger leaves test more facets, smaller ones visit more nodes.
inline constexpr std::uint32_t largest_leaf = 4;
/// Below this depth the builder halves ranges for any shape, which bounds the depth by largest_depth.
inline constexpr int deepest_shaped_split = 40;
inline constexpr int largest_depth = deepest_shaped_split + 16;
/// A depth-first walk that pushes all children of a node never holds more entries than this.
inline constexpr int stack_size = largest_depth * (width - 1) + width;

struct alignas(64) Node {
  OrientedBoxes boxes;         // boxes of the children
  std::uint32_t first[width];  // by child: its node; for a leaf, the slot of its first facet
  std::uint32_t count[width];  // by child: number of facets of a leaf; 0 for a node
  std::uint32_t leaf[width];   // by child: index of the boxes of a leaf's facets, unless it has only one
  int size;                    // number of used children, which come first
};
static_assert(OrientedBoxes::count == width && largest_leaf <= width);

/// The far field of a child: the winding number's expansion about the area-weighted centroid, see
/// TriangleBvh::winding_number.
struct alignas(64) Clusters {
  double centroid[3][width];
  double area_vector[3][width];
  double moment[6][width];  // ∫ y nᵀ, y from the centroid; xx yy zz, then xy + yx, xz + zx, yz + zy
  double radius[width];     // largest distance of a point of a facet from the centroid
};

struct Tree {
  Box box;  // box of all corners
  Units units;
  std::vector<Node> nodes;            // root first, children after their parents
  std::vector<Clusters> clusters;     // one for each node
  std::vector<FacetBoxes> boxes;      // boxes of the facets of leaves
  std::vector<std::uint32_t> facets;  // by slot: the facet's index in the mesh
  // The mesh's own positions and facets: separate corners would take three times the memory per facet.
  std::vector<Facet> corners;
  std::vector<Vec3> positions;

  Triangle triangle(std::uint32_t facet) const {
    const auto& [a, b, c] = corners[facet];
    return {positions[a], positions[b], positions[c]};
  }
};

/// The result depends only on the mesh, not on the workers.
Tree build(const MeshView& mesh, Workers& workers);

}  // namespace morula::detail::wide
