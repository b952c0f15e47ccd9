// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/cells.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>

#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::uint32_t no_vertex = std::numeric_limits<std::uint32_t>::max();
using Face = std::array<std::uint8_t, 4>;  // corners of a solid, outward; a triangle repeats its last
constexpr std::uint8_t none = 255;

constexpr std::array tetrahedron{Face{0, 2, 1, none}, Face{0, 1, 3, none}, Face{1, 2, 3, none}, Face{0, 3, 2, none}};
constexpr std::array hexahedron{Face{0, 3, 2, 1}, Face{4, 5, 6, 7}, Face{0, 1, 5, 4},
                                Face{1, 2, 6, 5}, Face{2, 3, 7, 6}, Face{3, 0, 4, 7}};
constexpr std::array wedge{Face{0, 1, 2, none}, Face{3, 5, 4, none}, Face{0, 3, 4, 1}, Face{1, 4, 5, 2},
                           Face{2, 5, 3, 0}};
constexpr std::array pyramid{Face{0, 3, 2, 1}, Face{0, 1, 4, none}, Face{1, 2, 4, none}, Face{2, 3, 4, none},
                             Face{3, 0, 4, none}};

std::span<const Face> faces_of(CellShape shape) {
  switch (shape) {
    case CellShape::tetrahedron:
      return tetrahedron;
    case CellShape::hexahedron:
      return hexahedron;
    case CellShape::wedge:
      return wedge;
    case CellShape::pyramid:
      return pyramid;
    default:
      return {};
  }
}

}  // namespace

struct CellSurface::OpenFace {
  std::array<std::uint32_t, 4> key;       // sorted
  std::array<std::uint32_t, 4> vertices;  // outward
  std::size_t place, solid;
};

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
      solids_.push_back({CellShape::hexahedron, corners_.size()});
      for (const std::size_t k : {0, 1, 3, 2, 4, 5, 7, 6}) corners_.push_back(corners[k]);
      return;
    default:
      solids_.push_back({type.shape, corners_.size()});
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

std::vector<CellSurface::OpenFace> CellSurface::faces_of_solids(std::span<const Vec3> points) const {
  std::vector<OpenFace> faces;
  InterruptPoller poll_interrupt(4096);
  for (std::size_t number = 0; number < solids_.size(); ++number) {
    poll_interrupt();
    const Solid& solid = solids_[number];
    const std::uint32_t* const c = corners_.data() + solid.first;
    // A solid whose corners are mirrored has its faces inward: the sign of its volume shows that.
    const std::span<const Face> table = faces_of(solid.shape);
    double volume = 0;
    for (const Face& face : table) {
      const Vec3 origin = points[c[0]], a = points[c[face[0]]] - origin;
      for (std::size_t k = 2; k < 4 && face[k] != none; ++k) {
        volume += dot(a, cross(points[c[face[k - 1]]] - origin, points[c[face[k]]] - origin));
      }
    }
    for (const Face& face : table) {
      OpenFace open{{no_vertex, no_vertex, no_vertex, no_vertex}, {}, faces.size(), number};
      const std::size_t count = face[3] == none ? 3 : 4;
      for (std::size_t k = 0; k < count; ++k) open.key[k] = c[face[k]];
      open.vertices = open.key;
      if (volume < 0) std::reverse(open.vertices.begin(), open.vertices.begin() + static_cast<std::ptrdiff_t>(count));
      std::sort(open.key.begin(), open.key.end());
      faces.push_back(open);
    }
  }
  return faces;
}

// Files usually list the faces of their solids' surface again, as polygons; polygons that are none of these faces, nor
// half of one, are separate shells.
void CellSurface::count_shells(std::span<const OpenFace> faces, MeshReading& reading) const {
  if (surface_.empty()) return;
  std::vector<std::array<std::uint32_t, 3>> parts;
  InterruptPoller poll_interrupt(4096);
  for (const OpenFace& face : faces) {
    poll_interrupt();
    parts.push_back({face.key[0], face.key[1], face.key[2]});
    if (face.key[3] == no_vertex) continue;
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
  std::vector<OpenFace> faces = faces_of_solids(points);
  count_shells(faces, reading);
  sort_interruptibly(
      faces, [](const OpenFace& a, const OpenFace& b) { return a.key != b.key ? a.key < b.key : a.place < b.place; });
  std::vector<OpenFace> single;
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t begin = 0; begin < faces.size();) {
    poll_interrupt();
    std::size_t end = begin + 1;
    while (end < faces.size() && faces[end].key == faces[begin].key) ++end;
    if (end == begin + 1) single.push_back(faces[begin]);
    begin = end;
  }
  sort_interruptibly(single, [](const OpenFace& a, const OpenFace& b) { return a.place < b.place; });
  std::vector<Facet> facets;
  for (const OpenFace& face : single) {
    poll_interrupt();
    const auto& v = face.vertices;
    facets.push_back({v[0], v[1], v[2]});
    if (v[3] == no_vertex) continue;
    facets.push_back({v[0], v[2], v[3]});
    polygons.cut(points, v, facets, facets.size() - 2, {face.solid, 0});
  }
  polygons.finish("solid");
  return facets;
}

}  // namespace morula::detail
