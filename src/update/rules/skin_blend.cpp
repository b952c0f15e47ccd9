// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_blend.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/sphere.hpp>

#include "update/rules/mode_rows.hpp"

namespace morula::detail {
namespace {

// Limits of slope × radius and of scale: the rounding of what they multiply is then small (skinned.cpp).
constexpr double steepest = 4, largest_scale = 2;
// Limit of slopes: their lengths, and products with what is at rest, stay finite.
constexpr double most_slope = 0x1p1000;
// A bone in less than one of so many corners gets a slope and a scale of 0.
constexpr std::size_t few = 16;

// The weight and the moment of a bone in a corner, the number of which counts the node's corners.
struct Share {
  std::uint32_t bone, corner;
  double weight;
  Vec3 moment;
};

// The shares of a node's corners, bone by bone.
class Shares {
 public:
  Shares(const Skin& skin, const PositionView& positions, const Cover& cover, std::span<const std::uint32_t> corners,
         const Vec3& center) {
    for (std::uint32_t k = 0; k < corners.size(); ++k) {
      const auto add = [&](std::uint32_t vertex, double factor) {
        const Vec3 place = positions[vertex] - center;
        each_weight(skin, vertex, [&](std::uint32_t bone, double weight) {
          if (factor * weight == 0) return;
          shares_.push_back({bone, k, factor * weight, factor * weight * place});
        });
      };
      if (corners[k] < cover.vertex_count) {
        add(corners[k], 1);
        continue;
      }
      const CutPoint& cut = cover.cut_points[corners[k] - cover.vertex_count];
      for (std::size_t i = 0; i < 3; ++i) add(cut.vertex[i], cut.weight[i]);
    }
    has_negative_ = std::any_of(shares_.begin(), shares_.end(), [](const Share& s) { return s.weight < 0; });
    std::stable_sort(shares_.begin(), shares_.end(), [](const Share& a, const Share& b) { return a.bone < b.bone; });
    unite();
  }

  bool has_negative() const { return has_negative_; }
  // Calls visit(shares of a bone) for each bone, in ascending order.
  template <class Visit>
  void each_bone(const Visit& visit) const {
    for (std::size_t begin = 0, end = 0; begin < shares_.size(); begin = end) {
      while (end < shares_.size() && shares_[end].bone == shares_[begin].bone) ++end;
      visit(std::span(shares_).subspan(begin, end - begin));
    }
  }

 private:
  // Adds up the shares of one bone in one corner, which are next to each other.
  void unite() {
    std::size_t count = 0;
    for (const Share& s : shares_) {
      if (count > 0 && shares_[count - 1].bone == s.bone && shares_[count - 1].corner == s.corner) {
        shares_[count - 1].weight += s.weight;
        shares_[count - 1].moment += s.moment;
      } else {
        shares_[count++] = s;
      }
    }
    shares_.resize(count);
  }

  std::vector<Share> shares_;
  bool has_negative_ = false;
};

std::array<Vec3, 3> covariance_of(std::span<const Vec3> points, const Vec3& middle) {
  std::array<Vec3, 3> result{};
  for (const Vec3& p : points) {
    const Vec3 z = p - middle;
    for (int k = 0; k < 3; ++k) result[k] += z * (z[k] / static_cast<double>(points.size()));
  }
  // A flat patch has no spread in one direction.
  const double ridge = 1e-3 * (result[0].x + result[1].y + result[2].z);
  for (int k = 0; k < 3; ++k) result[k][k] += ridge;
  return result;
}

// Solves covariance x = b; zero for a matrix that is singular to rounding.
Vec3 solution(const std::array<Vec3, 3>& covariance, const Vec3& b) {
  const Vec3 first = cross(covariance[1], covariance[2]);
  const double determinant = dot(covariance[0], first);
  const Vec3 x =
      Vec3{dot(first, b), dot(cross(covariance[2], covariance[0]), b), dot(cross(covariance[0], covariance[1]), b)} /
      determinant;
  return is_finite(x) ? x : Vec3{};
}

// The fit of a bone's weights and moments over the places of a node's corners, by least squares. Any fit is valid; a
// better one has less stray.
class TermFit {
 public:
  TermFit(std::span<const Vec3> places, double radius) : radius_(radius) {
    for (const Vec3& y : places) places_.push_back(y / radius);
    for (const Vec3& y : places_) mean_ += y / static_cast<double>(places_.size());
    covariance_ = covariance_of(places_, mean_);
    for (const Vec3& y : places_) spread_ += squared_length(y - mean_);
  }

