// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/page/page.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>

namespace morula {
namespace {

PageContent small_page() {
  const Mesh mesh = sample_body("limb", 4);
  PageContent content{.title = "limb", .motions = {}, .scenes = {}, .study = {}};
  content.motions.push_back({"limb", "bend", mesh.facets, {"rest", "bent"}, {mesh.positions, {}}});
  content.motions[0].frames[1] = deform(mesh, {Bend{30}}, 1);
  const CoveredTree built = build(mesh, {.method = Method::octree, .depth = 1});
  content.scenes.push_back(follow_motion(content.motions[0], mesh, built, "octree", {Rule::approach2}, true));
  return content;
}

TEST(Page, a_scene_has_the_spheres_that_a_body_has) {
  const PageContent content = small_page();
  const PageScene& scene = content.scenes[0];
  const Mesh mesh = sample_body("limb", 4);
  Body body(mesh, build(mesh, {.method = Method::octree, .depth = 1}), {.rules = {Rule::approach2}});
  ASSERT_TRUE(body.update(content.motions[0].frames[1]));
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  ASSERT_EQ(scene.frames.size(), 2u);
  EXPECT_TRUE(scene.frames[1] == spheres);
  EXPECT_EQ(scene.rule, "approach2");
  ASSERT_EQ(scene.measured.size(), 2u);
  EXPECT_EQ(scene.measured[1].size(), 2u);
  ASSERT_EQ(scene.empty_share.size(), 2u);
  for (const float share : scene.empty_share[1]) EXPECT_TRUE(share >= 0 && share <= 1) << share;
}

TEST(Page, a_frame_that_cannot_be_followed_is_named) {
  PageContent content = small_page();
  content.motions[0].frames[1][0].x = 1e40;
  const Mesh mesh = sample_body("limb", 4);
  try {
    follow_motion(content.motions[0], mesh, build(mesh, {.method = Method::octree, .depth = 1}), "octree",
                  {Rule::exact}, false);
    FAIL() << "it was followed";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("bent"), std::string::npos) << error.what();
  }
}

TEST(Page, is_made_or_says_why_not) {
  const PageContent content = small_page();
  EXPECT_EQ(has_page(), why_no_page().empty());
  if (!has_page()) {
    EXPECT_THROW(make_page(content), std::runtime_error);
    return;
  }
  const std::string page = make_page(content);
  EXPECT_NE(page.find("morula-scene-0"), std::string::npos);
  EXPECT_EQ(page, make_page(content));
  PageContent wrong = content;
  wrong.study = "[]";
  EXPECT_THROW(make_page(wrong), std::invalid_argument);
  wrong = content;
  wrong.scenes[0].frames.pop_back();
  EXPECT_THROW(make_page(wrong), std::invalid_argument);
}

}  // namespace
}  // namespace morula
