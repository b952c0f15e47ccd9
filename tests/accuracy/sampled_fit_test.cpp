// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The sampled figures on shapes whose figures are known, by formula or by an integral over a fine grid of angles.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <numbers>
#include <stdexcept>
#include <support/meshes.hpp>

namespace morula {
namespace {

const Mesh& cube() {  // of side 2 about the origin
  static const Mesh mesh = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  return mesh;
}

double distance_to_cube(const Vec3& p) {
  const auto beyond = [](double x) { return std::max(0.0, std::abs(x) - 1); };
  return length(Vec3{beyond(p.x), beyond(p.y), beyond(p.z)});
}

// Of the points outside the cube on a sphere about the origin: their share, and their distances, sorted.
struct OnSphere {
  double share;
  std::vector<double> distances;

  explicit OnSphere(double radius) {
    constexpr int rings = 600, around = 1200;
    for (int i = 0; i < rings; ++i)
      for (int k = 0; k < around; ++k) {
        // Equal areas: z is uniform.
        const double z = -1 + (2 * i + 1.0) / rings, ring = std::sqrt(1 - z * z);
        const double angle = 2 * std::numbers::pi * (k + 0.5) / around;
        const double d = distance_to_cube(Vec3{ring * std::cos(angle), ring * std::sin(angle), z} * radius);
        if (d > 0) distances.push_back(d);
      }
    share = static_cast<double>(distances.size()) / (rings * around);
    std::sort(distances.begin(), distances.end());
  }
  double mean() const {
    double sum = 0;
    for (const double d : distances) sum += d;
    return sum / static_cast<double>(distances.size());
  }
  double p95() const { return distances[static_cast<std::size_t>(0.95 * static_cast<double>(distances.size()))]; }
};

// Many samples, so that what is left of chance is small.
constexpr SampleCounts many{.interior = 60000, .surface = 60000, .of_a_sphere = 20000};

TEST(SampledFit, sphere_about_a_cube) {
  const Sphere about{{0, 0, 0}, std::sqrt(3.0)};
  const SampledFit fit = FitSampler(cube(), many).measure(std::span(&about, 1));
  const OnSphere expected(about.radius);
  EXPECT_EQ(fit.coverage, 1.0);
  EXPECT_NEAR(*fit.protrusion, 1.0, 1e-3);
  EXPECT_NEAR(*fit.protrusion_mean, expected.mean(), 1e-3);
  EXPECT_NEAR(*fit.protrusion_p95, expected.p95(), 2e-3);
  EXPECT_NEAR(*fit.protrusion_max, std::sqrt(3.0) - 1, 1e-3);
  EXPECT_EQ(fit.surface_gap_mean, 0);
  EXPECT_EQ(fit.surface_gap_max, 0);
  EXPECT_NEAR(*fit.volume_ratio, 4.0 / 3.0 * std::numbers::pi * std::pow(3.0, 1.5) / 8, 1e-12);
}

TEST(SampledFit, sphere_inside_a_cube) {
  const Sphere inside{{0, 0, 0}, 1 - 1e-9};
  const SampledFit fit = FitSampler(cube(), many).measure(std::span(&inside, 1));
  EXPECT_NEAR(*fit.coverage, std::numbers::pi / 6, 0.008);
  EXPECT_EQ(fit.protrusion, 0.0);
  EXPECT_EQ(fit.protrusion_mean, 0.0);
  EXPECT_EQ(fit.protrusion_p95, 0.0);
  EXPECT_EQ(fit.protrusion_max, 0.0);
  // Over a face: sqrt(1 + u^2 + v^2) - 1.
  std::vector<double> gaps;
  double mean = 0;
  for (int i = 0; i < 1000; ++i)
    for (int k = 0; k < 1000; ++k) {
      const double u = (i + 0.5) / 1000, v = (k + 0.5) / 1000;
      gaps.push_back(std::sqrt(1 + u * u + v * v) - 1);
      mean += gaps.back() / 1e6;
    }
  std::sort(gaps.begin(), gaps.end());
  EXPECT_NEAR(fit.surface_gap_mean, mean, 2e-3);
  EXPECT_NEAR(fit.surface_gap_p95, gaps[950000], 4e-3);
  EXPECT_NEAR(fit.surface_gap_max, std::sqrt(3.0) - 1, 0.02);
  EXPECT_LE(fit.surface_gap_max, std::sqrt(3.0) - 1 + 1e-8);
  EXPECT_NEAR(*fit.volume_ratio, std::numbers::pi / 6, 1e-8);
}

TEST(SampledFit, sphere_that_comes_out_of_the_faces) {
  const Sphere sphere{{0, 0, 0}, 1.25};
  const SampledFit fit = FitSampler(cube(), many).measure(std::span(&sphere, 1));
  const OnSphere expected(sphere.radius);
  // Six caps of height 1/4 on a sphere of radius 5/4.
  EXPECT_NEAR(*fit.protrusion, 6 * 0.5 * (0.25 / 1.25), 2e-3);
  EXPECT_NEAR(expected.share, 0.6, 2e-3);
  EXPECT_NEAR(*fit.protrusion_mean, expected.mean(), 1e-3);
  EXPECT_NEAR(*fit.protrusion_p95, expected.p95(), 2e-3);
  EXPECT_NEAR(*fit.protrusion_max, 0.25, 1e-3);
  // The ball less six caps, of the cube.
  const double cap = std::numbers::pi * 0.25 * 0.25 * (3 * 1.25 - 0.25) / 3;
  EXPECT_NEAR(*fit.coverage, (4.0 / 3.0 * std::numbers::pi * std::pow(1.25, 3) - 6 * cap) / 8, 0.006);
}

TEST(SampledFit, overlaps_count_twice_and_copies_change_no_share) {
  const Sphere one{{0.3, 0, 0}, 1.1};
  const std::vector<Sphere> two{one, one};
  const FitSampler sampler(cube());
  const SampledFit single = sampler.measure(std::span(&one, 1)), both = sampler.measure(two);
  EXPECT_NEAR(*both.volume_ratio, 2 * *single.volume_ratio, 1e-12);
  EXPECT_EQ(both.coverage, single.coverage);
  EXPECT_NEAR(*both.protrusion, *single.protrusion, 1e-12);
  EXPECT_EQ(both.surface_gap_mean, single.surface_gap_mean);
}

TEST(SampledFit, is_the_same_for_any_number_of_workers_and_moves_with_the_scale) {
  const std::vector<Sphere> spheres{{{0.3, 0, 0}, 1.1}, {{-0.5, 0.5, 0}, 0.7}};
  const SampledFit serial = FitSampler(cube()).measure(spheres);
  Workers three(3);
  const SampledFit threaded = FitSampler(cube(), {}, three).measure(spheres, three);
  EXPECT_EQ(serial.coverage, threaded.coverage);
  EXPECT_EQ(serial.protrusion_mean, threaded.protrusion_mean);
  EXPECT_EQ(serial.surface_gap_mean, threaded.surface_gap_mean);
  std::vector<Sphere> large = spheres;
  for (Sphere& s : large) s = {s.center * 1024.0, s.radius * 1024.0};
  const SampledFit scaled = FitSampler(test::scaled(cube(), 1024)).measure(large);
  EXPECT_EQ(scaled.coverage, serial.coverage);
  EXPECT_EQ(*scaled.protrusion_p95, 1024 * *serial.protrusion_p95);
  EXPECT_EQ(scaled.volume_ratio, serial.volume_ratio);
}

TEST(SampledFit, an_open_mesh_has_gaps_alone) {
  const Sphere s{{0.5, 0.5, 0}, 0.5};
  const SampledFit fit = FitSampler(test::grid_plate(4), many).measure(std::span(&s, 1));
  EXPECT_FALSE(fit.coverage || fit.protrusion || fit.protrusion_mean || fit.protrusion_p95 || fit.volume_ratio);
  EXPECT_NEAR(fit.surface_gap_max, std::sqrt(0.5) - 0.5, 0.02);
  EXPECT_THROW(FitSampler(cube()).measure({}), std::invalid_argument);
  EXPECT_THROW(FitSampler(Mesh{}), std::invalid_argument);
}

TEST(SampledFit, comes_with_measure_when_asked_for) {
  const Sphere about{{0, 0, 0}, 2};
  EXPECT_FALSE(measure_spheres(cube(), std::span(&about, 1)).sampled);
  const LevelMeasure level = measure_spheres(cube(), std::span(&about, 1), {.with_sampled_fit = true});
  ASSERT_TRUE(level.sampled);
  EXPECT_EQ(level.sampled->coverage, 1.0);
  EXPECT_LE(*level.sampled->protrusion_max, level.protrusion->worst * 1.01);
}

}  // namespace
}  // namespace morula
