// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a surface tree consists of.
//
// Facets are sorted so that blocks of eight, of 64, of 512 … are compact; box group g of level k has the boxes of 8 g
// to 8 g + 7 of that level, and level 0's are those of blocks. So there are no links: below box i of level k are those
// of group i of level k − 1. Vertices have slots, those that a block owns one after the other.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <morula/geometry/mesh_view.hpp>
#include <morula/surface/surface_tree.hpp>
#include <mutex>
#include <optional>
#include <vector>

#include "geometry/object_call.hpp"
#include "surface/boxes/followed_body.hpp"
#include "surface/boxes/region_borders.hpp"
#include "surface/boxes/surface_boxes.hpp"

namespace morula::detail {

class ExcludedPairs;

/// The tables of excluded pairs that queries asked for last: excluded_pairs() makes them.
struct ExclusionTables {
  std::mutex mutex;
  std::vector<std::shared_ptr<const ExcludedPairs>> latest_first;
};

/// Queries share it with the surface: what they stand at stays readable when the surface is gone or is another.
struct SurfaceTreeState : std::enable_shared_from_this<SurfaceTreeState> {
  static constexpr std::uint32_t no_slot = 0xffffffffu;

  // The surface, and how it is sorted.
  std::vector<Facet> facets;
  std::vector<std::array<std::uint32_t, 2>> edges;
  std::vector<Vec3> rest;                // by vertex
  std::vector<std::uint32_t> component;  // by vertex; of facets that share vertices
  std::vector<std::uint32_t> order;      // facets as blocks have them
  std::vector<Facet> facets_in_order;
  std::vector<std::uint32_t> vertex_of_slot;   // used vertices alone
  std::vector<std::uint32_t> slot_of_vertex;   // no_slot: no facet uses it
  std::vector<std::uint32_t> own_vertices;     // block b owns slots [own_vertices[b], own_vertices[b + 1])
  std::vector<std::uint32_t> corners_begin;    // all corners of its facets are
  std::vector<std::uint32_t> corners;          // corners[corners_begin[b] … corners_begin[b + 1]), as slots
  std::vector<std::uint32_t> own_edges_begin;  // its edges are
  std::vector<std::uint32_t> own_edges;        // own_edges[own_edges_begin[b] … own_edges_begin[b + 1])
  std::vector<std::array<std::uint32_t, 2>> ends_of_own_edges;
  std::vector<std::uint32_t> ring_begin, ring;  // neighbors of a vertex along edges, ascending
  std::vector<RegionBorders> borders;           // of levels 1 and above, the last one above that of one group
  Vec3 origin;                                  // what boxes are about
  double rest_reach = 0;                        // the largest |coordinate| at rest of a vertex that a facet uses
  std::unique_ptr<ExclusionTables> exclusions = std::make_unique<ExclusionTables>();

  // The present pose or step.
  SurfaceBoxes boxes;  // of an older one while a body is followed
  std::vector<MinBox> next_vertex_boxes;
  std::optional<PositionView> from, to;  // none: at rest
  std::optional<FollowedBody> followed;  // where it is placed, `from` is, too
  BlocksOfLeaves blocks_of_leaves;       // of the body followed last
  std::uint64_t frame = 0;
  CallState call;

  /// Boxes are of no frame, then.
  void forget() noexcept { ++frame; }
  std::uint32_t block_count() const { return static_cast<std::uint32_t>((order.size() + 7) / 8); }
  Vec3 from_of(std::uint32_t vertex) const {
    const Vec3 p = from ? (*from)[vertex] : rest[vertex];
    return followed && followed->is_placed ? followed->spheres.transform()(p) : p;
  }
  Vec3 to_of(std::uint32_t vertex) const { return to ? (*to)[vertex] : from_of(vertex); }

  /// Of a body whose pose covers: no vertex that a facet uses has a larger coordinate, in the world and about the
  /// surface's origin.
  double farthest_of_spheres(const FollowedBody& of) const;
  /// May it be asked: is a body that it follows where it was?
  Status askable(std::uint8_t body) const;

  /// Makes the boxes of all that is there.
  Status move(Workers& workers);
};

/// Sorts and links everything; positions are those at rest.
SurfaceTreeState make_surface_tree(const MeshView& rest);

}  // namespace morula::detail
