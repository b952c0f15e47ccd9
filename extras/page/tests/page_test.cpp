// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/page/collide_page.hpp>
#include <morula/page/page.hpp>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <utility>

namespace morula {
namespace {

PageContent small_page() {
  const Mesh mesh = sample_body("limb", 4);
  PageContent content{.title = "limb", .motions = {}, .scenes = {}, .study = {}};
  content.motions.push_back({"limb", "bend", mesh.facets, {"rest", "bent"}, {mesh.positions, {}}});
  content.motions[0].frames[1] = deform(mesh, {Bend{30}}, 1);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 1});
  content.scenes.push_back(follow_motion(content.motions[0], mesh, model, "octree", {Rule::approach2}, true));
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

TEST(Page, contact_patches_are_there_in_frames_that_have_them) {
  if (!has_page()) GTEST_SKIP() << why_no_page();
  const Mesh mesh = sample_body("limb", 8);
  const Body body(mesh, build(mesh, {.method = Method::octree, .depth = 1}));
  const Collider a(mesh, body);
  Collider b(mesh, body);
  b.set_transform(RigidTransform::from_quaternion(1, 0, 0, 0, {0, 0.1, 0}));
  CollidePage page("two limbs", {&a, &b}, "exact");
  page.add("without", std::vector<PageContact>());
  ContactPatchQuery query(a, b);
  CrossingQuery crossings;
  ASSERT_TRUE(query.run());
  ASSERT_TRUE(crossings.run(a, b));
  ASSERT_EQ(query.patches().size(), 1u);
  const ContactPatch& patch = query.patches()[0];
  page.add("with", query.patches(), crossings.pairs());
  page.add("without again", std::vector<PageContact>());
  const std::string empty = R"({"volumes":[],"depths":[],"facets":[],"curves":0})";
  const std::string full = R"("facets":[)" + std::to_string(patch.a.facets.size() + patch.b.facets.size()) +
                           R"(],"curves":)" + std::to_string(crossings.pairs().size()) + "}";
  const std::string text = page.text();
  const std::size_t first = text.find(R"("patches":[)" + empty), second = text.find(full),
                    third = text.find(empty, second);
  EXPECT_NE(first, std::string::npos);
  ASSERT_NE(second, std::string::npos);
  EXPECT_LT(first, second);
  EXPECT_NE(third, std::string::npos);

  PageContent wrong = small_page();
  wrong.scenes[0].patches.resize(wrong.scenes[0].frames.size());
  EXPECT_NO_THROW(make_page(wrong));
  const auto facets = static_cast<std::uint32_t>(wrong.motions[0].facets.size());
  wrong.scenes[0].patches[0].patches = {{.volume = 1, .depth = 1, .facets = {{facets, 1.0}}}};
  EXPECT_THROW(make_page(wrong), std::invalid_argument);
  wrong.scenes[0].patches.pop_back();
  EXPECT_THROW(make_page(wrong), std::invalid_argument);
}

TEST(Page, joints_that_hold_nothing_together_are_refused) {
  PageContent good = small_page();
  good.motions[0].frames.resize(1);
  good.motions[0].frame_names.resize(1);
  PageScene& scene = good.scenes[0];
  scene.frames.resize(1);
  scene.measured.clear();
  scene.empty_share.clear();
  scene.parts.assign(scene.rest.child_count[0], 1);
  const std::size_t vertices = good.motions[0].frames[0].size();
  PageJoints joints{.parts = {{.name = "a", .vertex_begin = 0, .vertex_end = 1}, {.name = "b"}, {.name = "c"}},
                    .joints = {}};
  joints.joints = {{.name = "j", .parent = 0, .child = 1}, {.name = "k", .parent = 1, .child = 2, .leader = 0}};
  joints.ignored = {{0, 1}};
  good.motions[0].joints = joints;
  if (!has_page()) {
    EXPECT_THROW(make_page(good), std::runtime_error) << why_no_page();
    return;
  }
  EXPECT_NE(make_page(good).find("\"leader\":0"), std::string::npos);
  const auto refuses = [&](auto change) {
    PageContent wrong = good;
    change(wrong);
    EXPECT_THROW(make_page(wrong), std::invalid_argument);
  };
  refuses([&](PageContent& c) { c.motions[0].joints->parts[2].vertex_end = vertices + 1; });
  refuses([](PageContent& c) { c.motions[0].joints->parts[0].vertex_begin = 2; });
  refuses([](PageContent& c) { c.motions[0].joints->joints[0].child = 3; });
  refuses([](PageContent& c) { c.motions[0].joints->joints[0].child = 0; });
  refuses([](PageContent& c) { c.motions[0].joints->joints[1].child = 1; });
  refuses([](PageContent& c) { std::swap(c.motions[0].joints->joints[0], c.motions[0].joints->joints[1]); });
  refuses([](PageContent& c) { c.motions[0].joints->joints[1].leader = 7; });
  refuses([](PageContent& c) { c.motions[0].joints->joints[1].leader = 1; });
  refuses([](PageContent& c) { c.motions[0].joints->ignored = {{1, 0}}; });
  refuses([](PageContent& c) { c.scenes[0].parts.pop_back(); });
  refuses([](PageContent& c) { c.scenes[0].parts[0] = 3; });
  refuses([](PageContent& c) { c.motions[0].joints.reset(); });
}

}  // namespace
}  // namespace morula
