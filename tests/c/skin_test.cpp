// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins of the C interface: the positions, spheres and bounds of the C++ one, bit for bit.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <cstddef>
#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <morula/update/sample_motions.hpp>
#include <morula/update/skin_bounds.hpp>
#include <string>
#include <vector>

namespace morula {
namespace {

struct SkinnedLimb {
  Mesh mesh = sample_body("limb", 12);
  Skin skin = sample_skin(mesh.positions);
  std::vector<AffineTransform> frames = sample_bones(mesh.positions, 5);
  std::size_t bones = skin.bone_count;

  std::span<const AffineTransform> frame(std::size_t i) const { return std::span(frames).subspan(i * bones, bones); }
};

std::vector<double> rows_of(std::span<const AffineTransform> transforms) {
  std::vector<double> rows;
  for (const AffineTransform& t : transforms)
    for (std::size_t r = 0; r < 3; ++r)
      rows.insert(rows.end(), {t.columns[0][r], t.columns[1][r], t.columns[2][r], t.translation[r]});
  return rows;
}

// Three influences a vertex, as engines have them: those that are not used have weight 0 and no valid bone.
morula_skin* c_skin_of(const Skin& skin) {
  const std::size_t influences = 3;
  std::vector<std::uint32_t> bones;
  std::vector<double> weights;
  for (std::size_t v = 0; v < skin.vertex_count(); ++v) {
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
      bones.push_back(skin.bones[k]), weights.push_back(skin.weights[k]);
    EXPECT_LE(bones.size(), influences * (v + 1));
    bones.resize(influences * (v + 1), 999), weights.resize(influences * (v + 1));
  }
  morula_skin* made = nullptr;
  EXPECT_EQ(morula_skin_create(skin.vertex_count(), influences, bones.data(), weights.data(), skin.bone_count, &made),
            MORULA_OK)
      << morula_message();
  return made;
}

morula_mesh* c_mesh_of(const Mesh& mesh) {
  morula_mesh* made = nullptr;
  EXPECT_EQ(
      morula_mesh_create(&mesh.positions[0].x, mesh.positions.size(), &mesh.facets[0][0], mesh.facets.size(), &made),
      MORULA_OK);
  return made;
}

morula_body* c_body_of(const morula_mesh* mesh, const morula_skin* skin, const char* rules) {
  morula_model* model = nullptr;
  morula_build_options build;
  morula_build_options_init(&build);
  build.method = "octree";
  EXPECT_EQ(morula_build(mesh, &build, &model), MORULA_OK) << morula_message();
  morula_body_options options;
  morula_body_options_init(&options);
  options.rules = rules;
  options.skin = skin;
  morula_body* body = nullptr;
  EXPECT_EQ(morula_body_create(mesh, model, &options, &body), MORULA_OK) << morula_message();
  morula_model_destroy(model);
  return body;
}

TEST(CSkin, bodies_follow_bones_like_those_of_the_library) {
  const SkinnedLimb limb;
  morula_mesh* mesh = c_mesh_of(limb.mesh);
  morula_skin* skin = c_skin_of(limb.skin);
  EXPECT_EQ(morula_skin_bone_count(skin), limb.bones);
  const CoveredTree model = build(limb.mesh, {.method = Method::octree});
  for (const char* rules : {"skinned", "exact", "exact,skinned"}) {
    morula_body* body = c_body_of(mesh, skin, rules);
    ASSERT_NE(body, nullptr);
    std::vector<Rule> names{Rule::skinned};
    if (std::string(rules) == "exact") names = {Rule::exact};
    if (std::string(rules) == "exact,skinned") names = {Rule::exact, Rule::skinned};
    Body expected(limb.mesh, model, {.rules = names, .skin = limb.skin});
    for (std::size_t f = 0; f < 5; ++f) {
      const std::vector<double> rows = rows_of(limb.frame(f));
      ASSERT_EQ(morula_body_update_skinned(body, rows.data(), limb.bones), MORULA_OK) << morula_message();
      ASSERT_TRUE(expected.update_skinned(limb.frame(f)));
      std::vector<morula_sphere> spheres(morula_body_node_count(body));
      ASSERT_EQ(morula_body_spheres(body, spheres.data()), MORULA_OK);
      ASSERT_EQ(spheres.size(), expected.spheres().size());
      for (std::uint32_t n = 0; n < spheres.size(); ++n) {
        const Sphere s = expected.sphere(n);
        EXPECT_TRUE(spheres[n].x == s.center.x && spheres[n].y == s.center.y && spheres[n].z == s.center.z &&
                    spheres[n].radius == s.radius)
            << rules << " " << n;
      }
      std::vector<double> positions(3 * limb.mesh.vertex_count());
      ASSERT_EQ(morula_skin_positions(skin, mesh, rows.data(), limb.bones, positions.data()), MORULA_OK);
      std::vector<Vec3> moved(limb.mesh.vertex_count());
      move_by_skin(limb.skin, limb.mesh.positions, limb.frame(f), moved);
      for (std::size_t v = 0; v < moved.size(); ++v)
        EXPECT_EQ(moved[v], Vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]));
      int covered = 0;
      ASSERT_EQ(morula_body_certify(body, positions.data(), moved.size(), &covered), MORULA_OK);
      EXPECT_EQ(covered, 1);
    }
    // The body has a copy of the skin, and queries compute the vertices that they read.
    int overlaps = 0;
    EXPECT_EQ(morula_overlap(body, body, &overlaps), MORULA_OK);
    EXPECT_EQ(overlaps, 1);
    morula_body_destroy(body);
  }
  morula_skin_destroy(skin);
  morula_mesh_destroy(mesh);
}

