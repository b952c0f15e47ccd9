// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/robot.hpp>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

const std::string robots_folder = MORULA_ROBOTS;
const std::string arm_file = robots_folder + "/arm_description/urdf/arm.urdf";
const std::string gripper_file = robots_folder + "/gripper_description/urdf/gripper.urdf";

void write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

/// "" when nothing is thrown.
std::string refusal(const std::filesystem::path& path, const robot::ReadOptions& options = {}) {
  try {
    const robot::Robot read = robot::read_robot(path, options);
    for (const robot::Link& link : read.links) robot::surface_of(path, link.collision);
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

TEST(ReadRobot, links_joints_and_what_moves_by_itself) {
  const robot::Robot read = robot::read_robot(arm_file);
  EXPECT_EQ(read.name, "arm");
  EXPECT_EQ(read.links.size(), 8u);
  EXPECT_EQ(read.joints.size(), 7u);
  EXPECT_EQ(read.links[read.root].name, "base");
  std::string order;
  for (const std::size_t joint : read.order) order += read.joints[joint].name + " ";
  EXPECT_EQ(order, "turn lift bend reach weld roll tip ");
  std::string own;
  for (const std::size_t joint : read.independent_joints) own += read.joints[joint].name + " ";
  EXPECT_EQ(own, "turn lift bend reach roll ");
  EXPECT_EQ(read.joints[read.find_joint("lift")].axis, (Vec3{0, 1, 0})) << "axes become unit";
  EXPECT_EQ(read.links[0].inertial->mass, 4);
  EXPECT_EQ(robot::read_robot(gripper_file).independent_joints.size(), 1u) << "what follows another is no coordinate";
}

TEST(ReadRobot, what_readers_of_others_take_is_taken_with_a_note) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "a/b/c/odd.urdf";
  write(scratch.path() / "a/package.xml", "<package/>");
  write(scratch.path() / "a/meshes/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write(file, std::string(
                  "<robot><link name='a'><collision><geometry><plane normal='0 0 1'/></geometry></collision>"
                  "<collision><geometry><sphere radius='0'/></geometry></collision><collision><geometry>"
                  "<mesh filename='/home/someone/ws/src/a/meshes/m.obj'/></geometry></collision></link><link name='b'/>"
                  "<joint name='j' type='spherical'><parent link='a'/><child link='b'/><origin xyz='0.5, -1, 2.'/>"
                  "<limit lower='-1.57' upper='$(optenv NAME 1.5)'/></joint></robot>\n") +
                  '\0');
  const robot::Robot read = robot::read_robot(file);
  EXPECT_EQ(read.name, "odd");
  ASSERT_EQ(read.links[0].collision.size(), 1u);
  EXPECT_EQ(read.links[0].collision[0].file, (scratch.path() / "a/meshes/m.obj").lexically_normal());
  EXPECT_EQ(read.joints[0].kind, robot::Joint::Kind::floating);
  EXPECT_EQ(read.joints[0].origin.translation, (Vec3{0.5, -1, 2}));
  EXPECT_EQ(read.joints[0].lower, -1.57);
  EXPECT_EQ(read.joints[0].upper, 1.5);
  std::string notes;
  for (const std::string& note : read.notes) notes += note + "\n";
  for (const char* words :
       {"has no name and is called odd", "a plane in a (line 1)", "a sphere of size 0 in a (line 1)",
        "is spherical, which URDF does not have", "is read as 0.5 -1 2", "is read as 1.5"}) {
    EXPECT_NE(notes.find(words), std::string::npos) << notes;
  }
}

