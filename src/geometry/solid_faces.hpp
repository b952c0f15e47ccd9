// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Faces of solid cells, and the pairs of equal faces by which cells of a volume mesh join: shared by the readers of
// volume meshes and by solid_surface().
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// The fourth corner of a triangular face.
inline constexpr std::uint32_t no_corner = std::numeric_limits<std::uint32_t>::max();

/// The order of corners is that of VTK and Gmsh: the lower face first, then the upper one, or the tip.
enum class SolidShape : std::uint8_t { tetrahedron, hexahedron, wedge, pyramid };

struct SolidFace {
  std::array<std::uint32_t, 4> key;  ///< corners in ascending order; a triangle's last is no_corner
  std::array<std::uint32_t, 4>
      vertices;              ///< corners, counter-clockwise seen from outside; a triangle's last is no_corner
  std::size_t place, solid;  ///< number of the face among all faces, and of its solid

  std::size_t corner_count() const { return vertices[3] == no_corner ? 3 : 4; }
};

/// Six times the volume that the faces of the solid enclose, by sums in double; negative if its corners are
/// mirrored. corners: indices of points.
double signed_volume_of(SolidShape shape, std::span<const Vec3> points, const std::uint32_t* corners);

/// Appends the faces of a solid. is_mirrored: its corners are mirrored, so its faces are turned over.
void add_faces(SolidShape shape, const std::uint32_t* corners, bool is_mirrored, std::size_t solid,
               std::vector<SolidFace>& faces);

/// Sorts the faces, so that equal ones are adjacent; the faces of a run have the order of their places. Interruptible.
void sort_by_key(std::vector<SolidFace>& faces);

/// The end of the run of equal faces that begins at `begin`, of faces in the order of sort_by_key().
std::size_t end_of_run(std::span<const SolidFace> faces, std::size_t begin);

/// Sorts the faces by their places.
void sort_by_place(std::vector<SolidFace>& faces);

}  // namespace morula::detail
