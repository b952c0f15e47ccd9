// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches of the C interface: the patches of the C++ one, bit for bit.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <cstddef>
#include <limits>
#include <morula/collide/contact_patches.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <string>
#include <vector>

namespace morula {
namespace {

constexpr double identity_rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

morula_body* body_of(const char* sample) {
  morula_mesh* mesh = nullptr;
  morula_model* model = nullptr;
  morula_body* body = nullptr;
  morula_build_options options;
  morula_build_options_init(&options);
  options.method = "octree";
  EXPECT_EQ(morula_mesh_sample(sample, 12, &mesh), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_build(mesh, &options, &model), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_body_create(mesh, model, nullptr, &body), MORULA_OK) << morula_message();
  morula_mesh_destroy(mesh);
  morula_model_destroy(model);
  return body;
}

Vec3 vector(const double* values) {
  return {values[0], values[1], values[2]};
}

void expect_side(const morula_patch_side& got, const PatchSide& expected) {
  EXPECT_EQ(vector(got.area_vector), expected.area_vector);
  EXPECT_EQ(vector(got.moment), expected.moment);
  EXPECT_EQ(got.area, expected.area);
  ASSERT_EQ(got.gradient_count, expected.gradients.size());
  for (std::size_t g = 0; g < got.gradient_count; ++g) {
    EXPECT_EQ(got.gradients[g].vertex, expected.gradients[g].vertex);
    EXPECT_EQ(vector(got.gradients[g].gradient), expected.gradients[g].gradient);
  }
}

void expect_surface_point(std::uint32_t facet, const double* point, const double* barycentric,
                          const SurfacePoint& expected) {
  EXPECT_EQ(facet, expected.facet);
  EXPECT_EQ(vector(point), expected.point);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(barycentric[i], expected.barycentric[i]);
}

void expect_patch(const morula_patch& got, const ContactPatch& expected) {
  EXPECT_EQ(got.id, expected.id);
  EXPECT_EQ(got.volume, expected.volume);
  EXPECT_EQ(vector(got.centroid), expected.centroid);
  EXPECT_EQ(vector(got.normal), expected.normal);
  EXPECT_EQ(got.depth, expected.depth);
  EXPECT_EQ(got.mean_depth, expected.mean_depth);
  expect_side(got.a, expected.a);
  expect_side(got.b, expected.b);
  ASSERT_EQ(got.point_count, expected.points.size());
  for (std::size_t p = 0; p < got.point_count; ++p) {
    const morula_patch_point& point = got.points[p];
    EXPECT_EQ(point.id, expected.points[p].id);
    EXPECT_EQ(vector(point.point), expected.points[p].point);
    EXPECT_EQ(vector(point.force), expected.points[p].force);
    EXPECT_EQ(point.volume, expected.points[p].volume);
    EXPECT_EQ(point.depth, expected.points[p].depth);
    expect_surface_point(point.facet_a, point.point_a, point.barycentric_a, expected.points[p].on_a);
    expect_surface_point(point.facet_b, point.point_b, point.barycentric_b, expected.points[p].on_b);
  }
}

TEST(CInterface, patches_are_those_of_the_other_one) {
  morula_body *limb = body_of("limb"), *two = body_of("two");
  const Mesh limb_mesh = sample_body("limb", 12), two_mesh = sample_body("two", 12);
  const Body a(limb_mesh, build(limb_mesh, {.method = Method::octree}));
  const Body b(two_mesh, build(two_mesh, {.method = Method::octree}));
  Collider first(limb_mesh, a), second(two_mesh, b);
  ContactPatchQuery query(first, second);
  morula_patches* patches = nullptr;
  ASSERT_EQ(morula_patches_create(limb, two, &patches), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_patches_count(patches), 0u) << "before the first run";

  std::size_t seen = 0;
  for (const double height : {0.0, 0.11, 0.23, 9.0}) {
    const double translation[3] = {0.05, 0, height};
    second.set_transform(RigidTransform::from_quaternion(1, 0, 0, 0, {0.05, 0, height}));
    ASSERT_EQ(morula_body_set_transform(two, identity_rotation, translation), MORULA_OK);
    for (const int points : {4, 0}) {
      morula_patch_options options;
      morula_patch_options_init(&options);
      options.max_points = points, options.depths = points == 4;
      ASSERT_TRUE(query.run({.max_points = static_cast<std::uint32_t>(points), .depths = points == 4}));
      ASSERT_EQ(morula_patches_run(patches, points == 4 ? nullptr : &options), MORULA_OK) << morula_message();
      ASSERT_EQ(morula_patches_count(patches), query.patches().size());
      EXPECT_EQ(morula_patches_volume(patches), query.volume());
      EXPECT_EQ(morula_patches_certified(patches), 1);
      for (std::size_t i = 0; i < query.patches().size(); ++i)
        expect_patch(morula_patches_data(patches)[i], query.patches()[i]);
      seen += query.patches().size();
    }
  }
  EXPECT_GT(seen, 6u);
  EXPECT_EQ(morula_patches_count(patches), 0u) << "far apart";
  morula_patches_destroy(patches);
  morula_body_destroy(limb);
  morula_body_destroy(two);
}

TEST(CInterface, patches_keep_their_bodies_and_the_results_of_the_last_run) {
  morula_body *limb = body_of("limb"), *tool = body_of("tool");
  morula_patches* patches = nullptr;
  ASSERT_EQ(morula_patches_create(limb, tool, &patches), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_patches_run(patches, nullptr), MORULA_OK) << morula_message();
  const std::size_t count = morula_patches_count(patches);
  ASSERT_GT(count, 0u);
  const double volume = morula_patches_volume(patches);
  const double gradient = morula_patches_data(patches)[0].a.gradients[0].gradient[0];

  morula_patch_options options;
  morula_patch_options_init(&options);
  options.max_points = 17;
  EXPECT_EQ(morula_patches_run(patches, &options), MORULA_BAD_ARGUMENT);
  EXPECT_NE(std::string(morula_message()).find("17"), std::string::npos) << morula_message();
  std::vector<Vec3> positions = sample_body("limb", 12).positions;
  positions[3].y = std::numeric_limits<double>::infinity();
  EXPECT_EQ(morula_body_update_double(limb, &positions[0].x, positions.size(), 0), MORULA_REFUSED);
  EXPECT_EQ(morula_patches_run(patches, nullptr), MORULA_REFUSED);
  EXPECT_EQ(morula_patches_count(patches), count);
  EXPECT_EQ(morula_patches_volume(patches), volume);
  EXPECT_EQ(morula_patches_data(patches)[0].a.gradients[0].gradient[0], gradient);

  positions = sample_body("limb", 12).positions;
  ASSERT_EQ(morula_body_update_double(limb, &positions[0].x, positions.size(), 0), MORULA_OK);
  morula_body_destroy(limb);
  morula_body_destroy(tool);
  ASSERT_EQ(morula_patches_run(patches, nullptr), MORULA_OK) << morula_message();
  EXPECT_EQ(morula_patches_volume(patches), volume);
  morula_patches_destroy(patches);
}

TEST(CInterface, patches_refuse_open_surfaces_by_name) {
  morula_body* limb = body_of("limb");
  morula_mesh* open = nullptr;
  const std::uint32_t facet[3] = {0, 1, 2};
  ASSERT_EQ(morula_mesh_create(identity_rotation, 3, facet, 1, &open), MORULA_OK);
  morula_model* model = nullptr;
  morula_body* sheet = nullptr;
  ASSERT_EQ(morula_build(open, nullptr, &model), MORULA_OK) << morula_message();
  ASSERT_EQ(morula_body_create(open, model, nullptr, &sheet), MORULA_OK) << morula_message();
  morula_patches* patches = nullptr;
  EXPECT_EQ(morula_patches_create(limb, sheet, &patches), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(patches, nullptr);
  EXPECT_NE(std::string(morula_message()).find("not closed"), std::string::npos) << morula_message();
  EXPECT_EQ(morula_patches_create(limb, nullptr, &patches), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_patches_run(nullptr, nullptr), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_patches_count(nullptr), 0u);
  EXPECT_EQ(morula_patches_data(nullptr), nullptr);
  morula_patches_destroy(nullptr);
  morula_body_destroy(sheet);
  morula_model_destroy(model);
  morula_mesh_destroy(open);
  morula_body_destroy(limb);
}

}  // namespace
}  // namespace morula
