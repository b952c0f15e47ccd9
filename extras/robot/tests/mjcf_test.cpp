// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MJCF: small robots whose poses are worked out by hand, and files that are refused.
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <morula/robot/robot.hpp>
#include <numbers>
#include <set>
#include <span>

#include "formats.hpp"

namespace morula::test {
namespace {

TEST_F(Formats, mjcf_joints_turn_about_their_own_place_one_after_the_other) {
  const double right = std::numbers::pi / 2;
  const robot::Robot one = mjcf(
      "<body name='a'><body name='b' pos='1 0 0'><joint name='j' pos='0 1 0' axis='0 0 2'/><geom "
      "size='1'/></body></body>");
  // b's origin is 1 below the joint at (1, 1, 0); turned by 90 degrees it lies 1 to the right of it.
  expect_near(origin_of(one, "b", {0}), {1, 0, 0}, "at rest");
  expect_near(origin_of(one, "b", {right}), {2, 1, 0}, "turned");
  EXPECT_EQ(one.links.size(), 3u) << "a link without shapes carries the joint";
  const robot::Robot two = mjcf(
      "<body name='a'><body name='b' pos='0 0 1'><joint name='s' type='slide' axis='1 0 0' range='0 3'/>"
      "<joint name='h' axis='0 0 1' pos='1 0 0'/><joint name='k' axis='1 0 0'/></body></body>");
  ASSERT_EQ(two.independent_joints.size(), 3u);
  // Slid by 2, then about (3, 0, 1), then about its own x, which points along y now.
  expect_near(point_of(two, "b", {2, right, right}, {0, 1, 0}), {3, -1, 2}, "a chain");
  const robot::Robot held = mjcf(
      "<body name='a'><body name='b'><joint name='j' type='slide' axis='0 1 0' ref='3' range='0 5'/></body></body>");
  expect_near(origin_of(held, "b", {0}), {0, -3, 0}, "stands in its place at the value of ref");
  const robot::Robot turned = mjcf("<body name='a'><body name='b'><joint name='j' ref='0.5'/></body></body>");
  expect_near(point_of(turned, "b", {0.5 + right}, {1, 0, 0}), {0, 1, 0}, "of a hinge, too");
}

TEST_F(Formats, mjcf_geoms_of_all_kinds_stand_where_they_are_said_to) {
  write("a/b/m/t.obj", tetrahedron);
  const robot::Robot r = mjcf(
      "<body name='a'><geom type='box' size='.1 .2 .3' zaxis='1 0 0'/>"
      "<geom type='ellipsoid' size='.1 .2 .3' pos='1 0 0'/>"
      "<geom type='mesh' mesh='t' pos='0 0 1'/>"
      "<geom type='box' size='.1' fromto='0 0 0 0 0 2'/>"
      "<geom type='capsule' size='.1' fromto='1 0 0 3 0 0'/>"
      "<frame pos='0 0 5' quat='0 0 0 1'><geom size='.5' pos='1 2 3'/><frame pos='1 0 0'><geom "
      "size='.25'/></frame></frame></body>",
      "<compiler meshdir='m'/><asset><mesh file='t.obj' refpos='1 0 0' refquat='0.7071067811865476 0 0 "
      "0.7071067811865476' scale='1 2 3'/></asset>");
  const auto& shapes = r.links[0].collision;
  ASSERT_EQ(shapes.size(), 7u);
  const auto box_of = [&](std::size_t i) {
    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const Vec3& p : robot::surface_of(r.file, std::span(&shapes[i], 1)).mesh.positions) {
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
    return std::array{low, high};
  };
  expect_near(box_of(0)[1], {0.3, 0.2, 0.1}, "z becomes x");
  expect_near(box_of(3)[1], {0.1, 0.1, 2}, "from here to there");
  EXPECT_EQ(shapes[4].length, 2);
  expect_near(shapes[4].origin({0, 0, -1}), {3, 0, 0}, "an axis of a capsule");
  const Vec3 upper = box_of(1)[1];
  const Vec3 largest = Vec3{1, 0, 0} + 1.003 * Vec3{0.1, 0.2, 0.3};
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(upper[k], (Vec3{1.1, 0.2, 0.3})[k]);
    EXPECT_LE(upper[k], largest[k] + 1e-12);
  }
  // Vertex (1, 0, 0) becomes (0, 0, 0); (0, 1, 0) becomes (-1, 1, 0), turned back by 90 degrees (1, 1, 0), scaled (1,
  // 2, 0).
  const Mesh mesh = robot::surface_of(r.file, std::span(&shapes[2], 1)).mesh;
  expect_near(mesh.positions[1], {0, 0, 1}, "refpos");
  expect_near(mesh.positions[2], {1, 2, 1}, "refquat and scale");
  expect_near(mesh.positions[3], {0, 2, 4}, "all of them");
  expect_near(shapes[5].origin.translation, {-1, -2, 8}, "in a frame that is turned round");
  expect_near(shapes[6].origin.translation, {-1, 0, 5}, "in a frame of a frame");
}

TEST_F(Formats, an_ellipsoid_is_contained_in_its_polyhedron) {
  const robot::Robot r = mjcf("<body name='a'><geom type='ellipsoid' size='.1 .7 .3'/></body>");
  const Mesh mesh = robot::surface_of(r.file, r.links[0].collision).mesh;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    const Vec3 n = cross(b - a, c - a);
    const double farthest = std::hypot(n.x * 0.1, n.y * 0.7, n.z * 0.3);
    EXPECT_GE(dot(n, a), farthest * (1 - 1e-13));
    EXPECT_LE(dot(n, a), farthest * 1.003);
  }
}

