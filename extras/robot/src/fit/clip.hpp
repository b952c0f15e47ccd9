// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Planes that cut a link's shapes: what lies beyond them need not be covered.
#pragma once

#include <morula/robot/fit.hpp>

namespace morula::robot {

/// How far a sphere reaches beyond a plane; not above 0: it stays on the side that is kept.
inline double reach_beyond(const Sphere& s, const ClipPlane& plane) {
  return plane.offset - dot(plane.normal, s.center) + s.radius;
}
/// The most of it over all planes and spheres that are larger by `growth`; 0 or more.
double reach_beyond(std::span<const Sphere> spheres, std::span<const ClipPlane> planes, double growth = 0);

/// A polyhedron around the sphere, or inside of it.
Mesh ball_mesh_of(const Sphere& s, RoundShapes round);
/// Adds the vertices and facets of another mesh.
void append_mesh(Mesh& to, const Mesh& mesh);

/// What is kept of a surface, `margin` inside of the planes: facets are cut where a plane passes, neighbors at the
/// same point of an edge; what lies within rounding of a plane may fall to either side. The cut is left open. Spheres
/// that a plane passes through become polyhedra around them first.
LinkSurface clipped(const LinkSurface& surface, std::span<const ClipPlane> planes, double margin);

/// How far a mesh stays from the planes: the least of it over all vertices and planes, infinite without any.
double least_height(const Mesh& mesh, std::span<const ClipPlane> planes);

/// Leaves that do not stay give way to smaller ones over the same part of the surface, which is built anew with these
/// options and four spheres, or by an octree, again and again. After: every leaf stays, or no smaller sphere over its
/// part may, which may_stay(leaf, part) says, or there are too many of them.
void divide_until(const std::function<bool(const Sphere&)>& stays,
                  const std::function<bool(const Sphere&, const Mesh&)>& may_stay, const Mesh& mesh, CoveredTree& model,
                  const BuildOptions& options);

}  // namespace morula::robot
