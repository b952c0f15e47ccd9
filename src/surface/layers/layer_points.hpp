// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A few points that stand for a patch: one for each sector about its center of pressure.
//
// A sample of the patch belongs to the two sectors between whose rays it is, with shares that change linearly from ray
// to ray, and to all sectors alike at the center. So points move continuously with the samples.
#pragma once

#include <morula/surface/layer_patches.hpp>
#include <vector>

#include "surface/layers/layer_integrals.hpp"

namespace morula::detail {

class LayerPoints {
 public:
  struct Side {
    const LayerMesh* mesh;
    std::span<const std::uint32_t> facets;
  };
  /// Adds up to `count` points. first: unit vector across the normal from which sectors are counted. area: the sum over
  /// all samples.
  void add(std::span<const LayerSample> samples, double area, const Vec3& normal, const Vec3& first,
           std::uint32_t count, const Side& a, const Side& b, const Vec3& origin, std::vector<LayerPoint>& points);

 private:
  struct Sector {
    Vec3 weighted, force;
    double area = 0, volume = 0;
  };
  void find_shares(double x, double y, double radius);
  std::vector<Sector> sectors_;
  std::vector<Vec3> rays_, arms_;
  std::vector<double> share_;
};

}  // namespace morula::detail
