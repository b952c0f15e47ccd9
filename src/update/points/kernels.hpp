// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops of an update that wide registers speed up: one source, kernels.inl, compiled for each kind of processor and
// chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/vector.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// Lists of points come in groups of this many; short ones repeat their last entry, which changes no maximum.
inline constexpr std::size_t points_per_group = 16;
inline constexpr std::size_t most_centers = 4;
/// Points that stand for all that a node owns when its center is pulled.
inline constexpr std::size_t core_size = 32;

/// Points [begin, end), a multiple of points_per_group.
struct PointRun {
  std::uint32_t begin, end;
};

/// Nodes whose centers are moved at once, one in each lane or a few times that.
inline constexpr std::size_t nodes_at_once = 16;
/// Nodes whose anchors lie side by side: anchor i of the group's node j at 4 i + j.
inline constexpr std::size_t nodes_per_group = 4;

/// A cut point on an edge: `weight` of the way from the first point to the second.
struct EdgeCut {
  std::array<std::uint32_t, 2> point;
  float weight;
};

/// One inside a facet, with the shares of the ways to two others.
struct InnerCut {
  std::array<std::uint32_t, 3> point;
  float weight1, weight2;
};

/// Remainders that axes of three anchors carry (CenterTie): entry i of every array. Arrays go on for nodes_at_once
/// entries, whose points are good ones.
struct Remainders {
  const std::uint32_t* points[3];
  const float *in_axes[3], *at_rest[3];
};

/// What the radii of a frame allow for (Rounding::allowances). rounding.hpp proves that it is enough.
struct RadiusAllowances {
  double coordinate;      ///< of the origin and the points
  double per_coordinate;  ///< a length, for every unit of that and of the center's coordinates
  double least;           ///< a length, whatever the center

  /// What a distance is multiplied with that was squared in float, and what is added for squares that vanish.
  // mutant covering-distance: `1 + 0x1p-22` -> `1`
  // mutant covering-distance-less: `22` -> `24`
  // mutant covering-underflow: `0x1p-62` -> `0`
  static constexpr double of_distance = 1 + 0x1p-22, of_underflow = 0x1p-62;
};

/// What leaves look at. Leaf k has runs [run_begin[k], run_begin[k + 1]), and its chain: itself and the nodes above it
/// that are measured, from the top, each as its place in `nodes`. Entry e of the chain looks at all runs and at the
/// points [point_begin[k], point_end[e]), whole groups; those below look at as many or more.
struct LeafLists {
  const PointRun* runs;
  const std::uint32_t *run_begin, *points, *point_begin, *point_end, *chain, *chain_begin, *nodes;
};

/// A center on its way: see pull.
struct Pull {
  const std::uint32_t* core;  ///< core_size points
  float enough;               ///< squared: a largest squared distance at or below this ends the pull
  float rest_radius;          ///< largest distance to the core at rest
};

/// Points of the surface that tell how near it comes to a leaf's center.
inline constexpr std::size_t near_size = 16;
/// Leaves whose centers are fitted, nodes_at_once of them: point i of leaf k is cores[nodes_at_once * i + k], one of
/// the core_size outermost that it owns, or near[nodes_at_once * i + k]. A leaf costs r² - d², where r is the largest
/// distance from the center to its core, and d the least one to its near points: how deep, as a power, the nearest of
/// the surface lies in the sphere.
struct Fits {
  const std::uint32_t *cores, *near;
  const float* enough;  ///< a leaf that costs no more is good
};

