// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters: a covering sphere and a covering box for each cluster that an engine defines, such as a
// meshlet, a draw cluster or a sub-mesh, from the transforms of the bones alone. They need no tree and no body, and
// read no vertex per frame.
//
//   morula::SkinBounds bounds(mesh, skin, cluster_of_facet);   // once
//   std::vector<morula::Spheref> spheres(bounds.cluster_count());
//   if (!bounds.bounds(transforms, {.spheres = spheres})) return;   // every frame
//
// Morph targets are modes: morula::SkinBounds bounds(mesh, skin, targets, cluster_of_facet), and bounds.bounds(
// transforms, morphs, output) with a number per target.
//
// An engine may keep SkinBounds::data() alone and evaluate it in a shader or in C, in float, by this formula:
//
//   T_b = A_b x + t_b  transform of bone b relative to rest    d_i  component i    A_b,i  row i of A_b
//   |A|    square root of the largest sum of |entries| of a row of A^T A: a bound of the largest stretch
//   |A|_F  square root of the sum of the squares of all entries
//   For a cluster K with the rows R_0 … R_n-1, r = R_0.bone:
//   center  = T_r K.center + sum_k R_k.weight d_k,    d_k = T_b K.center - T_r K.center,  b = R_k.bone
//   F       = A_r + sum_k R_k.weight (A_b - A_r)
//   stray   = sum_k R_k.weight_stray |d_k| + R_k.moment_stray |A_b - A_r|_F
//   stray_i = the same with the component |d_k,i| in place of |d_k|
//   q_k     = T_b R_k.center
//   size    = the largest, over the bones of the rows or over all bones, of
//             reach * (largest sum of |entries| of a row of A_b) + largest |component| of t_b, and at least reach
//   pad     = K.rounding size
//   radius  = min(|F| K.radius + stray, (1 + 2 K.overhang) max_k (|q_k - center| + |A_b| R_k.radius)) K.growth + pad
//   half_i  = min(|F_i| K.radius, sum_j |F_ij| K.half_extent_j) + stray_i
//   low_i   = min_k q_k,i - |A_b,i| R_k.radius,   high_i = max_k q_k,i + |A_b,i| R_k.radius
//   lower_i = max(center_i - half_i K.growth, low_i - K.overhang (high_i - low_i)) - pad
//   upper_i = min(center_i + half_i K.growth, high_i + K.overhang (high_i - low_i)) + pad
//
// If K has morph targets M_0 … M_m-1, and q_k is the number of the target M_k.target, then first
//   shift    = sum_k q_k M_k.shift,   spread = sum_k |q_k| M_k.radius,   spread_i = sum_k |q_k| M_k.half_extent_i
//   travel   = sum_k |q_k| (largest |component| of M_k.shift + M_k.radius)
// The formula then has K.center + shift, K.radius + spread, K.half_extent_i + spread_i, R_k.center + shift,
// R_k.radius + spread and R_k.moment_stray + R_k.weight_stray spread in the places of these numbers, and a size that is
// larger by travel times the largest sum of |entries| of a row of any A_b, or by travel if that sum is below 1.
//
// Sphere and box contain all vertices of the cluster, hence its facets, if operations round to a neighboring float,
// with square roots and divisions off by up to 4 units in the last place. Sums may be in any order, multiplications and
// additions fused or not, and numbers below the normal range may count as 0. K.growth and K.rounding pay for that, for
// transforms that were rounded from double to float, and for weights that add up to 1 within 1e-6, whether the engine
// gives the missing weight to the rest position, to a bone or to none. They also pay for vertices that a shader moves
// in float, morphed ones included. Transforms of a size above largest_size may leave the range of float.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/status.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula {

/// A box in float: the points x with lower ≤ x ≤ upper in each coordinate.
struct Boxf {
  Vec3f lower{}, upper{};

  bool operator==(const Boxf&) const = default;
};

