// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The paper's links: which vertices a sphere looks at [garcia2005, sec. 3.1].
#pragma once

#include <morula/query/triangle_bvh.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <vector>

namespace morula::detail {

struct Links {
  std::vector<std::uint32_t> vertices;  ///< of the mesh, ascending, each once; never empty
  bool fallback = false;                ///< nothing was where it was looked for
};

/// The three vertices of every facet that meets the closed ball, inside or outside of it; of the nearest facet where
/// none does (fallback).
Links linked_vertices(const Mesh& mesh, const TriangleBvh& bvh, const Sphere& ball);

/// The vertices inside the closed ball of a node. Where there are none (fallback, a void sphere), those of the nearest
/// facet that meets the ball; where there is none either, what the node's parent has; at the root, the nearest facet's.
Links enclosed_vertices(const Mesh& mesh, const TriangleBvh& bvh, const SphereTree& tree, std::uint32_t node);

/// A third of each facet's area to each of its vertices, at rest.
std::vector<double> vertex_areas(const Mesh& mesh);

}  // namespace morula::detail
