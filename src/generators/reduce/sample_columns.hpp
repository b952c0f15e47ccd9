// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Samples in columns, for computations over all of them at once.
#pragma once

#include <vector>

#include "generators/fit/fit_kernels.hpp"
#include "generators/reduce/sample_set.hpp"

namespace morula::detail {

class SampleColumns {
 public:
  SampleColumns() = default;
  explicit SampleColumns(std::span<const Vec3> samples) {
    for (const Vec3& p : samples) add(p);
  }
  void add(const Vec3& p) { x_.push_back(p.x), y_.push_back(p.y), z_.push_back(p.z); }
  std::size_t size() const { return x_.size(); }

  /// squares: as many as there are samples.
  void squared_distances(const Vec3& from, double* squares) const {
    fit_kernels().squared_distances_in_double({x_.data(), y_.data(), z_.data(), size()}, from, squares);
  }
  /// The samples in the ball, or on it.
  SampleSet inside(const Sphere& ball) const {
    std::vector<double> squares(size());
    squared_distances(ball.center, squares.data());
    SampleSet set(size());
    fit_kernels().at_most_in_double(squares.data(), size(), ball.radius * ball.radius, set.words());
    return set;
  }

 private:
  std::vector<double> x_, y_, z_;
};

}  // namespace morula::detail
