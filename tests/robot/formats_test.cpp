// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MJCF and SDF: the same robots written three times, and small ones whose poses are worked out by hand.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <functional>
#include <morula/geometry/random.hpp>
#include <morula/robot/output.hpp>
#include <numbers>
#include <support/allocations.hpp>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

namespace fs = std::filesystem;

const std::string arm = std::string(MORULA_ROBOTS) + "/arm_description/";
const std::string gripper = std::string(MORULA_ROBOTS) + "/gripper_description/";
const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class Formats : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) {
    const fs::path path = folder.path() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  robot::Robot mjcf(const std::string& body, const std::string& before = "") {
    return robot::read_robot(write("a/b/r.xml", "<mujoco model='r'><compiler angle='radian'/>\n" + before +
                                                    "\n<worldbody>\n" + body + "\n</worldbody></mujoco>"));
  }
  robot::Robot sdf(const std::string& body, const std::string& version = "1.9") {
    return robot::read_robot(
        write("a/b/r.sdf", "<sdf version='" + version + "'><model name='r'>\n" + body + "\n</model></sdf>"));
  }
  static std::string words_of(const std::function<void()>& read) {
    try {
      read();
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  }

  const ScratchFolder folder;
};

Vec3 origin_of(const robot::Robot& r, const std::string& link, const std::vector<double>& values) {
  return robot::link_poses(r, values)[r.find_link(link)].translation;
}
Vec3 point_of(const robot::Robot& r, const std::string& link, const std::vector<double>& values, const Vec3& p) {
  return robot::link_poses(r, values)[r.find_link(link)](p);
}

void expect_near(const Vec3& a, const Vec3& b, const std::string& what) {
  EXPECT_LT(distance(a, b), 1e-14) << what << ": " << a.x << " " << a.y << " " << a.z;
}

/// By names: links of one robot may stand in another order in the other.
void expect_same(const robot::Robot& a, const robot::Robot& b, bool limits) {
  ASSERT_EQ(a.links.size(), b.links.size());
  EXPECT_EQ(a.links[a.root].name, b.links[b.root].name);
  for (const robot::Link& link : a.links) {
    const std::size_t at = b.find_link(link.name);
    ASSERT_NE(at, robot::none) << link.name;
    const auto same_surface = [&](const std::vector<robot::Shape>& s, const std::vector<robot::Shape>& t) {
      const robot::LinkSurface p = robot::surface_of(a.file, s), q = robot::surface_of(b.file, t);
      ASSERT_EQ(p.mesh.facets, q.mesh.facets) << link.name;
      ASSERT_EQ(p.mesh.positions.size(), q.mesh.positions.size());
      for (std::size_t i = 0; i < p.mesh.positions.size(); ++i)
        expect_near(p.mesh.positions[i], q.mesh.positions[i], link.name);
      ASSERT_EQ(p.spheres.size(), q.spheres.size());
      for (std::size_t i = 0; i < p.spheres.size(); ++i) {
        expect_near(p.spheres[i].center, q.spheres[i].center, link.name);
        EXPECT_DOUBLE_EQ(p.spheres[i].radius, q.spheres[i].radius);
      }
    };
    same_surface(link.collision, b.links[at].collision);
    const auto& own = link.inertial;
    const auto& other = b.links[at].inertial;
    ASSERT_EQ(own.has_value(), other.has_value()) << link.name;
    if (own) {
      EXPECT_EQ(own->mass, other->mass);
      EXPECT_EQ(own->inertia, other->inertia);
      for (const Vec3& p : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) expect_near(own->origin(p), other->origin(p), link.name);
    }
  }
  ASSERT_EQ(a.own.size(), b.own.size());
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> p, q(b.own.size());
    for (const std::size_t j : a.own) {
      const robot::Joint& joint = a.joints[j];
      const std::size_t found = b.find_joint(joint.name);
      ASSERT_NE(found, robot::none) << joint.name;
      EXPECT_EQ(joint.kind, b.joints[found].kind);
      EXPECT_NEAR(joint.lower, b.joints[found].lower, 1e-15);
      EXPECT_NEAR(joint.upper, b.joints[found].upper, 1e-15);
      if (limits) {
        EXPECT_EQ(joint.velocity, b.joints[found].velocity);
        EXPECT_EQ(joint.effort, b.joints[found].effort);
      }
      p.push_back(random.uniform(joint.lower, joint.upper));
      q[static_cast<std::size_t>(std::find(b.own.begin(), b.own.end(), found) - b.own.begin())] = p.back();
    }
    const auto at_a = robot::link_poses(a, p), at_b = robot::link_poses(b, q);
    for (std::size_t i = 0; i < a.links.size(); ++i) {
      const RigidTransform& other = at_b[b.find_link(a.links[i].name)];
      for (const Vec3& point : {Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}})
        expect_near(at_a[i](point), other(point), a.links[i].name);
    }
  }
}

