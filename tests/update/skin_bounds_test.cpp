// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of skinned clusters. The oracle computes every vertex of every cluster from the definition of a skin, in long
// double, and compares without a tolerance; it shares no code with the bounds.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/skin_bounds.hpp>
#include <set>
#include <stdexcept>
#include <support/allocations.hpp>

#include "bodies.hpp"
#include "simd/processors.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;
using Motions = std::vector<AffineTransform>;
using LongPoint = std::array<long double, 3>;

struct Bounds {
  std::vector<Spheref> spheres, whole_spheres;
  std::vector<Boxf> boxes, whole_boxes;
  bool operator==(const Bounds&) const = default;
};
Bounds bounds_of(SkinBounds& bounds, const Motions& motions, Workers& workers = serial_workers()) {
  const std::size_t characters = motions.size() / bounds.bone_count(), count = characters * bounds.cluster_count();
  Bounds result{std::vector<Spheref>(count), std::vector<Spheref>(characters), std::vector<Boxf>(count),
                std::vector<Boxf>(characters)};
  const Status status =
      bounds.bounds(motions, {result.spheres, result.boxes, result.whole_spheres, result.whole_boxes}, workers);
  EXPECT_TRUE(status) << message(status);
  return result;
}

// How an engine uses weights that do not add up to 1.
enum class Missing { stays_at_rest, is_dropped };

LongPoint moved_vertex(const Mesh& mesh, const Skin& skin, const AffineTransform* motions, std::size_t v,
                       Missing missing) {
  LongPoint point{};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3& p = mesh.positions[v];
    long double rest = 1, sum = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
      const AffineTransform& t = motions[skin.bones[k]];
      long double moved = t.translation[axis];
      for (int column = 0; column < 3; ++column)
        moved += static_cast<long double>(t.columns[static_cast<std::size_t>(column)][axis]) * p[column];
      rest -= skin.weights[k];
      sum += static_cast<long double>(skin.weights[k]) * moved;
    }
    point[static_cast<std::size_t>(axis)] = missing == Missing::is_dropped ? sum : sum + rest * p[axis];
  }
  return point;
}

// A vertex as a shader computes it: in float, the matrices blended first.
LongPoint shaded_vertex(const Mesh& mesh, const Skin& skin, const AffineTransform* motions, std::size_t v) {
  float blended[3][4] = {};
  for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) {
        const AffineTransform& t = motions[skin.bones[k]];
        const double entry = column == 3 ? t.translation[row] : t.columns[static_cast<std::size_t>(column)][row];
        blended[row][column] += static_cast<float>(skin.weights[k]) * static_cast<float>(entry);
      }
  const Vec3f p(mesh.positions[v]);
  LongPoint point{};
  for (std::size_t row = 0; row < 3; ++row)
    point[row] = static_cast<long double>(blended[row][0] * p.x + blended[row][1] * p.y + blended[row][2] * p.z +
                                          blended[row][3]);
  return point;
}