TEST(ReadRobot, a_mass_below_0_and_second_shapes_are_left_out_and_told) {
  const ScratchFolder scratch;
  const auto link = [](const char* name, const char* mass) {
    return std::string("<link name='") + name + "'><inertial>" + mass +
           "</inertial><collision name='c'><geometry>\n<box><size>1 1 1</size></box>"
           "<sphere><radius>9</radius></sphere></geometry></collision></link>\n";
  };
  const std::vector<std::filesystem::path> files{
      scratch.file("r.urdf",
                   "<robot name='r'>\n<link name='a'><inertial><mass value='-1'/></inertial><collision>\n<geometry>"
                   "<box size='1 1 1'/><sphere radius='9'/></geometry></collision></link></robot>"),
      scratch.file("r.sdf", "<sdf version='1.9'><model name='r'>\n" + link("a", "<mass>-1</mass>") + "</model></sdf>")};
  for (const std::filesystem::path& file : files) {
    const robot::Robot read = robot::read_robot(file);
    EXPECT_FALSE(read.links[0].inertial) << file;
    ASSERT_EQ(read.links[0].collision.size(), 1u) << file;
    EXPECT_EQ(read.links[0].collision[0].kind, robot::Shape::Kind::box) << file;
    std::string notes;
    for (const std::string& note : read.notes) notes += note + "\n";
    for (const char* words :
         {"link a (line 2) has the mass -1, which is below 0",
          "a <geometry> of a (line 3) holds more than one shape: <box> is taken, <sphere> is left out"})
      EXPECT_NE(notes.find(words), std::string::npos) << notes;
  }
}

TEST(ReadRobot, shapes_beyond_the_usable_range_are_refused) {
  using Kind = robot::Shape::Kind;
  for (const Kind kind : {Kind::box, Kind::cylinder, Kind::sphere, Kind::capsule, Kind::ellipsoid})
    for (const double size : {0x1p98, 1e31, 1e200, 1e308}) {
      const robot::Shape shape{
          .kind = kind, .size = {size, 1, 1}, .radius = size, .length = 1, .file_name = {}, .file = {}, .line = 7};
      const auto read = [&] { return robot::surface_of("r.urdf", std::span(&shape, 1)); };
      if (size < 0x1p100)
        EXPECT_NO_THROW(read());
      else
        EXPECT_THROW(read(), FileError) << size;
    }
}

TEST(ReadRobot, a_mesh_is_scaled_first_and_placed_then) {
  const robot::Robot read = robot::read_robot(arm_file);
  const Mesh mesh = robot::surface_of(arm_file, read.links[read.find_link("shoulder")].collision).mesh;
  // Turned by 90 degrees about z, then shifted: (x, y, z) of the file goes to (0.05 - y/10, -0.05 + x/10, 0.1 + z/10).
  const std::vector<Vec3> expected{{0.05, -0.05, 0.1},  {0.05, 0.15, 0.1},  {-0.05, 0.15, 0.1},
                                   {-0.05, -0.05, 0.1}, {0.05, -0.05, 0.2}, {-0.05, -0.05, 0.25}};
  ASSERT_EQ(mesh.positions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT(distance(mesh.positions[i], expected[i]), 1e-15) << i;
  }
}

TEST(ReadRobot, facets_of_a_mirrored_mesh_still_look_outward) {
  const robot::Robot read = robot::read_robot(arm_file);
  const MeshReport plain = inspect(read_mesh(robots_folder + "/arm_description/meshes/wedge.obj"));
  const MeshReport mirrored = inspect(robot::surface_of(arm_file, read.links[read.find_link("upper")].collision).mesh);
  ASSERT_TRUE(plain.has_volume());
  ASSERT_TRUE(mirrored.has_volume());
  EXPECT_GT(plain.volume, 0);
  EXPECT_NEAR(mirrored.volume, plain.volume * 0.1 * 0.1 * 0.2, 1e-15);
}

