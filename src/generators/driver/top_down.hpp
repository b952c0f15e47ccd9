// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The driver of every generator: each node's region is divided among children, level by level, or the worst leaf first.
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
  std::uint32_t parent{};         // index among the nodes of the level above; valid in level hooks
  std::vector<Sphere> ancestors;  // spheres of the nodes above, except the root's
  std::uint64_t seed{};           // seed of this node's random choices, the same for any number of workers
};

/// The result of one node's division.
struct Division {
  std::vector<BuildNode> children;  // their regions divide the node's; empty: the node stays a leaf
  std::size_t leftover_patches = 0;
  std::string_view reducer{};  // name of the reducer with the best proposal; empty if there is no choice
};
/// The reducer's name on nodes that no reducer had a proposal for.
inline constexpr std::string_view no_proposal = "none (halved)";
/// A divider is called for several nodes at the same time.
using Divider = std::function<Division(const BuildNode&)>;
/// A level hook is called with all nodes of a new level before they join the tree. It may change spheres and regions as
/// long as each sphere, and each of its ancestors', contains the region and no region becomes empty.
using LevelHook = std::function<void(std::vector<BuildNode>&)>;

class ObjectLines;

/// A generator's input for the driver. Pointers are borrowed.
struct DriverInput {
  Divider divide;            ///< returns at most run.branching children with non-empty regions
  Box root_cell = {};        ///< cell of the root node
  LevelHook new_level = {};  ///< called level by level only
  /// Signed distance of the mesh; null: it is made on first use.
  const SignedDistance* distance = nullptr;
  /// Lines of the mesh. With lines no level is looser than the level above it.
  const ObjectLines* lines = nullptr;
  /// Called after the last division of a level-by-level build, so that data for divisions are freed when the cover
  /// takes its memory. It is not called if the worst leaf is divided first.
  std::function<void()> divided = {};
};

/// Whether the options give a number of spheres or a protrusion instead of a depth: then the worst leaf is divided
/// first.
inline bool is_worst_first(const BuildRun& run) {
  return run.spheres > 0 || run.max_protrusion > 0;
}
CoveredTree top_down(const MeshView& mesh, const BuildRun& run, const DriverInput& input, Workers& workers);

}  // namespace morula::detail
