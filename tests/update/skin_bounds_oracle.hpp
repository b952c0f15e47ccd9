// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// An oracle for bounds of skinned clusters, and skins, motions and clusters of all kinds. The oracle computes every
// vertex of every cluster from the definition of a skin and of morph targets, in long double, and compares without a
// tolerance; it shares no code with the bounds.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/skin_bounds.hpp>
#include <string>

#include "bodies.hpp"

namespace morula::test::skin_bounds {

using Motions = std::vector<AffineTransform>;
using LongPoint = std::array<long double, 3>;

struct Bounds {
  std::vector<Spheref> spheres, whole_spheres;
  std::vector<Boxf> boxes, whole_boxes;
  bool operator==(const Bounds&) const = default;
};
inline Bounds bounds_of(SkinBounds& bounds, const Motions& motions, std::span<const double> morphs,
                        Workers& workers = serial_workers()) {
  const std::size_t characters = motions.size() / bounds.bone_count(), count = characters * bounds.cluster_count();
  Bounds result{std::vector<Spheref>(count), std::vector<Spheref>(characters), std::vector<Boxf>(count),
                std::vector<Boxf>(characters)};
  const Status status =
      bounds.bounds(motions, morphs, {result.spheres, result.boxes, result.whole_spheres, result.whole_boxes}, workers);
  EXPECT_TRUE(status) << message(status);
  return result;
}
inline Bounds bounds_of(SkinBounds& bounds, const Motions& motions, Workers& workers = serial_workers()) {
  return bounds_of(bounds, motions, {}, workers);
}

// How an engine uses weights that do not add up to 1.
enum class Missing { stays_at_rest, is_dropped };

inline LongPoint at_rest(const Mesh& mesh, std::size_t v) {
  const Vec3& p = mesh.positions[v];
  return {p.x, p.y, p.z};
}
inline LongPoint morphed(const Mesh& mesh, const Modes& targets, const double* morphs, std::size_t v) {
  LongPoint point = at_rest(mesh, v);
  for (std::size_t j = 0; j < targets.mode_count; ++j)
    for (std::size_t axis = 0; axis < 3; ++axis)
      point[axis] += static_cast<long double>(morphs[j]) * targets.mode(j)[v][static_cast<int>(axis)];
  return point;
}

// p: the vertex before the bones move it.
inline LongPoint moved_vertex(const LongPoint& p, const Skin& skin, const AffineTransform* motions, std::size_t v,
                              Missing missing) {
  LongPoint point{};
  for (int axis = 0; axis < 3; ++axis) {
    long double rest = 1, sum = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
      const AffineTransform& t = motions[skin.bones[k]];
      long double moved = t.translation[axis];
      for (int column = 0; column < 3; ++column)
        moved += static_cast<long double>(t.columns[static_cast<std::size_t>(column)][axis]) *
                 p[static_cast<std::size_t>(column)];
      rest -= skin.weights[k];
      sum += static_cast<long double>(skin.weights[k]) * moved;
    }
    point[static_cast<std::size_t>(axis)] =
        missing == Missing::is_dropped ? sum : sum + rest * p[static_cast<std::size_t>(axis)];
  }
  return point;
}
inline LongPoint moved_vertex(const Mesh& mesh, const Skin& skin, const AffineTransform* motions, std::size_t v,
                              Missing missing) {
  return moved_vertex(at_rest(mesh, v), skin, motions, v, missing);
}

// A vertex as a shader computes it: in float, the matrices blended first.
inline LongPoint shaded_vertex(const Vec3f& p, const Skin& skin, const AffineTransform* motions, std::size_t v) {
  float blended[3][4] = {};
  for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) {
        const AffineTransform& t = motions[skin.bones[k]];
        const double entry = column == 3 ? t.translation[row] : t.columns[static_cast<std::size_t>(column)][row];
        blended[row][column] += static_cast<float>(skin.weights[k]) * static_cast<float>(entry);
      }
  LongPoint point{};
  for (std::size_t row = 0; row < 3; ++row)
    point[row] = static_cast<long double>(blended[row][0] * p.x + blended[row][1] * p.y + blended[row][2] * p.z +
                                          blended[row][3]);
  return point;
}
inline LongPoint shaded_vertex(const Mesh& mesh, const Skin& skin, const AffineTransform* motions, std::size_t v) {
  return shaded_vertex(Vec3f(mesh.positions[v]), skin, motions, v);
}