TEST(ReadRobot, round_primitives_are_polyhedra_that_contain_the_true_shapes) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    const double radius = random.uniform(0.01, 2), length = random.uniform(0.01, 3);
    for (const auto kind : {robot::Shape::Kind::cylinder, robot::Shape::Kind::capsule}) {
      robot::Shape shape;
      shape.kind = kind;
      shape.radius = radius;
      shape.length = length;
      const Mesh mesh = robot::surface_of(arm_file, std::span(&shape, 1)).mesh;
      const MeshReport report = inspect(mesh);
      ASSERT_TRUE(report.has_volume());
      EXPECT_GT(report.volume, 0);
      // Convex and around the origin: a shape is inside when the farthest point along each facet's normal is not
      // beyond.
      for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
        const auto [a, b, c] = mesh.corners(f);
        const Vec3 n = normalized(cross(b - a, c - a));
        const double across = std::sqrt(n.x * n.x + n.y * n.y);
        const double farthest = kind == robot::Shape::Kind::capsule ? radius + std::abs(n.z) * length / 2
                                                                    : radius * across + std::abs(n.z) * length / 2;
        EXPECT_GE(dot(n, a), farthest * (1 - 1e-14));
      }
      for (const Vec3& p : mesh.positions) {
        const double beyond = kind == robot::Shape::Kind::capsule ? std::max(0.0, std::abs(p.z) - length / 2) : 0.0;
        EXPECT_LE(std::sqrt(p.x * p.x + p.y * p.y + beyond * beyond), 1.003 * radius) << "as close as is said";
      }
    }
  }
}

TEST(ReadRobot, a_box_is_exact_and_a_sphere_is_itself) {
  const robot::Robot read = robot::read_robot(gripper_file);
  const MeshReport box = inspect(robot::surface_of(gripper_file, read.links[0].collision).mesh);
  EXPECT_NEAR(box.volume, 0.1 * 0.06 * 0.04, 1e-18);
  EXPECT_EQ(box.box.upper, (Vec3{0.05, 0.03, 0.02}));
  const robot::Robot other = robot::read_robot(arm_file);
  const robot::LinkSurface elbow = robot::surface_of(arm_file, other.links[other.find_link("elbow")].collision);
  EXPECT_TRUE(elbow.mesh.facets.empty());
  EXPECT_EQ(elbow.spheres, std::vector({Sphere{{0, 0, 0.02}, 0.06}}));
}

TEST(Kinematics, poses_are_those_worked_out_by_hand) {
  const robot::Robot read = robot::read_robot(arm_file);
  // turn = 90 degrees, reach = 0.1, everything else 0.
  const std::vector<RigidTransform> poses = robot::link_poses(read, std::vector{std::acos(0.0), 0.0, 0.0, 0.1, 0.0});
  const auto at = [&](const char* link, const Vec3& p) { return poses[read.find_link(link)](p); };
  EXPECT_LT(distance(at("shoulder", {0.1, 0, 0}), {0, 0.1, 0.16}), 1e-15);
  EXPECT_LT(distance(at("upper", {0, 0, 0}), {-0.1, 0, 0.41}), 1e-15);
  EXPECT_LT(distance(at("forearm", {0, 0, 0}), {-0.1, 0, 0.41 + 0.35 + 0.05 + 0.1}), 1e-15);
  EXPECT_LT(distance(at("wrist", {0, 0, 0.1}), {-0.1, 0, 0.91 + 0.3 - 0.1}), 1e-15) << "upside down";
}

TEST(Kinematics, floating_and_planar_joints_have_no_value_and_stay_where_they_are) {
  const ScratchFolder scratch;
  std::string text = "<robot name='r'><link name='l0'/>";
  const std::vector<std::string> kinds{"fixed", "revolute", "continuous", "prismatic", "floating", "planar"};
  for (std::size_t i = 0; i < kinds.size(); ++i)
    text += "<link name='l" + std::to_string(i + 1) + "'/><joint name='j" + std::to_string(i) + "' type='" + kinds[i] +
            "'><parent link='l" + std::to_string(i) + "'/><child link='l" + std::to_string(i + 1) +
            "'/><origin xyz='0 0 1'/><axis xyz='0 0 1'/><limit lower='-2' upper='2'/></joint>";
  const robot::Robot read = robot::read_robot(scratch.file("r.urdf", text + "</robot>"));
  for (std::size_t i = 0; i < kinds.size(); ++i)
    EXPECT_EQ(read.joints[i].moves(), kinds[i] == "revolute" || kinds[i] == "continuous" || kinds[i] == "prismatic")
        << kinds[i];
  EXPECT_EQ(read.independent_joints, (std::vector<std::size_t>{1, 2, 3}));
  const std::vector<RigidTransform> poses = robot::link_poses(read, std::vector<double>{0, 0, 0.5});
  EXPECT_EQ(poses[read.find_link("l6")].translation, (Vec3{0, 0, 6.5}));
  EXPECT_THROW(robot::link_poses(read, std::vector<double>(5)), std::invalid_argument);
}

