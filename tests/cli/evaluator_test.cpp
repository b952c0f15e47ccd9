// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <morula/geometry/mesh.hpp>
#include <random>

#include "evaluator_texts.hpp"

namespace morula::test {
namespace {

constexpr std::size_t bone_count = 6, target_count = 5;

/// Clusters of random triangles whose vertices follow two to four bones, and morph targets that move some of them.
struct RandomCharacter {
  Mesh mesh;
  Skin skin{.bone_count = bone_count, .begin = {0}};
  std::vector<std::uint32_t> clusters;
  Modes targets{0, target_count, {}};
};

RandomCharacter random_character(std::mt19937& random, bool with_negative_weights) {
  std::uniform_real_distribution<double> unit(-1, 1);
  RandomCharacter made;
  for (std::uint32_t cluster = 0; cluster < 4; ++cluster) {
    const Vec3 place{3 * unit(random), 3 * unit(random), 3 * unit(random)};
    const Vec3 flat{1, cluster % 2 == 0 ? 1 : 0.05, 0.3};
    for (int corner = 0; corner < 12; ++corner) {
      made.mesh.positions.push_back(place + Vec3{flat.x * unit(random), flat.y * unit(random), flat.z * unit(random)});
      const std::size_t count = 2 + random() % 3;
      double sum = 0;
      std::vector<double> weights;
      for (std::size_t k = 0; k < count; ++k) {
        weights.push_back(unit(random) + (with_negative_weights && cluster == 1 ? 0.9 : 1));
        sum += weights.back();
      }
      if (!(sum > 0.2)) weights.assign(count, 1), sum = static_cast<double>(count);
      for (std::size_t k = 0; k < count; ++k) {
        made.skin.bones.push_back(static_cast<std::uint32_t>((cluster + k * (1 + random() % 2)) % bone_count));
        made.skin.weights.push_back(weights[k] / sum);
      }
      made.skin.begin.push_back(static_cast<std::uint32_t>(made.skin.bones.size()));
    }
    for (std::uint32_t f = 0; f < 4; ++f) {
      const std::uint32_t v = 12 * cluster + 3 * f;
      made.mesh.facets.push_back({v, v + 1, v + 2});
      made.clusters.push_back(cluster);
    }
  }
  made.targets.vertex_count = made.mesh.vertex_count();
  for (std::size_t j = 0; j < target_count; ++j)
    for (std::size_t v = 0; v < made.mesh.vertex_count(); ++v) {
      const bool is_moved = (v / 12 + j) % 3 != 0;
      const Vec3 own{unit(random), unit(random), 0.1 * unit(random)}, shared{2, -1, 0.5};
      made.targets.displacements.push_back(is_moved ? shared + static_cast<double>(j % 3) * own : Vec3{});
    }
  return made;
}

/// None in every third round; else numbers of both signs, some of them 0.
std::vector<float> random_morphs(std::mt19937& random, int round) {
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<float> morphs;
  if (round % 3 == 2) return morphs;
  for (std::size_t j = 0; j < target_count; ++j)
    morphs.push_back(random() % 4 == 0 ? 0 : unit(random) * (round % 3 == 1 ? 50.0f : 1.0f));
  return morphs;
}

/// Matrices near the identity or anywhere, mirrored and uneven ones among them, near the origin or far from it.
std::vector<float> random_bones(std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const float apart = random() % 2 == 0 ? 0.2f : 2.0f, away = random() % 3 == 0 ? 1000.0f : 2.0f;
  const bool scales = random() % 2 == 0;
  std::vector<float> bones;
  for (std::size_t i = 0; i < 12 * bone_count; ++i) {
    const bool is_diagonal = i % 12 % 5 == 0 && i % 4 != 3;
    bones.push_back(i % 4 == 3 ? away + unit(random) : apart * unit(random) + (is_diagonal ? 1.0f : 0.0f));
    if (scales && i % 12 == 0) bones.back() *= -3;
  }
  if (random() % 7 == 0)
    for (float& number : bones) number *= 1e-4f;  // all but a point
  return bones;
}

std::vector<AffineTransform> as_transforms(const std::vector<float>& bones) {
  std::vector<AffineTransform> transforms(bones.size() / 12);
  for (std::size_t i = 0; i < bones.size(); ++i) {
    AffineTransform& t = transforms[i / 12];
    (i % 4 == 3 ? t.translation : t.columns[i % 4])[static_cast<int>(i % 12 / 4)] = static_cast<double>(bones[i]);
  }
  return transforms;
}

double largest_number(const std::vector<float>& bones) {
  double largest = 1;
  for (const float number : bones) largest = std::max(largest, std::abs(static_cast<double>(number)));
  return largest;
}

class EvaluatorTexts : public testing::TestWithParam<Evaluator> {};

/// The oracle poses vertices in long double, from the definitions of morph targets and linear blend skinning. A GPU may
/// round to either neighbor of a result: the texts run in every rounding mode.
TEST_P(EvaluatorTexts, spheres_and_boxes_contain_the_vertices_that_targets_and_bones_move) {
  using Real = long double;
  std::mt19937 random(1);
  for (int round = 0; round < 600; ++round) {
    const RandomCharacter c = random_character(random, round % 2 == 0);
    const SkinBounds bounds(c.mesh, c.skin, c.targets, c.clusters);
    const std::vector<float> bones = random_bones(random), morphs = random_morphs(random, round);
    for (std::uint32_t cluster = 0; cluster < bounds.cluster_count(); ++cluster) {
      constexpr int modes[]{FE_TONEAREST, FE_DOWNWARD, FE_UPWARD, FE_TOWARDZERO};
      ASSERT_EQ(std::fesetround(modes[round / 2 % 4]), 0);
      const auto bound = GetParam()(bounds.data(), cluster, bones, morphs);
      ASSERT_EQ(std::fesetround(FE_TONEAREST), 0);
      const auto& [sphere, box] = bound;
      for (std::uint32_t v = 12 * cluster; v < 12 * cluster + 12; ++v) {
        Real rest[3], p[3]{}, squares = 0;
        for (int axis = 0; axis < 3; ++axis) {
          rest[axis] = c.mesh.positions[v][axis];
          for (std::size_t j = 0; j < morphs.size(); ++j) rest[axis] += Real{morphs[j]} * c.targets.mode(j)[v][axis];
        }
        for (std::uint32_t k = c.skin.begin[v]; k < c.skin.begin[v + 1]; ++k)
          for (int row = 0; row < 3; ++row) {
            const float* m = &bones[12 * c.skin.bones[k] + 4 * static_cast<std::size_t>(row)];
            Real at = m[3];
            for (int axis = 0; axis < 3; ++axis) at += Real{m[axis]} * rest[axis];
            p[row] += c.skin.weights[k] * at;
          }
        for (int axis = 0; axis < 3; ++axis) {
          squares += (p[axis] - Real{sphere.center[axis]}) * (p[axis] - Real{sphere.center[axis]});
          EXPECT_LE(Real{box.lower[axis]}, p[axis]);
          EXPECT_GE(Real{box.upper[axis]}, p[axis]);
        }
        EXPECT_LE(squares, Real{sphere.radius} * Real{sphere.radius});
      }
    }
    if (HasFailure()) return;
  }
}

/// With large allowances, so that a text that leaves one out differs, as it does without any other of its terms.
TEST_P(EvaluatorTexts, results_are_those_of_the_library) {
  std::mt19937 random(2);
  for (int round = 0; round < 600; ++round) {
    RandomCharacter c = random_character(random, round % 2 == 0);
    // The library may take the size of the transforms over all bones: those of one cluster are all.
    const bool has_rounding = round % 5 == 0;
    if (has_rounding) c.clusters.assign(c.clusters.size(), 0);
    SkinBoundsData data = SkinBounds(c.mesh, c.skin, c.targets, c.clusters).data();
    for (SkinBoundsCluster& cluster : data.clusters) {
      cluster.growth = round % 3 == 0 ? 1.25f : cluster.growth;
      cluster.rounding = has_rounding ? 0.125f : cluster.rounding;
    }
    SkinBounds bounds(data);
    const std::vector<float> bones = random_bones(random), morphs = random_morphs(random, round);
    std::vector<Spheref> spheres(bounds.cluster_count());
    std::vector<Boxf> boxes(bounds.cluster_count());
    ASSERT_TRUE(bounds.bounds(as_transforms(bones), std::vector<double>(morphs.begin(), morphs.end()),
                              {.spheres = spheres, .boxes = boxes}));
    const double tolerance = 1e-4 * largest_number(bones) * (round % 3 == 1 ? 50 : 1);
    for (std::uint32_t cluster = 0; cluster < bounds.cluster_count(); ++cluster) {
      const auto [sphere, box] = GetParam()(data, cluster, bones, morphs);
      EXPECT_NEAR(sphere.radius, spheres[cluster].radius, tolerance);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sphere.center[axis], spheres[cluster].center[axis], tolerance);
        EXPECT_NEAR(box.lower[axis], boxes[cluster].lower[axis], tolerance);
        EXPECT_NEAR(box.upper[axis], boxes[cluster].upper[axis], tolerance);
      }
    }
    if (HasFailure()) return;
  }
}

TEST_P(EvaluatorTexts, a_cluster_without_facets_is_a_point_at_the_origin) {
  std::mt19937 random(3);
  RandomCharacter c = random_character(random, false);
  for (std::uint32_t& cluster : c.clusters) cluster += cluster > 1 ? 1 : 0;
  const SkinBounds bounds(c.mesh, c.skin, c.clusters);
  const auto [sphere, box] = GetParam()(bounds.data(), 2, random_bones(random), {});
  EXPECT_EQ(sphere, Spheref{});
  EXPECT_EQ(box, Boxf{});
}

INSTANTIATE_TEST_SUITE_P(
    All, EvaluatorTexts, testing::Values(evaluated_in_c, evaluated_in_glsl, evaluated_in_wgsl), [](const auto& info) {
      return std::string(info.param == evaluated_in_c ? "c" : info.param == evaluated_in_glsl ? "glsl" : "wgsl");
    });

}  // namespace
}  // namespace morula::test
