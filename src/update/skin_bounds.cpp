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
// any order. |coordinates| of T_b x are at most S, and sums of |entries| of rows of A_b at most S / X. As lengths, in
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
#include <algorithm>
#include <cmath>
#include <map>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/update/skin_bounds.hpp>
#include <stdexcept>
#include <string>

#include "geometry/rounded_up.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_blend.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double unit = 0x1p-23, least_reach = 0x1p-40, largest_reach = 0x1p50, largest_length = 0x1p55;
// Above the rounding, in double, of differences and lengths of rest data.
constexpr double of_rest = 1 + 0x1p-40;

constexpr std::uint32_t most_clusters = 1u << 24;

// A cluster's vertices and how bones move them.
class ClusterFit {
 public:
  ClusterFit(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> vertices) {
    for (const std::uint32_t v : vertices) {
      places_.push_back(mesh.positions[v]);
      add_weights(skin, v);
    }
  }

  /// Appends the rows.
  SkinBoundsCluster fit(double reach, std::vector<SkinBoundsRow>& rows, double& weight_sum) {
    SkinBoundsCluster result;
    result.first_row = static_cast<std::uint32_t>(rows.size());
    result.row_count = static_cast<std::uint32_t>(of_bone_.size());
    if (places_.empty()) return result;
    result.center = Vec3f(enclosing_sphere(places_).center);
    for (Vec3& p : places_) p -= Vec3(result.center);
    double farthest = 0;
    Vec3 extent;
    for (const Vec3& y : places_) {
      farthest = std::max(farthest, safe_length(y));
      extent = max(extent, Vec3{std::abs(y.x), std::abs(y.y), std::abs(y.z)});
    }
    // mutant skin-bounds-radius: `farthest * of_rest` -> `0.9 * farthest`
    result.radius = rounded_up(farthest * of_rest + reach * 0x1p-50);
    // mutant skin-bounds-extent: `rounded_up(extent[axis]` -> `rounded_up(0.9 * extent[axis]`
    for (int axis = 0; axis < 3; ++axis) result.half_extent[axis] = rounded_up(extent[axis] + reach * 0x1p-50);
    result.overhang = rounded_up(overhang_ * of_rest);
    const std::uint32_t main = main_bone();
    rows.push_back(row_of(result, main, true));
    for (const auto& [bone, shares] : of_bone_)
      if (bone != main) rows.push_back(row_of(result, bone, false));
    set_allowances(result, std::span(rows).last(result.row_count), reach, weight_sum);
    return result;
  }

 private:
  struct Share {
    std::uint32_t place;
    double weight;
  };

