// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Rest data of skinned clusters, and why its bounds cover.
//
// With w_b the weights of a vertex at x, which add up to 1, c the cluster's center, y = x - c, r its main bone,
// D_b = T_b - T_r and W_b the weights of the rows, the vertex moves to
//   p = T_r x + sum w_b D_b x = [T_r c + sum W_b D_b c] + [A_r + sum W_b D_b] y + sum (w_b - W_b) (D_b c + D_b y)
// where D_b y is by the linear part alone. The first bracket is the center, the second is F. So
//   |p - center| <= |F| |y| + sum |w_b - W_b| |D_b c| + |D_b| |(w_b - W_b) y|
// which is the first radius, and by components the first half extents. If no weight is negative, p is in the convex
// hull of the points T_b x of the bones that move it, so in any ball and any box around the moved balls of the rows:
// the second radius and the second box [kavan2005]. If the negative weights add up to -o, then p = center + sum w_b
// (T_b x - center) and sum |w_b| = 1 + 2 o; along an axis p is in [low - o (high - low), high + o (high - low)].
//
// Rounding. u = 2^-23, because a GPU may round to either neighbor of a result; S the size of the transforms, X = reach
// <= S, n rows, L = sum |W_b|, E = sum of weight strays, P = 1 + 2 overhang, v the largest number of influences of a
// vertex, V >= P their largest sum of |weights|, a sum of k numbers off by k u of the sum of their absolute values in
// any order. |coordinates| of T_b x are at most S, and sums of |entries| of rows of A_b at most S / X. In lengths, in
// units of u S:
//   transforms narrowed to float                                          sqrt(3) P
//   vertices that a shader computes in float, positions and weights, too  sqrt(3) V (v + 6)
//   center: T_b c to 4, D_b c to 10, their sum                            sqrt(3) (4 + (n + 1) (1 + 2 L) + 10 L)
//   F: rows off by u S / X ((n + 1) (1 + 2 L) + 2 L), times |y|           sqrt(3) |y| / X (…)
//   strays: D_b c to 10 sqrt(3), |D_b| to 2 sqrt(3) / X, |y| <= 1.8 X     24 E
//   box: center and half extents added, up to 3 (1 + 2 L) + 6 E, thrice   9 (1 + 2 L) + 18 E
//   hull: T_b x to 4, |A_b,i| to 10.5 of at most 1.8, sums thrice         40 P
// and relative to the bounds, with square roots off by 4 u: |F| 14, lengths 10, sums of n + 2, products: n + 24.
// Squares below the normal range lose up to 2^-62 (2 + E) and 2^-60 X; X >= 2^-40, so the pad is above 2^-58 (1 + E).
// If weights add up to 1 +- s, the rest moves a vertex by up to 2 sqrt(3) s S.
//
// Morph targets. With any shifts s_j, s = sum q_j s_j, a vertex is at c + s + (y + e), where e = sum q_j (U_j - s_j).
// So all of this holds for a cluster around c + s with radii larger by the spread, sum |q_j| D_j, D_j the largest |U_j
// - s_j| of a vertex, and with |(w_b - W_b) (y + e)| <= moment stray + weight stray times spread. Rounding: k targets
// move the cluster, |components| of s_j add D_j to be the travel of a target, so X + travel takes the place of X. In
// units of u (X + travel): c + s to k + 3 of q_j s_j and of the sum; a shader's vertices to k + 5; the spread to k + 2;
// as a length less than 5 k + 20. Each D_j has that share of its target's travel, and the cluster's radii that of X.
// The largest |y + e| over X + travel is at most 1.8. What floats lose of displacements below 2^-126 is less than q_j
// 2^-32 X.
#include "update/cluster_fit.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>

#include "geometry/rounded_up.hpp"
#include "parallel/interruption.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_blend.hpp"

