// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes that break builders, beyond those of support/meshes.hpp: every method covers them with few finite spheres.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <support/meshes.hpp>
#include <support/methods.hpp>

namespace morula {
namespace {

Mesh cylinder(int around, double radius, double length) {
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    const auto [s, c] = sin_cos(2 * std::numbers::pi * i / around);
    mesh.positions.push_back({0, radius * c, radius * s});
    mesh.positions.push_back({length, radius * c, radius * s});
  }
  mesh.positions.push_back({0, 0, 0});
  mesh.positions.push_back({length, 0, 0});
  const auto n = static_cast<std::uint32_t>(around);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t a = 2 * i, b = a + 1, c = 2 * ((i + 1) % n), d = c + 1;
    mesh.facets.insert(mesh.facets.end(), {Facet{a, b, c}, Facet{b, d, c}, Facet{a, c, 2 * n}, Facet{b, 2 * n + 1, d}});
  }
  return test::inverted(signed_volume(mesh) < 0 ? mesh : test::inverted(mesh));
}

// Every facet there twice, by the same vertices.
Mesh doubled(Mesh mesh) {
  const std::vector<Facet> facets = mesh.facets;
  mesh.facets.insert(mesh.facets.end(), facets.begin(), facets.end());
  return mesh;
}

// All in one plane, facing both ways.
Mesh flat_soup() {
  Mesh mesh = test::facet_soup(40, 5);
  for (Vec3& p : mesh.positions) p.z = 0.25;
  return mesh;
}

// All on one line: facets without area.
Mesh line_soup() {
  Mesh mesh = test::facet_soup(20, 6);
  for (Vec3& p : mesh.positions) p = Vec3{1, 2, -1} * p.x;
  return mesh;
}

struct Named {
  const char* name;
  Mesh mesh;
};
std::vector<Named> hard_meshes() {
  const Mesh limb = sample_body("limb", 6), ball = test::icosphere(2);
  return {{"cylinder", cylinder(16, 0.5, 2)},
          {"long thin cylinder", cylinder(8, 1e-4, 1)},
          {"torus inside out", test::inverted(sample_body("torus", 8))},
          {"all facets twice", doubled(ball)},
          {"both sides of all facets", test::joined(ball, test::inverted(ball))},
          {"tiny limb", test::scaled(limb, 1e-6)},
          {"huge limb", test::scaled(limb, 1e6)},
          {"limb far away", test::translated(limb, {1e5, -1e5, 1e5})},
          {"small ball far from a large one", test::joined(ball, test::icosphere(1, 1e-5, {50, 0, 0}))},
          {"facets in a plane", flat_soup()},
          {"facets in a line", line_soup()},
          {"soup", test::facet_soup(150, 9)}};
}

void expect_sound(const Mesh& mesh, const BuildOptions& options, const std::string& what) {
  const CoveredTree model = build(mesh, options);
  const auto faults = validate(mesh, model);
  EXPECT_TRUE(faults.empty()) << what << ": " << (faults.empty() ? "" : faults.front());
  EXPECT_TRUE(certify(model.cover, mesh.positions, model.tree.spheres).covered) << what;
  std::size_t most = 1;
  for (std::size_t level = 0; level < model.tree.level_count(); ++level, most *= 8)
    EXPECT_LE(model.tree.level_begin[level + 1] - model.tree.level_begin[level], most) << what;
  const Box box = bounding_box(mesh);
  for (const Sphere& s : model.tree.spheres) {
    ASSERT_TRUE(is_finite(s.center) && std::isfinite(s.radius) && s.radius >= 0) << what;
    ASSERT_LE(distance(s.center, box.center()), 4 * box.diagonal()) << what;
    ASSERT_LE(s.radius, 2 * box.diagonal()) << what;
  }
}

class RobustnessBy : public test::ByMethod {
 protected:
  static BuildOptions options() {
    const Method method = GetParam();
    return {.method = method, .depth = 2, .quality = method == Method::optimized ? Quality::fast : Quality::standard};
  }
};

TEST_P(RobustnessBy, covers_hard_meshes_with_few_finite_spheres) {
  BuildOptions few = options();
  if (few.method == Method::combined) few.depth = 1;
  for (const Named& named : hard_meshes())
    expect_sound(named.mesh, few, std::string(name(few.method)) + " on " + named.name);
}

TEST_P(RobustnessBy, size_and_place_hardly_change_the_tightness) {
  const Mesh mesh = sample_body("limb", 12);
  // The mean of three seeds: one alone says as much about the seed, with facets turned round as with another.
  const auto loose = [&](const Mesh& m) {
    double sum = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
      BuildOptions seeded = options();
      seeded.seed = seed;
      sum += looseness(m, level_set_spheres(build(m, seeded).tree, 2), {.resolution = 64}).looseness.value();
    }
    return sum / 3;
  };
  const double plain = loose(mesh);
  EXPECT_NEAR(loose(test::scaled(mesh, 1e-6)) / plain, 1, 0.2);
  EXPECT_NEAR(loose(test::scaled(mesh, 1e6)) / plain, 1, 0.2);
  EXPECT_NEAR(loose(test::translated(mesh, {1e5, -1e5, 1e5})) / plain, 1, 0.2);
  EXPECT_NEAR(loose(test::inverted(mesh)) / plain, 1, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Quick, RobustnessBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, RobustnessBy, testing::ValuesIn(test::slow_methods), test::method_name);

TEST(NightlyRobustness, method_morula_covers_hard_meshes_at_its_default_quality) {
  for (const Named& named : hard_meshes())
    expect_sound(named.mesh, {.method = Method::optimized, .depth = 1}, std::string("morula on ") + named.name);
  for (const char* mesh : {"needle", "flat_plate", "tiny"})
    expect_sound(test::mesh_named(mesh).mesh, {.method = Method::optimized, .depth = 2},
                 std::string("morula on ") + mesh);
}

TEST(Robustness, method_morula_covers_small_hard_meshes_at_its_default_quality) {
  for (const char* mesh : {"single_facet", "folded_facet"})
    expect_sound(test::mesh_named(mesh).mesh, {.method = Method::optimized, .depth = 2},
                 std::string("morula on ") + mesh);
}

}  // namespace
}  // namespace morula