TEST(CSkin, bounds_of_clusters_are_those_of_the_library) {
  const SkinnedLimb limb;
  morula_mesh* mesh = c_mesh_of(limb.mesh);
  morula_skin* skin = c_skin_of(limb.skin);
  std::vector<std::uint32_t> clusters;
  for (std::uint32_t f = 0; f < limb.mesh.facets.size(); ++f) clusters.push_back(f / 40);
  morula_skin_bounds* bounds = nullptr;
  ASSERT_EQ(morula_skin_bounds_create(mesh, skin, clusters.data(), &bounds), MORULA_OK) << morula_message();
  morula_skin_destroy(skin);
  morula_mesh_destroy(mesh);
  SkinBounds expected(limb.mesh, limb.skin, clusters);
  const std::size_t count = morula_skin_bounds_cluster_count(bounds);
  ASSERT_EQ(count, expected.cluster_count());
  const std::vector<double> rows = rows_of(limb.frames);
  std::vector<morula_spheref> spheres(5 * count);
  std::vector<morula_boxf> boxes(5 * count);
  ASSERT_EQ(morula_skin_bounds_compute(bounds, rows.data(), 5, spheres.data(), boxes.data()), MORULA_OK);
  std::vector<Spheref> of_library(5 * count);
  std::vector<Boxf> boxes_of_library(5 * count);
  ASSERT_TRUE(expected.bounds(limb.frames, {.spheres = of_library, .boxes = boxes_of_library}));
  for (std::size_t k = 0; k < 5 * count; ++k) {
    EXPECT_EQ(of_library[k], (Spheref{{spheres[k].x, spheres[k].y, spheres[k].z}, spheres[k].radius})) << k;
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(boxes[k].lower[i], boxes_of_library[k].lower[i]) << k;
      EXPECT_EQ(boxes[k].upper[i], boxes_of_library[k].upper[i]) << k;
    }
  }
  EXPECT_EQ(morula_skin_bounds_compute(bounds, rows.data(), 0, spheres.data(), nullptr), MORULA_OK);
  std::vector<double> bad = rows;
  bad[7] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(morula_skin_bounds_compute(bounds, bad.data(), 5, spheres.data(), nullptr), MORULA_REFUSED);
  // Times the number of bones, this count would wrap around.
  const std::size_t huge = std::numeric_limits<std::size_t>::max() / limb.bones + 2;
  EXPECT_EQ(morula_skin_bounds_compute(bounds, rows.data(), huge, nullptr, nullptr), MORULA_OUT_OF_MEMORY);
  morula_skin_bounds_destroy(bounds);
}