// How far a point is outside; not above 0 inside.
long double outside(const Spheref& s, const LongPoint& p) {
  long double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = p[static_cast<std::size_t>(axis)] - static_cast<long double>(s.center[axis]);
    squared += d * d;
  }
  const long double excess = std::sqrt(squared) - static_cast<long double>(s.radius);
  return std::isnan(excess) ? HUGE_VALL : excess;
}
long double outside(const Boxf& b, const LongPoint& p) {
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
Excess excess_of(const Bounds& bounds, const Mesh& mesh, std::span<const std::uint32_t> cluster_of_facet,
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

Vec3 vector_within(Random& random, double size) {
  return {size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
}
constexpr int motion_kinds = 6;
AffineTransform motion_of_kind(Random& random, int kind, double size) {
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
Skin skin_of_kind(const Mesh& mesh, std::size_t bone_count, Weights kind, double size) {
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

// Runs of facets, some of one facet, some clusters without any.
std::vector<std::uint32_t> some_clusters(const Mesh& mesh, std::size_t per_cluster) {
  std::vector<std::uint32_t> result;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    result.push_back(static_cast<std::uint32_t>(f == 0 ? 1 : 3 + 2 * (f / per_cluster)));
  return result;
}

void expect_all_inside(const std::string& name, const Mesh& mesh, double size, std::size_t characters) {
  for (const Weights kind :
       {Weights::smooth, Weights::rough, Weights::negative, Weights::eight, Weights::loose_sums, Weights::one})
    for (const std::size_t per_cluster : {std::size_t{3}, std::size_t{40}, mesh.facet_count()}) {
      const Skin skin = skin_of_kind(mesh, 9, kind, size);
      const std::vector<std::uint32_t> clusters = some_clusters(mesh, per_cluster);
      SkinBounds bounds(mesh, skin, clusters);
      Random random(3);
      Motions motions;
      for (std::size_t c = 0; c < characters; ++c) {
        const int round = static_cast<int>(c % 8);
        for (std::size_t b = 0; b < skin.bone_count; ++b)
          motions.push_back(
              motion_of_kind(random, round == 6 ? static_cast<int>(b % motion_kinds) : round % motion_kinds, size));
        if (c % 4 == 0) motions[c * skin.bone_count] = {};
        if (round == 7) std::fill_n(motions.end() - 9, 9, motions.back());
      }
      const Bounds result = bounds_of(bounds, motions);
      for (std::size_t c = 0; c < characters; ++c)
        for (const Missing missing : {Missing::stays_at_rest, Missing::is_dropped}) {
          const Excess most = excess_of(result, mesh, clusters, c, [&](std::size_t v) {
            return moved_vertex(mesh, skin, motions.data() + c * skin.bone_count, v, missing);
          });
          const std::string where =
              name + ", weights " + std::to_string(static_cast<int>(kind)) + ", character " + std::to_string(c);
          EXPECT_LE(most.sphere, 0) << where;
          EXPECT_LE(most.box, 0) << where;
          EXPECT_LE(most.whole, 0) << where;
        }
    }
}

TEST(SkinBounds, contain_every_vertex_at_any_transforms) {
  for (const Specimen& b : specimens()) expect_all_inside(b.name, b.mesh, 1, 8);
}

TEST(SkinBounds, contain_every_vertex_far_from_the_origin_and_at_any_size) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-25, 1e-9, 1e3})
    for (const double away : {0.0, 1e3, 1e7}) {
      Mesh mesh = b.mesh;
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 0.3 * away}) * scale;
      expect_all_inside("scale " + std::to_string(scale) + ", away " + std::to_string(away), mesh, scale, 8);
    }
}

// Facets far smaller than the rounding of their positions; one motion for all bones, so that spheres have no slack.
TEST(SkinBounds, pay_for_rounding) {
  Random random(11);
  for (int round = 0; round < 4000; ++round) {
    Mesh mesh;
    const Vec3 middle = vector_within(random, 2);
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + vector_within(random, 0x1p-33));
    mesh.facets = {{0, 1, 2}};
    const std::size_t bones = round % 3 == 0 ? 1 : 8;
    Skin skin{.bone_count = bones, .begin = {0}};
    for (std::uint32_t v = 0; v < 3; ++v) {
      for (std::uint32_t k = 0; k < bones; ++k)
        skin.bones.push_back(k), skin.weights.push_back(1 / static_cast<double>(bones));
      skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    }
    const std::vector<std::uint32_t> cluster{0};
    SkinBounds bounds(mesh, skin, cluster);
    AffineTransform motion = motion_of_kind(random, 0, 1);
    Motions motions(bones, motion);
    if (round % 2 == 0)
      for (AffineTransform& t : motions) t = motion_of_kind(random, 3, 4);
    const Bounds result = bounds_of(bounds, motions);
    const Excess exact = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
      return moved_vertex(mesh, skin, motions.data(), v, Missing::stays_at_rest);
    });
    const Excess shaded = excess_of(result, mesh, cluster, 0,
                                    [&](std::size_t v) { return shaded_vertex(mesh, skin, motions.data(), v); });
    ASSERT_LE(std::max({exact.sphere, exact.box, exact.whole}), 0) << round;
    ASSERT_LE(std::max({shaded.sphere, shaded.box, shaded.whole}), 0) << round;
    // Not by a wide margin.
    EXPECT_LE(result.spheres[0].radius, 2e-2f) << round;
  }
}