TEST(Kinematics, joints_follow_through_others) {
  const robot::Robot read = robot::read_robot(gripper_file);
  const std::vector<RigidTransform> poses = robot::link_poses(read, std::vector{0.03});
  EXPECT_LT(distance(poses[read.find_link("left")].translation, {0.035, 0, 0.02}), 1e-15);
  EXPECT_LT(distance(poses[read.find_link("right")].translation, {-0.035, 0, 0.02}), 1e-15);
  // hook_turn = 0.5 - 10 * 0.03 = 0.2 about y.
  const Vec3 up = poses[read.find_link("hook")].rotate({0, 0, 1});
  EXPECT_LT(distance(up, {std::sin(0.2), 0, std::cos(0.2)}), 1e-15);
  EXPECT_THROW(robot::link_poses(read, {}), std::invalid_argument);
}

TEST(FindMesh, package_by_convention_and_by_search_path) {
  const ScratchFolder scratch;
  const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto text = [](const std::string& file) {
    return "<robot name='r'><link name='l'><collision><geometry><mesh filename='" + file +
           "'/></geometry></collision></link></robot>";
  };
  write(scratch.path() / "ws/pkg/meshes/a.obj", body);
  write(scratch.path() / "ws/pkg/urdf/r.urdf", text("package://pkg/meshes/a.obj"));
  EXPECT_EQ(refusal(scratch.path() / "ws/pkg/urdf/r.urdf"), "");
  write(scratch.path() / "ws/renamed/meshes/a.obj", body);
  write(scratch.path() / "ws/renamed/urdf/r.urdf", text("package://lost/meshes/a.obj"));
  EXPECT_EQ(refusal(scratch.path() / "ws/renamed/urdf/r.urdf"), "")
      << "next to the file once the package is struck off";
  write(scratch.path() / "far/r.urdf", text("package:///pkg/meshes/a.obj"));
  EXPECT_NE(refusal(scratch.path() / "far/r.urdf"), "");
  EXPECT_EQ(refusal(scratch.path() / "far/r.urdf", {.package_paths = {scratch.path() / "ws"}}), "");
  EXPECT_EQ(refusal(scratch.path() / "far/r.urdf", {.package_paths = {scratch.path() / "ws/pkg"}}), "");
}

TEST(FindMesh, what_is_missing_is_named_with_every_place_searched) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "ws/pkg/urdf/r.urdf";
  write(file,
        "<robot name='r'>\n<link name='l'><collision><geometry>\n<mesh filename='package://pkg/meshes/no.stl'/>"
        "</geometry></collision></link></robot>");
  const std::string text = refusal(file, {.package_paths = {scratch.path() / "elsewhere"}});
  EXPECT_EQ(text.rfind(file.string() + ":3: mesh \"package://pkg/meshes/no.stl\" is missing; searched: ", 0), 0u)
      << text;
  for (const char* place : {"elsewhere/pkg/meshes/no.stl", "ws/pkg/urdf/pkg/meshes/no.stl", "ws/pkg/meshes/no.stl"}) {
    EXPECT_NE(text.find((scratch.path() / place).make_preferred().string()), std::string::npos) << text;
  }
  EXPECT_NE(text.find("as a package path"), std::string::npos);
}

