// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The cover of trees made elsewhere, and the validator that everything else is held against.
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/generators/build.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/tree/cover.hpp>
#include <support/meshes.hpp>

namespace morula {
namespace {

// A root and `count` small random spheres near the surface: leaves much of the surface bare.
SphereTree careless_tree(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  const double diagonal = bounding_box(mesh).diagonal();
  Random random(seed);
  SphereTree tree;
  tree.branching = 64;
  tree.append_level({}, std::vector<Sphere>{{bounding_box(mesh).center(), 0.3 * diagonal}});
  std::vector<Sphere> spheres;
  for (const SurfacePoint& s : sample_surface(mesh, count, seed))
    spheres.push_back({s.point, random.uniform(0.01, 0.15) * diagonal});
  tree.append_level(std::vector<std::uint32_t>{static_cast<std::uint32_t>(spheres.size())}, spheres);
  return tree;
}

// The union of the leaves contains every sample, in plain arithmetic.
void expect_samples_inside(const Mesh& mesh, const CoveredTree& model, const std::string& name) {
  for (std::size_t level = 0; level < model.tree.level_count(); ++level) {
    const std::vector<Sphere> spheres = level_set_spheres(model.tree, level);
    for (const SurfacePoint& s : sample_surface(mesh, 2000, 9)) {
      const bool inside = std::any_of(spheres.begin(), spheres.end(), [&](const Sphere& b) {
        return distance(b.center, s.point) <= b.radius * (1 + 1e-12);
      });
      ASSERT_TRUE(inside) << name << " level " << level;
    }
  }
}

TEST(Cover, repairs_a_careless_tree_on_every_kind_of_mesh) {
  for (const test::NamedMesh& named : test::all_meshes()) {
    const SphereTree tree = careless_tree(named.mesh, 40, 3);
    if (tree.node_count() == 1) continue;  // no area to put spheres on
    const CoveredTree model = cover(named.mesh, tree);
    const auto faults = validate(named.mesh, model);
    EXPECT_TRUE(faults.empty()) << named.name << ": " << (faults.empty() ? "" : faults.front());
    expect_samples_inside(named.mesh, model, named.name);
    EXPECT_EQ(model.report.dropped_spheres, tree.node_count() - model.tree.node_count());
  }
}

TEST(Cover, leaves_a_tree_that_covers_as_it_is_bit_for_bit) {
  const Mesh mesh = sample_body("blob", 24);
  SphereTree tree;
  tree.branching = 8;
  const Box box = bounding_box(mesh);
  tree.append_level({}, std::vector<Sphere>{{box.center(), box.diagonal()}});
  std::vector<Sphere> octants;
  for (int i = 0; i < 8; ++i) {
    const Vec3 step{i & 1 ? 0.25 : -0.25, i & 2 ? 0.25 : -0.25, i & 4 ? 0.25 : -0.25};
    octants.push_back({box.center() + Vec3{step.x * box.extent().x, step.y * box.extent().y, step.z * box.extent().z},
                       0.26 * box.diagonal()});
  }
  tree.append_level(std::vector<std::uint32_t>{8}, octants);
  const CoveredTree model = cover(mesh, tree);
  EXPECT_EQ(model.tree.spheres, tree.spheres);
  for (const LevelGrowth& g : model.report.growth) EXPECT_EQ(g.grown, 0u);
  EXPECT_EQ(model.report.leftover_patches, 0u);
}

TEST(Cover, reports_what_had_to_grow) {
  const Mesh mesh = test::icosphere(3);
  SphereTree tree;
  tree.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 0.5}});
  const CoveredTree model = cover(mesh, tree);
  ASSERT_EQ(model.report.growth.size(), 1u);
  EXPECT_EQ(model.report.growth[0].grown, 1u);
  EXPECT_NEAR(model.report.growth[0].largest_growth, 0.5, 1e-12);
  EXPECT_NEAR(model.report.growth[0].largest_factor, 2.0, 1e-12);
  EXPECT_EQ(model.report.method, "imported");
  EXPECT_EQ(model.report.mesh_hash, mesh_hash(mesh));
}

TEST(Cover, hands_gap_pieces_to_the_sphere_that_grows_least_not_to_the_one_of_least_power) {
  // A plate of 0…1 × 0…0.01 between a large sphere on the left, which reaches x = 0.8, and a minute one at x = 1.
  // The gap around x = 0.9 has the least power for the minute sphere, which would grow twenty-fold.
  Mesh strip;
  constexpr int n = 100;
  for (int i = 0; i <= n; ++i) {
    strip.positions.push_back({1.0 * i / n, 0, 0});
    strip.positions.push_back({1.0 * i / n, 0.01, 0});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    strip.facets.push_back({2 * i, 2 * i + 2, 2 * i + 3});
    strip.facets.push_back({2 * i, 2 * i + 3, 2 * i + 1});
  }
  SphereTree tree;
  tree.branching = 2;
  const Sphere large{{-4.2, 0, 0}, 5}, minute{{1, 0.005, 0}, 0.006};
  tree.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 2}});
  tree.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>{large, minute});
  const Vec3 gap{0.93, 0.005, 0};
  ASSERT_LT(power(minute, gap), power(large, gap));
  const CoveredTree model = cover(strip, tree);
  EXPECT_TRUE(validate(strip, model).empty());
  EXPECT_LT(model.tree.spheres[1].radius / large.radius, 1.05);
  // Half of the gap is 0.1 wide, a sphere about it 8.4 times as large; about all of it 16.4 times.
  EXPECT_LT(model.tree.spheres[2].radius / minute.radius, 10);
}

