// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A modal model: how the vertices of a mesh move, as a few displacement fields and a coordinate for each.
#pragma once

#include <cstddef>
#include <morula/geometry/vector.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

namespace morula {

/// Displacement fields U of a mesh's vertices: at the coordinates q, vertex i is at rest_i + sum_j q_j U_ij.
/// Coordinates have no unit, displacements that of the mesh; what a mode is scaled by is up to the caller.
struct Modes {
  std::size_t vertex_count = 0;     ///< of the mesh, vertices that no facet uses included
  std::size_t mode_count = 0;       ///< 0: no modal model
  std::vector<Vec3> displacements;  ///< mode after mode, one per vertex: mode_count × vertex_count

  bool empty() const { return mode_count == 0; }
  std::span<const Vec3> mode(std::size_t j) const {
    return std::span(displacements).subspan(j * vertex_count, vertex_count);
  }
};

/// positions[i] = rest[i] + sum_j coordinates[j] U_ij, in double, modes added in order: what Body::update_modal
/// follows. All sizes must be those of the modes. Modes whose coordinate is 0 are passed over, so that at rest the
/// positions are `rest` bit for bit. No allocation. Same bits for any number of workers. Cost: vertices × modes.
void move_by_modes(const Modes& modes, std::span<const Vec3> rest, std::span<const double> coordinates,
                   std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

}  // namespace morula
