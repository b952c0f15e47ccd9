// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Generators: a sphere tree with its proof, made from a mesh.
//
//   morula::CoveredTree model = morula::build(mesh);                        // the depth follows the number of facets
//   morula::CoveredTree shallow = morula::build(mesh, {.method = morula::Method::grid, .branching = 8, .depth = 2});
//   morula::CoveredTree flat = morula::build(mesh, {.spheres = 64});        // at most 64 leaves, as tight as they get
//   if (!flat.report.complete) std::puts("a limit ended the build; the tree covers all the same");
//   morula::write_tree("limb.morula", model);
#pragma once

#include <cstdint>
#include <functional>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <stop_token>
#include <string_view>
#include <vector>

namespace morula {

enum class Method {
  octree,     ///< occupied cells of a halved cube [liu1988, hubbard1993]; fastest, loosest
  grid,       ///< per node, the smallest oriented lattice whose occupied cells number at most branching [bradshaw2002]
  hubbard,    ///< Voronoi balls of surface samples, merged [hubbard1996]
  spawn,      ///< spheres that all stick out equally, laid one beside the other [bradshaw2002]
  medial,     ///< balls of an adaptive medial axis, reduced by merge, burst, expand [bradshaw2004]
  combined,   ///< several reducers, the best for each node [bradshaw2002]
  optimized,  ///< our own: least outside volume, searched from several starts
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
enum class Optimizer {
  none,
  recenter,  ///< each sphere moved to where it sticks out least, three rounds
  simplex,   ///< worst sphere first, center and radius searched, samples changing hands [bradshaw2002]
  balance,   ///< the same, then as many spheres removed as cost nothing [bradshaw2002]
};
std::string_view name(Optimizer optimizer);
std::optional<Optimizer> optimizer_from_name(std::string_view name);
std::span<const Optimizer> all_optimizers();

/// Time for tightness, for the method `optimized`; the others have one way.
/// draft is for rebuilding while a body moves: 0.7 of the time of fast.
enum class Quality { draft, fast, standard, best };
/// "draft", "fast", "default", "best".
std::string_view name(Quality quality);
std::optional<Quality> quality_from_name(std::string_view name);
std::span<const Quality> all_qualities();

/// How far a build is.
struct BuildProgress {
  double share;                        ///< of the time it takes, 0…1, estimated; never decreasing, 1 at the end
  int level;                           ///< the level that is being made; with spheres or max_protrusion, the deepest
  std::optional<double> seconds_left;  ///< nothing until there is something to estimate it by
};

struct BuildOptions {
  Method method = Method::optimized;
  int branching = 8;  ///< most children of a node, 2…64
  /// Levels below the root, 0…8; nothing: automatic_depth of the mesh, and the tree of a body like a ball, whose parts
  /// are as large as the whole at rest, is one sphere. Without effect when one of the next two is given.
  std::optional<int> depth{};
  /// One flat set of at most so many spheres, 1 or more, that covers the surface, as tight as the method makes it: the
  /// leaves. The tree above it is as deep as it needs to be, up to max_depth.
  std::optional<std::size_t> spheres{};
  /// As few leaves as needed for each to stick out of the object by at most this length, above 0, mesh units, proven by
  /// r + φ(c). With `spheres` too: until the one or the other.
  std::optional<double> max_protrusion{};
  /// Every sphere contains its children's, for engines that prune that way (certify_nesting): inner spheres grow or
  /// move for it, leaves stay as they are. Looser above them: docs/explanation/cover.md has a table.
  bool nested = false;
  std::uint64_t seed = 1;  ///< of every random choice; equal seeds, equal bits
  /// For medial: of merge, burst, expand; none means merge and expand. For combined: of all; none means grid, spawn,
  /// merge and expand. Every one adds to the time; the best is taken for each node.
  std::vector<Reduction> reducers{};
  Optimizer optimizer = Optimizer::none;  ///< for all methods but octree and optimized
  double balance_excess = 0;              ///< for balance: share by which the worst sphere may stick out further
  Quality quality = Quality::standard;    ///< for method optimized
  /// Not negative. When it is over, nodes not yet divided stay leaves: the tree covers as ever, report.notes says what
  /// was left, and report.complete is false. How far it gets depends on the machine: such a result is not reproducible.
  std::optional<double> time_limit_seconds{};
  /// Asked before every node, on all threads. Once requested, build throws BuildStopped as soon as the nodes in work
  /// are done.
  std::stop_token stop{};
  /// Called on the calling thread. May request the stop.
  std::function<void(const BuildProgress&)> progress{};
};

/// The stop was requested; nothing was built.
class BuildStopped : public std::runtime_error {
 public:
  BuildStopped() : std::runtime_error("build: stopped on request") {}
};

/// The most levels that a tree has which is not told how deep to be: at most 8, with at most 512 leaves and at most a
/// quarter as many as facets; at least 1. With branching 8: 1 below 256 facets, 2 below 2,048, 3 from there on.
/// Finer leaves cost time in every update and follow the facets' corners, not the shape. facet_count: of the mesh.
/// branching: at least 2.
int automatic_depth(std::size_t facet_count, int branching);

/// Depth of a tree that is not told how deep to be: automatic_depth of its number of facets, less where these are
/// needles. A facet falls into a patch for each leaf that it reaches; as many levels are left out, down to 1, as bring
/// the patches to be expected to twice those of as many equilateral facets. mesh: finite, of the range of
/// build(). Cost: linear in facets.
int automatic_depth(const MeshView& mesh, int branching);

/// Builds a tree whose every level covers the surface: each sphere contains its region, regions of siblings are
/// disjoint, and a node's region is the union of its children's (region wrapping; child spheres may stick out of their
/// parent's, unless options.nested). Works on open, non-manifold and multi-component meshes. The last step proves that
/// spheres contain their regions: certify() holds for every tree that is returned, wherever the mesh is.
///
/// A region that cannot be told apart further, or does not get tighter by division, ends in a leaf above the last
/// level; so does a node with a child that is the same sphere. Same bits for any number of workers, unless a time limit
/// ends it. Cost: near-linear in facets × levels. Throws std::invalid_argument for unusable meshes (require_usable,
/// require_usable_scale) and options out of range, before any work; BuildStopped.
CoveredTree build(const MeshView& mesh, const BuildOptions& options = {}, WorkersOrAll workers = {});

}  // namespace morula