TEST(ReadRobot, refuses_what_is_broken_with_file_line_and_words) {
  const ScratchFolder scratch, elsewhere;
  const std::filesystem::path file = scratch.path() / "a/b/c/r.urdf";
  const std::string two = "<link name='a'/><link name='b'/>";
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child,
                        const std::string& more = "") {
    return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child + "'/>" +
           more + "</joint>";
  };
  const auto collision = [](const std::string& geometry) {
    return "<link name='a'><collision><geometry>" + geometry + "</geometry></collision></link>";
  };
  const std::vector<std::array<std::string, 2>> cases{
      {"<link name='a'>", "is not well-formed XML"},
      {"<link/>", "<link> has no name"},
      {"<link name='a'/><xacro:arm/>", ":2: has macros: run xacro on the file first"},
      {two + two, "there are two links a"},
      {two, "both carried by no joint"},
      {two + joint("j", "a", "c"), "there is no link c"},
      {two + joint("j", "a", "b") + joint("j", "a", "b"), "there are two joints j"},
      {two + joint("i", "a", "b") + joint("j", "a", "b"), "carried by two joints"},
      {two + joint("i", "a", "b") + joint("j", "b", "a"), "a circle"},
      {two + "<link name='c'/>" + joint("i", "a", "b") + joint("j", "b", "a"), "circle"},
      {two + "<joint name='j' type='hinge'/>", "a joint is hinge"},
      {two + joint("j", "a", "b", "<axis xyz='0 0 0'/>"), "an axis of length 0"},
      {two + joint("j", "a", "b", "<axis xyz='0 nan 0'/>"), "is not three numbers"},
      {two + joint("j", "a", "b", "<limit lower='1e999'/>"), "is no number"},
      {two + joint("j", "a", "b", "<mimic joint='j'/>"), "follows itself"},
      {collision("<sphere radius='-1'/>"), "is below 0"},
      {collision("<box size='${a} 1 1'/>"), "run xacro on the file first"},
      {collision("<sphere radius='0x10'/>"), "is no number"},
      {collision("<box size='1 1'/>"), "is not three numbers"},
      {collision("<box size='1 -1 1'/>"), "an edge below 0"},
      {collision("<torus/>"), "<torus> is no geometry"},
      {collision(""), "has no geometry"},
      {collision("<mesh filename='http://host/x.stl'/>"), "is not on this disk"},
      {collision("<mesh filename='package://pkg/../../../etc/passwd'/>"), "leaves its package"},
      {collision("<mesh filename='/dev/null'/>"), "is missing"},
      {collision("<mesh filename='file://" + (elsewhere.path() / "ball.obj").generic_string() + "'/>"),
       "lies outside " + (scratch.path() / "a/b").make_preferred().string() +
           "; allow its folder with the package path"},
      {collision("<mesh filename='../../../r.obj'/>"), "lies outside"},
      {collision("<mesh filename='empty.obj'/>"), "empty.obj"},
      {collision("<mesh filename='part.step'/>"),
       "no mesh format has the extension '.step'; name a file with one of .dae .obj"},
  };
  write(scratch.path() / "r.obj", "");
  write(scratch.path() / "a/b/c/empty.obj", "");
  write(scratch.path() / "a/b/c/part.step", "ISO-10303-21;");
  write(elsewhere.path() / "ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const auto& [body, words] : cases) {
    write(file, "<robot name='r'>\n" + body + "\n</robot>");
    const std::string text = refusal(file);
    EXPECT_NE(text.find(words), std::string::npos) << body << "\n" << text;
    EXPECT_EQ(text.rfind(file.string() + ":", 0), 0u) << text;
  }
  write(file, "<!DOCTYPE r [\n<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]>\n<robot name='&b;'/>");
  EXPECT_NE(refusal(file).find("r.urdf:2: entities are declared"), std::string::npos) << refusal(file);
  write(file, "<xacro:macro/>");
  EXPECT_NE(refusal(file).find("give the file that begins with <robot>"), std::string::npos) << refusal(file);
  EXPECT_NE(refusal(scratch.path() / "none.urdf").find("there is no such file"), std::string::npos);
}