TEST_F(Formats, an_arm_written_three_times_is_one_robot) {
  const robot::Robot urdf = robot::read_robot(arm + "urdf/arm.urdf");
  const robot::Robot mjcf = robot::read_robot(arm + "mjcf/arm.xml"), sdf = robot::read_robot(arm + "sdf/arm.sdf");
  EXPECT_EQ(mjcf.name, "arm");
  expect_same(urdf, mjcf, false);
  expect_same(urdf, sdf, true);
  EXPECT_EQ(urdf.links[1].visual.size(), 1u);
  EXPECT_EQ(mjcf.links[1].visual.size(), 1u) << "geoms of group 3 are not seen";
  EXPECT_EQ(sdf.links[1].visual.size(), 1u);
}

TEST_F(Formats, a_gripper_written_three_times_is_one_robot) {
  const robot::Robot urdf = robot::read_robot(gripper + "urdf/gripper.urdf");
  const robot::Robot mjcf = robot::read_robot(gripper + "mjcf/gripper.xml");
  expect_same(urdf, mjcf, false);
  expect_same(urdf, robot::read_robot(gripper + "sdf/gripper.sdf"), false);
  EXPECT_EQ(mjcf.ignored, (std::vector<std::array<std::string, 2>>{{"palm", "hook"}}));
}

TEST_F(Formats, the_urdf_that_is_written_of_others_reads_back_the_same) {
  for (const std::string& file : {arm + "mjcf/arm.xml", arm + "sdf/arm.sdf", gripper + "mjcf/gripper.xml"}) {
    robot::Robot read = robot::read_robot(file, {.visual = true});
    const robot::OutputOptions options{.folder = folder.path() / "out"};
    const auto files = robot::output_format("curobo")->write({read, {}, {}, options});
    ASSERT_EQ(files.size(), 2u) << "a planner needs a URDF";
    EXPECT_NE(files[0].bytes.find((folder.path() / "out" / files[1].name).string()), std::string::npos);
    const fs::path path = write("out/" + files[1].name, files[1].bytes);
    const robot::Robot back = robot::read_robot(path, {.package_paths = {arm + ".."}, .visual = true});
    const auto see = [&](robot::Robot r) {
      for (robot::Link& link : r.links) link.collision = link.visual;
      return r;
    };
    expect_same(see(read), see(back), false);
  }
}

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
  ASSERT_EQ(two.own.size(), 3u);
  // Slid by 2, then about (3, 0, 1), then about its own x, which points along y now.
  expect_near(point_of(two, "b", {2, right, right}, {0, 1, 0}), {3, -1, 2}, "a chain");
  const robot::Robot held = mjcf(
      "<body name='a'><body name='b'><joint name='j' type='slide' axis='0 1 0' ref='3' range='0 5'/></body></body>");
  expect_near(origin_of(held, "b", {0}), {0, -3, 0}, "stands in its place at the value of ref");
  const robot::Robot turned = mjcf("<body name='a'><body name='b'><joint name='j' ref='0.5'/></body></body>");
  expect_near(point_of(turned, "b", {0.5 + right}, {1, 0, 0}), {0, 1, 0}, "of a hinge, too");
}