TEST_F(Formats, what_mjcf_classes_say_holds_where_nothing_nearer_does) {
  const robot::Robot r = mjcf(
      "<body name='a' childclass='outer'><geom/><geom class='inner'/><geom class='inner' size='3'/>"
      "<body name='b' childclass='inner'><geom/><frame childclass='outer'><geom pos='0 0 1'/></frame>"
      "<joint name='j' class='main'/></body></body>",
      "<default><geom size='7'/><joint axis='1 0 0'/><default class='outer'><geom size='1'/><joint axis='0 1 0'/>"
      "<default class='inner'><geom pos='0 2 0'/></default></default></default>");
  const auto& a = r.links[0].collision;
  ASSERT_EQ(a.size(), 3u);
  EXPECT_EQ(a[0].radius, 1);
  EXPECT_EQ(a[1].radius, 1);
  expect_near(a[1].origin.translation, {0, 2, 0}, "by its class");
  EXPECT_EQ(a[2].radius, 3);
  const auto& b = r.links[r.find_link("b")].collision;
  expect_near(b[0].origin.translation, {0, 2, 0}, "by that of the body");
  expect_near(b[1].origin.translation, {0, 0, 1}, "by that of the frame");
  EXPECT_EQ(r.joints[r.find_joint("j")].axis, (Vec3{1, 0, 0}));
}

TEST_F(Formats, of_mjcf_the_world_is_a_link_only_where_it_is_needed) {
  EXPECT_EQ(mjcf("<geom type='plane' size='1 1 1'/><body name='a'><geom size='1'/></body>").links.size(), 1u);
  EXPECT_EQ(mjcf("<body name='a' pos='0 0 1'><freejoint/></body>").links.size(), 1u);
  const robot::Robot placed = mjcf("<body name='a' pos='0 0 1'/>");
  EXPECT_EQ(placed.links[placed.root].name, "world");
  expect_near(origin_of(placed, "a", {}), {0, 0, 1}, "its place is kept");
  EXPECT_EQ(mjcf("<body name='a'/><body name='b'/>").links.size(), 3u);
  EXPECT_EQ(mjcf("<body name='a'><joint name='j'/></body>").independent_joints.size(), 1u);
  EXPECT_EQ(mjcf("<body/><body/><body name='body'/>").find_link("body_2"), 1u)
      << "names are made up beside those given";
}

