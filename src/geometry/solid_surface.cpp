// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/solid_surface.hpp>
#include <stdexcept>
#include <string>

#include "geometry/exact_predicates.hpp"
#include "geometry/polygon.hpp"
#include "geometry/solid_faces.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

/// Solids of both kinds under one number: tetrahedra first.
class Solids {
 public:
  Solids(std::span<const Vec3> points, std::span<const Tetrahedron> tetrahedra, std::span<const Hexahedron> hexahedra)
      : points_(points), tetrahedra_(tetrahedra), hexahedra_(hexahedra) {}

  std::size_t size() const { return tetrahedra_.size() + hexahedra_.size(); }
  bool is_tetrahedron(std::size_t solid) const { return solid < tetrahedra_.size(); }
  std::span<const std::uint32_t> corners(std::size_t solid) const {
    if (is_tetrahedron(solid)) return tetrahedra_[solid];
    return hexahedra_[solid - tetrahedra_.size()];
  }
  std::string name(std::size_t solid) const {
    if (is_tetrahedron(solid)) return "tetrahedron " + std::to_string(solid);
    return "hexahedron " + std::to_string(solid - tetrahedra_.size());
  }

  void require_good_corners(std::size_t solid) const {
    const auto all = corners(solid);
    for (std::size_t k = 0; k < all.size(); ++k) {
      const std::uint32_t corner = all[k];
      if (corner >= points_.size())
        throw std::invalid_argument(name(solid) + " has the corner " + std::to_string(corner) + "; there are " +
                                    std::to_string(points_.size()) + " points");
      if (std::find(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(k), corner) !=
          all.begin() + static_cast<std::ptrdiff_t>(k))
        throw std::invalid_argument(name(solid) + " has the corner " + std::to_string(corner) + " twice");
      if (!is_finite(points_[corner]))
        throw std::invalid_argument(name(solid) + " has the corner " + std::to_string(corner) +
                                    ", whose position is not finite");
    }
  }

  /// -1 for a solid whose corners are mirrored, else 1. Throws for a solid without volume.
  int orientation(std::size_t solid) const {
    const auto c = corners(solid);
    if (is_tetrahedron(solid)) {
      const int sign = orient3d(points_[c[0]], points_[c[1]], points_[c[2]], points_[c[3]]);
      if (sign == 0) throw std::invalid_argument(name(solid) + " has no volume: its corners lie in one plane");
      return sign;
    }
    const double volume = signed_volume_of(SolidShape::hexahedron, points_, c.data());
    if (!(std::abs(volume) > 0)) throw std::invalid_argument(name(solid) + " has no volume");
    return volume < 0 ? -1 : 1;
  }

  std::vector<SolidFace> faces() const {
    std::vector<SolidFace> faces;
    faces.reserve(4 * tetrahedra_.size() + 6 * hexahedra_.size());
    InterruptPoller poll_interrupt(4096);
    for (std::size_t solid = 0; solid < size(); ++solid) {
      poll_interrupt();
      require_good_corners(solid);
      const SolidShape shape = is_tetrahedron(solid) ? SolidShape::tetrahedron : SolidShape::hexahedron;
      add_faces(shape, corners(solid).data(), orientation(solid) < 0, solid, faces);
    }
    return faces;
  }

 private:
  std::span<const Vec3> points_;
  std::span<const Tetrahedron> tetrahedra_;
  std::span<const Hexahedron> hexahedra_;
};

/// True if b runs around the corners of a in the opposite direction. The faces have the same corners.
bool are_opposite(const SolidFace& a, const SolidFace& b) {
  const std::size_t count = a.corner_count();
  std::size_t start = 0;
  while (b.vertices[start] != a.vertices[0]) ++start;
  for (std::size_t k = 1; k < count; ++k)
    if (b.vertices[(start + count - k) % count] != a.vertices[k]) return false;
  return true;
}

/// The faces that one solid has, in the order of the solids.
std::vector<SolidFace> outer_faces(const Solids& solids) {
  std::vector<SolidFace> faces = solids.faces();
  sort_by_key(faces);
  std::vector<SolidFace> outer;
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t begin = 0, end = 0; begin < faces.size(); begin = end) {
    poll_interrupt();
    end = end_of_run(faces, begin);
    const SolidFace& first = faces[begin];
    if (end - begin == 1) {
      outer.push_back(first);
      continue;
    }
    const std::string names = solids.name(first.solid) + " and " + solids.name(faces[begin + 1].solid);
    if (end - begin > 2)
      throw std::invalid_argument(names + " share a face with " + solids.name(faces[begin + 2].solid) +
                                  "; a face may belong to two solids");
    // mutant solid-same-side: `!are_opposite(first, faces[begin + 1])` -> `are_opposite(first, first)`
    if (!are_opposite(first, faces[begin + 1]))
      throw std::invalid_argument(names + " lie on the same side of a common face: one is repeated, or they overlap");
  }
  sort_by_place(outer);
  return outer;
}

}  // namespace

UsedVertices solid_surface(const PositionView& points, std::span<const Tetrahedron> tetrahedra,
                           std::span<const Hexahedron> hexahedra) {
  const StandardFloats standard;
  if (tetrahedra.empty() && hexahedra.empty()) throw std::invalid_argument("no tetrahedra and no hexahedra");
  const std::vector<Vec3> positions = points.to_vector();
  const std::vector<SolidFace> outer = outer_faces({positions, tetrahedra, hexahedra});
  std::vector<Facet> facets;
  facets.reserve(outer.size() + outer.size() / 2);
  PolygonCutter cutter;
  for (const SolidFace& face : outer) {
    const auto& v = face.vertices;
    facets.push_back({v[0], v[1], v[2]});
    if (face.corner_count() == 3) continue;
    facets.push_back({v[0], v[2], v[3]});
    cutter.cut(positions, v, std::span(facets).last(2));
  }
  return used_vertices({positions, facets});
}

}  // namespace morula
