// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// SDF: small robots whose poses are worked out by hand, and files that are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <morula/robot/robot.hpp>
#include <numbers>

#include "formats.hpp"

namespace morula::test {
namespace {

TEST_F(Formats, sdf_poses_are_resolved_through_frames_and_joints) {
  const double right = std::numbers::pi / 2;
  const std::string links =
      "<link name='a'><pose>5 0 0 0 0 0</pose></link><link name='b'><pose relative_to='f'>0 0 1 0 0 0</pose></link>"
      "<frame name='f' attached_to='a'><pose degrees='true'>1 0 0 0 0 90</pose></frame>";
  const auto joint = [](const std::string& more) {
    return "<joint name='j' type='revolute'><parent>a</parent><child>b</child>" + more + "</joint>";
  };
  const robot::Robot plain = sdf(links + joint("<axis><xyz>1 0 0</xyz></axis>"));
  EXPECT_EQ(plain.joints[0].kind, robot::Joint::Kind::continuous) << "without limits";
  expect_near(origin_of(plain, "b", {0}), {1, 0, 1}, "in the axes of a");
  expect_near(point_of(plain, "b", {right}, {0, 1, 0}), {1, 0, 2}, "x of b is y of a");
  const robot::Robot model = sdf(links + joint("<axis><xyz expressed_in='__model__'>1 0 0</xyz></axis>"));
  expect_near(model.joints[0].axis, {0, -1, 0}, "in the axes of b");
  EXPECT_EQ(sdf(links + joint("<axis><xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>"), "1.6")
                .joints[0]
                .axis,
            model.joints[0].axis);
  EXPECT_EQ(sdf(links + joint("<axis><xyz>1 0 0</xyz></axis>"), "1.4").joints[0].axis, model.joints[0].axis)
      << "older files mean the model";
  EXPECT_EQ(sdf(links + joint("<axis><xyz>1 0 0</xyz></axis>"), "1.10").joints[0].axis, (Vec3{1, 0, 0}))
      << "1.10 is newer";
  // The axis passes 1 beside b's origin, along b's y.
  const robot::Robot beside = sdf(links + joint("<pose>0 1 0 0 0 0</pose><axis><xyz>0 0 1</xyz></axis>"));
  expect_near(origin_of(beside, "b", {0}), {1, 0, 1}, "at rest");
  expect_near(origin_of(beside, "b", {2 * right}), {-1, 0, 1}, "b's y is minus x of a");
  EXPECT_EQ(beside.links.size(), 3u);
  const robot::Robot cross =
      sdf("<link name='a'/><link name='b'/><joint name='u' type='universal'><parent>a</parent><child>b</child>"
          "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>");
  expect_near(point_of(cross, "b", {right, right}, {1, 0, 0}), {0, 1, 0}, "the first turns the second");
  const robot::Robot fixed = sdf(links + joint("<axis><xyz>1 0 0</xyz></axis>") +
                                 "<joint name='w' type='fixed'><parent>world</parent><child>a</child></joint>");
  EXPECT_EQ(fixed.links[fixed.root].name, "world");
  expect_near(origin_of(fixed, "b", {0}), {6, 0, 1}, "in the world");
}

TEST_F(Formats, sdf_parts_of_scenes_are_those_of_nodes_or_geometries) {
  const std::string folder_of_meshes = arm + "meshes";
  const Mesh all = robot::read_collada(arm + "meshes/wrist.dae");
  const Mesh part = robot::read_collada(arm + "meshes/wrist.dae", "tetra");
  EXPECT_EQ(all.positions, part.positions) << "both nodes show this geometry";
  EXPECT_NE(words_of([] { robot::read_collada(arm + "meshes/wrist.dae", "other"); }).find("no node or geometry other"),
            std::string::npos);
  write("a/m/t.obj", tetrahedron);
  const auto mesh = [&](const std::string& uri, const std::string& name) {
    return "<link name='a'><collision name='c'><geometry><mesh><uri>" + uri + "</uri><submesh><name>" + name +
           "</name><center>true</center></submesh></mesh></geometry></collision></link>";
  };
  std::ifstream stream(arm + "meshes/wrist.dae");
  write("a/m/w.dae", {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()});
  const robot::Robot r = sdf(mesh("../m/w.dae", "tetra"));
  Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
  for (const Vec3& p : robot::surface_of(r.file, r.links[0].collision).mesh.positions) {
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
  }
  expect_near(low + high, {}, "centered");
  const std::string words = words_of([&] {
    const robot::Robot other = sdf(mesh("../m/t.obj", "x"));
    robot::surface_of(other.file, other.links[0].collision);
  });
  EXPECT_NE(words.find("only submeshes of COLLADA files are read"), std::string::npos) << words;
}

TEST_F(Formats, sdf_that_is_broken_or_not_supported_is_refused_by_name) {
  const std::string two = "<link name='a'/><link name='b'/>";
  const auto joint = [](const std::string& type, const std::string& more = "", const std::string& child = "b") {
    return "<joint name='j' type='" + type + "'><parent>a</parent><child>" + child + "</child>" + more + "</joint>";
  };
  const auto shape = [](const std::string& geometry) {
    return "<link name='a'><collision name='c'><geometry>" + geometry + "</geometry></collision></link>";
  };
  const std::string axis = "<axis><xyz>0 0 1</xyz></axis>";
  const std::vector<std::array<std::string, 2>> cases{
      {"", "there is no link"},
      {"<link/>", "<link> has no name"},
      {"<link name='world'><pose>1 0 0 0 0 0</pose></link>", "no name that may be given"},
      {"<link name='a'/><link name='a'/>", "two links a"},
      {"<link name='a'/><frame name='a'/>", "both called a"},
      {two, "both carried by no joint"},
      {"<include><uri>model://x</uri></include>", "<include> in a model is not supported"},
      {"<link name='a'/><model name='m'/>", "<model> in a model is not supported"},
      {two + joint("screw", axis), "is screw, which is not supported"},
      {two + joint("gearbox", axis), "is gearbox"},
      {two + joint("revolute"), "has no <axis>"},
      {two + joint("universal", axis), "has no <axis2>"},
      {two + joint("revolute", "<axis><xyz>0 0 0</xyz></axis>"), "an axis of length 0"},
      {two + joint("revolute", "<axis><xyz>0 0 nan</xyz></axis>"), "not 3 numbers"},
      {two + joint("revolute", "<axis><limit><lower>1</lower><upper>0</upper></limit></axis>"), "above its upper"},
      {two + joint("fixed", "", "c"), "there is no frame c"},
      {two + joint("fixed", "", "m::c"), "models in models"},
      {two + joint("fixed", "", "a"), "joins link a to itself"},
      {two + joint("fixed", "<pose relative_to='j'/>"), "relative to itself"},
      {two + "<link name='c'/>" + joint("fixed") +
           "<joint name='k' type='fixed'><parent>c</parent><child>b</child></joint>",
       "carried by two joints, j and k"},
      {"<link name='a'><pose relative_to='b'/></link><link name='b'><pose relative_to='a'/></link>",
       "relative to itself"},
      {"<link name='a'><pose relative_to='x'/></link>", "there is no frame x"},
      {"<link name='a'/><frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>", "relative to itself"},
      {"<link name='a'><pose>1 2 3</pose></link>", "is not 6 numbers"},
      {"<link name='a'><pose rotation_format='quat_xyzw'>0 0 0 0 0 0 0</pose></link>", "a quaternion is 0"},
      {"<link name='a'><pose rotation_format='matrix'>0</pose></link>", "neither euler_rpy nor quat_xyzw"},
      {shape(""), "has no geometry"},
      {shape("<heightmap/>"), "<heightmap> is no geometry"},
      {shape("<heightmap/>"), "<heightmap> is no geometry"},
      {shape("<polyline/>"), "<polyline> is no geometry"},
      {shape("<sphere><radius>-1</radius></sphere>"), "which is below 0"},
      {shape("<sphere/>"), "<sphere> has no <radius>"},
      {shape("<box><size>1 1</size></box>"), "is not 3 numbers"},
      {shape("<ellipsoid><radii>1 -1 1</radii></ellipsoid>"), "a radius below 0"},
      {shape("<mesh/>"), "<mesh> has no <uri>"},
      {shape("<mesh><uri> </uri></mesh>"), "<uri>"},
      {shape("<mesh><uri>no.stl</uri></mesh>"), "is missing; searched"},
      {shape("<mesh><uri>model://m/../../../../etc/passwd</uri></mesh>"), "leaves its package"},
      {shape("<mesh><uri>https://host/x.stl</uri></mesh>"), "is not on this disk"},
  };
  for (const auto& [body, words] : cases) {
    const std::string text = words_of([&, &body = body] { sdf(body); });
    EXPECT_NE(text.find(words), std::string::npos) << body << "\n" << text;
    EXPECT_EQ(text.rfind((folder.path() / "a/b/r.sdf").string() + ":", 0), 0u) << text;
  }
  EXPECT_NE(words_of([&] { sdf("<link name='a'/>", "2"); }).find("is none of 1.x"), std::string::npos);
  const fs::path file =
      write("s.sdf", "<sdf version='1.9'><model name='a'><link name='l'/></model>\n<model name='b'/></sdf>");
  EXPECT_NE(words_of([&] { robot::read_robot(file); }).find("s.sdf:2: there are two models"), std::string::npos);
}

}  // namespace
}  // namespace morula::test
