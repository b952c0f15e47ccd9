// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The loops of an update that wide registers speed up: one source, kernels.inl, is compiled for each kind of processor,
// and the kind is chosen at run time.
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
/// Points that stand for all points of a node when its center is pulled.
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

/// A cut point inside a facet, with the shares of the ways to two others.
struct InnerCut {
  std::array<std::uint32_t, 3> point;
  float weight1, weight2;
};

/// Remainders that axes of three anchors carry (CenterTie): entry i of every array. Arrays are padded by nodes_at_once
/// entries with valid points.
struct Remainders {
  const std::uint32_t* points[3];
  const float *in_axes[3], *at_rest[3];
};

/// Allowances of a frame's radii (Rounding::allowances). rounding.hpp proves that they are enough.
struct RadiusAllowances {
  double coordinate;      ///< largest |coordinate| of the origin and the points
  double per_coordinate;  ///< a length per unit of `coordinate` and of the center's largest |coordinate|
  double least;           ///< a length, for every center

  /// Factor of a distance that was squared in float, and the addend for squares that vanish.
  // mutant covering-distance: `1 + 0x1p-22` -> `1`
  // mutant covering-distance-less: `22` -> `24`
  // mutant covering-underflow: `0x1p-62` -> `0`
  static constexpr double of_distance = 1 + 0x1p-22, of_underflow = 0x1p-62;
};

/// Input of the walk over leaves. Leaf k has runs [run_begin[k], run_begin[k + 1]), and its chain: the measured ones of
/// itself and the nodes above it, from the top, each as its place in `nodes`. Entry e of the chain reads all runs and
/// the points [point_begin[k], point_end[e]), whole groups; lower entries read as many or more.
struct LeafLists {
  const PointRun* runs;
  const std::uint32_t *run_begin, *points, *point_begin, *point_end, *chain, *chain_begin, *nodes;
};

/// Input of pull: a center that is moved.
struct Pull {
  const std::uint32_t* core;  ///< core_size points
  float enough;               ///< squared distance: the pull ends at a largest squared distance at or below this
  float rest_radius;          ///< largest distance to the core at rest
};

/// Points of the surface from which its distance to a leaf's center is estimated.
inline constexpr std::size_t near_size = 16;
/// Leaves whose centers are fitted, nodes_at_once of them: point i of leaf k is cores[nodes_at_once * i + k], one of
/// the core_size outermost that it owns, or near[nodes_at_once * i + k]. A leaf costs r² - d², where r is the largest
/// distance from the center to its core, and d the least one to its near points: the depth, as a power, of the nearest
/// surface in the sphere.
struct Fits {
  const std::uint32_t *cores, *near;
  const float* enough;  ///< cost of each leaf that needs no further fit
};

/// All kernels give the same bits: every distance is computed by the same operations in the same order, without fused
/// ones, and then only compared.
struct Kernels {
  /// squared[k] = largest squared distance from centers[k] to a point of the runs or of the list; 0 without any. At
  /// most most_centers; index.size() is a multiple of points_per_group.
  void (*farthest)(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                   std::span<const Vec3f> centers, float* squared);
  /// groups[g] = largest squared distance from the center to a point of group g: groups of points_per_group points,
  /// first those of the runs, then those of the list.
  void (*farthest_of_groups)(const LocalPoint* points, std::span<const PointRun> runs,
                             std::span<const std::uint32_t> index, const Vec3f& center, float* groups);
  /// Returns the largest squared distance to a point of the groups that have `least` or more; 0 without any.
  float (*farthest_of_some)(const LocalPoint* points, std::span<const PointRun> runs,
                            std::span<const std::uint32_t> index, const Vec3f& center, const float* groups,
                            float least);
  /// Returns the center moved towards the farthest point of its core, up to pull_steps times: the best place on the way
  /// [badoiu2003], so never one farther from the core than the start.
  Vec3f (*pull)(const LocalPoint* points, const Pull& pull, const Vec3f& center);
  /// Pulls nodes_at_once centers, in place, each with its own radius and core of core_count points: point i of center k
  /// is cores[nodes_at_once * i + k]. enough: most_growth times the radius, squared.
  void (*pull_many)(const LocalPoint* points, const std::uint32_t* cores, std::size_t core_count,
                    const float* rest_radii, LocalPoint* centers);
  /// Moves centers to places of lower cost, in place: up to fit_steps times along the way from the nearest of the near
  /// points to the farthest of the core, along which the cost falls most. The result is the best place on the way, so
  /// never one of higher cost than the start, nor one from which r² is more than most_squared_growth times as large.
  void (*fit_many)(const LocalPoint* points, const Fits& fits, LocalPoint* centers);
  /// sums[k] = the sum of a node's anchors by weight; anchors with even numbers and anchors with odd ones are first
  /// summed by themselves. Group g of nodes_per_group nodes has the entries [group_begin[g], group_begin[g + 1]) of
  /// index and weight, an even number for each node, padded by weights 0.
  void (*weighted_sums)(const LocalPoint* points, const std::uint32_t* index, const float* weight,
                        std::span<const std::uint32_t> group_begin, LocalPoint* sums);
  /// Writes the carried remainders begin … end - 1 minus their values at rest, in whole multiples of nodes_at_once.
  void (*carry)(const LocalPoint* points, const Remainders& remainders, std::size_t begin, std::size_t end,
                LocalPoint* moves);
  /// For the leaves [begin, end), and the nodes of their chains whose place is below `count`: squared[e] = largest
  /// squared distance from the center of node chain[e] to a point of the leaf that the entry reads.
  void (*farthest_of_leaves)(const LocalPoint* points, const LeafLists& lists, std::size_t begin, std::size_t end,
                             std::size_t count, const Spheref* spheres, float* squared);
  /// radii[i] = Rounding::covering_radius of squared[i], about a center whose largest |coordinate| is norms[i].
  void (*covering_radii)(const float* squared, const float* norms, std::size_t count,
                         const RadiusAllowances& allowances, float* radii);
  /// out[i] = the position of cuts[i].
  void (*move_edge_cuts)(const LocalPoint* points, const EdgeCut* cuts, std::size_t count, LocalPoint* out);
  void (*move_inner_cuts)(const LocalPoint* points, const InnerCut* cuts, std::size_t count, LocalPoint* out);
  /// out[i] = the i-th of `count` packed points (x, y, z of each, nothing between) minus origin. Returns the largest
  /// bit pattern of an absolute coordinate: at least that of infinity if one is not finite.
  std::uint32_t (*narrow_floats)(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out);
  /// Like narrow_floats, but the i-th point goes to out[to[i]].
  std::uint32_t (*narrow_scattered)(const float* packed, std::size_t count, const Vec3f& origin,
                                    const std::uint32_t* to, LocalPoint* out);
};
inline constexpr int pull_steps = 4;
inline constexpr int fit_steps = 8;
/// Squared limit of growth: a radius grows by 2 % at most. A sphere that moves off a sheet could grow without end, at
/// the same cost.
inline constexpr float most_squared_growth = 1.0404f;
/// Length of each step of a fit, as a share of r - d, on a way as long as r.
inline constexpr float fit_lengths[fit_steps] = {0.5f, 0.5f, 0.5f, 0.5f, 0.4f, 0.33f, 0.29f, 0.25f};
/// Spheres that are at most this times as large as at rest are good.
inline constexpr float most_growth = 1.01f;

/// The kernels that this processor can run, narrowest first.
std::span<const Kernels> all_kernels();
/// The widest kernels that this processor can run.
const Kernels& kernels();

}  // namespace morula::detail