/// All kernels give the same bits: every distance is taken by the same operations in the same order, without fused
/// ones, and then only compared.
struct Kernels {
  /// squared[k] = largest squared distance from centers[k] to a point of the runs or of the list; 0 without any. At
  /// most most_centers; index.size() is a multiple of points_per_group.
  void (*farthest)(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                   std::span<const Vec3f> centers, float* squared);
  /// groups[g] = largest squared distance from the center to a point of group g: points_per_group at once of the runs,
  /// then of the list.
  void (*farthest_of_groups)(const LocalPoint* points, std::span<const PointRun> runs,
                             std::span<const std::uint32_t> index, const Vec3f& center, float* groups);
  /// The largest squared distance to a point of the groups that have `least` or more; 0 without any.
  float (*farthest_of_some)(const LocalPoint* points, std::span<const PointRun> runs,
                            std::span<const std::uint32_t> index, const Vec3f& center, const float* groups,
                            float least);
  /// The center moved towards the farthest point of its core, up to pull_steps times: the best place on the way
  /// [badoiu2003], so never one farther from the core than it was.
  Vec3f (*pull)(const LocalPoint* points, const Pull& pull, const Vec3f& center);
  /// The same for nodes_at_once centers, in place, each with its own radius and core of core_count points: point i of
  /// center k is cores[nodes_at_once * i + k]. enough: most_growth times the radius, squared.
  void (*pull_many)(const LocalPoint* points, const std::uint32_t* cores, std::size_t core_count,
                    const float* rest_radii, LocalPoint* centers);
  /// Centers moved to where they cost less, in place: up to fit_steps times the way from the nearest of the near points
  /// to the farthest of the core, which is where the cost falls most; the best place on the way, so never one that
  /// costs more than where it was, nor one from where r² is more than most_squared_growth times as large.
  void (*fit_many)(const LocalPoint* points, const Fits& fits, LocalPoint* centers);
  /// sums[k] = the sum of a node's anchors by weight, those with even numbers and those with odd ones first summed by
  /// themselves. Group g of nodes_per_group nodes has the entries [group_begin[g], group_begin[g + 1]) of index and
  /// weight, an even number for each node, padded by weights 0.
  void (*weighted_sums)(const LocalPoint* points, const std::uint32_t* index, const float* weight,
                        std::span<const std::uint32_t> group_begin, LocalPoint* sums);
  /// Where the remainders begin … end - 1 have come, minus where they were at rest; written in whole nodes_at_once.
  void (*carry)(const LocalPoint* points, const Remainders& remainders, std::size_t begin, std::size_t end,
                LocalPoint* moves);
  /// For the leaves [begin, end), and the nodes of their chains whose place is below `count`: squared[e] = largest
  /// squared distance from the center of node chain[e] to a point of the leaf that it looks at.
  void (*farthest_of_leaves)(const LocalPoint* points, const LeafLists& lists, std::size_t begin, std::size_t end,
                             std::size_t count, const Spheref* spheres, float* squared);
  /// radii[i] = Rounding::covering_radius of squared[i], about a center whose largest |coordinate| is norms[i].
  void (*covering_radii)(const float* squared, const float* norms, std::size_t count,
                         const RadiusAllowances& allowances, float* radii);
  /// out[i] = where cuts[i] is.
  void (*move_edge_cuts)(const LocalPoint* points, const EdgeCut* cuts, std::size_t count, LocalPoint* out);
  void (*move_inner_cuts)(const LocalPoint* points, const InnerCut* cuts, std::size_t count, LocalPoint* out);
  /// out[i] = the i-th of `count` packed points (x, y, z of each, nothing between) minus origin. Returns the largest
  /// bit pattern of an absolute coordinate: of infinity or more when one is not finite.
  std::uint32_t (*narrow_floats)(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out);
  /// The same, where the i-th goes to out[to[i]].
  std::uint32_t (*narrow_scattered)(const float* packed, std::size_t count, const Vec3f& origin,
                                    const std::uint32_t* to, LocalPoint* out);
};
inline constexpr int pull_steps = 4;
inline constexpr int fit_steps = 8;
/// Squared: a radius grows by 2 % at most. Off a sheet it could for ever, at the same cost.
inline constexpr float most_squared_growth = 1.0404f;
/// Of each step of a fit: its length as a share of r - d, on a way as long as r.
inline constexpr float fit_lengths[fit_steps] = {0.5f, 0.5f, 0.5f, 0.5f, 0.4f, 0.33f, 0.29f, 0.25f};
/// Spheres that are no more than this times as large as at rest are good.
inline constexpr float most_growth = 1.01f;

/// Those that this processor can run, narrowest first.
std::span<const Kernels> all_kernels();
/// The widest.
const Kernels& kernels();

}  // namespace morula::detail
