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
#include <vector>

namespace morula {

enum class Method {
  octree,  ///< occupied cells of a halved cube [liu1988, hubbard1993]; fastest, loosest
  grid,    ///< per node, the smallest oriented lattice whose occupied cells number at most branching [bradshaw2002]
  hubbard,   ///< Voronoi balls of surface samples, merged [hubbard1996]
  spawn,     ///< spheres that all stick out equally, laid one beside the other [bradshaw2002]
  medial,    ///< balls of an adaptive medial axis, reduced by merge, burst, expand [bradshaw2004]
  combined,  ///< several reducers, the best for each node [bradshaw2002]
  morula,    ///< our own: least outside volume, searched from several starts
};
std::string_view name(Method method);
std::optional<Method> method_from_name(std::string_view name);
std::span<const Method> all_methods();

/// How few spheres are made for a node, by name: the methods above, and the three reductions of `medial`.
enum class Reduction { grid, hubbard, spawn, merge, burst, expand };
std::string_view name(Reduction reduction);
std::optional<Reduction> reduction_from_name(std::string_view name);
std::span<const Reduction> all_reductions();

/// What is done to proposed spheres before they are fitted to their part of the surface.
enum class Optimiser {
  none,
  refit,    ///< each sphere moved to where it sticks out least, three rounds
  simplex,  ///< worst sphere first, centre and radius searched, samples changing hands [bradshaw2002]
  balance,  ///< the same, then as many spheres removed as cost nothing [bradshaw2002]
};
std::string_view name(Optimiser optimiser);
std::optional<Optimiser> optimiser_from_name(std::string_view name);
std::span<const Optimiser> all_optimisers();

struct BuildOptions {
  Method method = Method::grid;
  int branching = 8;       ///< most children of a node, 2…64
  int depth = 3;           ///< levels below the root, 0…8
  std::uint64_t seed = 1;  ///< of every random choice; equal seeds, equal bits
  /// For medial: of merge, burst, expand; none means merge and expand. For combined: of all; none means grid, spawn,
  /// merge and expand. Every one adds to the time; the best is taken for each node.
  std::vector<Reduction> reducers{};
  Optimiser optimiser = Optimiser::none;  ///< for all methods but octree
  double balance_excess = 0;              ///< for balance: share by which the worst sphere may stick out further
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