// Influences of one bone that cancel: what a shader rounds is far larger than the weights that are left.
TEST(SkinBounds, pay_for_influences_that_cancel) {
  Mesh mesh;
  for (int k = 0; k < 3; ++k) mesh.positions.push_back({0.7 + (k == 1 ? 1e-6 : 0), 0.3 + (k == 2 ? 1e-6 : 0), 0.9});
  mesh.facets = {{0, 1, 2}};
  const std::vector<std::uint32_t> cluster{0};
  // Bone 1 is left with no weight at all, and moves farther than bone 0.
  for (const double weight : {1.0, 1e3, 1e5}) {
    const std::vector<double> of_vertex{1 + weight, -weight, weight, -weight};
    Skin skin{.bone_count = 2, .begin = {0, 4, 8, 12}};
    for (int v = 0; v < 3; ++v) {
      skin.bones.insert(skin.bones.end(), {0, 0, 1, 1});
      skin.weights.insert(skin.weights.end(), of_vertex.begin(), of_vertex.end());
    }
    SkinBounds bounds(mesh, skin, cluster);
    Random random(5);
    for (int round = 0; round < 200; ++round) {
      const Motions motions{motion_of_kind(random, 0, 1), motion_of_kind(random, 0, 100)};
      const Bounds result = bounds_of(bounds, motions);
      const Excess shaded = excess_of(result, mesh, cluster, 0,
                                      [&](std::size_t v) { return shaded_vertex(mesh, skin, motions.data(), v); });
      ASSERT_LE(std::max({shaded.sphere, shaded.box, shaded.whole}), 0) << weight << ", " << round;
    }
  }
}

TEST(SkinBounds, pay_for_weights_that_do_not_add_up) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.facets = {{0, 1, 2}};
  const std::vector<std::uint32_t> cluster{0};
  for (const double slack : {-9.9e-7, 9.9e-7}) {
    const Skin skin{1, {0, 1, 2, 3}, {0, 0, 0}, {1 - slack, 1 + slack, 1}};
    SkinBounds bounds(mesh, skin, cluster);
    for (int axis = 0; axis < 3; ++axis)
      for (const double far : {-1e3, 1e3}) {
        Motions motions(1);
        motions[0].translation[axis] = far;
        const Bounds result = bounds_of(bounds, motions);
        for (const Missing missing : {Missing::stays_at_rest, Missing::is_dropped}) {
          const Excess most = excess_of(result, mesh, cluster, 0, [&](std::size_t v) {
            return moved_vertex(mesh, skin, motions.data(), v, missing);
          });
          EXPECT_LE(std::max({most.sphere, most.box, most.whole}), 0);
        }
      }
  }
}

