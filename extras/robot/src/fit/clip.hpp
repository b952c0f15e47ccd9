// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Planes that cut a link's shapes: surface beyond them need not be covered.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// The length by which a sphere reaches beyond a plane; at most 0 if it stays on the kept side.
inline double reach_beyond(const Sphere& s, const ClipPlane& plane) {
  return plane.offset - dot(plane.normal, s.center) + s.radius;
}
/// The largest reach over all planes and spheres, enlarged by `growth`; 0 or more.
double reach_beyond(std::span<const Sphere> spheres, std::span<const ClipPlane> planes, double growth = 0);

/// A polyhedron around the sphere, or inside of it.
Mesh ball_mesh_of(const Sphere& s, RoundShapes round);
/// Adds the vertices and facets of another mesh.
void append_mesh(Mesh& to, const Mesh& mesh);

/// The kept part of a surface, `margin` inside of the planes: facets are cut where a plane passes, neighbors at the
/// same point of an edge; parts within rounding of a plane may fall to either side. The cut is left open. Spheres that
/// a plane passes through become polyhedra around them first.
LinkSurface clipped(const LinkSurface& surface, std::span<const ClipPlane> planes, double margin);

/// The distance of a mesh from the planes: the least over all vertices and planes, infinite without any.
double least_height(const Mesh& mesh, std::span<const ClipPlane> planes);

/// The surface that a node of a cover owns.
Mesh region_mesh(const Mesh& mesh, const Cover& cover, std::uint32_t node);

/// Replaces leaves that do not stay by smaller ones over the same part of the surface, built with these options and
/// four spheres, or by an octree, repeatedly. At the end: every leaf stays, or no smaller sphere over its part may,
/// which may_stay(leaf, part) says, or there are too many of them.
void divide_until(const std::function<bool(const Sphere&)>& stays,
                  const std::function<bool(const Sphere&, const Mesh&)>& may_stay, const Mesh& mesh, CoveredTree& model,
                  const BuildOptions& options);

}  // namespace morula::robot