TEST(ReadRobot, numbers_that_are_not_clear_are_refused_with_file_line_and_attribute) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "r.urdf";
  const auto said = [&](const std::string& body) {
    write(file, "<robot name='r'>\n<link name='a'>\n" + body + "</link></robot>");
    return refusal(file);
  };
  const auto box = [](const std::string& size) {
    return "<collision><geometry><box size='" + size + "'/></geometry></collision>";
  };
  const std::string of_size = file.string() + ":3: size=\"", of_box = "\" of <box> is not three numbers";
  for (const std::string size :
       {"1,5 2,5 3,5", "1,5, 2,5, 3,5", "1 2 3 4", "1, 2, 3, 4", "1 2",     "1, 2,",     ",1 2 3",
        "1,,2,3",      "1 2,3",         "1,2 3",   "1 2 3m",     "1 2 3 m", "1.5.1 2 3", "1. 2. 3.0.",
        "1 2 +-3",     "1 2 3;",        "1;2;3",   "1e 2 3",     "inf 1 1", "0x1 2 3"}) {
    EXPECT_EQ(said(box(size)).rfind(of_size + size + of_box, 0), 0u) << size << "\n" << said(box(size));
  }
  EXPECT_NE(said(box("1,5 2,5 3,5")).find("; write decimals with a point"), std::string::npos);
  for (const char* size : {"1.5 2.5 3.5", " 1.5\t2.5\n3.5 ", "1.5,2.5,3.5", "1.5, 2.5 ,3.5", "+1.5 25e-1 3.5"}) {
    write(file, "<robot name='r'><link name='a'>" + box(size) + "</link></robot>");
    EXPECT_EQ(robot::read_robot(file).links[0].collision.at(0).size, (Vec3{1.5, 2.5, 3.5})) << size;
  }
  const auto number = [](const std::string& radius) {
    return "<collision><geometry><sphere radius='" + radius + "'/></geometry></collision>";
  };
  for (const std::string radius : {"1,5", "1 2", "1.5.", "1.5m", "1,", ""}) {
    const std::string text = said(number(radius));
    EXPECT_EQ(text.rfind(file.string() + ":3: ", 0), 0u) << text;
    EXPECT_NE(text.find("radius"), std::string::npos) << text;
  }
  for (const char* where : {"<inertial><origin rpy='0 0 0 9'/></inertial>", "<inertial><mass value='1,5'/></inertial>",
                            "<inertial><inertia ixx='1 2'/></inertial>"}) {
    EXPECT_NE(said(where).find(":3: "), std::string::npos) << said(where);
  }
}

TEST(ReadRobot, shapes_without_a_surface_are_passed_over_with_a_note) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "r.urdf";
  write(scratch.path() / "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  struct Case {
    const char* geometry;
    const char* note;  // nothing: it is there as it is
    std::size_t shapes;
  };
  for (const Case& c : std::vector<Case>{
           {"<box size='0 0 0'/>", "a box of size 0 in tip (line 2) is left out", 0},
           {"<box size='0 2 0'/>", "a box of size 0 in tip (line 2) is left out", 0},
           {"<box size='1 2 0'/>", "a box in tip (line 2) is flat", 1},
           {"<sphere radius='0'/>", "a sphere of size 0 in tip (line 2) is left out", 0},
           {"<cylinder radius='0' length='1'/>", "a cylinder of size 0 in tip (line 2) is left out", 0},
           {"<cylinder radius='1' length='0'/>", "a cylinder in tip (line 2) is flat", 1},
           {"<capsule radius='0' length='1'/>", "a capsule of size 0 in tip (line 2) is left out", 0},
           {"<capsule radius='1' length='0'/>", "", 1},
           {"<mesh filename='m.obj' scale='0 0 0'/>", "a mesh of size 0 in tip (line 2) is left out", 0},
           {"<mesh filename='m.obj' scale='1 0 1'/>", "a mesh in tip (line 2) is flat", 1},
       }) {
    for (const bool visual : {false, true}) {
      const std::string kind = visual ? "visual" : "collision", other = visual ? "collision" : "visual";
      const auto text = [&](const std::string& needed) {
        return "<robot name='r'><link name='base'/><link name='tip'>\n<" + needed + "><geometry>" + c.geometry +
               "</geometry></" + needed +
               "></link><joint name='j' type='fixed'><parent link='base'/><child link='tip'/></joint></robot>";
      };
      write(file, text(kind));
      const robot::Robot read = robot::read_robot(file, {.visual = visual});
      EXPECT_EQ((visual ? read.links[1].visual : read.links[1].collision).size(), c.shapes) << c.geometry;
      if (*c.note == '\0') {
        EXPECT_TRUE(read.notes.empty()) << read.notes[0];
      } else {
        ASSERT_EQ(read.notes.size(), 1u) << c.geometry;
        EXPECT_EQ(read.notes[0].rfind(c.note, 0), 0u) << read.notes[0];
      }
      write(file, text(other));
      EXPECT_TRUE(robot::read_robot(file, {.visual = visual}).notes.empty()) << "nobody asks for it: " << c.geometry;
    }
  }
}

