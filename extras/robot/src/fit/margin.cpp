// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/margin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/box.hpp>
#include <morula/tree/cover.hpp>
#include <stdexcept>

#include "fit/clip.hpp"

namespace morula::robot {

namespace {

/// The least distance of a sphere from planes: rounding to decimals moves less than 1e-6 of the size, and rounding to
/// float even less.
double clip_allowance(const Mesh& mesh) {
  double extent = 0;
  for (const Vec3& p : mesh.positions) extent = std::max(extent, max_norm(p));
  return 2e-6 * extent;
}

/// Whether the sphere of a leaf stays on the kept side, as files have it.
bool stays_as_written(const Sphere& leaf, std::span<const ClipPlane> planes, const FitOptions& options,
                      double allowance) {
  const Sphere last{leaf.center, padded_radius(reduced(leaf, options.tolerance).radius, options)};
  return !(reach_beyond(std::span(&last, 1), planes, allowance) > 0);
}

}  // namespace

void require_margin(const std::string& link, const Mesh& mesh, std::span<const ClipPlane> planes,
                    const FitOptions& options) {
  const double least = options.padding + clip_allowance(mesh);
  if (least_height(mesh, planes) >= least) return;
  throw std::invalid_argument(
      fmt::format("clip margin {} is too small for link {}: padding and rounding take {:.6g}, so every cover reaches "
                  "beyond its clip planes; give more than that, and the more, the fewer spheres it takes",
                  *options.clip_margin, link, least));
}

void keep_from_planes(const Mesh& mesh, std::span<const ClipPlane> planes, const FitOptions& options,
                      CoveredTree& model) {
  const double allowance = clip_allowance(mesh);
  const auto stays = [&](const Sphere& s) { return stays_as_written(s, planes, options, allowance); };
  // The center of a sphere around the lowest point is no higher above that than its radius.
  const auto may_stay = [&](const Sphere& s, const Mesh& part) {
    return least_height(part, planes) >= allowance + std::max(options.padding, options.min_radius - s.radius);
  };
  divide_until(stays, may_stay, mesh, model, {.seed = options.seed, .quality = Quality::draft, .stop = options.stop});
}

bool stays_from_planes(const Mesh& mesh, std::span<const Sphere> leaves, std::span<const ClipPlane> planes,
                       const FitOptions& options) {
  const double allowance = clip_allowance(mesh);
  return std::all_of(leaves.begin(), leaves.end(),
                     [&](const Sphere& s) { return stays_as_written(s, planes, options, allowance); });
}

}  // namespace morula::robot
