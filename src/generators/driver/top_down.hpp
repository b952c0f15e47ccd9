// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The driver that every generator goes through: each node's region is divided among children, level by level, or the
// worst leaf first.
#pragma once

#include <functional>
#include <morula/query/signed_distance.hpp>
#include <string_view>

#include "generators/driver/build_run.hpp"
#include "tree/region.hpp"

namespace morula::detail {

/// A node while the tree is being built.
struct BuildNode {
  Region region;
  Sphere sphere;                  // wraps the region, radius rounded up
  Box cell;                       // the part of space that an octree node stands for; empty otherwise
  int level = 0;                  // 0: the root
  std::uint32_t parent{};         // its place among the nodes of the level above; known to level hooks
  std::vector<Sphere> ancestors;  // spheres of the nodes above, the root's aside
  std::uint64_t seed{};           // of this node's random choices, the same for any number of workers
};

/// What a generator did to one node.
struct Division {
  std::vector<BuildNode> children;  // their regions divide the node's; empty: the node stays a leaf
  std::size_t leftover_patches = 0;
  std::string_view reducer{};  // whose proposal it is; empty where there is no choice
};
/// The reducer's name on nodes that no reducer had a proposal for.
inline constexpr std::string_view no_proposal = "none (halved)";
/// Called for several nodes at the same time.
using Divider = std::function<Division(const BuildNode&)>;
/// Called with all nodes of a new level before they join the tree. May change spheres and regions as long as each
/// sphere, and each of its ancestors', contains the region and no region becomes empty.
using LevelHook = std::function<void(std::vector<BuildNode>&)>;

class ObjectLines;

/// What a generator has for the driver. Pointers are borrowed.
struct DriverInput {
  Divider divide;            ///< returns at most run.branching children with non-empty regions
  Box root_cell = {};        ///< of the root node
  LevelHook new_level = {};  ///< level by level only
  /// Of the mesh; null: made where it is needed.
  const SignedDistance* distance = nullptr;
  /// Of the mesh. With lines no level is looser than the level above it.
  const ObjectLines* lines = nullptr;
  /// Called when no level is divided any more, so that what only dividing needs is gone when the cover takes its
  /// memory; not where the worst leaf is first.
  std::function<void()> divided = {};
};

/// Whether the run asks for a number of spheres or a protrusion instead of a depth: then the worst leaf is divided
/// first.
inline bool is_worst_first(const BuildRun& run) {
  return run.spheres > 0 || run.max_protrusion > 0;
}
CoveredTree top_down(const MeshView& mesh, const BuildRun& run, const DriverInput& input, Workers& workers);

}  // namespace morula::detail
