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

#include "simd/float4.hpp"

namespace morula::detail::wide {

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

/// Slabs across small clusters: parallel planes, at right angles to the mean normal, with all facets between them.
/// Where the surface is smooth they are far thinner than boxes, and most facets that are nearly nearest are never
/// looked at.
struct alignas(64) Slabs {
  double normal[3][width];  // unit or zero
  double lower[width];
  double upper[width];
};

struct Tree {
  Box box;                            // of all corners
  std::vector<Node> nodes;            // root first, children after their parents
  std::vector<Slabs> slabs;           // one for each node
  std::vector<Clusters> clusters;     // one for each node
  std::vector<std::uint32_t> facets;  // by slot: the facet's index in the mesh
  std::vector<Triangle> triangles;    // by slot
  std::vector<std::uint32_t> slots;   // by facet
};

/// Depends on the mesh alone, not on the workers.
Tree build(const MeshView& mesh, Workers& workers);

/// Squared distances from p to the boxes of all children, in the order of operations of squared_length, so that
/// rounding is monotone: never more than the squared distance to a point inside the box.
inline void squared_distances(const Node& node, const Vec3& p, double* result) {
  const Double2 zero(0), x(p.x), y(p.y), z(p.z);
  for (int k = 0; k < width; k += 2) {
    const Double2 dx = max(max(Double2::load(node.lower[0] + k) - x, x - Double2::load(node.upper[0] + k)), zero);
    const Double2 dy = max(max(Double2::load(node.lower[1] + k) - y, y - Double2::load(node.upper[1] + k)), zero);
    const Double2 dz = max(max(Double2::load(node.lower[2] + k) - z, z - Double2::load(node.upper[2] + k)), zero);
    (dx * dx + dy * dy + dz * dz).store(result + k);
  }
}

/// The same for slabs; raises `result` where the slab is farther. Never more than the computed squared distance to a
/// facet, like squared_distances().
inline void raise_to_slabs(const Slabs& slabs, const Vec3& p, double* result) {
  // Heights and normals are rounded by a few ulps of the point's coordinates: of the surface's, which the slabs are
  // padded by, and of the distance.
  const Double2 sure(1 - 0x1p-44), zero(0), x(p.x), y(p.y), z(p.z);
  for (int k = 0; k < width; k += 2) {
    const Double2 height = x * Double2::load(slabs.normal[0] + k) + y * Double2::load(slabs.normal[1] + k) +
                           z * Double2::load(slabs.normal[2] + k);
    const Double2 gap =
        max(max(Double2::load(slabs.lower + k) - height, height - Double2::load(slabs.upper + k)), zero) * sure;
    max(gap * gap, Double2::load(result + k)).store(result + k);
  }
}

}  // namespace morula::detail::wide
