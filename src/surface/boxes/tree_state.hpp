// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The parts of a surface tree.
//
// Facets are sorted so that blocks of eight, of 64, of 512 … are compact; box group g of level k has the boxes of 8 g
// to 8 g + 7 of that level, and level 0 holds the boxes of blocks. So there are no links: below box i of level k are
// the boxes of group i of level k − 1. Vertices have slots; the slots that a block owns are consecutive.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <morula/collide/collider.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/surface/surface_tree.hpp>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "geometry/object_call.hpp"
#include "surface/boxes/box_groups.hpp"

namespace morula::detail {

struct SurfaceTreeState;

/// Boxes of the vertices, blocks and groups of a surface tree in one pose or step. A block without a box holds an empty
/// one, which meets nothing.
struct SurfaceBoxes {
  std::vector<MinBox> vertices;               // by slot
  std::vector<std::vector<BoxGroup>> levels;  // the lowest first
  double extent = 0;                          // upper bound of all |coordinates| of the boxes, about the origin

  /// Makes levels for so many blocks, all of them empty.
  void make_levels(std::size_t blocks);
  /// Makes the box of a block from the boxes of its vertices.
  void join_block(const SurfaceTreeState& s, std::size_t block);
  /// Makes group g of a level above the lowest from the groups below.
  void join_group(std::size_t level, std::size_t g);
  /// Sets `extent` from the highest level.
  void measure();
};

inline void put(BoxGroup& group, std::size_t place, const MinBox& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    group.bound[k][place] = box.bound[k];
    group.bound[k + 3][place] = -box.bound[k + 4];
  }
}

/// The number of corners of a block is a multiple of this, the last corner repeated: nearly all blocks have equally
/// many, which branch predictors predict.
inline constexpr std::uint32_t corners_step = 4;

/// Sizes of a worker's task, and the number of vertices that are read before their boxes are made.
inline constexpr std::size_t vertices_at_once = 8192, groups_at_once = 256, vertices_together = 128;

/// Boxes are made only of vertices that are near the origin of their surface.
inline constexpr double farthest_vertex = 0x1p102;
inline bool is_near(const Vec3& p) {
  // This has no branches.
  const auto is_far = [](double x) { return static_cast<unsigned>(!(std::abs(x) <= farthest_vertex)); };
  return is_far(p.x) + is_far(p.y) + is_far(p.z) == 0;
}

/// The body that a surface follows: its spheres bound which blocks of the surface can be near another body's.
struct FollowedBody {
  Collider spheres;  // a copy of the caller's: only the sphere state and the transform are read, since the mesh may
                     // be gone
  std::uint64_t frame = 0;  // frame of the sphere state
  bool is_placed = false;   // whether the transform is not the identity

  /// Whether the body is unchanged since then and all of its spheres are fresh.
  bool is_current() const {
    const SphereState& pose = spheres.sphere_state();
    // mutant follow-moved: `pose.frame` -> `frame`
    return pose.frame == frame && pose.current && pose.complete;
  }
  bool covers() const { return spheres.sphere_state().covers; }
};

/// By leaf, the blocks that have a facet of which the leaf owns a part; leaves are numbered by their nodes.
struct BlocksOfLeaves {
  std::uint64_t cover_id = 0;
  std::vector<std::uint32_t> begin, blocks;

  std::span<const std::uint32_t> operator[](std::uint32_t node) const {
    return std::span(blocks).subspan(begin[node], begin[node + 1] - begin[node]);
  }
};

/// Borders of the regions of one level, where the facets below a box end; made once, with the tree.
///
/// Region r has the 8^(level + 1) facets from r 8^(level + 1) on, in the order of the tree.
///
/// An edge is an inner edge of a region when two facets of the surface have it, one in each direction, and both are in
/// the region. All other edges of the region's facets are its border, each in the direction of its facet. They make
/// loops, closed, the region on the left of each: where one edge comes to a vertex, the next is the other side of the
/// same fan, which is the facets of the region about the vertex that are joined by inner edges. So a loop is at a
/// vertex once for each fan there, and so are loops together. A region without a border has none, nor has one whose
/// border is out of proportion to its facets, such as that of many separate ones.
struct RegionBorders {
  std::vector<std::uint32_t> loops_begin;  // region r has loops [loops_begin[r], loops_begin[r + 1])
  std::vector<std::uint32_t> slots_begin;  // loop k has the vertices in slots [slots_begin[k], slots_begin[k + 1])
  std::vector<std::uint32_t> slots;

  std::span<const std::uint32_t> loop(std::size_t k) const {
    return std::span(slots).subspan(slots_begin[k], slots_begin[k + 1] - slots_begin[k]);
  }
};

class ExcludedPairs;
class RestBoxes;
class RestShapes;

/// The excluded pairs that queries requested last, and the boxes and shapes at rest that serve all of them;
/// excluded_pairs() makes them.
struct ExclusionTables {
  Mutex mutex;
  std::vector<std::shared_ptr<const ExcludedPairs>> latest_first;
  std::shared_ptr<const RestBoxes> rest_boxes;
  std::shared_ptr<const RestShapes> rest_shapes[2];  // of facets alone, and of all features
};