// How far a point is outside; not above 0 inside.
inline long double outside(const Spheref& s, const LongPoint& p) {
  long double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = p[static_cast<std::size_t>(axis)] - static_cast<long double>(s.center[axis]);
    squared += d * d;
  }
  const long double excess = std::sqrt(squared) - static_cast<long double>(s.radius);
  return std::isnan(excess) ? HUGE_VALL : excess;
}
inline long double outside(const Boxf& b, const LongPoint& p) {
  long double most = -HUGE_VALL;
  for (int axis = 0; axis < 3; ++axis) {
    const long double x = p[static_cast<std::size_t>(axis)];
    const long double excess =
        std::max(static_cast<long double>(b.lower[axis]) - x, x - static_cast<long double>(b.upper[axis]));
    most = std::isnan(excess) ? HUGE_VALL : std::max(most, excess);
  }
  return most;
}

// The farthest that a vertex is outside the sphere and the box of a cluster that uses it, or of the whole mesh.
struct Excess {
  long double sphere = -HUGE_VALL, box = -HUGE_VALL, whole = -HUGE_VALL;
};
inline Excess excess_of(const Bounds& bounds, const Mesh& mesh, std::span<const std::uint32_t> cluster_of_facet,
                        std::size_t character, const std::function<LongPoint(std::size_t)>& vertex) {
  const std::size_t clusters = bounds.spheres.size() / bounds.whole_boxes.size();
  std::vector<LongPoint> points;
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) points.push_back(vertex(v));
  Excess most;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (const std::uint32_t v : mesh.facets[f]) {
      const LongPoint& p = points[v];
      const std::size_t k = character * clusters + cluster_of_facet[f];
      most.sphere = std::max(most.sphere, outside(bounds.spheres[k], p));
      most.box = std::max(most.box, outside(bounds.boxes[k], p));
      most.whole = std::max(
          {most.whole, outside(bounds.whole_spheres[character], p), outside(bounds.whole_boxes[character], p)});
    }
  return most;
}

inline Vec3 vector_within(Random& random, double size) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}
inline constexpr int motion_kinds = 6;
inline AffineTransform motion_of_kind(Random& random, int kind, double size) {
  AffineTransform t;
  for (Vec3& column : t.columns) column = vector_within(random, kind == 3 ? 100 : 1);
  if (kind == 0 || kind == 5) {  // rotations
    t.columns[0] = normalized(t.columns[0]);
    t.columns[1] = normalized(cross(t.columns[0], t.columns[1]));
    t.columns[2] = cross(t.columns[0], t.columns[1]);
  }
  if (kind == 1) t.columns[2] = t.columns[1] = -t.columns[0];                              // rank one
  if (kind == 2) t.columns = {Vec3{-1, 0, 0}, Vec3{0, random.uniform(0, 50), 0}, Vec3{}};  // mirrored, uneven, flat
  t.translation = vector_within(random, size * (kind == 4 ? 1e9 : kind == 5 ? 0 : 1));
  return t;
}

enum class Weights { smooth, rough, negative, eight, loose_sums, one };
inline Skin skin_of_kind(const Mesh& mesh, std::size_t bone_count, Weights kind, double size) {
  Random random(7);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
    const std::size_t count = kind == Weights::eight                                            ? 8
                              : kind == Weights::one || (v % 7 == 0 && kind != Weights::smooth) ? 1
                                                                                                : 4;
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 p = is_finite(mesh.positions[v]) ? mesh.positions[v] / size : Vec3{};
      const double smooth = 1.2 + std::sin(static_cast<double>(k) + p.x) + 0.1 * p.y;
      weights.push_back(kind == Weights::smooth ? smooth : random.uniform(kind == Weights::negative ? -0.3 : 0.05, 1));
      sum += weights.back();
      skin.bones.push_back(static_cast<std::uint32_t>((kind == Weights::smooth ? k : v / 9 + k) % bone_count));
    }
    if (kind == Weights::negative) weights[0] += 2, sum += 2;
    const double wanted = kind == Weights::loose_sums ? 1 + 9e-7 * random.uniform(-1, 1) : 1;
    for (const double weight : weights) skin.weights.push_back(weight / sum * wanted);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

// Smooth and rough targets, some of a few vertices alone, and one that moves all vertices alike.
inline Modes targets_of_kinds(const Mesh& mesh, std::size_t count, double size) {
  const Modes smooth = smooth_modes(mesh, count), rough = rough_modes(mesh, count);
  Modes targets{mesh.vertex_count(), count, {}};
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
      const Vec3 u = j % 4 == 0 ? smooth.mode(j)[v] : j % 4 == 3 ? Vec3{0.3, -1, 0.2} : rough.mode(j)[v];
      targets.displacements.push_back(j % 4 != 2 || v % 11 == j ? size * u : Vec3{});
    }
  return targets;
}

// Runs of facets, some of one facet, some clusters without any.
inline std::vector<std::uint32_t> some_clusters(const Mesh& mesh, std::size_t per_cluster) {
  std::vector<std::uint32_t> result;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    result.push_back(static_cast<std::uint32_t>(f == 0 ? 1 : 3 + 2 * (f / per_cluster)));
  return result;
}

}  // namespace morula::test::skin_bounds