namespace morula::detail {
namespace {

constexpr double unit = 0x1p-23;
// Above the rounding, in double, of differences and lengths of rest data.
constexpr double of_rest = 1 + 0x1p-40;

// The largest |component| of the points, per axis.
Vec3 largest_components(std::span<const Vec3> points) {
  Vec3 extent;
  for (const Vec3& y : points) extent = max(extent, Vec3{std::abs(y.x), std::abs(y.y), std::abs(y.z)});
  return extent;
}

double length_of_farthest(std::span<const Vec3> points) {
  double farthest = 0;
  for (const Vec3& y : points) farthest = std::max(farthest, safe_length(y));
  return farthest;
}

// The rounding of vertices that a number of targets move, as a share of how far they move and of the coordinates.
double share_of_targets(std::size_t count) {
  // mutant skin-bounds-target-rounding: `unit * static_cast` -> `0 * static_cast`
  return unit * static_cast<double>(5 * count + 20);
}

}  // namespace

ClusterFit::ClusterFit(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> vertices)
    : vertices_(vertices) {
  for (const std::uint32_t v : vertices) {
    places_.push_back(mesh.positions[v]);
    add_weights(skin, v);
  }
}

ClusterFit::Result ClusterFit::fit(const Modes& targets, double reach) {
  Result result;
  if (places_.empty()) return result;
  SkinBoundsCluster& cluster = result.cluster;
  cluster.row_count = static_cast<std::uint32_t>(of_bone_.size());
  cluster.center = Vec3f(enclosing_sphere(places_).center);
  for (Vec3& p : places_) p -= Vec3(cluster.center);
  const double farthest = length_of_farthest(places_);
  const Vec3 extent = largest_components(places_);
  // mutant skin-bounds-radius: `farthest * of_rest` -> `0.9 * farthest`
  cluster.radius = rounded_up(farthest * of_rest + reach * 0x1p-50);
  // mutant skin-bounds-extent: `rounded_up(extent[axis]` -> `rounded_up(0.9 * extent[axis]`
  for (int axis = 0; axis < 3; ++axis) cluster.half_extent[axis] = rounded_up(extent[axis] + reach * 0x1p-50);
  cluster.overhang = rounded_up(overhang_ * of_rest);
  const std::uint32_t main = main_bone();
  result.rows.push_back(row_of(cluster, main, true));
  for (const auto& [bone, shares] : of_bone_)
    if (bone != main) result.rows.push_back(row_of(cluster, bone, false));
  add_targets(targets, reach, result);
  set_allowances(result, reach);
  return result;
}

void ClusterFit::add_weights(const Skin& skin, std::uint32_t vertex) {
  const auto place = static_cast<std::uint32_t>(places_.size() - 1);
  double sum = 0;
  for (std::uint32_t k = skin.begin[vertex]; k < skin.begin[vertex + 1]; ++k) sum += skin.weights[k];
  slack_ = std::max(slack_, std::abs(1 - sum));
  influences_ = std::max<std::size_t>(influences_, skin.begin[vertex + 1] - skin.begin[vertex]);
  std::map<std::uint32_t, double> weights;
  double absolute = 0;
  each_weight(skin, vertex, [&](std::uint32_t bone, double weight) {
    absolute += std::abs(weight);
    if (weight != 0) weights[bone] += weight;
  });
  // mutant skin-bounds-absolute: `std::max(absolute_, absolute)` -> `0`
  absolute_ = std::max(absolute_, absolute);
  double negative = 0;
  for (const auto& [bone, weight] : weights) {
    of_bone_[bone].push_back({place, weight});
    negative -= std::min(weight, 0.0);
  }
  // mutant skin-bounds-overhang: `std::max(overhang_, negative)` -> `0`
  overhang_ = std::max(overhang_, negative);
}

std::uint32_t ClusterFit::main_bone() const {
  double most = -HUGE_VAL;
  std::uint32_t main = 0;
  for (const auto& [bone, shares] : of_bone_) {
    double sum = 0;
    for (const Share& s : shares) sum += s.weight;
    if (sum > most) most = sum, main = bone;
  }
  return main;
}

SkinBoundsRow ClusterFit::row_of(const SkinBoundsCluster& cluster, std::uint32_t bone, bool is_main) const {
  const std::vector<Share>& shares = of_bone_.at(bone);
  SkinBoundsRow row{.bone = bone};
  std::vector<Vec3> moved;
  for (const Share& s : shares) moved.push_back(places_[s.place]);
  row.center = Vec3f(enclosing_sphere(moved).center + Vec3(cluster.center));
  const Vec3 middle = Vec3(row.center) - Vec3(cluster.center);
  double farthest = 0;
  for (const Vec3& y : moved) farthest = std::max(farthest, safe_length(y - middle));
  // mutant skin-bounds-ball: `farthest * of_rest` -> `0.9 * farthest`
  row.radius = rounded_up(farthest * of_rest + static_cast<double>(max_norm(cluster.center)) * 0x1p-50 +
                          max_norm(middle) * 0x1p-50 + static_cast<double>(cluster.radius) * 0x1p-50);
  if (is_main) return row;
  double least = shares.size() < places_.size() ? 0 : shares.front().weight, most = least;
  for (const Share& s : shares) least = std::min(least, s.weight), most = std::max(most, s.weight);
  row.weight = static_cast<float>(least + (most - least) / 2);
  const double weight = static_cast<double>(row.weight);
  std::vector<double> strays(places_.size(), std::abs(weight));
  for (const Share& s : shares) strays[s.place] = std::abs(s.weight - weight);
  double stray = 0, moment = 0;
  for (std::size_t k = 0; k < places_.size(); ++k) {
    stray = std::max(stray, strays[k]);
    moment = std::max(moment, strays[k] * safe_length(places_[k]));
  }
  const double rounding = 0x1p-48 * (stray + std::abs(weight));
  // mutant skin-bounds-weight-stray: `stray + rounding` -> `0`
  row.weight_stray = rounded_up(stray + rounding);
  // mutant skin-bounds-moment-stray: `moment * of_rest + rounding * static_cast<double>(cluster.radius)` -> `0`
  row.moment_stray = rounded_up(moment * of_rest + rounding * static_cast<double>(cluster.radius));
  return row;
}

// The targets that move the cluster, and what they allow for in the rest of its data.
void ClusterFit::add_targets(const Modes& targets, double reach, Result& result) const {
  struct Moving {
    std::uint32_t target;
    Vec3f shift;
    double farthest;
    Vec3 extent;
  };
  std::vector<Moving> moving;
  std::vector<Vec3> displacements(vertices_.size());
  for (std::size_t j = 0; j < targets.mode_count; ++j) {
    check_interrupt();
    const std::span<const Vec3> of_target = targets.mode(j);
    for (std::size_t k = 0; k < vertices_.size(); ++k) displacements[k] = of_target[vertices_[k]];
    if (std::all_of(displacements.begin(), displacements.end(), [](const Vec3& u) { return u == Vec3{}; })) continue;
    const Vec3f shift(mode_row(displacements).shift);
    for (Vec3& u : displacements) u -= Vec3(shift);
    moving.push_back(
        {static_cast<std::uint32_t>(j), shift, length_of_farthest(displacements), largest_components(displacements)});
  }
  if (moving.empty()) return;
  const double share = share_of_targets(moving.size());
  for (const Moving& m : moving) {
    SkinBoundsTarget target{.shift = m.shift, .target = m.target};
    // mutant skin-bounds-target-tiny: `+ reach * 0x1p-32` -> ``
    const double allowed = share * (static_cast<double>(max_norm(m.shift)) + m.farthest) + reach * 0x1p-32;
    // mutant skin-bounds-target-radius: `rounded_up(m.farthest` -> `rounded_up(0.9 * m.farthest`
    target.radius = rounded_up(m.farthest * of_rest + allowed);
    // mutant skin-bounds-target-extent: `rounded_up(m.extent[axis]` -> `rounded_up(0.9 * m.extent[axis]`
    for (int axis = 0; axis < 3; ++axis) target.half_extent[axis] = rounded_up(m.extent[axis] * of_rest + allowed);
    result.targets.push_back(target);
  }
  // mutant skin-bounds-target-reach: `share * reach` -> `0 * reach`
  const double pad = share * reach;
  const auto enlarge = [](float& length, double by) { length = rounded_up(static_cast<double>(length) + by); };
  enlarge(result.cluster.radius, pad);
  for (int axis = 0; axis < 3; ++axis) enlarge(result.cluster.half_extent[axis], pad);
  for (SkinBoundsRow& row : result.rows) {
    enlarge(row.radius, pad);
    enlarge(row.moment_stray, static_cast<double>(row.weight_stray) * pad);
  }
}

void ClusterFit::set_allowances(Result& result, double reach) const {
  SkinBoundsCluster& cluster = result.cluster;
  double weights = 0, strays = 0;
  for (const SkinBoundsRow& row : result.rows) {
    weights += std::abs(static_cast<double>(row.weight));
    strays += static_cast<double>(row.weight_stray);
  }
  double place = static_cast<double>(cluster.radius) / reach;
  for (const SkinBoundsTarget& t : result.targets) {
    const double radius = static_cast<double>(t.radius);
    place = std::max(place, radius / (static_cast<double>(max_norm(t.shift)) + radius));
  }
  const double overhang = 1 + 2 * static_cast<double>(cluster.overhang), root = std::sqrt(3.0);
  const double n = static_cast<double>(result.rows.size()), v = static_cast<double>(influences_);
  const double sum = (n + 1) * (1 + 2 * weights);
  const double center = root * (4 + sum + 10 * weights);
  const double stretch = root * place * (sum + 2 * weights);
  const double linear = center + stretch + 42 * strays + 9 * (1 + 2 * weights);
  const double moved = root * std::max(absolute_, overhang) * (v + 7);
  // mutant skin-bounds-rounding: `1.02 * unit` -> `0.005 * unit`
  cluster.rounding = rounded_up(1.02 * unit * (moved + std::max(linear, 40 * overhang)) + 4 * slack_ * overhang);
  cluster.growth = rounded_up(1 + unit * (n + 32));
  result.weight_sum = std::max(1.0, overhang + 2 * weights + strays);
}

}  // namespace morula::detail
