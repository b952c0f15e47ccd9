// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters: the formula of skin_bounds.hpp, in double from its text.
#include <gtest/gtest.h>

#include "bodies.hpp"
#include "skin_bounds_oracle.hpp"

namespace morula {
namespace {

using namespace test::skin_bounds;

double entry(const AffineTransform& m, int i, int j) {
  return m.columns[static_cast<std::size_t>(j)][i];
}
Vec3 row_of_matrix(const AffineTransform& m, int i) {
  return {entry(m, i, 0), entry(m, i, 1), entry(m, i, 2)};
}
double row_sum(const AffineTransform& m) {
  double most = 0;
  for (int i = 0; i < 3; ++i)
    most = std::max(most, std::abs(entry(m, i, 0)) + std::abs(entry(m, i, 1)) + std::abs(entry(m, i, 2)));
  return most;
}
double stretch(const AffineTransform& m) {
  double most = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    for (int j = 0; j < 3; ++j) {
      double product = 0;
      for (int l = 0; l < 3; ++l) product += entry(m, l, i) * entry(m, l, j);
      sum += std::abs(product);
    }
    most = std::max(most, sum);
  }
  return std::sqrt(most);
}

// What morph targets add to the rest data of a cluster.
struct MovedRest {
  Vec3 shift, spreads;
  double spread = 0, travel = 0;
};
MovedRest moved_rest(const SkinBoundsData& data, std::size_t k, std::span<const double> morphs) {
  MovedRest result;
  if (morphs.empty()) return result;
  for (std::uint32_t n = data.target_begin[k]; n < data.target_begin[k + 1]; ++n) {
    const SkinBoundsTarget& t = data.targets[n];
    const double q = morphs[t.target];
    result.shift += q * Vec3(t.shift);
    result.spreads += std::abs(q) * Vec3(t.half_extent);
    result.spread += std::abs(q) * static_cast<double>(t.radius);
    result.travel += std::abs(q) * (static_cast<double>(max_norm(t.shift)) + static_cast<double>(t.radius));
  }
  return result;
}

struct FormulaBounds {
  Vec3 center;
  double radius = 0;
  Vec3 lower, upper;
};
FormulaBounds by_formula(const SkinBoundsData& data, std::size_t k, const Motions& t, std::span<const double> morphs) {
  const SkinBoundsCluster& c = data.clusters[k];
  const SkinBoundsRow* rows = data.rows.data() + c.first_row;
  const MovedRest moved = moved_rest(data, k, morphs);
  double size = static_cast<double>(data.reach), largest_sum = 1;
  for (const AffineTransform& m : t) {
    size = std::max(size, row_sum(m) * static_cast<double>(data.reach) + max_norm(m.translation));
    largest_sum = std::max(largest_sum, row_sum(m));
  }
  size += moved.travel * largest_sum;
  const Vec3 middle = Vec3(c.center) + moved.shift;
  const AffineTransform& main = t[rows[0].bone];
  AffineTransform f = main;
  Vec3 center = main(middle), strays;
  double stray = 0;
  for (std::uint32_t n = 0; n < c.row_count; ++n) {
    const SkinBoundsRow& row = rows[n];
    const double weight = static_cast<double>(row.weight), weight_stray = static_cast<double>(row.weight_stray);
    const double moment = static_cast<double>(row.moment_stray) + weight_stray * moved.spread;
    const Vec3 d = t[row.bone](middle) - main(middle);
    center += weight * d;
    double frobenius = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 difference = t[row.bone].columns[j] - main.columns[j];
      f.columns[j] += weight * difference;
      frobenius += squared_length(difference);
    }
    stray += weight_stray * length(d) + moment * std::sqrt(frobenius);
    for (int i = 0; i < 3; ++i) strays[i] += weight_stray * std::abs(d[i]) + moment * std::sqrt(frobenius);
  }
  double hull = 0;
  Box box;
  for (std::uint32_t n = 0; n < c.row_count; ++n) {
    const AffineTransform& m = t[rows[n].bone];
    const Vec3 q = m(Vec3(rows[n].center) + moved.shift);
    const double radius = static_cast<double>(rows[n].radius) + moved.spread;
    hull = std::max(hull, distance(q, center) + stretch(m) * radius);
    Vec3 extent;
    for (int i = 0; i < 3; ++i) extent[i] = radius * length(row_of_matrix(m, i));
    box.add(q - extent), box.add(q + extent);
  }
  const double overhang = static_cast<double>(c.overhang), growth = static_cast<double>(c.growth);
  const double pad = static_cast<double>(c.rounding) * size, radius = static_cast<double>(c.radius) + moved.spread;
  FormulaBounds result{center, std::min(stretch(f) * radius + stray, (1 + 2 * overhang) * hull) * growth + pad, {}, {}};
  for (int i = 0; i < 3; ++i) {
    double by_box = 0;
    for (int j = 0; j < 3; ++j)
      by_box += std::abs(entry(f, i, j)) * (static_cast<double>(c.half_extent[j]) + moved.spreads[j]);
    const double half = (std::min(length(row_of_matrix(f, i)) * radius, by_box) + strays[i]) * growth;
    const double over = overhang * box.extent()[i];
    result.lower[i] = std::max(center[i] - half, box.lower[i] - over) - pad;
    result.upper[i] = std::min(center[i] + half, box.upper[i] + over) + pad;
  }
  return result;
}

TEST(SkinBounds, follow_the_formula_of_the_header) {
  const Mesh& mesh = test::specimens()[2].mesh;
  const Modes targets = targets_of_kinds(mesh, 4, 1);
  for (const Weights kind : {Weights::smooth, Weights::negative}) {
    const Skin skin = skin_of_kind(mesh, 9, kind, 1);
    SkinBounds bounds(mesh, skin, targets, some_clusters(mesh, 25));
    Random random(8);
    for (int round = 0; round < 48; ++round) {
      Motions t;
      for (int b = 0; b < 9; ++b) t.push_back(motion_of_kind(random, round % motion_kinds, 1));
      std::vector<double> morphs;
      if (round % 2 == 0)
        for (std::size_t j = 0; j < targets.mode_count; ++j) morphs.push_back(2 * random.uniform(-1, 1));
      const Bounds result = bounds_of(bounds, t, morphs);
      double near = static_cast<double>(bounds.data().reach) + 20;
      for (const AffineTransform& m : t) near = std::max(near, row_sum(m) * 20 + max_norm(m.translation));
      near *= 1e-5;
      for (std::size_t k = 0; k < bounds.cluster_count(); ++k) {
        if (bounds.data().clusters[k].row_count == 0) continue;
        const FormulaBounds expected = by_formula(bounds.data(), k, t, morphs);
        EXPECT_LE(distance(Vec3(result.spheres[k].center), expected.center), near);
        EXPECT_NEAR(static_cast<double>(result.spheres[k].radius), expected.radius, near);
        EXPECT_LE(max_norm(Vec3(result.boxes[k].lower) - expected.lower), near);
        EXPECT_LE(max_norm(Vec3(result.boxes[k].upper) - expected.upper), near);
      }
    }
  }
}

}  // namespace
}  // namespace morula