TEST(CSkin, morphed_bounds_are_those_of_the_library) {
  const SkinnedLimb limb;
  const Modes targets = sample_modes(limb.mesh.positions, 3);
  morula_mesh* mesh = c_mesh_of(limb.mesh);
  morula_skin* skin = c_skin_of(limb.skin);
  morula_skin_bounds* bounds = nullptr;
  ASSERT_EQ(morula_skin_bounds_create_morphed(mesh, skin, 3, &targets.displacements[0].x, nullptr, &bounds), MORULA_OK)
      << morula_message();
  const std::vector<std::uint32_t> one_cluster(limb.mesh.facets.size());
  SkinBounds expected(limb.mesh, limb.skin, targets, one_cluster);
  const std::vector<double> rows = rows_of(limb.frames);
  std::vector<double> morphs;
  for (int k = 0; k < 15; ++k) morphs.push_back(0.3 * k - 2);
  std::vector<morula_spheref> spheres(5);
  std::vector<Spheref> of_library(5);
  for (const bool has_morphs : {true, false}) {
    ASSERT_EQ(morula_skin_bounds_compute_morphed(bounds, rows.data(), has_morphs ? morphs.data() : nullptr, 5,
                                                 spheres.data(), nullptr),
              MORULA_OK);
    ASSERT_TRUE(expected.bounds(limb.frames, has_morphs ? std::span<const double>(morphs) : std::span<const double>(),
                                {.spheres = of_library}));
    for (std::size_t k = 0; k < 5; ++k)
      EXPECT_EQ(of_library[k], (Spheref{{spheres[k].x, spheres[k].y, spheres[k].z}, spheres[k].radius})) << k;
  }
  morphs[7] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(morula_skin_bounds_compute_morphed(bounds, rows.data(), morphs.data(), 5, spheres.data(), nullptr),
            MORULA_REFUSED);
  morula_skin_bounds_destroy(bounds);
  EXPECT_EQ(morula_skin_bounds_create_morphed(mesh, skin, 3, nullptr, nullptr, &bounds), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(bounds, nullptr);
  morula_skin_destroy(skin);
  morula_mesh_destroy(mesh);
}

TEST(CSkin, bad_calls_are_refused_and_change_nothing) {
  const SkinnedLimb limb;
  morula_mesh* mesh = c_mesh_of(limb.mesh);
  morula_skin* skin = c_skin_of(limb.skin);
  morula_body* body = c_body_of(mesh, skin, "skinned");
  const std::vector<double> rows = rows_of(limb.frame(4));
  ASSERT_EQ(morula_body_update_skinned(body, rows.data(), limb.bones), MORULA_OK);
  std::vector<morula_sphere> before(morula_body_node_count(body)), after(before.size());
  ASSERT_EQ(morula_body_spheres(body, before.data()), MORULA_OK);
  std::vector<double> bad = rows;
  bad[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(morula_body_update_skinned(body, bad.data(), limb.bones), MORULA_REFUSED);
  EXPECT_EQ(morula_body_update_skinned(body, rows.data(), limb.bones + 1), MORULA_REFUSED);
  EXPECT_EQ(morula_body_update_skinned(body, nullptr, limb.bones), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_body_update_double(body, &limb.mesh.positions[0].x, limb.mesh.vertex_count(), 0), MORULA_REFUSED);
  ASSERT_EQ(morula_body_spheres(body, after.data()), MORULA_OK);
  for (std::size_t n = 0; n < before.size(); ++n) EXPECT_EQ(before[n].radius, after[n].radius);
  morula_body_destroy(body);

  morula_body* without = nullptr;
  morula_model* model = nullptr;
  ASSERT_EQ(morula_build(mesh, nullptr, &model), MORULA_OK);
  morula_body_options options;
  morula_body_options_init(&options);
  options.rules = "skinned";
  EXPECT_EQ(morula_body_create(mesh, model, &options, &without), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(without, nullptr);
  ASSERT_EQ(morula_body_create(mesh, model, nullptr, &without), MORULA_OK);
  EXPECT_EQ(morula_body_update_skinned(without, rows.data(), limb.bones), MORULA_BAD_ARGUMENT);
  EXPECT_STREQ(morula_message(), "the body has no skin");
  morula_body_destroy(without);
  morula_model_destroy(model);

  morula_skin* none = skin;
  const std::uint32_t bone = 7;
  const double weight = 1;
  EXPECT_EQ(morula_skin_create(1, 1, &bone, &weight, 7, &none), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(none, nullptr);
  EXPECT_EQ(morula_skin_read("no such file.glb", mesh, &none), MORULA_BAD_FILE);
  const double halves[2] = {0.25, 0.25};
  const std::uint32_t two[2] = {0, 1};
  ASSERT_EQ(morula_skin_create(1, 2, two, halves, 2, &none), MORULA_OK);
  EXPECT_EQ(morula_skin_positions(none, mesh, rows.data(), 2, bad.data()), MORULA_BAD_ARGUMENT);
  morula_skin_destroy(none);
  morula_skin_destroy(skin);
  morula_mesh_destroy(mesh);
}

}  // namespace
}  // namespace morula