/// Poses, names and pairs as MuJoCo 4.0 has them of these files.
TEST_F(Formats, mjcf_replicates_are_copies_whose_names_end_with_their_numbers) {
  const robot::Robot arms = mjcf(
      "<body name='hub'><geom size='.1'/><replicate count='3' offset='1 0 0' euler='0 0 1.5707963267948966' sep='-'>"
      "<body name='f' pos='.5 0 0'><joint name='j' axis='0 1 0'/><geom name='g' size='.05' pos='0 0 1'/>"
      "<body name='h'><joint name='k' axis='0 1 0'/><geom size='.1'/></body></body></replicate>"
      "<replicate count='2' offset='0 1 0'><geom type='box' size='.1 .1 .1' pos='0 0 2'/>"
      "<replicate count='2' offset='0 0 1' sep='_'><body name='w'><geom "
      "size='.1'/></body></replicate></replicate></body>",
      "<contact><exclude body1='f' body2='h'/><exclude body1='hub' body2='h'/><exclude body1='f-0' body2='f-2'/>"
      "</contact><equality><joint joint1='k' joint2='j' polycoef='0 2 0 0 0'/></equality>");
  const std::vector<double> still(arms.independent_joints.size(), 0);
  expect_near(origin_of(arms, "f-0", still), {0.5, 0, 0}, "the first stands where it would");
  expect_near(origin_of(arms, "f-1", still), {1, 0.5, 0}, "turned, and away from it");
  expect_near(origin_of(arms, "h-2", still), {0.5, 1, 0}, "away from the second, in its axes");
  expect_near(point_of(arms, "f-2", still, {1, 0, 0}), {-0.5, 1, 0}, "turned twice");
  for (const auto& [name, at] : {std::pair{"w_00", Vec3{0, 0, 0}}, std::pair{"w_10", Vec3{0, 0, 1}},
                                 std::pair{"w_01", Vec3{0, 1, 0}}, std::pair{"w_11", Vec3{0, 1, 1}}}) {
    ASSERT_NE(arms.find_link(name), robot::none) << name << ": the number of the inner copy stands first";
    expect_near(origin_of(arms, name, still), at, name);
  }
  const auto& boxes = arms.links[arms.find_link("hub")].collision;
  ASSERT_EQ(boxes.size(), 3u);
  EXPECT_EQ(boxes[2].origin.translation, (Vec3{0, 1, 2}));
  std::set<std::array<std::string, 2>> pairs(arms.ignored.begin(), arms.ignored.end());
  EXPECT_EQ(pairs, (std::set<std::array<std::string, 2>>{{"f-0", "h-0"},
                                                         {"f-1", "h-1"},
                                                         {"f-2", "h-2"},
                                                         {"hub", "h-0"},
                                                         {"hub", "h-1"},
                                                         {"hub", "h-2"},
                                                         {"f-0", "f-2"}}));
  for (const char* number : {"0", "1", "2"}) {
    const robot::Joint& k = arms.joints[arms.find_joint(std::string("k-") + number)];
    ASSERT_TRUE(k.mimic) << number;
    EXPECT_EQ(arms.joints[k.mimic->joint].name, std::string("j-") + number) << "of the same copy";
    EXPECT_EQ(k.mimic->multiplier, 2);
  }
  const auto in_degrees = [&](const std::string& count) {
    return mjcf("<body><replicate count='" + count +
                    "' offset='1 0.5 0' euler='30 40 20'><body name='f' pos='.5 0 0'>"
                    "<geom size='.05'/></body></replicate></body>",
                "<compiler angle='degree'/>");
  };
  const robot::Robot spiral = in_degrees("3");
  const Vec3 apart = origin_of(spiral, "f2", {}) - Vec3{1.65535611, 1.93751128, 0.06776398};
  EXPECT_LT(length(apart), 1e-8) << "turned by twice the angles, which is not turned twice by the angles";
  EXPECT_NE(in_degrees("10").find_link("f09"), robot::none) << "as many digits as the count has";
  EXPECT_EQ(in_degrees("0").links.size(), 1u);
}

