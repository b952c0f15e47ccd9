// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Functions that make, check and renumber covers. A cover divides the surface into patches that the nodes of a tree
// own; with it certify() proves that every sphere contains the part of the surface that its node owns.
#pragma once

#include <memory>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/query/power_diagram.hpp>
#include <morula/tree/covered_tree.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace morula {

/// The position of a corner of a patch, computed in double, if the mesh's vertices are at `positions`. corner: an entry
/// of Cover::corners.
Vec3 corner_position(const Cover& cover, std::uint32_t corner, const PositionView& positions);

struct CoverOptions {
  /// true: make every sphere of the result contain its children's, with make_nested(). A tree with SphereTree::nested
  /// gets that in any case.
  bool nested = false;
};

/// Makes a cover of the mesh for a given tree, and enlarges the spheres that do not contain their part of the surface.
///
/// The power diagram of all leaf spheres cuts the surface into patches: a point belongs to the leaf with the smallest
/// power() there. A patch that is not inside the sphere of its leaf goes to the leaf whose sphere contains it after the
/// smallest increase of the radius. Inner nodes own the patches of their descendants.
///
/// A sphere that contains its region stays unchanged, bit for bit. Any other becomes the smaller of {same center,
/// larger radius} and {smallest sphere of its region}, with a radius rounded up. Leaves that own no patch are removed,
/// with the ancestors that lose all their leaves; report.dropped_spheres counts both. report.growth has, for each
/// level, the number of spheres that grew or moved, and the largest growth.
///
/// workers: by default one thread per processor. Throws std::invalid_argument for a mesh that require_usable() rejects,
/// for a tree in which validate(tree) finds faults, and for numbers out of range in either (geometry/scale.hpp).
CoveredTree cover(const MeshView& mesh, const SphereTree& tree, const CoverOptions& options = {},
                  WorkersOrAll workers = {});

/// A cover of the same tree with fewer patches and cut points, so updates cost less. build() and cover() call it last;
/// it also improves covers from files of older versions.
///
/// A facet that several leaves share goes to one of them as a whole if the sphere of that leaf and all spheres above it
/// contain the facet; the leaf with the largest part of the facet is tried first. If none qualifies, the part of one
/// leaf goes to another under the same condition. The patches of a facet that one leaf owns are joined
/// where the result is convex.
///
/// The distance from a node's center to its farthest corner does not increase. So spheres that cover still cover, and
/// no radius grows at rest; in motion the spheres of an update are up to a few percent looser or tighter than with the
/// given cover. No leaf loses its last patch, and cut points that no patch uses are removed. mesh: the mesh that the
/// tree was built for; validate(mesh, model) must find no fault.
Cover with_fewer_cuts(const MeshView& mesh, const CoveredTree& model, WorkersOrAll workers = {});

/// The result of certify().
struct [[nodiscard]] Certificate {
  bool covered = true;  ///< true if every sphere contains the part of the surface that its node owns
  /// The largest |corner − center| − radius of all nodes and their corners, mesh units: 0 or less if covered, infinite
  /// if a number is not comparable.
  double worst_excess = 0;
  std::uint32_t worst_node = no_node;  ///< node with that excess, the lowest of equals
};

/// Checks for every node of every level that its sphere contains all corners of its region. Spheres and patches are
/// convex, so the spheres of each level then contain the whole surface.
///
/// positions: one per mesh vertex, at rest or deformed. spheres: one per node of the cover's tree. The check compares
/// in double without a tolerance, for numbers of any size: no square vanishes or overflows. A positive result also
/// holds in exact arithmetic if the radii carry the pad of rounded_up_radius() or a larger one, like those of build(),
/// cover() and Body. Throws std::invalid_argument for another number of positions or spheres. Cost: O(levels ×
/// corners).
Certificate certify(const Cover& cover, const PositionView& positions, std::span<const Sphere> spheres,
                    Workers& workers = serial_workers());

/// The sphere with a smaller radius: its radius less `length`, at least 0, rounded up so that the sphere with the
/// radius increased by `length` again, in exact arithmetic, contains the given one. If spheres cover a surface, every
/// point of the surface lies within `length` of their reduced spheres. length: 0 or more, mesh units; throws
/// std::invalid_argument otherwise.
Sphere reduced(const Sphere& sphere, double length);
/// The tree with reduced spheres. Each level is within `length` of what the given level covers. SphereTree::nested is
/// false if the length is above 0: a sphere that became a point may lie outside its parent's.
SphereTree reduced(const SphereTree& tree, double length);

/// The faults of a cover's arrays, as text; empty if there is none. Faults are wrong sizes, indices out of range, wrong
/// weights of cut points, and regions that are not the disjoint union of their children's. The check reads no mesh. If
/// a fault makes it impossible to read on, the list has only that fault. validate(tree) must find no fault. Readers,
/// writers and bodies apply this check.
std::vector<std::string> validate(const SphereTree& tree, const Cover& cover);

/// The faults of a model of this mesh, as text; empty if there is none. Faults are those of validate(tree) and
/// validate(tree, cover), patches that do not tile their facet, and spheres that do not contain their region at rest.
/// Trees of known poses are checked in the same way at their poses.
std::vector<std::string> validate(const MeshView& mesh, const CoveredTree& model);

/// An order of the mesh's vertices with which updates are faster: the vertices of the first leaf, then those of the
/// second leaf that are not in the first, and so on, each leaf's in ascending order; vertices of no leaf are last.
/// Entry i is the old number of the new vertex i. It serves simulations that can number their vertices freely: pass it
/// to renumbered(). Cost: O(corners log corners).
std::vector<std::uint32_t> leaf_order(const CoveredTree& model);

/// The mesh with renumbered vertices: old vertex order[i] is the new vertex i. Facets keep their numbers. Throws
/// std::invalid_argument unless the order has every vertex once.
Mesh renumbered(const MeshView& mesh, std::span<const std::uint32_t> order);
/// The model for the mesh with renumbered vertices. Patches, nodes and spheres keep their numbers; known poses are
/// renumbered also. mesh: the renumbered mesh, whose hash the report stores. Throws like renumbered(mesh, order).
CoveredTree renumbered(const CoveredTree& model, const MeshView& mesh, std::span<const std::uint32_t> order);

}  // namespace morula
