// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The cover: made for a tree, checked, and the proof that every sphere contains its part of the surface.
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

/// Where a corner is when the mesh's vertices are at `positions`.
Vec3 corner_position(const Cover& cover, std::uint32_t corner, const PositionView& positions);

struct CoverOptions {
  /// Every sphere of the result contains its children's, as after make_nested(). A tree that says it is nested stays so
  /// anyway.
  bool nested = false;
};

/// Proves that a tree made elsewhere covers the mesh, or repairs it.
///
/// All leaves share the surface in one flat power partition; inner nodes own what their descendants own. A patch
/// outside its own sphere goes to the leaf that grows least, never by power alone (a gap piece would swell a minute
/// sphere). A sphere that contains its region stays as it is, bit for bit; one that does not gets the smaller of {same
/// center, grown radius} and {smallest sphere of its region}. Leaves that own nothing are dropped, with ancestors that
/// lose all their leaves. report.growth says per level what had to grow. Throws std::invalid_argument when
/// validate(tree) finds faults, and for numbers out of range (geometry/scale.hpp).
CoveredTree cover(const MeshView& mesh, const SphereTree& tree, const CoverOptions& options = {},
                  WorkersOrAll workers = {});

/// The same tree's cover with fewer cuts: build() and cover() end with it; trees kept from before gain by it too.
///
/// A facet that several leaves share goes whole to one of them, the one with the most of it first, whose sphere and all
/// spheres above reach as far already; else what one has of it to another, likewise. What a leaf has of a facet becomes
/// one patch where it is convex, fewer where it is not. No node's farthest corner is
/// farther from its center than before, so spheres that covered cover, and an update at rest grows none; in motion they
/// come out up to a few hundredths looser or tighter. No leaf loses its last patch; cut points that nobody owns any
/// longer are left out. mesh: the one that the tree was built for; validate(mesh, model) finds nothing.
Cover with_fewer_cuts(const MeshView& mesh, const CoveredTree& model, WorkersOrAll workers = {});

struct [[nodiscard]] Certificate {
  bool covered = true;
  double worst_excess = 0;  ///< largest |corner − center| − radius over all nodes; ≤ 0 when covered
  std::uint32_t worst_node = no_node;
};

/// The proof, checked: every corner of every node's region lies in that node's sphere, at every level.
///
/// positions: one per mesh vertex, at rest or deformed. spheres: one per node of the tree the cover belongs to.
/// Evaluated in double, of numbers of any size: no square vanishes or overflows. A true answer holds exactly when the
/// spheres' radii carry the pad of rounded_up_radius or more.
/// Cost: O(levels × corners).
Certificate certify(const Cover& cover, const PositionView& positions, std::span<const Sphere> spheres,
                    Workers& workers = serial_workers());

/// Every violated promise of a cover's arrays, in words: sizes, indices, weights of cut points, regions that are not
/// the disjoint union of their children's. Looks at no mesh. Where an array cannot be read further, the first fault
/// alone. The tree must have passed validate(tree). Readers, writers and bodies ask the same.
std::vector<std::string> validate(const SphereTree& tree, const Cover& cover);

/// Every violated promise of a built tree, in words: array invariants, patches that do not tile their facet, regions
/// that are not the disjoint union of their children's, spheres that do not wrap their region. The same of the trees
/// for known poses, at these. Empty: all hold.
std::vector<std::string> validate(const MeshView& mesh, const CoveredTree& model);

/// Mesh vertices, those of the first leaf first: leaf_order(…)[i] is the old number of what becomes vertex i. Vertices
/// that no leaf has come last. For whoever can number the vertices of a simulation as they like; O(corners log
/// corners).
std::vector<std::uint32_t> leaf_order(const CoveredTree& model);

/// The same with vertices renumbered: old vertex order[i] is the new vertex i. Throws std::invalid_argument unless the
/// order names every vertex once. Facets, patches and spheres keep their numbers.
Mesh renumbered(const MeshView& mesh, std::span<const std::uint32_t> order);
/// mesh: as renumbered, for its hash, which the report carries.
CoveredTree renumbered(const CoveredTree& model, const MeshView& mesh, std::span<const std::uint32_t> order);

}  // namespace morula
