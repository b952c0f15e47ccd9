// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes by kind, good and bad, for tests to loop over; and the simple shapes that they are made of.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <string>
#include <vector>

namespace morula::test {

struct NamedMesh {
  std::string name;
  Mesh mesh;
  // As in MeshReport, known by construction.
  bool closed;
  bool oriented;
  bool manifold;
  double volume;  ///< signed, to about 1e-9 relative; 0 unless closed and oriented

  bool has_volume() const { return closed && oriented; }
};

/// Every kind below, small (at most a few thousand facets). All of them pass require_usable.
const std::vector<NamedMesh>& all_meshes();
/// Those with a well-defined inside and a positive volume.
std::vector<NamedMesh> closed_meshes();
/// By name; throws std::invalid_argument when there is none.
const NamedMesh& mesh_named(const std::string& name);

/// Geodesic sphere: an icosahedron, every facet cut into four `subdivisions` times: 20 × 4^subdivisions facets,
/// vertices on the sphere to rounding.
Mesh icosphere(int subdivisions, double radius = 1.0, const Vec3& center = {0, 0, 0});
/// Latitudes and longitudes with one vertex at each pole: 2 × around × (rings − 1) facets.
Mesh uv_sphere(int around, int rings, double radius = 1.0, const Vec3& center = {0, 0, 0});
/// Box with n × n squares on each side: 12 n² facets, no duplicate vertices, outward.
Mesh box_mesh(const Vec3& lower, const Vec3& upper, int n = 1);
/// Open grid of n × n squares over [0, width] × [0, depth] at z = 0, facing up.
Mesh grid_plate(int n, double width = 1.0, double depth = 1.0);
/// Random triangles in the unit box, no vertex shared.
Mesh facet_soup(std::size_t facet_count, std::uint64_t seed);

/// Both meshes as one, the second one's indices shifted.
Mesh joined(const Mesh& a, const Mesh& b);
/// Every facet with vertices of its own, as STL has them.
Mesh soup_of(const Mesh& mesh);
/// Every facet turned over.
Mesh inverted(Mesh mesh);
Mesh scaled(Mesh mesh, double factor);
Mesh translated(Mesh mesh, const Vec3& offset);
Mesh placed(Mesh mesh, const RigidTransform& place);

}  // namespace morula::test
