// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// From a mesh to a sphere tree with its proof.
#pragma once

#include <cstdint>
#include <functional>
#include <morula/geometry/mesh.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <span>
#include <string_view>

namespace morula {

enum class Method {
  octree,  ///< occupied cells of a halved cube [liu1988, hubbard1993]; fastest, loosest
  grid,    ///< per node, the smallest oriented lattice whose occupied cells number at most branching [bradshaw2002]
  morula,  ///< our own
};
std::string_view name(Method method);
std::optional<Method> method_from_name(std::string_view name);
std::span<const Method> all_methods();

struct BuildOptions {
  Method method = Method::grid;
  int branching = 8;       ///< most children of a node, 2…64
  int depth = 3;           ///< levels below the root, 0…8
  std::uint64_t seed = 1;  ///< of every random choice; equal seeds, equal bits
  /// Called on the calling thread with the share of work done, 0…1, never decreasing.
  std::function<void(double)> progress{};
};

/// Builds a tree whose every level covers the surface: each sphere contains its region, regions of siblings are
/// disjoint, and a node's region is the union of its children's (region wrapping; child spheres may stick out of their
/// parent's). Works on open, non-manifold and multi-component meshes.
///
/// A region that cannot be told apart further, or does not get tighter by division, ends in a leaf above the last
/// level. Same bits for any number of workers. Cost: near-linear in facets × levels. Throws std::invalid_argument for
/// unusable meshes (require_usable) and options out of range, before any work.
Built build(const Mesh& mesh, const BuildOptions& options = {}, Workers& workers = serial_workers());

}  // namespace morula
