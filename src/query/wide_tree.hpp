// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tree inside TriangleBvh: nodes of four children whose boxes lie side by side, so one pass of the same arithmetic
// tests all four.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/parallel/workers.hpp>
#include <vector>

#include "query/lanes.hpp"

namespace morula::wide {

inline constexpr int width = 4;
/// A child with at most this many facets is a leaf. Larger leaves test more facets, smaller ones visit more nodes.
inline constexpr std::uint32_t largest_leaf = 4;
/// Below this depth the builder halves ranges whatever their shape, which bounds the depth by largest_depth.
inline constexpr int deepest_shaped_split = 40;
inline constexpr int largest_depth = deepest_shaped_split + 16;
/// A depth-first walk that pushes all children of a node never holds more entries than this.
inline constexpr int stack_size = largest_depth * (width - 1) + width;

struct alignas(64) Node {
  double lower[3][width];  // boxes hold the computed nearest points of their facets, see facet_box
  double upper[3][width];
  std::uint32_t first[width];  // the child's node; in a leaf, the slot of its first facet
  std::uint32_t count[width];  // facets of a leaf; 0 where the child is a node
  int size;                    // children in use, the first ones
};

/// What a child looks like from afar: the winding number's expansion about the area-weighted centroid, see
/// TriangleBvh::winding_number.
struct alignas(64) Clusters {
  double centroid[3][width];
  double area_vector[3][width];
  double moment[6][width];  // ∫ y nᵀ, y from the centroid; xx yy zz, then xy + yx, xz + zx, yz + zy
  double radius[width];     // no facet reaches farther from the centroid
};

struct Tree {
  std::vector<Node> nodes;            // root first, children after their parents
  std::vector<Clusters> clusters;     // one for each node
  std::vector<std::uint32_t> facets;  // by slot: the facet's index in the mesh
  std::vector<Triangle> triangles;    // by slot
  std::vector<std::uint32_t> slots;   // by facet
};

/// Depends on the mesh alone, not on the workers.
Tree build(const Mesh& mesh, Workers& workers);

/// Squared distances from p to the boxes of all children, in the order of operations of squared_length, so that
/// rounding is monotone: never more than the squared distance to a point inside the box.
inline void squared_distances(const Node& node, const Vec3& p, double* result) {
  using namespace lanes;
  const Double2 zero = both(0), x = both(p.x), y = both(p.y), z = both(p.z);
  for (int k = 0; k < width; k += 2) {
    const Double2 dx = max(max(load(node.lower[0] + k) - x, x - load(node.upper[0] + k)), zero);
    const Double2 dy = max(max(load(node.lower[1] + k) - y, y - load(node.upper[1] + k)), zero);
    const Double2 dz = max(max(load(node.lower[2] + k) - z, z - load(node.upper[2] + k)), zero);
    store(dx * dx + dy * dy + dz * dz, result + k);
  }
}

}  // namespace morula::wide