TEST(ReadRobot, shapes_that_nobody_asks_for_never_end_a_robot) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "r.urdf";
  const auto shape = [](const std::string& kind, const std::string& inside) {
    return "<" + kind + "><geometry>" + inside + "</geometry></" + kind + ">";
  };
  for (const char* fault :
       {"<box size='1,5 2,5 3,5'/>", "<box size='-1 1 1'/>", "<torus/>", "", "<mesh/>",
        "<mesh filename='none.stl' scale='x'/>", "<sphere radius='${r}'/>", "<cylinder radius='1'/>"}) {
    const auto text = [&](const std::string& kind) {
      return "<robot name='r'>\n<link name='a'>" + shape("collision", "<sphere radius='1'/>") +
             shape("visual", "<sphere radius='2'/>") + shape(kind, fault) + "</link></robot>";
    };
    for (const bool visual : {false, true}) {
      write(file, text(visual ? "collision" : "visual"));
      const robot::Robot read = robot::read_robot(file, {.visual = visual});
      EXPECT_EQ(read.links[0].collision.size(), 1u);
      EXPECT_EQ(read.links[0].visual.size(), 1u);
      ASSERT_EQ(read.notes.size(), 1u) << fault;
      EXPECT_EQ(read.notes[0].rfind("a shape of a that is not requested is left out: " + file.string() + ":2: ", 0), 0u)
          << read.notes[0];
      write(file, text(visual ? "visual" : "collision"));
      EXPECT_THROW(robot::read_robot(file, {.visual = visual}), FileError) << fault;
      EXPECT_NO_THROW(robot::read_robot(file, {.visual = visual, .skip = {"a"}})) << fault;
      EXPECT_THROW(robot::read_robot(file, {.visual = visual, .skip = {"b"}}), FileError) << fault;
    }
  }
  // The mesh of a link that is left out need not be there.
  write(file,
        "<robot name='r'><link name='a'>" + shape("collision", "<mesh filename='none.stl'/>") + "</link></robot>");
  EXPECT_THROW(robot::read_robot(file), FileError);
  EXPECT_EQ(robot::read_robot(file, {.skip = {"a"}}).links.size(), 1u);
}

TEST(ReadRobot, text_nested_without_end_and_cut_short_is_refused_not_followed) {
  const ScratchFolder scratch;
  const std::filesystem::path file = scratch.path() / "r.urdf";
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  write(file, deep);
  EXPECT_NE(refusal(file), "");
  std::ifstream stream(arm_file);
  const std::string whole{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  for (std::size_t end = 0; end < whole.size() - 8; end += 97) {
    write(file, whole.substr(0, end));
    EXPECT_NE(refusal(file), "") << end;
  }
}

}  // namespace
}  // namespace morula::test
