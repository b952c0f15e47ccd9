// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The cover: functions that make and check it. It proves that every sphere contains its part of the surface.
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

/// Position of a corner if the mesh's vertices are at `positions`.
Vec3 corner_position(const Cover& cover, std::uint32_t corner, const PositionView& positions);

struct CoverOptions {
  /// Make every sphere of the result contain its children's, as make_nested() does. A tree with `nested` set stays
  /// nested in any case.
  bool nested = false;
};

/// Proves that a given tree covers the mesh, or repairs the tree so that it does.
///
/// All leaves share the surface in one flat power partition; inner nodes own the patches of their descendants. A patch
/// outside its own sphere goes to the leaf that grows least, never by power alone (a patch in a gap would swell a
/// minute sphere). A sphere that contains its region stays unchanged, bit for bit; any other becomes the smaller of
/// {same center, grown radius} and {smallest sphere of its region}. Leaves that own nothing are dropped, with the
/// ancestors that lose all their leaves. report.growth lists per level the spheres that had to grow. Throws
/// std::invalid_argument if validate(tree) finds faults, and for numbers out of range (geometry/scale.hpp).
CoveredTree cover(const MeshView& mesh, const SphereTree& tree, const CoverOptions& options = {},
                  WorkersOrAll workers = {});

/// A cover of the same tree with fewer cuts. build() and cover() end with it; models from older files profit from it
/// too.
///
/// If several leaves share a facet, the whole facet goes to one of them, the leaf with its largest part first, provided
/// that the leaf's sphere and all spheres above it are large enough already. Otherwise the part of one leaf goes to
/// another, under the same condition. The part of a facet that a leaf owns becomes one patch if it is convex, and fewer
/// patches if it is not. No node's farthest corner moves farther from its center, so spheres that covered still cover,
/// and an update at rest grows none; in motion spheres come out up to a few hundredths looser or tighter. No leaf loses
/// its last patch; cut points without an owner are removed. mesh: the mesh that the tree was built for; validate(mesh,
/// model) finds nothing.
Cover with_fewer_cuts(const MeshView& mesh, const CoveredTree& model, WorkersOrAll workers = {});

struct [[nodiscard]] Certificate {
  bool covered = true;
  double worst_excess = 0;  ///< largest |corner − center| − radius over all nodes, mesh units; ≤ 0 if covered
  std::uint32_t worst_node = no_node;
};

/// Checks the proof: every corner of every node's region lies in that node's sphere, at every level.
///
/// positions: one per mesh vertex, at rest or deformed. spheres: one per node of the cover's tree. Evaluated in double,
/// for numbers of any size: no square vanishes or overflows. A true result holds exactly if the spheres' radii carry
/// the pad of rounded_up_radius or more.
/// Cost: O(levels × corners).
Certificate certify(const Cover& cover, const PositionView& positions, std::span<const Sphere> spheres,
                    Workers& workers = serial_workers());

/// Every violated promise of a cover's arrays, as text: sizes, indices, weights of cut points, regions that are not the
/// disjoint union of their children's. Reads no mesh. If an array cannot be read further, the list has the first fault
/// alone. The tree must have passed validate(tree). Readers, writers and bodies apply the same check.
std::vector<std::string> validate(const SphereTree& tree, const Cover& cover);

/// Every violated promise of a built tree, as text: array invariants, patches that do not tile their facet, regions
/// that are not the disjoint union of their children's, spheres that do not wrap their region. Trees of known poses are
/// checked the same way at their poses. Empty if all promises hold.
std::vector<std::string> validate(const MeshView& mesh, const CoveredTree& model);

/// Mesh vertices in the order of leaves, starting with the first leaf: leaf_order(…)[i] is the old number of the new
/// vertex i. Vertices without a leaf come last. It serves simulations whose vertices can be numbered freely. Cost:
/// O(corners log corners).
std::vector<std::uint32_t> leaf_order(const CoveredTree& model);

/// The mesh with renumbered vertices: old vertex order[i] is the new vertex i. Throws std::invalid_argument unless the
/// order has every vertex once. Facets, patches and spheres keep their numbers.
Mesh renumbered(const MeshView& mesh, std::span<const std::uint32_t> order);
/// The model with renumbered vertices. mesh: the renumbered mesh; the report stores its hash.
CoveredTree renumbered(const CoveredTree& model, const MeshView& mesh, std::span<const std::uint32_t> order);

}  // namespace morula
