// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cells of files that hold more than triangles: polygons, strips and solids, of which the surface is taken.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <span>
#include <vector>

#include "io/mesh/reading.hpp"

namespace morula::detail {

/// What a surface is made of. Corners are numbered as VTK numbers them, as Gmsh does, too; higher orders give their
/// corners alone.
enum class CellShape { none, polygon, strip, pixel, tetrahedron, voxel, hexahedron, wedge, pyramid };

/// Of VTK's number for a type of cell; nothing for what has no surface of its own here (points, lines) …
struct CellType {
  CellShape shape;
  std::size_t corners;  ///< how many come first in the file; 0: as many as there are
};
/// … and false for types that are not known.
bool vtk_cell_type(std::uint64_t number, CellType& type);

/// Gathers cells, and gives their surface.
class CellSurface {
 public:
  /// corners: of one cell, indices of points that are there.
  void add(CellType type, std::span<const std::uint32_t> corners);
  /// Of solids, the faces that only one of them has, outward, in the order of the solids; polygons and strips beside
  /// them lie on their faces, or are left out and counted. Without solids, all polygons and strips. Vertices keep their
  /// numbers.
  std::vector<Facet> facets(std::span<const Vec3> points, MeshReading& reading);

 private:
  struct Solid {
    CellShape shape;
    std::size_t first;  // in corners_
  };
  struct Polygon {
    std::size_t first, corners;  // in surface_, as facets about the first corner; how many
    std::size_t cell;
  };
  struct OpenFace;
  std::vector<Facet> cut_surface(std::span<const Vec3> points, PolygonReader& polygons);
  std::vector<OpenFace> faces_of_solids(std::span<const Vec3> points) const;
  void count_shells(std::span<const OpenFace> faces, MeshReading& reading) const;

  std::size_t cells_ = 0;
  std::vector<Facet> surface_;
  std::vector<Polygon> polygons_;  // of more than three corners
  std::vector<Solid> solids_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace morula::detail
