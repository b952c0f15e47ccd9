// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A tree with its cover: the part of the surface that each node owns, and the report of how both were made. Plain data;
// tree/cover.hpp has the functions.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/geometry/vector.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace morula {

/// A point of the surface that is not a mesh vertex: Σ weight[k] × position of vertex[k]. On a mesh edge, weight[2] is
/// 0 and vertex[2] repeats vertex[1]; the point is stored once for both facets.
struct CutPoint {
  std::array<std::uint32_t, 3> vertex;
  std::array<double, 3> weight;
  bool operator==(const CutPoint&) const = default;
};

/// Patches are convex polygons inside one facet. They are in the order of their leaves (depth first), so the region of
/// every node is one range of patches. A patch moves with its facet: its corners are fixed convex combinations of
/// vertices, so a sphere that contains the moved corners contains the moved patch.
struct Cover {
  std::uint32_t vertex_count = 0;  ///< number of vertices of the mesh
  std::uint32_t facet_count = 0;
  std::vector<CutPoint> cut_points;
  std::vector<std::uint32_t> patch_facet;   ///< facet of each patch
  std::vector<std::uint32_t> corner_begin;  ///< patch p has corners [corner_begin[p], corner_begin[p + 1]), at least 3
  std::vector<std::uint32_t> corners;  ///< mesh vertex if < vertex_count; otherwise cut_points[corner − vertex_count]
  std::vector<std::uint32_t> region_begin;  ///< one per node: its region is the patches [begin, end)
  std::vector<std::uint32_t> region_end;

  std::size_t patch_count() const { return patch_facet.size(); }
  /// The largest number of patches of one facet. Cost: linear in patches and facets.
  std::size_t most_patches_of_a_facet() const;
  std::span<const std::uint32_t> patch(std::size_t p) const {
    return std::span(corners).subspan(corner_begin[p], corner_begin[p + 1] - corner_begin[p]);
  }
  /// The corners of all patches of a node, with repetitions.
  std::span<const std::uint32_t> region_corners(std::uint32_t node) const {
    const std::uint32_t begin = corner_begin[region_begin[node]];
    return std::span(corners).subspan(begin, corner_begin[region_end[node]] - begin);
  }
};

struct LevelGrowth {
  std::size_t grown = 0;        ///< spheres that grew or moved to contain their region
  double largest_factor = 1.0;  ///< largest ratio of the new radius to the old one
  double largest_growth = 0.0;  ///< largest increase of a radius, mesh units
};

/// The report of a builder or of cover(). It travels with the tree and is written into native files.
struct BuildReport {
  std::string method;  ///< "octree", "grid", …; "imported" from cover()
  std::uint32_t branching = 0;
  std::uint32_t depth = 0;  ///< requested depth
  std::uint64_t seed = 0;
  std::uint64_t mesh_hash = 0;
  std::vector<LevelGrowth> growth;   ///< growth per level; empty except after cover()
  std::size_t early_leaves = 0;      ///< leaves above the last level
  std::size_t leftover_patches = 0;  ///< patches outside their own sphere, assigned to the leaf that grew least
  std::size_t dropped_spheres = 0;   ///< spheres without a region
  std::vector<std::string> notes;    ///< fallbacks taken, as text

  // Properties of the cover, which files contain: these are recomputed when a file is read.
  std::size_t most_patches_of_a_facet = 0;  ///< largest number of patches of one facet

  // Properties of the run that built the tree; not written into files.
  bool complete = true;  ///< false: a time limit ended the run, or the requested protrusion was not reached
  /// Wall time of the division for each level, seconds; the first entry is the preparation.
  std::vector<double> level_seconds;
  std::optional<double> protrusion_bound;  ///< max of (r + φ(c))⁺ over the leaves, mesh units; set if spheres or
                                           ///< max_protrusion is requested
};

struct CoveredTree;

/// Another tree of the same mesh, made for a known pose. Its cover holds in every pose, and is tighter near the known
/// one.
struct KnownPose {
  std::string name;
  std::vector<Vec3> positions;  ///< one per mesh vertex
  /// Covered tree of the mesh with these positions; it has no known poses of its own.
  std::shared_ptr<const CoveredTree> model;
};

namespace detail {
class FacetLists;

/// Lists of facets of a covered tree, made on first use, on any thread. Copies and assignment keep the trees' lists
/// apart: a tree that may have changed has none.
class SharedFacetLists {
 public:
  SharedFacetLists() = default;
  SharedFacetLists(const SharedFacetLists&) noexcept {}
  SharedFacetLists& operator=(const SharedFacetLists&) noexcept {
    made_.reset();
    return *this;
  }
  std::shared_ptr<const FacetLists> get(const SphereTree& tree, const Cover& cover) const;

 private:
  mutable Mutex mutex_;
  mutable std::shared_ptr<const FacetLists> made_;
};
}  // namespace detail

/// A tree with its proof. Bodies borrow it: it must not change as long as a body follows it.
struct CoveredTree {
  SphereTree tree;
  Cover cover;
  BuildReport report;
  /// Trees for known poses: made by add_known_poses (update/known_poses.hpp), written into native files, used by
  /// RebuiltBody.
  std::vector<KnownPose> poses{};
  detail::SharedFacetLists facet_lists{};  ///< lists for colliders of all bodies that follow this tree
};

}  // namespace morula