  // Cost: linear in the shares.
  BlendTerm term(std::span<const Share> shares, std::span<const Vec3> places) const {
    if (shares.size() < places.size() / few) return constant_term(shares);
    std::vector<double> weights(places.size());
    std::vector<Vec3> moments(places.size());
    for (const Share& s : shares) weights[s.corner] = s.weight, moments[s.corner] = s.moment;
    BlendTerm term;
    term.bone = shares.front().bone;
    term.slope = slope(weights);
    double least = weights[0] - dot(term.slope, places[0]), most = least;
    for (std::size_t k = 1; k < places.size(); ++k) {
      const double left = weights[k] - dot(term.slope, places[k]);
      least = std::min(least, left), most = std::max(most, left);
    }
    term.weight = least + (most - least) / 2;
    // mutant skinned-weight-stray: `std::max(most - term.weight, term.weight - least)` -> `0`
    term.weight_stray = std::max(most - term.weight, term.weight - least);
    term.scale = scale(moments);
    for (std::size_t k = 0; k < places.size(); ++k) moments[k] -= term.scale * places[k];
    const ModeRow row = mode_row(moments);
    term.moment = row.shift;
    // mutant skinned-moment-stray: `row.stray` -> `0`
    term.moment_stray = row.stray;
    return term;
  }

 private:
  // The other corners have the weight 0 and the moment 0.
  static BlendTerm constant_term(std::span<const Share> shares) {
    BlendTerm term;
    term.bone = shares.front().bone;
    double least = 0, most = 0;
    std::vector<Vec3> moments(1);
    for (const Share& s : shares) {
      least = std::min(least, s.weight), most = std::max(most, s.weight);
      moments.push_back(s.moment);
    }
    term.weight = least + (most - least) / 2;
    // mutant skinned-constant-weight-stray: `std::max(most - term.weight, term.weight - least)` -> `0`
    term.weight_stray = std::max(most - term.weight, term.weight - least);
    const ModeRow row = mode_row(moments);
    term.moment = row.shift;
    // mutant skinned-constant-moment-stray: `row.stray` -> `0`
    term.moment_stray = row.stray;
    return term;
  }

  Vec3 slope(std::span<const double> weights) const {
    Vec3 product;
    for (std::size_t k = 0; k < places_.size(); ++k)
      product += (places_[k] - mean_) * (weights[k] / static_cast<double>(places_.size()));
    const Vec3 scaled = solution(covariance_, product), slope = scaled / radius_;
    return length(scaled) <= steepest && max_norm(slope) <= most_slope ? slope : Vec3{};
  }
  double scale(std::span<const Vec3> moments) const {
    double product = 0;
    for (std::size_t k = 0; k < places_.size(); ++k) product += dot(places_[k] - mean_, moments[k] / radius_);
    const double scale = product / spread_;
    return std::abs(scale) <= largest_scale ? scale : 0;
  }

