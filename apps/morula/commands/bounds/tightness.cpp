// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/bounds/tightness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/update/skin_morphs.hpp>

#include "commands/bounds/clusters.hpp"
#include "evaluators/skin_bounds.h"
#include "shared/command.hpp"
#include "shared/figures.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

/// A number as the sum of two, the second one of at most half an ulp of the first.
struct Double2 {
  double high, low;
};

Double2 sum(double a, double b) {
  const double s = a + b, part = s - a;
  return {s, (a - (s - part)) + (b - part)};
}

Double2 operator+(const Double2& a, const Double2& b) {
  const Double2 high = sum(a.high, b.high);
  return sum(high.high, high.low + (a.low + b.low));
}

/// The square of a number, without its part of 2^-106.
Double2 square(const Double2& a) {
  const double high = a.high * a.high;
  return sum(high, std::fma(a.high, a.high, -high) + 2 * a.high * a.low);
}

}  // namespace

bool is_outside(const Sphere& sphere, const Vec3& p) {
  Double2 power = square({sphere.radius, 0});
  power = {-power.high, -power.low};
  for (int axis = 0; axis < 3; ++axis) power = power + square(sum(p[axis], -sphere.center[axis]));
  return !(power.high <= 0);
}

void Tightness::add(const Sphere& sphere, const Box& box, std::span<const Vec3> points) {
  ++spheres_;
  for (const Vec3& p : points) uncovered_ += is_outside(sphere, p) || !(squared_distance(box, p) == 0) ? 1 : 0;
  const double smallest = enclosing_sphere(points).radius;
  if (!(smallest > 0)) return;
  ratios_.push_back(sphere.radius / smallest);
  sorted_ = false;
}

double Tightness::ratio(double share) {
  if (!sorted_) std::sort(ratios_.begin(), ratios_.end());
  sorted_ = true;
  return ratios_[static_cast<std::size_t>(share * static_cast<double>(ratios_.size() - 1))];
}

Json Tightness::json() {
  const auto or_null = [&](double share) { return ratios_.empty() ? Json(nullptr) : Json(ratio(share)); };
  return {{"spheres", spheres_},
          {"uncovered_corners", uncovered_},
          {"radius_over_smallest", {{"median", or_null(0.5)}, {"95%", or_null(0.95)}, {"largest", or_null(1)}}}};
}

std::string Tightness::text() {
  if (ratios_.empty()) return "n/a";
  return fmt::format("median {}, 95 % {}, largest {}", figure(ratio(0.5)), figure(ratio(0.95)), figure(ratio(1)));
}

namespace {

/// SkinBoundsData::largest_size is the limit of this, with a reach of at least 1.
double size_of(const AffineTransform& t, double reach) {
  double turned = 0, moved = 0;
  for (int row = 0; row < 3; ++row) {
    turned = std::max(turned, std::abs(t.columns[0][row]) + std::abs(t.columns[1][row]) + std::abs(t.columns[2][row]));
    moved = std::max(moved, std::abs(t.translation[row]));
  }
  return reach * turned + moved;
}

/// Rows of matrices as an engine has them.
std::vector<float> engine_rows(const SkinBoundsData& data, std::span<const AffineTransform> transforms,
                               std::size_t frame) {
  std::vector<float> rows;
  const double reach = std::max(1.0, static_cast<double>(data.reach));
  for (std::size_t bone = 0; bone < transforms.size(); ++bone) {
    const AffineTransform& t = transforms[bone];
    if (!(size_of(t, reach) <= static_cast<double>(data.largest_size)))
      throw UsageError(fmt::format(
          "frame {}: the transform of bone {} is too large for engines, which compute in float", frame, bone));
    for (int row = 0; row < 3; ++row)
      for (const double number : {t.columns[0][row], t.columns[1][row], t.columns[2][row], t.translation[row]})
        rows.push_back(static_cast<float>(number));
  }
  return rows;
}

std::vector<AffineTransform> transforms_of(std::span<const float> rows) {
  std::vector<AffineTransform> transforms(rows.size() / 12);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    AffineTransform& t = transforms[i / 12];
    const auto row = static_cast<int>(i % 12 / 4);
    (i % 4 == 3 ? t.translation : t.columns[i % 4])[row] = static_cast<double>(rows[i]);
  }
  return transforms;
}

/// Coordinates of morph targets as an engine has them.
std::vector<float> engine_morphs(const BoneFrames& frames, std::size_t frame) {
  if (frames.morphs.mode_count == 0) return {};
  const std::span<const double> morphs = frames.morphs.frame(frame);
  std::vector<float> numbers;
  for (const double morph : morphs) {
    numbers.push_back(static_cast<float>(morph));
    if (!std::isfinite(numbers.back()))
      throw UsageError(
          fmt::format("frame {}: the number of a morph target is too large for engines, which compute in "
                      "float",
                      frame));
  }
  return numbers;
}

/// The sum of the targets of a cluster.
skin_bounds_morph morph_of(const SkinBoundsData& data, std::size_t cluster, std::span<const float> morphs) {
  skin_bounds_morph morph{};
  if (morphs.empty()) return morph;
  for (std::uint32_t i = data.target_begin[cluster]; i < data.target_begin[cluster + 1]; ++i) {
    const auto target = std::bit_cast<skin_bounds_target>(data.targets[i]);
    skin_bounds_add_target(&morph, &target, morphs[target.target]);
  }
  return morph;
}

}  // namespace

Tightness measured_tightness(const SkinBoundsData& data, const Mesh& mesh, const Skin& skin, const Modes& targets,
                             std::span<const std::uint32_t> cluster_of_facet, const BoneFrames& frames,
                             Workers& workers) {
  const auto vertices = cluster_vertices(mesh, cluster_of_facet, data.clusters.size());
  std::vector<skin_bounds_cluster> clusters;
  std::vector<skin_bounds_row> cluster_rows;
  for (const SkinBoundsCluster& c : data.clusters) clusters.push_back(std::bit_cast<skin_bounds_cluster>(c));
  for (const SkinBoundsRow& r : data.rows) cluster_rows.push_back(std::bit_cast<skin_bounds_row>(r));
  Tightness tightness;
  Progress progress("checking");
  std::vector<Vec3> positions(mesh.vertex_count()), points;
  for (std::size_t frame = 0; frame < frames.frame_count(); ++frame) {
    progress.update(static_cast<double>(frame) / static_cast<double>(frames.frame_count()));
    const std::vector<float> bones = engine_rows(data, frames.frame(frame), frame);
    const std::vector<float> morphs = engine_morphs(frames, frame);
    const std::vector<double> numbers(morphs.begin(), morphs.end());
    move_by_skin(skin, targets, mesh.positions, transforms_of(bones), numbers, positions, workers);
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      if (vertices[i].empty()) continue;
      const skin_bounds_morph morph = morph_of(data, i, morphs);
      const skin_bounds found =
          skin_bounds_morphed(&clusters[i], cluster_rows.data(), data.reach, bones.data(), &morph);
      points.clear();
      for (const std::uint32_t v : vertices[i]) points.push_back(positions[v]);
      const auto& [center, radius, lower, upper] = found;
      tightness.add({{center[0], center[1], center[2]}, radius},
                    {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}, points);
    }
  }
  return tightness;
}

}  // namespace morula::cli