TEST_F(Formats, a_ball_is_three_turns) {
  const robot::Robot m =
      mjcf("<body name='a'><body name='b' pos='0 0 1'><joint name='j' type='ball' range='0 1'/></body></body>");
  const robot::Robot s =
      sdf("<link name='a'/><link name='b'><pose>0 0 1 0 0 0</pose></link><joint name='j' "
          "type='ball'><parent>a</parent><child>b</child></joint>");
  for (const robot::Robot& r : {m, s}) {
    ASSERT_EQ(r.own.size(), 3u);
    EXPECT_EQ(r.joints[r.own[1]].name, "j_y");
    const double right = std::numbers::pi / 2;
    expect_near(point_of(r, "b", {right, right, 0}, {1, 0, 0}), {0, 1, 1}, "about x, then about what y became");
  }
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
  EXPECT_EQ(mjcf("<body name='a'><joint name='j'/></body>").own.size(), 1u);
  EXPECT_EQ(mjcf("<body/><body/><body name='body'/>").find_link("body_2"), 1u)
      << "names are made up beside those given";
}

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
  expect_near(low + high, {}, "centred");
  const std::string words = words_of([&] {
    const robot::Robot other = sdf(mesh("../m/t.obj", "x"));
    robot::surface_of(other.file, other.links[0].collision);
  });
  EXPECT_NE(words.find("only those of COLLADA files are read"), std::string::npos) << words;
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

