// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/layer_integrals.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {
namespace {

// Points and weights of Gauss's rules on [-1, 1] [abramowitz1964, 25.4.30].
constexpr std::array<std::array<double, 2>, 2> two_points{{{-0.57735026918962576451, 1}, {0.57735026918962576451, 1}}};
constexpr std::array<std::array<double, 2>, 5> five_points{{{-0.90617984593866399280, 0.23692688505618908751},
                                                            {-0.53846931010568309104, 0.47862867049936646804},
                                                            {0, 0.56888888888888888889},
                                                            {0.53846931010568309104, 0.47862867049936646804},
                                                            {0.90617984593866399280, 0.23692688505618908751}}};
constexpr std::array<std::array<double, 2>, 8> eight_points{{{-0.96028985649753623168, 0.10122853629037625915},
                                                             {-0.79666647741362673959, 0.22238103445337447054},
                                                             {-0.52553240991632898582, 0.31370664587788728734},
                                                             {-0.18343464249564980494, 0.36268378337836198297},
                                                             {0.18343464249564980494, 0.36268378337836198297},
                                                             {0.52553240991632898582, 0.31370664587788728734},
                                                             {0.79666647741362673959, 0.22238103445337447054},
                                                             {0.96028985649753623168, 0.10122853629037625915}}};

}  // namespace

void LayerIntegrals::start(const LayerMesh& a, const LayerMesh& b, double thickness, double coincident) {
  ++patch_;
  thickness_ = thickness, coincident_ = coincident;
  sums_ = {};
  for (std::size_t k = 0; k < 2; ++k) {
    Gradients& of = gradients_[k];
    of.mesh = k == 0 ? &a : &b;
    of.touched.clear();
    of.sum.resize(std::max(of.sum.size(), of.mesh->vertex_count()));
    of.patch.resize(of.sum.size(), 0);
  }
}

LayerIntegrals::Foot LayerIntegrals::foot_of(const LayerPiece& piece, const LayerMesh& other, const Vec3& p,
                                             const Vec3& u) const {
  Foot foot;
  if (piece.kind == Feature::vertex) {
    foot.vertices[0] = piece.feature;
    foot.share[0] = 1;
    foot.offset = p - other.at(piece.feature), foot.offset_slope = u;
  } else if (piece.kind == Feature::edge) {
    const auto [lower, upper] = other.ends(piece.feature);
    const Vec3 along = other.at(upper) - other.at(lower), arm = p - other.at(lower);
    const double squared = squared_length(along), constant = dot(arm, along) / squared, slope = dot(u, along) / squared;
    foot.vertices = {lower, upper, 0}, foot.size = 2;
    foot.share = {1 - constant, constant, 0}, foot.share_slope = {-slope, slope, 0};
    foot.offset = arm - along * constant, foot.offset_slope = u - along * slope;
  } else {
    const Triangle t = other.triangle(piece.feature);
    const LayerNormal of(t);
    foot.vertices = other.corners(piece.feature), foot.size = 3;
    for (std::size_t k = 0; k < 2; ++k) {
      const Vec3 inwards = cross(of.normal, t[(k + 2) % 3] - t[k + 1]) / of.double_area;
      foot.share[k] = dot(p - t[k + 1], inwards), foot.share_slope[k] = dot(u, inwards);
    }
    foot.share[2] = 1 - foot.share[0] - foot.share[1];
    foot.share_slope[2] = -foot.share_slope[0] - foot.share_slope[1];
    foot.normal = of.normal;
    foot.offset = of.normal * dot(p - t[0], of.normal), foot.offset_slope = of.normal * dot(u, of.normal);
  }
  return foot;
}