TEST_F(Formats, mjcf_joints_of_the_readers_own_are_followed_by_none) {
  // `palm_fixed` is what ties the palm to the world here; it is no joint of the file, and is dropped with the world.
  const robot::Robot gripper = mjcf(
      "<body name='palm'><geom size='.1'/><body name='finger'><joint name='slide' type='slide'/><geom "
      "size='.1'/></body>"
      "</body>",
      "<equality><joint joint1='slide' joint2='palm_fixed'/></equality>");
  ASSERT_EQ(gripper.joints.size(), 1u);
  EXPECT_FALSE(gripper.joints[0].mimic);
  ASSERT_FALSE(gripper.notes.empty());
  EXPECT_NE(gripper.notes.back().find("joint slide (line"), std::string::npos) << gripper.notes.back();
  // Nor does what moves freely lead anybody.
  const robot::Robot free = mjcf(
      "<body name='palm'><freejoint name='free'/><geom size='.1'/><body name='finger'><joint name='slide' "
      "type='slide'/><geom size='.1'/></body></body>",
      "<equality><joint joint1='slide' joint2='free'/></equality>");
  ASSERT_EQ(free.joints.size(), 1u);
  EXPECT_FALSE(free.joints[0].mimic);
}

/// The tetrahedron above as MuJoCo writes it: four counts, then vertices, normals, places in a texture, facets.
std::string mujoco_mesh(std::int32_t facets = 4, float first = 0) {
  std::string bytes;
  const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const std::int32_t count : {4, 1, 1, facets}) add(count);
  for (const float x : {first, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) add(x);
  for (const float x : {0.f, 0.f, 1.f, 0.5f, 0.5f}) add(x);
  for (const std::int32_t v : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) {
    if (facets > 0) add(v);
  }
  return bytes;
}

// A count of vertices is written first: 36, 292 and 548 begin with the byte of '$', as files of Gmsh do.
TEST_F(Formats, meshes_of_mujoco_are_told_by_all_their_counts) {
  for (const std::int32_t vertices : {35, 36, 37, 292, 548, 9252, 36 + (77 << 8)}) {
    std::string bytes;
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const std::int32_t count : {vertices, 0, 0, vertices - 2}) add(count);
    for (std::int32_t v = 0; v < vertices; ++v) {
      for (const int x : {v, v * v % 101, v % 7}) add(static_cast<float>(x));
    }
    for (std::int32_t f = 0; f < vertices - 2; ++f) {
      for (const std::int32_t corner : {f, f + 1, f + 2}) add(corner);
    }
    write("a/b/m/t.msh", bytes);
    const robot::Robot r =
        mjcf("<body name='a'><geom type='mesh' mesh='t'/></body>", "<asset><mesh name='t' file='m/t.msh'/></asset>");
    const Mesh mesh = robot::surface_of(r.file, r.links[0].collision).mesh;
    ASSERT_EQ(mesh.vertex_count(), static_cast<std::size_t>(vertices));
    EXPECT_EQ(mesh.facet_count(), static_cast<std::size_t>(vertices - 2));
    EXPECT_EQ(mesh.facets.back()[2], static_cast<std::uint32_t>(vertices - 1));
  }
}