TEST_F(Formats, what_other_programs_write_is_taken_with_a_note) {
  const robot::Robot fixed =
      mjcf("<body name='a'><body name='b' pos='1 0 0'><joint type='fixed'/><geom size='1'/></body></body>");
  EXPECT_EQ(origin_of(fixed, "b", {}), (Vec3{1, 0, 0}));
  EXPECT_NE(fixed.notes.at(0).find("is fixed, which MuJoCo does not know"), std::string::npos);
  // A plane, and a link called world that stands where the model does.
  const robot::Robot arm_of_world =
      sdf("<link name='world'/><link name='a'><pose>0 0 2 0 0 0</pose><collision "
          "name='c'><geometry><plane/></geometry></collision>"
          "<collision name='d'><geometry><sphere><radius>1</radius></sphere></geometry></collision></link>"
          "<joint name='j' type='fixed'><parent>world</parent><child>a</child></joint>");
  ASSERT_EQ(arm_of_world.links.size(), 2u);
  EXPECT_EQ(origin_of(arm_of_world, "a", {}), (Vec3{0, 0, 2}));
  EXPECT_EQ(arm_of_world.links[arm_of_world.find_link("a")].collision.size(), 1u);
  EXPECT_NE(arm_of_world.notes.at(0).find("a plane in a"), std::string::npos);
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
  write("a/escape.xml", "<mujocoinclude/>");
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
      {body("<geom size='0'/>"), "", "is not above 0"},
      {body("<geom size='1' type='capsule'/>"), "", "is not 2 to 3 numbers"},
      {body("<geom size='1' type='capsule' fromto='1 1 1 1 1 1'/>"), "", "one point twice"},
      {body("<geom type='hfield' hfield='h'/>"), "", "is a hfield"},
      {body("<geom type='torus' size='1'/>"), "", "is a torus"},
      {body("<geom type='mesh'/>"), "", "names no mesh"},
      {use, "", "there is no mesh t"},
      {use, asset("<mesh name='t' vertex='0 0 0'/>"), "written out or built in"},
      {use, asset("<mesh file='m/t.msh'/>"), "is missing; searched"},
      {use, asset("<mesh file='m/t.obj' scale='1 0 1'/>"), "scaled by 0"},
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
      {body("<replicate count='1000000000'/>"), "", "<replicate> is not supported"},
      {body("<composite count='9999 9999 9999'/>"), "", "<composite> is not supported"},
      {body("<flexcomp name='f'/>"), "", "<flexcomp> is not supported"},
      {body("<attach model='m'/>"), "", "<attach> is not supported"},
      {body("") + "<replicate count='7'/>", "", "<replicate> in the world is not supported"},
      {body(""), "<deformable>\n<flex name='f'/></deformable>", "r.xml:3: <flex> of <deformable> is not supported"},
      {body(""), "<compiler coordinate='global'/>", "coordinate=\"global\" is not supported"},
      {body(""), "<compiler angle='grad'/>", "neither degree nor radian"},
      {body(""), "<compiler eulerseq='xy'/>", "three of the letters"},
      {body(""), "<include file='../../escape.xml'/>", "leaves the folder"},
      {body(""), "<include file='/etc/passwd'/>", "leaves the folder"},
      {body(""), "<include file='x/../../../escape.xml'/>", "leaves the folder"},
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
      {two + joint("fixed") + "<joint name='k' type='fixed'><parent>a</parent><child>b</child></joint>",
       "carried by two joints"},
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
      {shape("<sphere><radius>0</radius></sphere>"), "not above 0"},
      {shape("<sphere/>"), "<sphere> has no <radius>"},
      {shape("<box><size>1 1</size></box>"), "is not 3 numbers"},
      {shape("<ellipsoid><radii>1 0 1</radii></ellipsoid>"), "a radius not above 0"},
      {shape("<mesh/>"), "<mesh> has no <uri>"},
      {shape("<mesh><uri> </uri></mesh>"), "<uri>"},
      {shape("<mesh><uri>no.stl</uri></mesh>"), "is missing; searched"},
      {shape("<mesh><uri>model://m/../../../../etc/passwd</uri></mesh>"), "leaves its package"},
      {shape("<mesh><uri>https://host/x.stl</uri></mesh>"), "is not on this disk"},
      {shape("<mesh><uri>no.stl</uri><scale>0 1 1</scale></mesh>"), "scaled by 0"},
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

TEST_F(Formats, text_cut_short_is_refused_not_followed) {
  for (const std::string& file : {arm + "mjcf/arm.xml", arm + "sdf/arm.sdf"}) {
    std::ifstream stream(file);
    const std::string whole{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    for (std::size_t end = 0; end < whole.size() - 12; end += 97) {
      const fs::path path = write("cut", whole.substr(0, end));
      EXPECT_NE(words_of([&] { robot::read_robot(path); }), "") << end;
    }
  }
}

/// A kilobyte that means much is refused before much is allocated, all allocations together.
TEST_F(Formats, small_files_that_mean_much_are_refused_with_little_memory) {
  const auto refused = [&](const std::string& name, const std::string& text, const auto& read,
                           const std::string& words) {
    const fs::path path = write(name, text);
    ASSERT_LE(text.size(), 8192u);
    const std::size_t before = allocated_bytes;
    const std::string said = words_of([&] { read(path); });
    EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20) << name;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  };
  const auto read = [](const fs::path& path) { robot::read_robot(path); };
  std::string laughs = "<!DOCTYPE l [<!ENTITY a0 'lol'>";
  for (int i = 1; i < 12; ++i) {
    laughs += "<!ENTITY a" + std::to_string(i) + " '";
    for (int k = 0; k < 10; ++k) laughs += "&a" + std::to_string(i - 1) + ";";
    laughs += "'>";
  }
  for (const std::string root : {"mujoco", "sdf", "robot"}) {
    refused("r", laughs + "]><" + root + ">&a11;</" + root + ">", read, "entities are declared");
    std::string deep;
    for (int i = 0; i < 1000; ++i) deep += "<b>";
    refused("r", "<" + root + ">" + deep, read, "no well-formed XML");
  }
  std::string classes;
  for (int i = 0; i < 70; ++i) classes += "<default class='" + std::to_string(i) + "'><geom size='1'/>";
  for (int i = 0; i < 70; ++i) classes += "</default>";
  refused("r", "<mujoco><default>" + classes + "</default></mujoco>", read, "nested more than 64 deep");
  // Ten levels of nodes, each of which shows the one below ten times.
  std::string nodes;
  for (int i = 0; i < 10; ++i) {
    nodes += "<node id='n" + std::to_string(i) + "'>";
    for (int k = 0; k < 10; ++k) {
      nodes += i == 0 ? "<instance_geometry url='#g'/>" : "<instance_node url='#n" + std::to_string(i - 1) + "'/>";
    }
    nodes += "</node>";
  }
  const std::string scene =
      "<COLLADA><library_geometries><geometry id='g'><mesh><source id='p'><float_array>0 0 0 1 0 0 0 1 0</float_array>"
      "</source><vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles><input "
      "semantic='VERTEX' "
      "source='#v' offset='0'/><p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_nodes>" +
      nodes +
      "</library_nodes><library_visual_scenes><visual_scene id='s'><node><instance_node url='#n9'/></node>"
      "</visual_scene></library_visual_scenes></COLLADA>";
  refused(
      "bomb.dae", scene, [](const fs::path& path) { robot::read_collada(path); }, "are shown more than 101");
}

}  // namespace
}  // namespace morula::test