// A limb bent by two bones, clusters of some thirty facets.
TEST(SkinBounds, are_near_the_least_ones) {
  const Mesh mesh = sample_body("limb", 48);
  Skin skin{.bone_count = 2, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    const double second = std::clamp(p.x + 0.5, 0.0, 1.0);
    skin.bones.insert(skin.bones.end(), {0, 1});
    skin.weights.insert(skin.weights.end(), {1 - second, second});
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  const Box box = bounding_box(mesh);
  std::vector<std::uint32_t> clusters;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const Vec3 p = mesh.corners(f)[0];
    clusters.push_back(static_cast<std::uint32_t>(31.9 * (p.x - box.lower.x) / box.extent().x));
  }
  SkinBounds bounds(mesh, skin, clusters);
  Motions motions(2);
  motions[1].columns = {Vec3{0.5, 0.8660254037844386, 0}, Vec3{-0.8660254037844386, 0.5, 0}, Vec3{0, 0, 1}};
  const Bounds result = bounds_of(bounds, motions);
  std::vector<Vec3> positions(mesh.vertex_count());
  move_by_skin(skin, mesh.positions, motions, positions);
  double whole = 0, largest = 0;
  for (std::uint32_t k = 0; k < 32; ++k) {
    Box least;
    for (std::size_t f = 0; f < mesh.facet_count(); ++f)
      if (clusters[f] == k)
        for (const std::uint32_t v : mesh.facets[f]) least.add(positions[v]);
    const Boxf& b = result.boxes[k];
    const double ratio = length(Vec3(b.upper) - Vec3(b.lower)) / least.diagonal();
    whole += ratio / 32, largest = std::max(largest, ratio);
    EXPECT_LE(static_cast<double>(result.spheres[k].radius), 1.25 * least.diagonal() / 2) << k;
  }
  EXPECT_LE(whole, 1.25);
  EXPECT_LE(largest, 1.6);
}

TEST(SkinBounds, of_rest_and_of_one_rotation_are_those_of_rest) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 20));
  Random random(5);
  for (const AffineTransform& motion : {AffineTransform{}, motion_of_kind(random, 0, 1)}) {
    const Bounds result = bounds_of(bounds, Motions(9, motion));
    for (std::size_t k = 0; k < bounds.cluster_count(); ++k) {
      const SkinBoundsCluster& rest = bounds.data().clusters[k];
      // What is allowed for rounding: 2^-23 times some hundred of the size.
      EXPECT_NEAR(result.spheres[k].radius, rest.radius, 2e-4f);
      if (rest.row_count == 0) continue;
      EXPECT_LE(distance(Vec3(result.spheres[k].center), motion(Vec3(rest.center))), 1e-5);
    }
  }
}