/// A fact about the mesh at rest that is found on first use, by any thread.
struct DuplicateCount {
  static constexpr std::size_t unknown = static_cast<std::size_t>(-1);
  std::atomic<std::size_t> count = unknown;
};

/// The mesh, by its own numbers. make_surface_tree() fills it first, from the mesh alone.
struct SurfaceMesh {
  std::vector<Facet> facets;
  std::vector<std::array<std::uint32_t, 2>> edges;  // in ascending order, each from its lower vertex
  std::vector<Vec3> rest;                           // by vertex
  std::vector<std::uint32_t> component;             // by vertex: component of facets that share vertices
  std::vector<std::uint32_t> ring_begin, ring;      // neighbors of vertex v along edges, ascending:
                                                    // ring[ring_begin[v] … ring_begin[v + 1])
};

/// How the mesh is sorted: blocks of eight facets, and what each block owns. make_surface_tree() fills it from the
/// SurfaceMesh: facets, then vertices, then edges.
struct SurfaceBlocks {
  std::vector<std::uint32_t> order;  // facets in the order of the blocks
  std::vector<Facet> facets_in_order;
  std::vector<std::uint32_t> vertex_of_slot;   // used vertices only
  std::vector<std::uint32_t> slot_of_vertex;   // no_slot: no facet uses the vertex
  std::vector<std::uint32_t> own_vertices;     // block b owns slots [own_vertices[b], own_vertices[b + 1])
  std::vector<std::uint32_t> corners_begin;    // block b has all corners of its facets at
  std::vector<std::uint32_t> corners;          // corners[corners_begin[b] … corners_begin[b + 1]), as slots
  std::vector<std::uint32_t> own_edges_begin;  // block b owns the edges
  std::vector<std::uint32_t> own_edges;        // own_edges[own_edges_begin[b] … own_edges_begin[b + 1])
  std::vector<std::array<std::uint32_t, 2>> ends_of_own_edges;

  std::uint32_t count() const { return static_cast<std::uint32_t>((order.size() + 7) / 8); }
};

/// The pose of the surface; SurfaceTree::update() and follow() set it, each all members of it.
struct SurfacePose {
  std::optional<PositionView> from, to;  // none: at rest
  std::optional<FollowedBody> followed;  // the transform of the body also places `from`
};

/// Queries share it with the surface: the state at which a query stopped stays readable when the surface is gone or has
/// changed.
struct SurfaceTreeState : std::enable_shared_from_this<SurfaceTreeState> {
  static constexpr std::uint32_t no_slot = 0xffffffffu;

  // The surface and its order: make_surface_tree() fills it once, in this order.
  Vec3 origin;            // origin of the boxes' coordinates
  double rest_reach = 0;  // the largest |coordinate| at rest of a vertex that a facet uses
  SurfaceMesh mesh;
  SurfaceBlocks blocks;
  std::vector<RegionBorders> borders;  // by level, from 1 on; the last level is above the level of one group
  std::unique_ptr<ExclusionTables> exclusions = std::make_unique<ExclusionTables>();
  std::unique_ptr<DuplicateCount> duplicates = std::make_unique<DuplicateCount>();

  // The present pose or step: update() and follow() set the pose, move() makes the boxes, then the frame changes.
  SurfacePose pose;
  SurfaceBoxes boxes;                     // boxes of an older pose while the surface follows a body
  std::vector<MinBox> next_vertex_boxes;  // memory of move(): a rejected one leaves `boxes` unchanged
  BlocksOfLeaves blocks_of_leaves;        // blocks by leaf of the last body that was followed
  std::uint64_t frame = 0;
  CallState call;

  /// The boxes then belong to no frame.
  void forget() noexcept { ++frame; }
  std::uint32_t block_count() const { return blocks.count(); }
  Vec3 from_of(std::uint32_t vertex) const {
    const Vec3 p = pose.from ? (*pose.from)[vertex] : mesh.rest[vertex];
    return pose.followed && pose.followed->is_placed ? pose.followed->spheres.transform()(p) : p;
  }
  Vec3 to_of(std::uint32_t vertex) const { return pose.to ? (*pose.to)[vertex] : from_of(vertex); }

  /// For a body whose spheres cover: no vertex that a facet uses has a larger |coordinate|, in the world and about the
  /// surface's origin.
  double farthest_of_spheres(const Collider& body) const;
  /// ok if queries may run: a body that the surface follows has not moved since.
  Status askable(std::uint8_t body) const;

  /// Makes the boxes of the whole surface.
  Status move(Workers& workers);
};

/// Borders of levels 1 to `levels`, the last of which has one region; level 0 stays empty. facets: facets in the order
/// of the tree.
std::vector<RegionBorders> region_borders(std::span<const Facet> facets, std::span<const std::uint32_t> slot_of_vertex,
                                          std::size_t levels);
/// Sorts the mesh and makes the tables; the positions are the rest positions.
SurfaceTreeState make_surface_tree(const MeshView& rest);

}  // namespace morula::detail
