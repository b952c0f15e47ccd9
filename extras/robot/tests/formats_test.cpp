// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The same robots in several formats, and what no format has by itself.
#include "formats.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/output.hpp>
#include <numbers>

namespace morula::test {
namespace {

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
  ASSERT_EQ(a.independent_joints.size(), b.independent_joints.size());
  Random random(5);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> p, q(b.independent_joints.size());
    for (const std::size_t j : a.independent_joints) {
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
      q[static_cast<std::size_t>(std::find(b.independent_joints.begin(), b.independent_joints.end(), found) -
                                 b.independent_joints.begin())] = p.back();
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
    EXPECT_NE(files[0].bytes.find((folder.path() / "out" / files[1].name).generic_string()), std::string::npos);
    const fs::path path = write("out/" + files[1].name, files[1].bytes);
    const robot::Robot back = robot::read_robot(path, {.package_paths = {arm + ".."}, .visual = true});
    const auto see = [&](robot::Robot r) {
      for (robot::Link& link : r.links) link.collision = link.visual;
      return r;
    };
    expect_same(see(read), see(back), false);
  }
}

TEST_F(Formats, a_ball_is_three_turns) {
  const robot::Robot m =
      mjcf("<body name='a'><body name='b' pos='0 0 1'><joint name='j' type='ball' range='0 1'/></body></body>");
  const robot::Robot s =
      sdf("<link name='a'/><link name='b'><pose>0 0 1 0 0 0</pose></link><joint name='j' "
          "type='ball'><parent>a</parent><child>b</child></joint>");
  for (const robot::Robot& r : {m, s}) {
    ASSERT_EQ(r.independent_joints.size(), 3u);
    EXPECT_EQ(r.joints[r.independent_joints[1]].name, "j_y");
    const double right = std::numbers::pi / 2;
    expect_near(point_of(r, "b", {right, right, 0}, {1, 0, 0}), {0, 1, 1}, "about x, then about what y became");
  }
}

TEST_F(Formats, of_all_formats_only_shapes_that_are_asked_for_are_refused) {
  const auto geoms = [](const std::string& visual, const std::string& collision) {
    return "<body name='a'><geom contype='0' conaffinity='0' " + visual + "/><geom group='3' " + collision +
           "/></body>";
  };
  const std::string good = "size='1'";
  for (const std::string fault : {"size='1,5'", "type='box' size='1 1'", "type='torus' size='1'", "size='-1'",
                                  "type='mesh' mesh='none'", "type='hfield' hfield='h'", "size='1' pos='1 2'"}) {
    const robot::Robot read = mjcf(geoms(fault, good));
    EXPECT_EQ(read.links[0].collision.size(), 1u);
    EXPECT_EQ(read.links[0].visual.size(), 0u);
    if (fault.find("hfield") == std::string::npos) {
      ASSERT_EQ(read.notes.size(), 1u) << fault;
      EXPECT_NE(read.notes[0].find("a shape of a that is not requested is left out: "), std::string::npos);
    }
    EXPECT_THROW(mjcf(geoms(good, fault)), FileError) << fault;
  }
  EXPECT_EQ(mjcf("<body name='a'><geom size='0'/><geom type='box' size='1 0 1'/></body>").notes.size(), 2u);
  const auto shapes = [](const std::string& visual, const std::string& collision) {
    return "<link name='a'><visual name='v'><geometry>" + visual +
           "</geometry></visual><collision name='c'><geometry>" + collision + "</geometry></collision></link>";
  };
  const std::string ball = "<sphere><radius>1</radius></sphere>";
  for (const std::string fault :
       {"", "<sphere/>", "<sphere><radius>1,5</radius></sphere>", "<sphere><radius>1 2</radius></sphere>",
        "<box><size>1,5 2,5 3,5</size></box>", "<box><size>1 2 3 4</size></box>", "<box><size>-1 1 1</size></box>"}) {
    const robot::Robot read = sdf(shapes(fault, ball));
    EXPECT_EQ(read.links[0].collision.size(), 1u);
    EXPECT_EQ(read.links[0].visual.size(), 0u);
    ASSERT_EQ(read.notes.size(), 1u) << fault;
    EXPECT_NE(read.notes[0].find("a shape of a that is not requested is left out: "), std::string::npos);
    EXPECT_THROW(sdf(shapes(ball, fault)), FileError) << fault;
  }
  for (const char* nothing : {"<sphere><radius>0</radius></sphere>", "<ellipsoid><radii>0 0 1</radii></ellipsoid>",
                              "<box><size>0 0 0</size></box>"}) {
    const robot::Robot read = sdf(shapes(ball, nothing));
    EXPECT_TRUE(read.links[0].collision.empty());
    ASSERT_EQ(read.notes.size(), 1u);
    EXPECT_NE(read.notes[0].find(" of size 0 in a (line 2) is left out"), std::string::npos) << read.notes[0];
  }
}

TEST_F(Formats, joints_of_sdf_that_close_loops_are_left_out_with_a_note) {
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name='" + name + "' type='revolute'><parent>" + parent + "</parent><child>" + child +
           "</child><axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>\n";
  };
  const std::string links =
      "<link name='a'/><link name='b'><pose>1 0 0 0 0 0</pose></link><link name='c'><pose>1 1 0 0 0 0</pose></link>"
      "<link name='d'><pose>0 1 0 0 0 0</pose></link>\n";
  // Four bars: the joint that would carry d a second time, or lead back to a, is left out.
  for (const std::string& last : {joint("cd", "c", "d"), joint("dc", "d", "c"), joint("ca", "c", "a")}) {
    const robot::Robot r = sdf(links + joint("ab", "a", "b") + joint("bc", "b", "c") + joint("ad", "a", "d") + last);
    ASSERT_EQ(r.joints.size(), 3u) << last;
    EXPECT_EQ(r.links[r.root].name, "a");
    ASSERT_EQ(r.notes.size(), 1u);
    EXPECT_NE(r.notes[0].find("(line 6) closes a loop and is left out"), std::string::npos) << r.notes[0];
    EXPECT_EQ(r.ignored.size(), 1u) << "what the joint holds together is not tested";
    expect_near(origin_of(r, "c", {0, 0, 0}), {1, 1, 0}, "others stay as they are");
    expect_near(origin_of(r, "d", {0, 0, 0}), {0, 1, 0}, "others stay as they are");
  }
  // A link with two carriers that nothing else joins is no loop.
  EXPECT_NE(words_of([&] {
              sdf(links + joint("ab", "a", "b") + joint("cb", "c", "b") + joint("ad", "a", "d"));
            }).find("link b is carried by two joints, ab and cb: a robot is a tree"),
            std::string::npos);
  // Joined later, it is one.
  const robot::Robot late =
      sdf(links + joint("ab", "a", "b") + joint("cb", "c", "b") + joint("ad", "a", "d") + joint("dc", "d", "c"));
  ASSERT_EQ(late.joints.size(), 3u);
  EXPECT_EQ(late.find_joint("cb"), robot::none);
}

TEST_F(Formats, a_free_joint_keeps_the_frame_that_is_written_or_is_refused) {
  const std::string geom = "<geom type='box' size='.1 .2 .3' pos='.5 .2 0'/>";
  const std::string on = "<compiler alignfree='true'/>";
  for (const auto& [body, before] : std::vector<std::pair<std::string, std::string>>{
           {"<freejoint/>", ""},
           {"<freejoint align='false'/>", on},
           {"<freejoint align='auto'/>", ""},
           {"<freejoint/>", on + "<compiler alignfree='false'/>"},
           {"<freejoint align='true'/><body name='b'><geom size='1'/></body>", ""},
           {"<freejoint/><frame><body name='b'><geom size='1'/></body></frame>", on},
           {"<joint type='hinge'/>", on}}) {
    const robot::Robot r = mjcf("<body name='a' pos='0 0 1'>" + body + geom + "</body>", before);
    expect_near(r.links[r.find_link("a")].collision.at(0).origin.translation, {0.5, 0.2, 0}, body + before);
  }
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

}  // namespace
}  // namespace morula::test
