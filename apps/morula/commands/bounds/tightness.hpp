// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Comparison of covering spheres with the smallest ones, and the exact check that they cover.
#pragma once

#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/io/skin_file.hpp>
#include <morula/update/skin_bounds.hpp>
#include <span>
#include <string>
#include <vector>

#include "shared/report.hpp"

namespace morula::cli {

/// True if p is outside: decided on |p - c|² - r² with an error of a 2⁻⁹⁰-th of its terms.
bool is_outside(const Sphere& sphere, const Vec3& p);

/// Radii of covering spheres over those of the smallest spheres of the same points, of clusters in frames.
class Tightness {
 public:
  /// points: of one cluster in one frame, at least one.
  void add(const Sphere& sphere, const Box& box, std::span<const Vec3> points);

  std::size_t sphere_count() const { return spheres_; }
  /// Points outside of their sphere or their box, over all frames.
  std::size_t uncovered_count() const { return uncovered_; }
  /// Spheres of a smallest radius of 0 are left out.
  Json json();
  std::string text();

 private:
  double ratio(double share);

  std::vector<double> ratios_;
  std::size_t spheres_ = 0, uncovered_ = 0;
  bool sorted_ = true;
};

/// Measures the spheres that the evaluator in C computes in all frames, with transforms and morphs rounded to float,
/// against the vertices as these move them. Frames without morphs have all targets at rest.
Tightness measured_tightness(const SkinBoundsData& data, const Mesh& mesh, const Skin& skin, const Modes& targets,
                             std::span<const std::uint32_t> cluster_of_facet, const BoneFrames& frames,
                             Workers& workers);

}  // namespace morula::cli