void LayerIntegrals::add(const LayerPiece& piece, std::uint8_t side, std::vector<LayerSample>* samples) {
  const LayerMesh &mesh = *gradients_[side].mesh, &other = *gradients_[1 - side].mesh;
  side_ = side, samples_ = samples;
  ends_ = mesh.ends(piece.edge);
  p_ = mesh.at(ends_[0]), u_ = mesh.at(ends_[1]) - p_;
  foot_ = foot_of(piece, other, p_, u_);
  weight_ = mesh.rest_area(piece.edge) * piece.index;
  sums_.area[side] += weight_ * (piece.to - piece.from);

  const double speed = squared_length(foot_.offset_slope);
  double nearest = -dot(foot_.offset, foot_.offset_slope) / speed;
  // So far away, distances are as good as constant.
  const bool is_far = !(std::abs(nearest) < 1e6);
  if (is_far) nearest = -1e6;
  const double at = std::clamp(nearest, piece.from, piece.to);
  const double height = is_far ? 0 : length(foot_.offset + foot_.offset_slope * nearest) / std::sqrt(speed);
  for (const double t : {piece.from, at, piece.to})
    if (piece.index > 0)
      sums_.depth = std::max(sums_.depth, thickness_ - length(foot_.offset + foot_.offset_slope * t));
  const std::array<double, 3> ends{piece.from, at, piece.to};
  for (std::size_t k = 0; k < 2; ++k) {
    if (!(ends[k] < ends[k + 1])) continue;
    if (piece.kind == Feature::facet)
      gauss(two_points, ends[k], ends[k + 1]);
    else
      integrate(ends[k], ends[k + 1], nearest, height);
  }
}

// The square root is singular at nearest ± i height, where `nearest` is not inside. If a part is too long for the
// rules, its farther half is not, and the other half is the next part. A part shorter than 2^-48 counts nothing.
void LayerIntegrals::integrate(double from, double to, double nearest, double height) {
  const bool is_before = to <= nearest;
  while (to - from > 0x1p-48) {
    const double middle = 0.5 * (from + to) - nearest, half = 0.5 * (to - from);
    const double ratio = (middle * middle + height * height) / (half * half);
    if (ratio >= 64) return gauss(five_points, from, to);
    if (ratio >= 6.25) return gauss(eight_points, from, to);
    const double cut = 0.5 * (from + to);
    gauss(eight_points, is_before ? from : cut, is_before ? cut : to);
    (is_before ? from : to) = cut;
  }
}

void LayerIntegrals::gauss(std::span<const std::array<double, 2>> rule, double from, double to) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  for (const auto& [point, share] : rule) add_point(middle + half * point, half * share);
}

// Each surface counts half: a weight and the derivative of half a volume.
void LayerIntegrals::add_point(double t, double share) {
  const Vec3 offset = foot_.offset + foot_.offset_slope * t;
  const double distance = length(offset), depth = std::max(0.0, thickness_ - distance);
  const double area = 0.5 * weight_ * share * (depth / thickness_), volume = 0.5 * area * depth;
  // The unit vector along which the nearest point sees x; none for points that coincide.
  // mutant layers-coincident: `distance > coincident_` -> `distance > 0`
  const Vec3 away = distance > coincident_ ? offset / distance : Vec3{};
  const Vec3 push = away * area, middle = p_ + u_ * t - offset * 0.5;
  sums_.volume += volume;
  sums_.pressed_area += area;
  sums_.first_moment += middle * volume;
  add_gradient(side_, ends_[0], push * (t - 1));
  add_gradient(side_, ends_[1], push * -t);
  for (std::size_t k = 0; k < foot_.size; ++k)
    add_gradient(1 - side_, foot_.vertices[k], push * (foot_.share[k] + foot_.share_slope[k] * t));
  if (samples_) samples_->push_back({middle, side_ == 0 ? push : -push, volume, area});
}

void LayerIntegrals::add_gradient(std::uint8_t side, std::uint32_t vertex, const Vec3& gradient) {
  Gradients& of = gradients_[side];
  if (of.patch[vertex] != patch_) {
    of.patch[vertex] = patch_;
    of.sum[vertex] = {};
    of.touched.push_back(vertex);
  }
  of.sum[vertex] += gradient;
}

void LayerIntegrals::put(std::uint8_t side, const Vec3& about, std::vector<VertexGradient>& gradients, Vec3& sum,
                         Vec3& moment) {
  Gradients& of = gradients_[side];
  std::sort(of.touched.begin(), of.touched.end());
  for (const std::uint32_t vertex : of.touched) {
    gradients.push_back({vertex, of.sum[vertex]});
    sum += of.sum[vertex];
    moment += cross(of.mesh->at(vertex) - about, of.sum[vertex]);
  }
}

}  // namespace morula::detail