/// How one bone moves a cluster. Eight 32-bit numbers without gaps: two vec4 of a shader.
struct SkinBoundsRow {
  std::uint32_t bone = 0;
  float weight = 0;  ///< weight of the bone in the cluster's center; 0 for the first row
  /// Largest |w - weight| over the cluster's vertices, w the bone's weight; 0 for the first row.
  float weight_stray = 0;
  /// Largest |w - weight| |x - SkinBoundsCluster::center| over the vertices, mesh units; 0 for the first row.
  float moment_stray = 0;
  /// A ball around the rest positions of the vertices in which the bone has a weight other than 0.
  Vec3f center{};
  float radius = 0;

  bool operator==(const SkinBoundsRow&) const = default;
};
static_assert(sizeof(SkinBoundsRow) == 32);

/// How a morph target moves a cluster. Eight 32-bit numbers without gaps: two vec4 of a shader. For each vertex of the
/// cluster, u its displacement per unit of the target's number: |u - shift| <= radius, and by components |u - shift| <=
/// half_extent, with allowances for rounding.
struct SkinBoundsTarget {
  Vec3f shift{};
  float radius = 0;
  Vec3f half_extent{};
  std::uint32_t target = 0;  ///< number of the target

  bool operator==(const SkinBoundsTarget&) const = default;
};
static_assert(sizeof(SkinBoundsTarget) == 32);

/// A cluster at rest. Twelve 32-bit numbers without gaps: three vec4 of a shader.
struct SkinBoundsCluster {
  Vec3f center{};       ///< center of a ball around the vertices' rest positions
  float radius = 0;     ///< radius of that ball
  Vec3f half_extent{};  ///< largest |component| of rest position - center, per axis
  float overhang = 0;   ///< largest sum, over a vertex, of its |negative weights|
  float growth = 1;     ///< factor of the bounds, above 1, for rounding
  float rounding = 0;   ///< share of the size of the transforms, for rounding
  std::uint32_t first_row = 0;
  std::uint32_t row_count = 0;  ///< the first of these rows is of the main bone; 0 for a cluster without facets

  bool operator==(const SkinBoundsCluster&) const = default;
};
static_assert(sizeof(SkinBoundsCluster) == 48);

/// The rest data of all clusters: the content of a file or of a shader's buffer.
struct SkinBoundsData {
  std::uint32_t bone_count = 0;
  /// At least the largest |coordinate| of a used vertex at rest, mesh units, and at least 2^-40.
  float reach = 0;
  /// Transforms up to this size keep all numbers in the range of float. Size as above, with max(reach, 1) as the reach,
  /// and with the largest travel of a cluster.
  float largest_size = 0;
  std::vector<SkinBoundsCluster> clusters{};
  std::vector<SkinBoundsRow> rows{};
  std::uint32_t target_count = 0;  ///< number of morph targets
  /// Cluster k has the targets target_begin[k] to target_begin[k + 1] - 1 of `targets`: those that move it. One entry
  /// more than clusters, ascending from 0; empty if target_count is 0.
  std::vector<std::uint32_t> target_begin{};
  std::vector<SkinBoundsTarget> targets{};

  bool operator==(const SkinBoundsData&) const = default;
};

/// Destinations of SkinBounds::bounds(). A result whose span is empty is skipped.
struct SkinBoundsOutput {
  /// One per character and cluster: clusters of the first character first. A cluster without facets gets radius 0 at
  /// the origin.
  std::span<Spheref> spheres{};
  /// The same order. A cluster without facets gets the box from (0, 0, 0) to (0, 0, 0).
  std::span<Boxf> boxes{};
  std::span<Spheref> whole_spheres{};  ///< one per character, around all its clusters; requires `spheres`
  std::span<Boxf> whole_boxes{};       ///< one per character
};

/// Cluster numbers of facets for clusters that are runs of facets, as after meshopt_buildMeshlets: cluster k has the
/// facets begin[k] to begin[k + 1] - 1. begin: ascending from 0; the last entry is the number of facets. Throws
/// std::invalid_argument for another list.
std::vector<std::uint32_t> clusters_of_runs(std::span<const std::uint32_t> begin);