TEST(Cover, drops_spheres_that_own_nothing) {
  const Mesh mesh = test::icosphere(2);
  SphereTree tree;
  tree.branching = 3;
  tree.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 2}});
  tree.append_level(std::vector<std::uint32_t>{3},
                    std::vector<Sphere>{{{0, 0, 0}, 1.1}, {{0, 0, 0}, 0.1}, {{90, 0, 0}, 1}});
  tree.append_level(std::vector<std::uint32_t>{0, 0, 1}, std::vector<Sphere>{{{90, 0, 0}, 0.5}});
  const CoveredTree model = cover(mesh, tree);
  EXPECT_EQ(model.tree.node_count(), 2u);
  EXPECT_EQ(model.report.dropped_spheres, 3u);
  EXPECT_TRUE(validate(mesh, model).empty());
}

TEST(Cover, has_the_same_bits_for_any_number_of_workers) {
  const Mesh mesh = sample_body("limb", 24);
  const SphereTree tree = careless_tree(mesh, 60, 5);
  const CoveredTree reference = cover(mesh, tree);
  for (const unsigned threads : {2u, 3u, 8u}) {
    Workers workers(threads);
    const CoveredTree model = cover(mesh, tree, {}, workers);
    EXPECT_EQ(tree_hash(model.tree), tree_hash(reference.tree));
    EXPECT_EQ(model.cover.corners, reference.cover.corners);
    EXPECT_EQ(model.cover.cut_points, reference.cover.cut_points);
    EXPECT_EQ(model.cover.region_end, reference.cover.region_end);
  }
}

TEST(Cover, refuses_a_broken_tree_and_an_unusable_mesh) {
  SphereTree broken;
  broken.append_level({}, std::vector<Sphere>{{{0, 0, 0}, NAN}});
  EXPECT_THROW(cover(test::icosphere(1), broken), std::invalid_argument);
  SphereTree fine;
  fine.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 1}});
  EXPECT_THROW(cover(Mesh{}, fine), std::invalid_argument);
}

class CoverOfABlob : public ::testing::Test {
 protected:
  const Mesh mesh = sample_body("blob", 16);
  const CoveredTree good = build(mesh, {.method = Method::octree, .depth = 2});

  template <class Spoil>
  std::string faults_after(Spoil spoil) const {
    CoveredTree model = good;
    spoil(model);
    std::string all;
    for (const std::string& f : validate(mesh, model)) all += f + "\n";
    return all;
  }
  static bool mentions(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }
};

TEST_F(CoverOfABlob, is_valid_as_built) {
  EXPECT_EQ(faults_after([](CoveredTree&) {}), "");
}

TEST_F(CoverOfABlob, validate_notices_a_radius_too_small_by_a_hair) {
  EXPECT_TRUE(
      mentions(faults_after([](CoveredTree& b) { b.tree.spheres[3].radius *= 1 - 1e-9; }), "node 3 does not wrap"));
}

TEST_F(CoverOfABlob, validate_notices_a_missing_patch) {
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) {
                         // Give the first patch's facet to another: its own is now short, the other one too full.
                         b.cover.patch_facet[0] = b.cover.patch_facet[40];
                       }),
                       "off its facet"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) {
                         Cover& c = b.cover;
                         c.corners[1] = c.corners[0];  // the first patch loses its area
                       }),
                       "instead of the whole"));
}

TEST_F(CoverOfABlob, validate_notices_regions_that_are_not_their_childrens) {
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.region_end[1] -= 1; }), "children"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.region_begin[0] = 1; }), "whole surface"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.region_begin[9] = b.cover.region_end[9]; }),
                       "owns no patches"));
}

TEST_F(CoverOfABlob, validate_notices_wrong_sizes_and_indices) {
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.vertex_count += 1; }), "number of vertices"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.corners[5] = 0xfffffff; }), "neither a vertex"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.patch_facet[5] = 0xfffffff; }), "lies on facet"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.cut_points[0].weight[0] += 0.1; }), "cut point"));
  EXPECT_TRUE(mentions(faults_after([](CoveredTree& b) { b.cover.region_end.pop_back(); }), "number of nodes"));
}

TEST_F(CoverOfABlob, certify_measures_how_far_out_the_worst_corner_is) {
  std::vector<Sphere> spheres = good.tree.spheres;
  EXPECT_TRUE(certify(good.cover, mesh.positions, spheres).covered);
  spheres[5].radius -= 0.01;
  const Certificate bare = certify(good.cover, mesh.positions, spheres);
  EXPECT_FALSE(bare.covered);
  EXPECT_EQ(bare.worst_node, 5u);
  EXPECT_NEAR(bare.worst_excess, 0.01, 1e-9);
  spheres[5].radius = NAN;
  EXPECT_FALSE(certify(good.cover, mesh.positions, spheres).covered);
  EXPECT_THROW(static_cast<void>(certify(good.cover, std::vector<Vec3>(3), spheres)), std::invalid_argument);
}

}  // namespace
}  // namespace morula
