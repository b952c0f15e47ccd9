// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Generators: build a sphere tree with its cover from a mesh.
//
//   morula::CoveredTree model = morula::build(mesh);                        // the depth follows the number of facets
//   morula::CoveredTree shallow = morula::build(mesh, {.method = morula::Method::grid, .branching = 8, .depth = 2});
//   morula::CoveredTree flat = morula::build(mesh, {.spheres = 64});        // at most 64 leaves, as tight as possible
//   if (!flat.report.complete) std::puts("a limit ended the build; the tree covers all the same");
//   morula::write_tree("limb.morula", model);
#pragma once

#include <cstdint>
#include <functional>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/mesh_view.hpp>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace morula {

enum class Method {
  octree,     ///< occupied cells of a cube that is halved repeatedly [liu1988, hubbard1993]; fastest, loosest
  grid,       ///< per node, the finest oriented lattice with at most `branching` occupied cells [bradshaw2002]
  hubbard,    ///< Voronoi balls of surface samples, merged [hubbard1996]
  spawn,      ///< spheres of equal protrusion, placed one next to the other [bradshaw2002]
  medial,     ///< balls of an adaptive medial axis, reduced by merge, burst, expand [bradshaw2004]
  combined,   ///< several reducers, the best for each node [bradshaw2002]
  optimized,  ///< Morula's own: least outside volume, searched from several starts
};

/// The reduction of a node's spheres to a few, by name: the methods above, and the three reductions of `medial`.
enum class Reduction { grid, hubbard, spawn, merge, burst, expand };

/// The optimization of proposed spheres ahead of their fit to the surface.
enum class Optimizer {
  none,
  recenter,  ///< moves each sphere to where it sticks out least, three rounds
  simplex,   ///< worst sphere first, searches center and radius, with reassignment of samples [bradshaw2002]
  balance,   ///< like simplex, then removes spheres while this costs nothing [bradshaw2002]
};

/// Trade-off of build time and tightness, for the method `optimized`; the other methods have only one. draft is for
/// rebuilds while a body moves: 0.7 of the time of fast.
enum class Quality { draft, fast, standard, best };

struct BuildProgress;

struct BuildOptions {
  Method method = Method::optimized;
  int branching = 8;  ///< largest number of children of a node, 2…64
  /// Levels below the root, 0…8. No value: automatic_depth of the mesh; a ball-like body, whose parts are as large as
  /// the whole at rest, then gets one sphere. Without effect if one of the next two options is set.
  std::optional<int> depth{};
  /// Largest number of spheres, 1 or more, of one flat set that covers the surface as tightly as the method can: the
  /// leaves. The tree above it is as deep as necessary, up to max_depth.
  std::optional<std::size_t> spheres{};
  /// Largest protrusion of a leaf, above 0, mesh units, proven by r + φ(c): the build uses as few leaves as it can.
  /// With a tolerance: of the reduced leaf. Together with `spheres`, the build ends at the first of both limits.
  std::optional<double> max_protrusion{};
  /// Distance within which spheres have to cover, 0 or more, mesh units; for the method `optimized`. Above 0 the tree
  /// is fitted for spheres whose radii are smaller by that length: reduced(model.tree, tolerance) makes them. Every
  /// point of the surface is proven to lie within the tolerance of each level of them, and their outside volume is what
  /// the fit minimizes. The returned tree covers: it has the radii before the reduction, so bodies and queries may use
  /// it.
  double tolerance = 0;
  /// true: every sphere contains its children's, for engines that prune by this (certify_nesting). Inner spheres grow
  /// or move, leaves stay unchanged. Levels above the leaves get looser: docs/explanation/cover.md has a table.
  bool nested = false;
  std::uint64_t seed = 1;  ///< seed of all random choices; equal seeds give equal bits
  /// Reductions. For medial: of merge, burst, expand; empty means merge and expand. For combined: of all; empty means
  /// grid, spawn, merge and expand. Each adds build time; the best is used for each node.
  std::vector<Reduction> reducers{};
  Optimizer optimizer = Optimizer::none;  ///< optimizer for all methods except octree and optimized
  double balance_excess = 0;            ///< for balance: share by which the protrusion of the worst sphere may increase
  Quality quality = Quality::standard;  ///< quality of the method `optimized`
  /// Limit of the build time, seconds; not negative. When it is reached, undivided nodes stay leaves: the tree covers
  /// nevertheless, report.notes lists the rest, and report.complete is false. Progress depends on the machine, so such
  /// a result is not reproducible.
  std::optional<double> time_limit_seconds{};
  /// Read at intervals, like an Interrupt, and ahead of every node on all threads. After a stop request, build throws
  /// BuildStopped as soon as the nodes in progress are done.
  StopToken stop{};
  /// Called on the calling thread. It may request the stop.
  std::function<void(const BuildProgress&)> progress{};
};

/// Builds a tree in which every level covers the surface. Each sphere contains its region; regions of siblings are
/// disjoint; a node's region is the union of its children's (region wrapping; child spheres may stick out of their
/// parent's, unless options.nested). Accepts open, non-manifold and multi-component meshes. The last step proves that
/// spheres contain their regions: certify() holds for every returned tree, for a mesh at any position.
///
/// A region that cannot be divided further, or does not get tighter by division, ends in a leaf above the last level;
/// so does a node with a child that is the same sphere. The result has the same bits for any number of workers, unless
/// a time limit ends the build. Cost: near-linear in facets × levels. Throws std::invalid_argument for unusable meshes
/// (require_usable, require_usable_scale) and for options out of range, ahead of any work; throws BuildStopped.
CoveredTree build(const MeshView& mesh, const BuildOptions& options = {}, WorkersOrAll workers = {});

/// The progress of a build.
struct BuildProgress {
  double share;                        ///< share of the total time, 0…1, estimated; never decreasing, 1 at the end
  int level;                           ///< present level; with spheres or max_protrusion, the deepest one
  std::optional<double> seconds_left;  ///< estimate of the remaining time, seconds; no value until one is possible
};

/// A stop was requested; no tree was built.
class BuildStopped : public std::runtime_error {
 public:
  BuildStopped() : std::runtime_error("build: stopped on request") {}
};

/// Largest automatic depth: at most 8, with at most 512 leaves and at most a quarter as many leaves as facets; at least
/// 1. With branching 8: 1 below 256 facets, 2 below 2,048, 3 from 2,048 on. Finer leaves cost time in every update and
/// follow the facets' corners, not the shape. facet_count: of the mesh. branching: at least 2.
int automatic_depth(std::size_t facet_count, int branching);

/// Automatic depth of a mesh: automatic_depth of its number of facets, less for needle-shaped facets. A facet is cut
/// into a patch for each leaf that it reaches; the depth is reduced, down to 1, until the expected number of patches is
/// at most twice that of equilateral facets. mesh: finite, of the range of build(). Cost: linear in facets.
int automatic_depth(const MeshView& mesh, int branching);

// Names of the enumerators in files and commands, and lists of all of them.

std::string_view name(Method method);
std::optional<Method> method_from_name(std::string_view name);
std::span<const Method> all_methods();

std::string_view name(Reduction reduction);
std::optional<Reduction> reduction_from_name(std::string_view name);
std::span<const Reduction> all_reductions();

std::string_view name(Optimizer optimizer);
std::optional<Optimizer> optimizer_from_name(std::string_view name);
std::span<const Optimizer> all_optimizers();

/// Names: "draft", "fast", "default", "best".
std::string_view name(Quality quality);
std::optional<Quality> quality_from_name(std::string_view name);
std::span<const Quality> all_qualities();

}  // namespace morula