/// Covering bounds of the clusters of skinned characters. All vertices at sum_b w_b T_b x, and so all points of the
/// facets between them, lie in the sphere and in the box of their cluster, rounding included, for any affine
/// transforms, also mirrored, singular and uneven ones. Morph targets U displace them first: x is then x + sum_j q_j
/// U_j, for any numbers q_j. Only one thread may use an object at a time; copies are independent.
class SkinBounds {
 public:
  /// Computes the rest data. cluster_of_facet: a number per facet; clusters are numbered from 0 to the largest of these
  /// numbers, and may be without facets. Throws std::invalid_argument for a mesh that require_usable() rejects, for
  /// coordinates of used vertices beyond 2^50, for a skin that does not fit the mesh (see Skin), for a list without one
  /// number per facet, and for cluster numbers of 2^24 or more. Cost: linear in the influences of all facets, times a
  /// small factor for balls, and in each cluster's vertices times its bones.
  SkinBounds(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> cluster_of_facet,
             Workers& workers = serial_workers());
  /// Rest data with morph targets. Throws std::invalid_argument also for targets that do not fit the mesh or are not
  /// finite, for 2^16 targets or more, and for displacements of used vertices beyond 2^50. Cost: also vertices ×
  /// targets.
  SkinBounds(const MeshView& mesh, const Skin& skin, const Modes& targets,
             std::span<const std::uint32_t> cluster_of_facet, Workers& workers = serial_workers());
  /// Takes stored rest data. Throws std::invalid_argument if an index or a list of targets is out of range, if a number
  /// is not finite, or if a number other than a weight, a shift or a coordinate of a center is negative.
  explicit SkinBounds(SkinBoundsData data);

  std::size_t cluster_count() const { return data_.clusters.size(); }
  std::size_t bone_count() const { return data_.bone_count; }
  std::size_t target_count() const { return data_.target_count; }
  const SkinBoundsData& data() const { return data_; }

  /// Computes bounds in mesh coordinates, rounded outward, with all morph targets at 0.
  ///
  /// transforms: relative to rest, bone_count() for each character, one character after another. Output arrays are
  /// empty or have the sizes given above; other sizes throw std::invalid_argument. A call allocates if it uses more
  /// threads than all earlier ones, and may if it has more characters; other calls do not. Rejects, and then writes
  /// nothing: wrong_transform_count for a number of transforms that is no multiple of bone_count(); bad_transform, with
  /// the index of the first one in `transforms`, for one that is not finite or is larger than
  /// SkinBoundsData::largest_size. The result has the same bits for any number of workers, and for one character as for
  /// many at once. Cost: linear in the rows of all clusters, for each character.
  Status bounds(std::span<const AffineTransform> transforms, const SkinBoundsOutput& output,
                Workers& workers = serial_workers());
  /// The same with morph targets. morphs: target_count() for each character, in the order of the transforms; none means
  /// that all are 0. Also rejects: wrong_coordinate_count for another number of morphs; bad_coordinate for one that is
  /// not finite or above 2^127, or for morphs that move a character beyond SkinBoundsData::largest_size, with the index
  /// in `morphs` of the lowest one not finite or of the one that moves this character most. The first call with morphs
  /// may allocate. Cost: also linear in the targets of all clusters.
  Status bounds(std::span<const AffineTransform> transforms, std::span<const double> morphs,
                const SkinBoundsOutput& output, Workers& workers = serial_workers());

 private:
  Status check(std::span<const AffineTransform> transforms, std::span<const double> morphs) const;
  void set_travels();

  SkinBoundsData data_;
  std::vector<double> travels_;  // by target: the farthest that it moves a vertex of a cluster, per unit
  std::vector<float> scratch_;   // transforms and morphs of the characters that a thread computes
};

}  // namespace morula