// The header's formula, in double from its text.
TEST(SkinBounds, follow_the_formula_of_the_header) {
  const Mesh& mesh = specimens()[2].mesh;
  for (const Weights kind : {Weights::smooth, Weights::negative}) {
    const Skin skin = skin_of_kind(mesh, 9, kind, 1);
    SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
    Random random(8);
    for (int round = 0; round < 24; ++round) {
      Motions t;
      for (int b = 0; b < 9; ++b) t.push_back(motion_of_kind(random, round % motion_kinds, 1));
      const Bounds result = bounds_of(bounds, t);
      double size = static_cast<double>(bounds.data().reach);
      const auto entry = [](const AffineTransform& m, int i, int j) {
        return m.columns[static_cast<std::size_t>(j)][i];
      };
      for (const AffineTransform& m : t) {
        double most = 0;
        for (int i = 0; i < 3; ++i)
          most = std::max(most, std::abs(entry(m, i, 0)) + std::abs(entry(m, i, 1)) + std::abs(entry(m, i, 2)));
        size = std::max(size, most * static_cast<double>(bounds.data().reach) + max_norm(m.translation));
      }
      const auto stretch = [&](const AffineTransform& m) {
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
      };
      for (std::size_t k = 0; k < bounds.cluster_count(); ++k) {
        const SkinBoundsCluster& c = bounds.data().clusters[k];
        if (c.row_count == 0) continue;
        const SkinBoundsRow* rows = bounds.data().rows.data() + c.first_row;
        const AffineTransform& main = t[rows[0].bone];
        AffineTransform f = main;
        Vec3 center = main(Vec3(c.center)), strays;
        double stray = 0;
        for (std::uint32_t n = 0; n < c.row_count; ++n) {
          const SkinBoundsRow& row = rows[n];
          const double weight = static_cast<double>(row.weight), moment = static_cast<double>(row.moment_stray);
          const Vec3 d = t[row.bone](Vec3(c.center)) - main(Vec3(c.center));
          center += weight * d;
          double frobenius = 0;
          for (std::size_t j = 0; j < 3; ++j) {
            const Vec3 difference = t[row.bone].columns[j] - main.columns[j];
            f.columns[j] += weight * difference;
            frobenius += squared_length(difference);
          }
          stray += static_cast<double>(row.weight_stray) * length(d) + moment * std::sqrt(frobenius);
          for (int i = 0; i < 3; ++i)
            strays[i] += static_cast<double>(row.weight_stray) * std::abs(d[i]) + moment * std::sqrt(frobenius);
        }
        double hull = 0;
        Box box;
        for (std::uint32_t n = 0; n < c.row_count; ++n) {
          const AffineTransform& m = t[rows[n].bone];
          const Vec3 q = m(Vec3(rows[n].center));
          const double radius = static_cast<double>(rows[n].radius);
          hull = std::max(hull, distance(q, center) + stretch(m) * radius);
          Vec3 extent;
          for (int i = 0; i < 3; ++i) extent[i] = radius * length(Vec3{entry(m, i, 0), entry(m, i, 1), entry(m, i, 2)});
          box.add(q - extent), box.add(q + extent);
        }
        const double overhang = static_cast<double>(c.overhang), growth = static_cast<double>(c.growth);
        const double pad = static_cast<double>(c.rounding) * size;
        const double radius =
            std::min(stretch(f) * static_cast<double>(c.radius) + stray, (1 + 2 * overhang) * hull) * growth + pad;
        const double near = 1e-5 * size;
        EXPECT_LE(distance(Vec3(result.spheres[k].center), center), near);
        EXPECT_NEAR(static_cast<double>(result.spheres[k].radius), radius, near);
        for (int i = 0; i < 3; ++i) {
          const Vec3 row{entry(f, i, 0), entry(f, i, 1), entry(f, i, 2)};
          double by_box = 0;
          for (int j = 0; j < 3; ++j) by_box += std::abs(row[j]) * static_cast<double>(c.half_extent[j]);
          const double half = (std::min(length(row) * static_cast<double>(c.radius), by_box) + strays[i]) * growth;
          const double over = overhang * box.extent()[i];
          EXPECT_NEAR(static_cast<double>(result.boxes[k].lower[i]),
                      std::max(center[i] - half, box.lower[i] - over) - pad, near);
          EXPECT_NEAR(static_cast<double>(result.boxes[k].upper[i]),
                      std::min(center[i] + half, box.upper[i] + over) + pad, near);
        }
      }
    }
  }
}

// Many characters, one, stored rest data, any threads and any registers.
TEST(SkinBounds, have_the_same_bits_however_they_are_computed) {
  const Mesh& mesh = specimens()[2].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  Random random(9);
  Motions motions;
  constexpr std::size_t characters = 53;
  for (std::size_t k = 0; k < characters * 9; ++k)
    motions.push_back(motion_of_kind(random, static_cast<int>(k / 9 % motion_kinds), 1));
  const Bounds all = bounds_of(bounds, motions);
  for (std::size_t c = 0; c < characters; ++c) {
    const Bounds one = bounds_of(bounds, Motions(motions.begin() + static_cast<std::ptrdiff_t>(9 * c),
                                                 motions.begin() + static_cast<std::ptrdiff_t>(9 * c + 9)));
    const std::size_t n = bounds.cluster_count();
    EXPECT_TRUE(
        std::equal(one.spheres.begin(), one.spheres.end(), all.spheres.begin() + static_cast<std::ptrdiff_t>(c * n)));
    EXPECT_TRUE(std::equal(one.boxes.begin(), one.boxes.end(), all.boxes.begin() + static_cast<std::ptrdiff_t>(c * n)));
    EXPECT_EQ(one.whole_spheres[0], all.whole_spheres[c]);
    EXPECT_EQ(one.whole_boxes[0], all.whole_boxes[c]);
  }
  Workers three(3);
  EXPECT_EQ(bounds_of(bounds, motions, three), all);
  EXPECT_EQ(SkinBounds(mesh, skin, some_clusters(mesh, 25), three).data(), bounds.data());
  SkinBounds stored{SkinBoundsData(bounds.data())};
  EXPECT_EQ(bounds_of(stored, motions), all);
  const std::size_t kinds = detail::runnable_kinds();
  for (std::size_t most = 1; most <= kinds; ++most) {
    detail::allow_kinds(most);
    EXPECT_EQ(bounds_of(bounds, motions), all) << detail::kind_name(most - 1);
  }
  detail::allow_kinds(kinds);
}

