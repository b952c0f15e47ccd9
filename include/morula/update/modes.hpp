// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A modal model: the motion of a mesh's vertices as a few displacement fields and a coordinate for each.
//
//   const morula::Modes modes = morula::read_modes("modes.npy", mesh);  // or the displacements of your solver
//   morula::Body body(mesh, morula::build(mesh), {.rules = {morula::Rule::modal}, .modes = modes});
//   const std::vector<double> coordinates(modes.mode_count, 0.1);       // every frame: a number per mode
//   if (const auto status = body.update_modal(coordinates); !status) std::puts(message(status).c_str());
//   std::vector<morula::Vec3> moved(mesh.vertex_count());               // if the vertices themselves are needed
//   morula::move_by_modes(modes, mesh.positions, coordinates, moved);
#pragma once

#include <cstddef>
#include <morula/geometry/vector.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

namespace morula {

struct Modes;

/// Writes rest[i] + sum_j coordinates[j] U_ij for each vertex i to `positions`, computed in double, with modes added in
/// order. Body::update_modal() uses the same positions.
///
/// coordinates: one per mode. rest, positions: one per vertex of the modes. Modes whose coordinate is 0 are skipped, so
/// at rest the positions equal `rest` bit for bit. Allocates nothing. The result has the same bits for any number of
/// workers. Cost: vertices × modes.
void move_by_modes(const Modes& modes, std::span<const Vec3> rest, std::span<const double> coordinates,
                   std::span<Vec3> positions, Workers& workers = serial_workers()) noexcept;

/// Displacement fields U of a mesh's vertices: at the coordinates q, vertex i is at rest_i + sum_j q_j U_ij.
/// Coordinates have no unit; displacements are in mesh units. The caller chooses the scale of each mode.
struct Modes {
  std::size_t vertex_count = 0;     ///< number of the mesh's vertices, including unused ones
  std::size_t mode_count = 0;       ///< 0: no modal model
  std::vector<Vec3> displacements;  ///< mode after mode, one displacement per vertex: mode_count × vertex_count

  bool empty() const { return mode_count == 0; }
  std::span<const Vec3> mode(std::size_t j) const {
    return std::span(displacements).subspan(j * vertex_count, vertex_count);
  }
};

}  // namespace morula
