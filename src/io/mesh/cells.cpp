// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/cells.hpp"

#include <algorithm>
#include <array>
#include <functional>

#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

SolidShape solid_shape(CellShape shape) {
  switch (shape) {
    case CellShape::hexahedron:
      return SolidShape::hexahedron;
    case CellShape::wedge:
      return SolidShape::wedge;
    case CellShape::pyramid:
      return SolidShape::pyramid;
    default:
      return SolidShape::tetrahedron;
  }
}

}  // namespace

bool vtk_cell_type(std::uint64_t number, CellType& type) {
  switch (number) {
    case 0:   // empty
    case 1:   // vertex
    case 2:   // several
    case 3:   // line
    case 4:   // several
    case 21:  // quadratic edge
      type = {CellShape::none, 0};
      return true;
    case 5:
    case 22:  // quadratic triangle
    case 34:  // biquadratic
      type = {CellShape::polygon, 3};
      return true;
    case 6:
      type = {CellShape::strip, 0};
      return true;
    case 7:
      type = {CellShape::polygon, 0};
      return true;
    case 8:
      type = {CellShape::pixel, 4};
      return true;
    case 9:
    case 23:  // quadratic quadrilateral
    case 28:  // biquadratic
      type = {CellShape::polygon, 4};
      return true;
    case 10:
    case 24:  // quadratic tetrahedron
      type = {CellShape::tetrahedron, 4};
      return true;
    case 11:
      type = {CellShape::voxel, 8};
      return true;
    case 12:
    case 25:  // quadratic hexahedron
    case 29:  // triquadratic
      type = {CellShape::hexahedron, 8};
      return true;
    case 13:
    case 26:  // quadratic wedge
      type = {CellShape::wedge, 6};
      return true;
    case 14:
    case 27:  // quadratic pyramid
      type = {CellShape::pyramid, 5};
      return true;
    default:
      return false;
  }
}

void CellSurface::add(CellType type, std::span<const std::uint32_t> corners) {
  const std::size_t cell = cells_++;
  switch (type.shape) {
    case CellShape::none:
      return;
    case CellShape::polygon: {
      const std::size_t count = type.corners == 0 ? corners.size() : type.corners;
      if (count > 3) polygons_.push_back({surface_.size(), count, cell});
      for (std::size_t k = 2; k < count; ++k) surface_.push_back({corners[0], corners[k - 1], corners[k]});
      return;
    }
    case CellShape::strip:
      for (std::size_t k = 2; k < corners.size(); ++k) {
        // Every other triangle of a strip is reversed.
        const std::size_t a = k % 2 == 0 ? k - 2 : k - 1, b = k % 2 == 0 ? k - 1 : k - 2;
        surface_.push_back({corners[a], corners[b], corners[k]});
      }
      return;
    case CellShape::pixel:
      surface_.push_back({corners[0], corners[1], corners[3]});
      surface_.push_back({corners[0], corners[3], corners[2]});
      return;
    case CellShape::voxel:
      solids_.push_back({SolidShape::hexahedron, corners_.size()});
      for (const std::size_t k : {0, 1, 3, 2, 4, 5, 7, 6}) corners_.push_back(corners[k]);
      return;
    default:
      solids_.push_back({solid_shape(type.shape), corners_.size()});
      corners_.insert(corners_.end(), corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(type.corners));
  }
}

std::vector<Facet> CellSurface::cut_surface(std::span<const Vec3> points, PolygonReader& polygons) {
  std::vector<std::uint32_t> corners;
  InterruptPoller poll_interrupt(4096);
  for (const Polygon& polygon : polygons_) {
    poll_interrupt();
    corners_of_fan(std::span(surface_).subspan(polygon.first, polygon.corners - 2), corners);
    polygons.cut(points, corners, surface_, polygon.first, {polygon.cell, 0});
  }
  return surface_;
}

std::vector<SolidFace> CellSurface::faces_of_solids(std::span<const Vec3> points) const {
  std::vector<SolidFace> faces;
  InterruptPoller poll_interrupt(4096);
  for (std::size_t number = 0; number < solids_.size(); ++number) {
    poll_interrupt();
    const Solid& solid = solids_[number];
    const std::uint32_t* const corners = corners_.data() + solid.first;
    add_faces(solid.shape, corners, signed_volume_of(solid.shape, points, corners) < 0, number, faces);
  }
  return faces;
}

// Files usually list the faces of their solids' surface again, as polygons; polygons that are none of these faces, nor
// half of one, are separate shells.
void CellSurface::count_shells(std::span<const SolidFace> faces, MeshReading& reading) const {
  if (surface_.empty()) return;
  std::vector<std::array<std::uint32_t, 3>> parts;
  InterruptPoller poll_interrupt(4096);
  for (const SolidFace& face : faces) {
    poll_interrupt();
    parts.push_back({face.key[0], face.key[1], face.key[2]});
    if (face.key[3] == no_corner) continue;
    parts.push_back({face.key[0], face.key[1], face.key[3]});
    parts.push_back({face.key[0], face.key[2], face.key[3]});
    parts.push_back({face.key[1], face.key[2], face.key[3]});
  }
  sort_interruptibly(parts, std::less<>());
  std::size_t shells = 0;
  for (const Facet& facet : surface_) {
    poll_interrupt();
    std::array<std::uint32_t, 3> key{facet[0], facet[1], facet[2]};
    std::sort(key.begin(), key.end());
    if (!std::binary_search(parts.begin(), parts.end(), key)) ++shells;
  }
  if (shells > 0)
    reading.info.notes.push_back(counted(shells, "triangle") + " of shells besides the solids " +
                                 (shells == 1 ? "lies on no face of them and is" : "lie on no face of them and are") +
                                 " left out; save the shells as a file of their own");
}

std::vector<Facet> CellSurface::facets(std::span<const Vec3> points, MeshReading& reading) {
  PolygonReader polygons(reading);
  if (solids_.empty()) {
    std::vector<Facet> facets = cut_surface(points, polygons);
    polygons.finish("cell");
    return facets;
  }
  std::vector<SolidFace> faces = faces_of_solids(points);
  count_shells(faces, reading);
  sort_by_key(faces);
  std::vector<SolidFace> single;
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t begin = 0; begin < faces.size();) {
    poll_interrupt();
    const std::size_t end = end_of_run(faces, begin);
    if (end == begin + 1) single.push_back(faces[begin]);
    begin = end;
  }
  sort_by_place(single);
  std::vector<Facet> facets;
  for (const SolidFace& face : single) {
    poll_interrupt();
    const auto& v = face.vertices;
    facets.push_back({v[0], v[1], v[2]});
    if (face.corner_count() == 3) continue;
    facets.push_back({v[0], v[2], v[3]});
    polygons.cut(points, v, facets, facets.size() - 2, {face.solid, 0});
  }
  polygons.finish("solid");
  return facets;
}

}  // namespace morula::detail
