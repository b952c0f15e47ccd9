// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A mesh without the vertices that no facet uses, such as the inner points of a solid.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <vector>

namespace morula {

struct UsedVertices {
  Mesh mesh;
  std::vector<std::uint32_t> index;  ///< of every vertex of `mesh`: its number before, ascending
};
/// Vertices keep their order and facets theirs.
UsedVertices used_vertices(const Mesh& mesh);

}  // namespace morula