TEST_F(Formats, meshes_of_mujoco_are_read_and_broken_ones_refused) {
  static_assert(std::endian::native == std::endian::little, "the file is written as the machine has its numbers");
  write("a/b/m/t.obj", tetrahedron);
  write("a/b/m/t.msh", mujoco_mesh());
  const auto surface = [&](const std::string& file) {
    const robot::Robot r = mjcf("<body name='a'><geom type='mesh' mesh='t'/></body>",
                                "<asset><mesh name='t' file='m/" + file + "' scale='2 1 1'/></asset>");
    return robot::surface_of(r.file, r.links[0].collision).mesh;
  };
  EXPECT_EQ(surface("t.msh").positions, surface("t.obj").positions);
  EXPECT_EQ(surface("t.msh").facets, surface("t.obj").facets);
  const auto refusal = [&](const std::string& bytes) {
    write("a/b/m/bad.msh", bytes);
    return words_of([&] { surface("bad.msh"); });
  };
  const std::string whole = mujoco_mesh();
  for (const std::size_t size : {0u, 3u, 15u, 16u, 100u}) {
    EXPECT_NE(refusal(whole.substr(0, size)).find("bad.msh: "), std::string::npos) << size;
  }
  EXPECT_NE(refusal(whole + "x").find("has 133 bytes where its numbers"), std::string::npos) << refusal(whole + "x");
  EXPECT_NE(refusal(mujoco_mesh(0)).find("has no facets"), std::string::npos);
  EXPECT_NE(refusal(mujoco_mesh(4, std::nanf(""))).find("no number in vertex 0"), std::string::npos);
  std::string bad = whole;
  bad.back() = 1;  // the highest byte of the last index
  EXPECT_NE(refusal(bad).find("facet 3 names vertex 16777219 of 4"), std::string::npos) << refusal(bad);
  bad = whole;
  bad[3] = '\x80';
  EXPECT_NE(refusal(bad).find("below 0"), std::string::npos);
}

TEST_F(Formats, planes_are_left_out_and_meshes_stand_for_what_is_fitted_to_them) {
  write("a/b/m/t.obj", tetrahedron);
  const robot::Robot r = mjcf(
      "<body name='a'><geom type='plane' size='1 1 1'/><geom size='0.1'/>"
      "<geom type='capsule' mesh='t' pos='1 2 3'/></body>",
      "<asset><mesh file='m/t.obj'/></asset><deformable><skin name='s'/></deformable>");
  ASSERT_EQ(r.links[0].collision.size(), 2u);
  EXPECT_EQ(robot::surface_of(r.file, r.links[0].collision).mesh.positions[0], (Vec3{1, 2, 3}));
  ASSERT_EQ(r.notes.size(), 2u);
  EXPECT_NE(r.notes[0].find("a plane in a (line 4) has no end and is left out"), std::string::npos) << r.notes[0];
  EXPECT_NE(r.notes[1].find("the capsule that MuJoCo fits to mesh t (line 4)"), std::string::npos) << r.notes[1];
}

TEST_F(Formats, a_file_may_be_included_from_beside_the_one_that_includes_it) {
  write("a/b/sub/one.xml", "<mujocoinclude><include file='two.xml'/></mujocoinclude>");
  write("a/b/sub/two.xml", "<mujocoinclude><geom size='0.5'/></mujocoinclude>");
  const robot::Robot r = mjcf("<body name='a'><include file='sub/one.xml'/></body>");
  ASSERT_EQ(r.links[0].collision.size(), 1u);
  EXPECT_EQ(r.links[0].collision[0].radius, 0.5);
  write("a/parts/three.xml", "<mujocoinclude><geom size='0.25'/></mujocoinclude>");
  EXPECT_EQ(mjcf("<body name='a'><include file='../parts/three.xml'/></body>").links[0].collision[0].radius, 0.25);
}

