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

class ObjectLines;

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

/// root_cell: of the root node. The divider must return at most options.branching children with non-empty regions.
/// shape, lines: of the mesh, borrowed, where the generator has them anyway. With lines no level is looser than the
/// level above it. divided: called when no level is divided any more, so that what only dividing needs is gone when the
/// cover takes its memory; not where the run asks for a flat set.
CoveredTree top_down(const Mesh& mesh, const BuildRun& run, const Box& root_cell, const Divider& divide,
                     Workers& workers, const SignedDistance* shape = nullptr, const ObjectLines* lines = nullptr,
                     const LevelHook& new_level = {}, const std::function<void()>& divided = {});

/// The generators: what divides a node, with whatever they need to know about the mesh.
CoveredTree build_octree(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_grid(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_hubbard(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_spawn(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_medial(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_combined(const Mesh& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_own(const Mesh& mesh, const BuildRun& run, Workers& workers);

}  // namespace morula::detail
