// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cells of files that hold more than triangles: polygons, strips and solids, whose surface is the mesh.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <span>
#include <vector>

#include "geometry/solid_faces.hpp"
#include "io/mesh/reading.hpp"

namespace morula::detail {

/// The shapes of cells. The order of corners is that of VTK and Gmsh; cells of higher order give only their corners.
enum class CellShape { none, polygon, strip, pixel, tetrahedron, voxel, hexahedron, wedge, pyramid };

/// The shape for VTK's number of a type of cell; none for cells without a surface here (points, lines).
struct CellType {
  CellShape shape;
  std::size_t corners;  ///< number of corners, which come first in the file; 0: all points of the cell
};
/// Sets the type for a number of VTK. Returns false for unknown types.
bool vtk_cell_type(std::uint64_t number, CellType& type);

/// Collects cells and returns their surface.
class CellSurface {
 public:
  /// Adds a cell. corners: its corners, indices of existing points.
  void add(CellType type, std::span<const std::uint32_t> corners);
  /// The facets of the surface. With solids: the faces that only one solid has, outward, in the order of the solids;
  /// polygons and strips then lie on these faces, or are left out and counted. Without solids: all polygons and strips.
  /// Vertices keep their numbers.
  std::vector<Facet> facets(std::span<const Vec3> points, MeshReading& reading);

 private:
  struct Solid {
    SolidShape shape;
    std::size_t first;  // first corner, in corners_
  };
  struct Polygon {
    std::size_t first, corners;  // first facet in surface_, of a fan about the first corner; number of corners
    std::size_t cell;
  };
  std::vector<Facet> cut_surface(std::span<const Vec3> points, PolygonReader& polygons);
  std::vector<SolidFace> faces_of_solids(std::span<const Vec3> points) const;
  void count_shells(std::span<const SolidFace> faces, MeshReading& reading) const;

  std::size_t cells_ = 0;
  std::vector<Facet> surface_;
  std::vector<Polygon> polygons_;  // polygons of more than three corners
  std::vector<Solid> solids_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace morula::detail