TEST_F(Formats, a_file_without_bodies_is_one_link_and_a_mesh_may_be_named_twice_alike) {
  write("a/b/m/t.obj", tetrahedron);
  const robot::Robot r =
      mjcf("<geom size='0.5'/><frame pos='1 0 0'><geom type='mesh' mesh='t'/></frame><geom type='plane' size='1 1 1'/>",
           "<asset><mesh file='m/t.obj'/><mesh file='m/t.obj'/></asset>");
  ASSERT_EQ(r.links.size(), 1u);
  EXPECT_EQ(r.links[0].name, "world");
  ASSERT_EQ(r.links[0].collision.size(), 2u);
  EXPECT_EQ(robot::link_poses(r, {}).size(), 1u);
  EXPECT_EQ(r.notes.size(), 2u);
  EXPECT_NE(words_of([&] { mjcf("<joint name='j'/><geom size='1'/>"); }).find("joint"), std::string::npos);
}

TEST_F(Formats, mjcf_that_is_broken_or_not_supported_is_refused_by_name) {
  write("a/b/m/t.obj", tetrahedron);
  write("a/b/twice.xml", "<mujocoinclude/>");
  write("a/b/self.xml", "<mujocoinclude><include file='self.xml'/></mujocoinclude>");
  write("a/b/wrong.xml", "<mujocoinclude>\n<body/></mujocoinclude>");
  write("a/b/other.xml", "<robot/>");
  const std::string outside = write("escape.xml", "<mujocoinclude/>").generic_string();
  const auto body = [](const std::string& inside) { return "<body name='a'>" + inside + "</body>"; };
  const auto asset = [](const std::string& mesh) { return "<asset>" + mesh + "</asset>"; };
  const std::string use = body("<geom type='mesh' mesh='t'/>");
  const std::vector<std::array<std::string, 3>> cases{
      {"", "", "no <body>"},
      {"<body name='a'/><body name='a'/>", "", "two bodies a"},
      {"<body name='world'/>", "", "called world"},
      {body("<joint name='j'/><body><joint name='j'/></body>"), "", "two joints j"},
      {body("<joint type='screw'/>"), "", "a joint is screw"},
      {body("<joint axis='0 0 0'/>"), "", "an axis of length 0"},
      {body("<joint axis='0 0 nan'/>"), "", "is not 3 numbers"},
      {body("<joint range='1 0' limited='true'/>"), "", "is empty"},
      {body("<joint limited='maybe'/>"), "", "neither true nor false"},
      {body("<body><freejoint/></body>"), "", "free joint"},
      {body("<geom/>"), "", "has no size"},
      {body("<geom size='-1'/>"), "", "is below 0"},
      {body("<geom size='1' type='capsule'/>"), "", "is not 2 to 3 numbers"},
      {body("<geom size='1' type='capsule' fromto='1 1 1 1 1 1'/>"), "", "one point twice"},
      {body("<geom type='hfield' hfield='h'/>"), "", "is a hfield"},
      {body("<geom type='torus' size='1'/>"), "", "is a torus"},
      {body("<geom type='mesh'/>"), "", "names no mesh"},
      {use, "", "there is no mesh t"},
      {use, asset("<mesh name='t' vertex='0 0 0'/>"), "written out or built in"},
      {use, asset("<mesh file='m/t.msh'/>"), "is missing; searched"},
      {use, asset("<mesh file='m/t.obj'/><mesh file='t.obj'/>"), "two meshes t"},
      {use, asset("<mesh name='t' file='../../../../../etc/passwd'/>"), "r.xml:2: mesh \"../../../../../etc/passwd\""},
      {use, asset("<mesh name='t' file='m/no.obj'/>"), "is missing; searched"},
      {body("<geom size='1' quat='1 0 0 0' euler='0 0 0'/>"), "", "both quat and euler"},
      {body("<geom size='1' quat='0 0 0 0'/>"), "", "gives no direction"},
      {body("<geom size='1' xyaxes='1 0 0 1 0 0'/>"), "", "gives no direction"},
      {body("<geom size='1' class='no'/>"), "", "no default class no"},
      {"<body childclass='no'/>", "", "no default class no"},
      {body(""), "<default><default/></default>", "has no class"},
      {body(""), "<default><default class='x'/><default class='x'/></default>", "two default classes x"},
      {body("<replicate count='1000000000'/>"), "", "is not a number of copies from 0 to 10000"},
      {body("<replicate count='2.5'/>"), "", "is not a number of copies from 0 to 10000"},
      {body("<replicate count='-1'/>"), "", "is not a number of copies from 0 to 10000"},
      {body("<replicate offset='1 0 0'/>"), "", "count=\"\" of <replicate> is not 1 numbers"},
      {body("<replicate count='200'><replicate count='200'/></replicate>"), "", "makes more than 10000 elements"},
      {body("<replicate count='2'><body name='b'/></replicate><body name='b1'/>"), "", "two bodies b1"},
      {body("<replicate count='150'><body name='b'/></replicate><replicate count='150'><body name='c'/></replicate>"),
       "<contact><exclude body1='b' body2='c'/></contact>", "too many pairs of copies"},
      {body("<composite count='9999 9999 9999'/>"), "", "<composite> is not supported"},
      {body("<flexcomp name='f'/>"), "", "<flexcomp> is not supported"},
      {body("<attach model='m'/>"), "", "<attach> is not supported"},
      {body("") + "<composite count='7'/>", "", "<composite> in the world is not supported"},
      {body(""), "<deformable>\n<flex name='f'/></deformable>", "r.xml:3: <flex> of <deformable> is not supported"},
      {body(""), "<compiler coordinate='global'/>", "coordinate=\"global\" is not supported"},
      {body(""), "<compiler angle='grad'/>", "neither degree nor radian"},
      {body(""), "<compiler eulerseq='xy'/>", "three of the letters"},
      {body(""), "<include file='../../escape.xml'/>", "lies outside"},
      {body(""), "<include file='%2e%2e/../escape.xml'/>", "lies outside"},
      {body(""), "<include file='" + outside + "'/>", "lies outside"},
      {body(""), "<include file='file://" + outside + "'/>", "lies outside"},
      {body(""), "<include file='http://host/a.xml'/>", "is not on this disk"},
      {body(""), "<include file='x/../../../escape.xml'/>", "lies outside"},
      {body("<freejoint align='true'/><geom size='1' pos='1 0 0'/>"), "", "the frame of a is aligned with its inertia"},
      {body("<freejoint/><geom size='1'/>"), "<compiler alignfree='true'/>", "the frame of a is aligned"},
      {body("<freejoint align='auto'/><geom size='1'/>"), "<compiler alignfree='true'/>", "write align=\"false\""},
      {body("<joint type='free'/><geom size='1'/>"), "<compiler alignfree='true'/>", "the frame of a is aligned"},
      {body("<freejoint align='maybe'/>"), "", "neither true nor false"},
      {body(""), "<include file='no.xml'/>", "is missing; searched"},
      {body(""), "<include/>", "<include> has no file"},
      {body(""), "<include file='twice.xml'/><include file='twice.xml'/>", "a second time"},
      {body(""), "<include file='r.xml'/>", "a second time, or includes itself"},
      {body(""), "<include file='self.xml'/>", "self.xml:1: file \"self.xml\""},
      {body(""), "<include file='other.xml'/>", "other.xml:1: begins with <robot>"},
      {body("<joint name='i'/><joint name='j'/>"),
       "<equality><joint joint1='i' joint2='j'/><joint joint1='j' joint2='i'/></equality>", "follows itself"},
  };
  for (const auto& [inside, before, words] : cases) {
    const std::string text = words_of([&, &inside = inside, &before = before] { mjcf(inside, before); });
    EXPECT_NE(text.find(words), std::string::npos) << inside << before << "\n" << text;
    EXPECT_EQ(text.rfind(folder.path().string(), 0), 0u) << text;
  }
}

}  // namespace
}  // namespace morula::test