TEST(SkinBounds, write_what_is_asked_for_and_allocate_nothing) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  const Motions motions(27);
  const Bounds all = bounds_of(bounds, motions);
  Bounds part = all;
  std::fill(part.boxes.begin(), part.boxes.end(), Boxf{});
  std::fill(part.whole_boxes.begin(), part.whole_boxes.end(), Boxf{});
  ASSERT_TRUE(bounds.bounds(motions, {.boxes = part.boxes}));
  EXPECT_EQ(part.boxes, all.boxes);
  ASSERT_TRUE(bounds.bounds(motions, {.whole_boxes = part.whole_boxes}));
  EXPECT_EQ(part, all);
  EXPECT_TRUE(bounds.bounds({}, {}));
  EXPECT_EQ(test::allocations_once_warm([&] { ASSERT_TRUE(bounds.bounds(motions, {.spheres = part.spheres})); }), 0u);

  // A cluster without facets is no part of the whole.
  ASSERT_EQ(bounds.data().clusters[0].row_count, 0u);
  EXPECT_EQ(all.spheres[0], Spheref{});
  EXPECT_EQ(all.boxes[0], Boxf{});
  Mesh away = mesh;
  for (Vec3& p : away.positions) p += Vec3{50, 50, 50};
  SkinBounds far(away, skin, some_clusters(mesh, 25));
  EXPECT_GT(bounds_of(far, motions).whole_boxes[0].lower.x, 40);
  EXPECT_LT(bounds_of(far, motions).whole_spheres[0].radius, 10);
}

TEST(SkinBounds, reject_transforms_that_they_cannot_bound) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::negative, 1);
  SkinBounds bounds(mesh, skin, some_clusters(mesh, 25));
  Motions motions(18);
  std::vector<Spheref> spheres(2 * bounds.cluster_count(), Spheref{{1, 2, 3}, 4});
  const std::vector<Spheref> before = spheres;
  constexpr double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {std::nan(""), inf, -inf, 1e300, 0x1p56}) {
    for (int entry = 0; entry < 4; ++entry) {
      Motions wrong = motions;
      (entry == 3 ? wrong[13].translation : wrong[13].columns[static_cast<std::size_t>(entry)]).y = bad;
      const Status status = bounds.bounds(wrong, {.spheres = spheres});
      EXPECT_EQ(status.code, Status::Code::bad_transform);
      EXPECT_EQ(status.index, 13u);
    }
  }
  EXPECT_EQ(bounds.bounds(Motions(10), {.spheres = spheres}).code, Status::Code::wrong_transform_count);
  EXPECT_EQ(spheres, before);
  EXPECT_THROW(static_cast<void>(bounds.bounds(motions, {.spheres = std::span(spheres).first(3)})),
               std::invalid_argument);
  std::vector<Spheref> whole(2);
  EXPECT_THROW(static_cast<void>(bounds.bounds(motions, {.whole_spheres = whole})), std::invalid_argument);
}

