// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/triangle.hpp>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "geometry/own_units.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;

void require_usable(const MeshView& mesh) {
  if (mesh.facets.empty()) throw std::invalid_argument("the mesh has no facets");
  if (mesh.vertex_count() >= 0xffffffffu || mesh.facet_count() >= 0xffffffffu / 3)
    throw std::invalid_argument("the mesh is too large for 32-bit indices");
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    poll_interrupt();
    for (const std::uint32_t v : mesh.facets[f]) {
      if (v >= mesh.vertex_count())
        throw std::invalid_argument("facet " + std::to_string(f) + " refers to vertex " + std::to_string(v) +
                                    ", but the mesh has " + std::to_string(mesh.vertex_count()) + " vertices");
      if (!is_finite(mesh.positions[v]))
        throw std::invalid_argument("vertex " + std::to_string(v) + " has a coordinate that is not finite");
    }
  }
}

Box bounding_box(const MeshView& mesh) {
  Box box;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) box.add(mesh.positions[v]);
  return box;
}

double largest_coordinate(const MeshView& mesh) {
  double largest = 0;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) largest = std::max(largest, max_norm(mesh.positions[v]));
  return largest;
}

double detail::surface_area(const OwnUnits& own) {
  double sum = 0;
  for (std::size_t f = 0; f < own.mesh().facet_count(); ++f) sum += area(own.mesh().corners(f));
  return std::ldexp(sum, 2 * own.exponent());
}

double detail::signed_volume(const OwnUnits& own) {
  // About the box center, so that far from the origin nothing cancels.
  const Vec3 origin = own.box().center();
  double six_times = 0;
  for (std::size_t f = 0; f < own.mesh().facet_count(); ++f) {
    const auto [a, b, c] = own.mesh().corners(f);
    six_times += dot(a - origin, cross(b - origin, c - origin));
  }
  return std::ldexp(six_times / 6, 3 * own.exponent());
}

double surface_area(const MeshView& mesh) {
  return surface_area(OwnUnits(mesh, bounding_box(mesh)));
}

double signed_volume(const MeshView& mesh) {
  return signed_volume(OwnUnits(mesh, bounding_box(mesh)));
}

std::uint64_t mesh_hash(const MeshView& mesh) {
  Hasher hash;
  hash.add(std::uint64_t{mesh.vertex_count()});
  hash.add(std::uint64_t{mesh.facet_count()});
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) hash.add(mesh.positions[v]);
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) hash.add(v);
  return hash.value();
}

Mesh to_mesh(const MeshView& view) {
  return {view.positions.to_vector(), {view.facets.begin(), view.facets.end()}};
}

}  // namespace morula
