// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/triangle.hpp>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "geometry/own_units.hpp"

namespace morula {

void require_usable(const Mesh& mesh) {
  if (mesh.facets.empty()) throw std::invalid_argument("the mesh has no facets");
  if (mesh.vertex_count() >= 0xffffffffu || mesh.facet_count() >= 0xffffffffu / 3)
    throw std::invalid_argument("the mesh is too large for 32-bit indices");
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (const std::uint32_t v : mesh.facets[f]) {
      if (v >= mesh.vertex_count())
        throw std::invalid_argument("facet " + std::to_string(f) + " refers to vertex " + std::to_string(v) +
                                    ", but the mesh has " + std::to_string(mesh.vertex_count()) + " vertices");
      if (!is_finite(mesh.positions[v]))
        throw std::invalid_argument("vertex " + std::to_string(v) + " has a coordinate that is not finite");
    }
}

Box bounding_box(const Mesh& mesh) {
  Box box;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) box.add(mesh.positions[v]);
  return box;
}

double surface_area(const Mesh& mesh) {
  if (const auto own = in_own_units(mesh)) return std::ldexp(surface_area(own->mesh), 2 * own->exponent);
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) sum += area(mesh.corners(f));
  return sum;
}

double signed_volume(const Mesh& mesh) {
  if (const auto own = in_own_units(mesh)) return std::ldexp(signed_volume(own->mesh), 3 * own->exponent);
  // About the box centre, so that far from the origin nothing cancels.
  const Vec3 origin = bounding_box(mesh).center();
  double six_times = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    six_times += dot(a - origin, cross(b - origin, c - origin));
  }
  return six_times / 6;
}

std::uint64_t mesh_hash(const Mesh& mesh) {
  Hasher hash;
  hash.add(std::uint64_t{mesh.vertex_count()});
  hash.add(std::uint64_t{mesh.facet_count()});
  for (const Vec3& p : mesh.positions) hash.add(p);
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) hash.add(v);
  return hash.value();
}

}  // namespace morula