// The largest transforms that are accepted: all results are numbers, and cover.
TEST(SkinBounds, stay_in_range_at_the_largest_transforms) {
  const Mesh& mesh = specimens()[0].mesh;
  for (const Weights kind : {Weights::rough, Weights::negative}) {
    const Skin skin = skin_of_kind(mesh, 9, kind, 1);
    const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
    SkinBounds bounds(mesh, skin, clusters);
    const double most = static_cast<double>(bounds.data().largest_size);
    EXPECT_GE(most, 0x1p48);
    const double turned = most / (6 * std::max(1.0, static_cast<double>(bounds.data().reach)));
    Motions motions(9);
    for (std::size_t b = 0; b < 9; ++b) {
      const double sign = b % 2 == 0 ? 1 : -1;
      for (Vec3& column : motions[b].columns) column = Vec3{turned, turned, turned} * sign;
      motions[b].translation = Vec3{most, most, most} * (-0.49 * sign);
    }
    const Bounds result = bounds_of(bounds, motions);
    const Excess excess = excess_of(result, mesh, clusters, 0, [&](std::size_t v) {
      return moved_vertex(mesh, skin, motions.data(), v, Missing::stays_at_rest);
    });
    EXPECT_LE(std::max({excess.sphere, excess.box, excess.whole}), 0);
    for (const Spheref& s : result.spheres) EXPECT_TRUE(std::isfinite(s.radius));
  }
}

TEST(SkinBounds, refuse_input_by_name) {
  const Mesh& mesh = specimens()[0].mesh;
  const Skin skin = skin_of_kind(mesh, 9, Weights::rough, 1);
  const std::vector<std::uint32_t> clusters = some_clusters(mesh, 25);
  EXPECT_THROW(SkinBounds(mesh, skin, std::span(clusters).first(5)), std::invalid_argument);
  std::vector<std::uint32_t> beyond = clusters;
  beyond.back() = 1u << 24;
  EXPECT_THROW(SkinBounds(mesh, skin, beyond), std::invalid_argument);
  Skin other = skin;
  other.weights[0] += 1;
  EXPECT_THROW(SkinBounds(mesh, other, clusters), std::invalid_argument);
  Mesh huge = mesh;
  for (Vec3& p : huge.positions) p = p * 0x1p52;
  EXPECT_THROW(SkinBounds(huge, skin, clusters), std::invalid_argument);

  const SkinBoundsData good = SkinBounds(mesh, skin, clusters).data();
  const auto refuses = [&](const std::function<void(SkinBoundsData&)>& spoil) {
    SkinBoundsData bad = good;
    spoil(bad);
    EXPECT_THROW(SkinBounds{std::move(bad)}, std::invalid_argument);
  };
  refuses([](SkinBoundsData& d) { d.bone_count = 8; });
  refuses([](SkinBoundsData& d) { d.reach = 0; });
  refuses([](SkinBoundsData& d) { d.clusters[3].row_count = 1u << 20; });
  refuses([](SkinBoundsData& d) { d.clusters[3].first_row = 0xffffffff; });
  refuses([](SkinBoundsData& d) { d.clusters[3].radius = -1; });
  refuses([](SkinBoundsData& d) { d.clusters[3].growth = 0.5f; });
  refuses([](SkinBoundsData& d) { d.rows[3].center.x = NAN; });
  refuses([](SkinBoundsData& d) { d.rows[3].weight_stray = HUGE_VALF; });
}

TEST(SkinBounds, numbers_of_runs) {
  EXPECT_EQ(clusters_of_runs(std::vector<std::uint32_t>{0, 2, 2, 3}), (std::vector<std::uint32_t>{0, 0, 2}));
  EXPECT_TRUE(clusters_of_runs(std::vector<std::uint32_t>{0}).empty());
  EXPECT_THROW(clusters_of_runs({}), std::invalid_argument);
  EXPECT_THROW(clusters_of_runs(std::vector<std::uint32_t>{1, 2}), std::invalid_argument);
  EXPECT_THROW(clusters_of_runs(std::vector<std::uint32_t>{0, 3, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace morula