  void add_weights(const Skin& skin, std::uint32_t vertex) {
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

  std::uint32_t main_bone() const {
    double most = -HUGE_VAL;
    std::uint32_t main = 0;
    for (const auto& [bone, shares] : of_bone_) {
      double sum = 0;
      for (const Share& s : shares) sum += s.weight;
      if (sum > most) most = sum, main = bone;
    }
    return main;
  }

  SkinBoundsRow row_of(const SkinBoundsCluster& cluster, std::uint32_t bone, bool is_main) const {
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

  void set_allowances(SkinBoundsCluster& cluster, std::span<const SkinBoundsRow> rows, double reach,
                      double& weight_sum) const {
    double weights = 0, strays = 0;
    for (const SkinBoundsRow& row : rows) {
      weights += std::abs(static_cast<double>(row.weight));
      strays += static_cast<double>(row.weight_stray);
    }
    const double overhang = 1 + 2 * static_cast<double>(cluster.overhang), root = std::sqrt(3.0);
    const double n = static_cast<double>(rows.size()), v = static_cast<double>(influences_);
    const double sum = (n + 1) * (1 + 2 * weights);
    const double center = root * (4 + sum + 10 * weights);
    const double stretch = root * static_cast<double>(cluster.radius) / reach * (sum + 2 * weights);
    const double linear = center + stretch + 42 * strays + 9 * (1 + 2 * weights);
    const double moved = root * std::max(absolute_, overhang) * (v + 7);
    // mutant skin-bounds-rounding: `1.02 * unit` -> `0.005 * unit`
    cluster.rounding = rounded_up(1.02 * unit * (moved + std::max(linear, 40 * overhang)) + 4 * slack_ * overhang);
    cluster.growth = rounded_up(1 + unit * (n + 32));
    weight_sum = std::max(weight_sum, overhang + 2 * weights + strays);
  }

  std::vector<Vec3> places_;  // about the cluster's center, once it is determined
  std::map<std::uint32_t, std::vector<Share>> of_bone_;
  double slack_ = 0, overhang_ = 0;
  double absolute_ = 0;  // more than 1 + 2 overhang_ if influences of one bone cancel
  std::size_t influences_ = 0;
};

// The vertices of each cluster's facets, each once, in ascending order.
std::vector<std::vector<std::uint32_t>> vertices_of_clusters(const MeshView& mesh,
                                                             std::span<const std::uint32_t> cluster_of_facet) {
  if (cluster_of_facet.size() != mesh.facet_count())
    throw std::invalid_argument("there are " + std::to_string(cluster_of_facet.size()) +
                                " numbers of clusters, but the mesh has " + std::to_string(mesh.facet_count()) +
                                " facets");
  const std::uint32_t largest = *std::max_element(cluster_of_facet.begin(), cluster_of_facet.end());
  if (largest >= most_clusters)
    throw std::invalid_argument("the number of a cluster is " + std::to_string(largest) + ", not below " +
                                std::to_string(most_clusters));
  std::vector<std::vector<std::uint32_t>> result(largest + 1);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    std::vector<std::uint32_t>& vertices = result[cluster_of_facet[f]];
    vertices.insert(vertices.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  }
  for (std::vector<std::uint32_t>& vertices : result) {
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  }
  return result;
}

}  // namespace

std::vector<std::uint32_t> clusters_of_runs(std::span<const std::uint32_t> begin) {
  if (begin.empty() || begin.front() != 0 || !std::is_sorted(begin.begin(), begin.end()))
    throw std::invalid_argument("the list of where clusters begin does not go up from 0 to the number of facets");
  std::vector<std::uint32_t> result(begin.back());
  for (std::size_t k = 0; k + 1 < begin.size(); ++k)
    std::fill(result.begin() + begin[k], result.begin() + begin[k + 1], static_cast<std::uint32_t>(k));
  return result;
}

SkinBounds::SkinBounds(const MeshView& mesh, const Skin& skin, std::span<const std::uint32_t> cluster_of_facet,
                       Workers& workers) {
  const StandardFloats standard;
  require_usable(mesh);
  require_skin(skin, mesh);
  const double reach = std::max(largest_coordinate(mesh), least_reach);
  if (!(reach <= largest_reach))
    throw std::invalid_argument("the mesh has coordinates beyond 2^50, too large for bounds in float: scale it");
  data_.bone_count = static_cast<std::uint32_t>(skin.bone_count);
  data_.reach = rounded_up(reach);
  const std::vector<std::vector<std::uint32_t>> vertices = vertices_of_clusters(mesh, cluster_of_facet);
  data_.clusters.resize(vertices.size());
  std::vector<std::vector<SkinBoundsRow>> rows(vertices.size());
  std::vector<double> weight_sums(vertices.size(), 1);
  parallel_for(workers, vertices.size(), 1, [&](std::size_t k, std::size_t) {
    check_interrupt();
    data_.clusters[k] = ClusterFit(mesh, skin, vertices[k]).fit(reach, rows[k], weight_sums[k]);
  });
  for (std::size_t k = 0; k < rows.size(); ++k) {
    data_.clusters[k].first_row = static_cast<std::uint32_t>(data_.rows.size());
    data_.rows.insert(data_.rows.end(), rows[k].begin(), rows[k].end());
  }
  const double weight_sum = *std::max_element(weight_sums.begin(), weight_sums.end());
  data_.largest_size = static_cast<float>(largest_length / weight_sum * (1 - 0x1p-20));
}

SkinBounds::SkinBounds(SkinBoundsData data) : data_(std::move(data)) {
  const auto require = [](bool holds, const char* what, std::size_t index) {
    if (!holds) throw std::invalid_argument(what + (" " + std::to_string(index)) + " of the rest data is not valid");
  };
  const auto is_length = [](float x) { return x >= 0 && std::isfinite(x); };
  const auto is_point = [](const Vec3f& p) { return is_finite(Vec3(p)); };
  if (data_.bone_count == 0 || !(data_.reach >= static_cast<float>(least_reach)) || !is_length(data_.reach) ||
      !is_length(data_.largest_size))
    throw std::invalid_argument("the rest data needs bones, a reach of at least 2^-40, and a largest size");
  for (std::size_t k = 0; k < data_.clusters.size(); ++k) {
    const SkinBoundsCluster& c = data_.clusters[k];
    const Vec3f& h = c.half_extent;
    require(is_point(c.center) && is_length(c.radius) && is_length(h.x) && is_length(h.y) && is_length(h.z) &&
                is_length(c.overhang) && c.growth >= 1 && is_length(c.growth) && is_length(c.rounding) &&
                c.first_row <= data_.rows.size() && c.row_count <= data_.rows.size() - c.first_row,
            "cluster", k);
  }
  for (std::size_t k = 0; k < data_.rows.size(); ++k) {
    const SkinBoundsRow& row = data_.rows[k];
    require(row.bone < data_.bone_count && std::isfinite(row.weight) && is_length(row.weight_stray) &&
                is_length(row.moment_stray) && is_point(row.center) && is_length(row.radius),
            "row", k);
  }
}

}  // namespace morula
