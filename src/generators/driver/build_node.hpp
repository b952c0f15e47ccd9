// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A node while its tree is being built, and what divides it.
#pragma once

#include <functional>
#include <string_view>

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

}  // namespace morula::detail