  std::vector<Vec3> places_;  // over the radius
  double radius_;
  Vec3 mean_;
  std::array<Vec3, 3> covariance_;
  double spread_ = 0;
};

// Axes: the Cholesky factor of the covariance, scaled until the ellipsoid contains every place. Places are first scaled
// by a power of two: if squares vanished, a flat patch could get an axis of 0, and the quotient 0 / 0 would hide how
// far its places are out. If all places are equal, the axes are NaN, and the kernels do not take the shape.
PatchShape shape_of(std::span<const Vec3> places) {
  const Vec3 middle = mode_row(places).shift;
  double largest = 0;
  for (const Vec3& y : places) largest = std::max(largest, max_norm(y - middle));
  // mutant skinned-shape-size: `std::ldexp(1, std::ilogb(largest))` -> `1`
  const double size = std::ldexp(1, std::ilogb(largest));
  std::vector<Vec3> scaled;
  for (const Vec3& y : places) scaled.push_back((y - middle) / size);
  const std::array<Vec3, 3> c = covariance_of(scaled, {});
  const double xx = std::sqrt(c[0].x), xy = c[0].y / xx, xz = c[0].z / xx;
  const double yy = std::sqrt(c[1].y - xy * xy), yz = (c[1].z - xy * xz) / yy;
  const double zz = std::sqrt(c[2].z - xz * xz - yz * yz);
  double farthest = 0;
  for (const Vec3& z : scaled) {
    const double u = z.x / xx, v = (z.y - xy * u) / yy, w = (z.z - xz * u - yz * v) / zz;
    farthest = std::max(farthest, length(Vec3{u, v, w}));
  }
  // The share is far above the rounding of the three quotients, since the ridge bounds the ratio of the axes.
  const double scale = farthest * size * (1 + 0x1p-30);
  return {middle, {Vec3{xx, xy, xz} * scale, Vec3{0, yy, yz} * scale, Vec3{0, 0, zz} * scale}};
}

BoneBall ball_of(std::span<const Share> shares) {
  std::vector<Vec3> places;
  for (const Share& s : shares) places.push_back(s.moment / s.weight);
  const ModeRow row = mode_row(places);
  // mutant skinned-ball: `row.stray}` -> `0.9 * row.stray}`
  return {shares.front().bone, row.shift, row.stray};
}

// The smaller of a sphere about the node's center and one about the middle of its corners.
Sphere rest_sphere(std::span<const Vec3> corners, const Vec3& center) {
  const ModeRow own = mode_row(corners);
  double farthest = 0, largest = max_norm(center);
  for (const Vec3& p : corners) {
    farthest = std::max(farthest, safe_length(p - center));
    largest = std::max(largest, max_norm(p) + max_norm(center));
  }
  const double radius = rounded_up_radius(farthest, largest);
  return own.stray < radius ? Sphere{own.shift, own.stray} : Sphere{center, radius};
}

}  // namespace

NodeBlend blend_of_node(const Skin& skin, const PositionView& positions, const Cover& cover,
                        std::span<const std::uint32_t> corners, const Vec3& center, double reach) {
  NodeBlend result;
  std::vector<Vec3> places;
  for (const std::uint32_t c : corners) places.push_back(corner_position(cover, c, positions));
  result.node.rest = rest_sphere(places, center);
  const Sphere rest = result.node.rest;
  for (Vec3& p : places) p -= rest.center;

  const Shares shares(skin, positions, cover, corners, rest.center);
  std::size_t bone_count = 0;
  double most = 0;
  shares.each_bone([&](std::span<const Share> of_bone) {
    double sum = 0;
    for (const Share& s : of_bone) sum += s.weight;
    if (bone_count++ == 0 || sum > most) most = sum, result.node.bone = of_bone.front().bone;
  });
  if (bone_count == 1) return result;

  if (!shares.has_negative())
    shares.each_bone([&](std::span<const Share> of_bone) { result.balls.push_back(ball_of(of_bone)); });
  result.shape = shape_of(places);
  const TermFit fit(places, rest.radius > 0 ? rest.radius : 1);
  shares.each_bone([&](std::span<const Share> of_bone) {
    if (of_bone.front().bone == result.node.bone) return;
    const BlendTerm& t = result.terms.emplace_back(fit.term(of_bone, places));
    result.factor_sum += std::abs(t.weight) + t.weight_stray + safe_length(t.slope) * rest.radius + std::abs(t.scale);
    if (reach > 0) result.factor_sum += (max_norm(t.moment) + t.moment_stray) / reach;
  });
  return result;
}

}  // namespace morula::detail
