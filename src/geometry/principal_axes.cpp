// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/principal_axes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace morula::detail {

PrincipalAxes principal_axes(const std::array<double, 6>& tensor, double noise) {
  const auto [xx, xy, xz, yy, yz, zz] = tensor;
  std::array<std::array<double, 3>, 3> a{{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
  std::array<std::array<double, 3>, 3> v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // rows are axes
  const double largest = std::max({std::abs(xx), std::abs(yy), std::abs(zz)});
  if (std::max({std::abs(xy), std::abs(xz), std::abs(yz)}) > noise * largest) {
    // Jacobi's rotations in a fixed order; ten rounds are twice what the worst tensors of three rows need.
    for (int round = 0; round < 10; ++round) {
      for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (std::size_t k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = v[p][k], vq = v[q][k];
          v[p][k] = c * vp - s * vq;
          v[q][k] = s * vp + c * vq;
        }
      }
    }
  }
  // The order of axes that rotates least: the largest trace, signs chosen for it.
  std::array<std::size_t, 3> order{0, 1, 2}, best = order;
  double best_trace = -1;
  do {
    double trace = 0;
    for (std::size_t i = 0; i < 3; ++i) trace += std::abs(v[order[i]][i]);
    if (trace > best_trace + 1e-12) {
      best_trace = trace;
      best = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  PrincipalAxes result;
  std::array<double, 3> moments{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = v[best[i]];
    const double sign = row[i] < 0 ? -1 : 1;
    result.axes[i] = sign * Vec3{row[0], row[1], row[2]};
    moments[i] = a[best[i]][best[i]];
  }
  if (dot(cross(result.axes[0], result.axes[1]), result.axes[2]) < 0) result.axes[2] = -result.axes[2];
  result.moments = {moments[0], moments[1], moments[2]};
  return result;
}

}  // namespace morula::detail
