// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ignored pairs of robots whose truth is known by geometry.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/self_collision.hpp>
#include <numbers>
#include <support/scratch_folder.hpp>

#include "fit/pair_search.hpp"

namespace morula::test {
namespace {

using robot::IgnoreReason;
using robot::Joint;
using robot::none;

constexpr double pi = std::numbers::pi;

/// A robot put together link by link, with spheres given by hand or fitted.
struct Maker {
  robot::Robot robot;
  robot::RobotSpheres spheres;

  Maker() { add_link("base"); }

  std::size_t add_link(const std::string& name) {
    robot::Link link;
    link.name = name;
    robot.links.push_back(link);
    if (robot.root == none) robot.root = 0;
    return robot.links.size() - 1;
  }

  std::size_t add(std::size_t parent, const std::string& name, Joint joint) {
    const std::size_t link = add_link(name);
    joint.name = "to_" + name;
    joint.parent = parent;
    joint.child = link;
    robot.links[link].joint = robot.joints.size();
    robot.order.push_back(robot.joints.size());
    if (joint.moves() && !joint.mimic) robot.independent_joints.push_back(robot.joints.size());
    robot.joints.push_back(joint);
    return link;
  }
  std::size_t fix(std::size_t parent, const std::string& name, const Vec3& at) {
    Joint joint;
    joint.origin.translation = at;
    return add(parent, name, joint);
  }
  std::size_t turn(std::size_t parent, const std::string& name, const Vec3& at, const Vec3& axis, double lower = -pi,
                   double upper = pi) {
    Joint joint;
    joint.kind = Joint::Kind::revolute;
    joint.origin.translation = at;
    joint.axis = axis;
    joint.lower = lower, joint.upper = upper;
    return add(parent, name, joint);
  }
  std::size_t slide(std::size_t parent, const std::string& name, const Vec3& at, const Vec3& axis, double lower,
                    double upper) {
    Joint joint;
    joint.kind = Joint::Kind::prismatic;
    joint.origin.translation = at;
    joint.axis = axis;
    joint.lower = lower, joint.upper = upper;
    return add(parent, name, joint);
  }
  void ball(std::size_t link, const Vec3& center, double radius) {
    robot::LinkSpheres of;
    of.link = link;
    of.spheres = {Sphere{center, radius}};
    spheres.links.push_back(of);
  }
  void box(std::size_t link, const Vec3& center, const Vec3& size) {
    robot::Shape shape;
    shape.kind = robot::Shape::Kind::box;
    shape.origin.translation = center;
    shape.size = size;
    robot.links[link].collision.push_back(shape);
  }
  void cylinder(std::size_t link, const Vec3& center, double radius, double length) {
    robot::Shape shape;
    shape.kind = robot::Shape::Kind::cylinder;
    shape.origin.translation = center;
    shape.radius = radius, shape.length = length;
    robot.links[link].collision.push_back(shape);
  }
};

/// "Never", … of a pair, "proven" for what is apart, "tested" where it is not ignored.
std::string fate(const robot::Robot& robot, const robot::SelfCollision& found, const char* a, const char* b) {
  const std::pair<std::size_t, std::size_t> asked = std::minmax(robot.find_link(a), robot.find_link(b));
  for (const robot::IgnoredPair& pair : found.ignored) {
    if (asked != std::pair(pair.a, pair.b)) continue;
    return pair.reason == IgnoreReason::apart ? "proven" : std::string(name(pair.reason));
  }
  return "tested";
}

/// A pendulum whose ball meets that of a post within a share of its circle.
Maker pendulum(double share) {
  Maker made;
  const std::size_t arm = made.turn(0, "arm", {}, {0, 0, 1}), post = made.fix(0, "post", {});
  const double radius = std::sin(0.5 * pi * share);  // centers at an angle of pi share are twice this apart
  made.ball(arm, {1, 0, 0}, radius);
  made.ball(post, {std::cos(2.1), std::sin(2.1), 0}, radius);
  return made;
}

TEST(IgnoredPairs, a_contact_in_few_configurations_is_found) {
  for (const double share : {1e-2, 1e-4, 1e-6, 1e-9}) {
    const Maker made = pendulum(share);
    for (const std::uint64_t seed : {1, 2, 3}) {
      const robot::SelfCollision found = robot::find_ignored(made.robot, made.spheres, {.samples = 1000, .seed = seed});
      EXPECT_EQ(fate(made.robot, found, "arm", "post"), "tested") << share;
    }
  }
}

/// Arms of three links of 0.5 that turn about all axes; balls of 0.1 at the end and on a post, far away.
Maker reaching_arm(double missing) {
  Maker made;
  const std::size_t shoulder = made.turn(0, "shoulder", {}, {0, 0, 1}),
                    elbow = made.turn(shoulder, "elbow", {0.5, 0, 0}, {0, 1, 0}),
                    wrist = made.turn(elbow, "wrist", {0.5, 0, 0}, {0, 0, 1}), post = made.fix(0, "post", {});
  made.ball(wrist, {0.5, 0, 0}, 0.1);
  const Vec3 way = normalized(Vec3{0.6, -0.8, 0});
  made.ball(post, (1.5 + 0.2 + missing) * way, 0.1);
  return made;
}

TEST(IgnoredPairs, a_contact_that_only_going_downhill_finds_is_found) {
  // Eight joints; the arm reaches the post where it is nearly straight, in few of all configurations.
  Maker made;
  std::size_t link = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 at = i < 2 ? Vec3{} : Vec3{0.15, 0, 0}, axis = i % 2 == 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    link = made.turn(link, "l" + std::to_string(i), at, axis, -0.9, 0.9);
  }
  const std::size_t post = made.fix(0, "post", {});
  made.ball(link, {0.1, 0, 0}, 0.01);
  const Vec3 way = normalized(Vec3{1, 0.43, -0.31});
  made.ball(post, (1 + 0.02 - 2e-2) * way, 0.01);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const robot::SelfCollision found = robot::find_ignored(made.robot, made.spheres, {.samples = 1000, .seed = seed});
    EXPECT_EQ(fate(made.robot, found, "l7", "post"), "tested") << seed;
  }
}

TEST(IgnoredPairs, an_arm_that_does_not_reach_by_a_millimeter_is_proven_apart) {
  const Maker made = reaching_arm(1e-3);
  const robot::SelfCollision found = robot::find_ignored(made.robot, made.spheres, {.samples = 1000});
  EXPECT_EQ(fate(made.robot, found, "wrist", "post"), "proven");
  // Without samples, too.
  EXPECT_EQ(fate(made.robot, robot::find_ignored(made.robot, made.spheres, {.samples = 0}), "wrist", "post"), "proven");
}

TEST(IgnoredPairs, an_arm_that_reaches_by_a_millimeter_is_tested) {
  const Maker made = reaching_arm(-1e-3);
  const robot::SelfCollision found = robot::find_ignored(made.robot, made.spheres, {.samples = 1000});
  EXPECT_EQ(fate(made.robot, found, "wrist", "post"), "tested");
}

TEST(IgnoredPairs, limits_of_joints_decide) {
  // A pendulum that comes as near as 0.01 rad to what it would touch.
  const auto limited = [](double upper) {
    Maker made;
    const std::size_t arm = made.turn(0, "arm", {}, {0, 1, 0}, -2, upper), post = made.fix(0, "post", {});
    const double angle = 1.0;  // of contact, where the arm turns to it; about −y as from x to −z
    made.ball(arm, {1, 0, 0}, 0.05);
    const double more = 2 * std::asin(0.05);  // balls of 0.05 touch at this angle between them
    made.ball(post, {std::cos(angle + more), 0, -std::sin(angle + more)}, 0.05);
    return fate(made.robot, robot::find_ignored(made.robot, made.spheres, {.samples = 1000}), "arm", "post");
  };
  EXPECT_EQ(limited(0.99), "proven");
  EXPECT_EQ(limited(1.01), "tested");
}

TEST(IgnoredPairs, slides_within_limits_are_proven_or_tested) {
  const auto limited = [](double upper) {
    Maker made;
    const std::size_t cart = made.slide(0, "cart", {-3, 0, 0}, {1, 0, 0}, 0, upper), post = made.fix(0, "post", {});
    made.ball(cart, {}, 0.5);
    made.ball(post, {}, 0.5);
    return fate(made.robot, robot::find_ignored(made.robot, made.spheres, {.samples = 1000}), "cart", "post");
  };
  EXPECT_EQ(limited(1.999), "proven");
  EXPECT_EQ(limited(2.001), "tested");
}

TEST(IgnoredPairs, joints_that_follow_others_move_with_them) {
  // Two fingers close on each other; the second one follows the first.
  const auto fingers = [](double multiplier) {
    Maker made;
    made.ball(0, {0, 0, -5}, 0.1);
    const std::size_t left = made.slide(0, "left", {-1, 0, 0}, {1, 0, 0}, 0, 0.6);
    Joint follows;
    follows.kind = Joint::Kind::prismatic;
    follows.origin.translation = {1, 0, 0};
    follows.axis = {1, 0, 0};
    follows.mimic = Joint::Mimic{made.robot.links[left].joint, multiplier, 0};
    const std::size_t right = made.add(0, "right", follows);
    made.ball(left, {}, 0.45);
    made.ball(right, {}, 0.45);
    return fate(made.robot, robot::find_ignored(made.robot, made.spheres, {.samples = 500}), "left", "right");
  };
  EXPECT_EQ(fingers(-1), "tested");    // they come to 0.8 of each other
  EXPECT_EQ(fingers(-0.7), "proven");  // 2 - 1.02 is left, more than 0.9
  EXPECT_EQ(fingers(1), "proven");
}

/// The files of robots with a slide from far away to a post: its range is unknown, or absurd.
TEST(IgnoredPairs, over_joints_of_unknown_or_absurd_range_are_tested) {
  const ScratchFolder scratch;
  const auto urdf = [](const std::string& limit) {
    return "<robot name='r'><link name='base'><collision><geometry><box size='1 1 .1'/></geometry></collision></link>"
           "<link name='slide'><collision><geometry><box size='.2 .2 .2'/></geometry></collision></link>"
           "<link name='post'><collision><origin xyz='0 0 1'/><geometry><box size='.2 .2 2'/></geometry></collision>"
           "</link><joint name='s' type='prismatic'><parent link='base'/><child link='slide'/>"
           "<origin xyz='-3 0 1'/><axis xyz='1 0 0'/>" +
           limit + "</joint><joint name='p' type='fixed'><parent link='base'/><child link='post'/></joint></robot>";
  };
  const auto sdf = [](const std::string& limit) {
    return "<sdf version='1.7'><model name='r'><link name='base'><collision name='c'><geometry><box><size>1 1 .1</size>"
           "</box></geometry></collision></link><link name='slide'><pose>-3 0 1 0 0 0</pose><collision name='c'>"
           "<geometry><box><size>.2 .2 .2</size></box></geometry></collision></link><link name='post'>"
           "<pose>0 0 1 0 0 0</pose><collision name='c'><geometry><box><size>.2 .2 "
           "2</size></box></geometry></collision>"
           "</link><joint name='p' type='fixed'><parent>base</parent><child>post</child></joint>"
           "<joint name='s' type='prismatic'><parent>base</parent><child>slide</child><axis><xyz>1 0 0</xyz>" +
           limit + "</axis></joint></model></sdf>";
  };
  const auto mjcf = [](const std::string& range) {
    return "<mujoco><worldbody><body name='base'><geom type='box' size='.5 .5 .05'/><body name='post'><geom type='box' "
           "size='.1 .1 1' pos='0 0 1'/></body><body name='slide' pos='-3 0 1'><joint name='s' type='slide' "
           "axis='1 0 0' " +
           range + "/><geom type='box' size='.1 .1 .1'/></body></body></worldbody></mujoco>";
  };
  const auto check = [&](const char* file, const std::string& text, const std::string& expected) {
    SCOPED_TRACE(text);
    const robot::Robot read = robot::read_robot(scratch.file(file, text));
    const robot::RobotSpheres spheres = robot::fit_spheres(read, {.spheres = 2, .quality = Quality::draft});
    const robot::SelfCollision found = robot::find_ignored(read, spheres, {.samples = 500});
    EXPECT_EQ(fate(read, found, "slide", "post"), expected);
    const bool is_named = std::any_of(found.notes.begin(), found.notes.end(), [](const std::string& note) {
      return note.find("joint s ") != std::string::npos;
    });
    EXPECT_EQ(is_named, expected == "tested");
  };
  for (const char* limit : {"", "<limit effort='1' velocity='1'/>", "<limit lower='-1e16' upper='1e16'/>",
                            "<limit lower='-1e16' upper='-1e15'/>", "<limit lower='-1e7' upper='1e7'/>"}) {
    check("r.urdf", urdf(limit), "tested");
  }
  for (const char* limit :
       {"", "<limit><lower>-1e16</lower><upper>1e16</upper></limit>", "<limit><lower>-1</lower></limit>",
        "<limit><lower>-1e9</lower><upper>1e9</upper></limit>"}) {
    check("r.sdf", sdf(limit), "tested");
  }
  for (const char* range : {"", "range='-1e16 1e16'", "limited='false' range='-1 1'"}) {
    check("r.xml", mjcf(range), "tested");
  }
  // A range that is known and small is proven.
  check("r.urdf", urdf("<limit lower='-1' upper='1'/>"), "proven");
  check("r.urdf", urdf("<limit lower='0' upper='0'/>"), "proven");
  check("r.sdf", sdf("<limit><lower>-1</lower><upper>1</upper></limit>"), "proven");
  check("r.xml", mjcf("range='-1 1'"), "proven");
}

TEST(IgnoredPairs, over_floating_and_planar_joints_and_followers_of_unknown_ones_are_tested) {
  for (const Joint::Kind kind : {Joint::Kind::floating, Joint::Kind::planar}) {
    Maker made;
    Joint joint;
    joint.kind = kind;
    const std::size_t free = made.add(0, "free", joint), post = made.fix(0, "post", {});
    made.ball(free, {}, 0.1);
    made.ball(post, {5, 0, 0}, 0.1);
    EXPECT_EQ(fate(made.robot, robot::find_ignored(made.robot, made.spheres), "free", "post"), "tested");
  }
  Maker made;
  const std::size_t leader = made.slide(0, "leader", {0, 9, 0}, {1, 0, 0}, 0, 0);
  made.robot.joints[made.robot.links[leader].joint].range_known = false;
  Joint follows;
  follows.kind = Joint::Kind::revolute;
  follows.mimic = Joint::Mimic{made.robot.links[leader].joint, 1, 0};
  const std::size_t arm = made.add(0, "arm", follows), post = made.fix(0, "post", {});
  made.ball(arm, {0, 1, 0}, 0.1);
  made.ball(post, {0, -1, 0}, 0.1);
  EXPECT_EQ(fate(made.robot, robot::find_ignored(made.robot, made.spheres), "arm", "post"), "tested");
}

/// Two links whose single spheres overlap. Their joints could move them against each other, but have no room for it.
robot::SelfCollision two_links(const std::function<void(Maker&, std::size_t, std::size_t)>& shapes) {
  Maker made;
  const std::size_t left = made.slide(0, "left", {}, {1, 0, 0}, 0, 0),
                    right = made.slide(0, "right", {}, {1, 0, 0}, 0, 0);
  shapes(made, left, right);
  const robot::RobotSpheres spheres = robot::fit_spheres(made.robot, {.spheres = 1});
  const robot::SelfCollision found = robot::find_ignored(made.robot, spheres, {.samples = 100});
  EXPECT_EQ(found.pairs, 1u);
  return found;
}

TEST(IgnoredPairs, at_rest_the_surfaces_decide_not_the_spheres) {
  const auto boxes = [](double gap) {
    return two_links([&](Maker& made, std::size_t left, std::size_t right) {
      made.box(left, {}, {1, 1, 1});
      made.box(right, {1 + gap, 0.3, 0.2}, {1, 1, 1});
    });
  };
  for (const double gap : {0.3, 1e-2, 1e-4}) {
    const robot::SelfCollision found = boxes(gap);
    EXPECT_TRUE(found.ignored.empty()) << gap;
    ASSERT_EQ(found.overlapping.size(), 1u);
    ASSERT_TRUE(found.overlapping[0].rest_distance);
    EXPECT_NEAR(*found.overlapping[0].rest_distance, gap, 1e-12);
    EXPECT_EQ(found.overlapping[0].share, 1);
    ASSERT_EQ(found.notes.size(), 2u);
    for (const std::string& note : found.notes) EXPECT_NE(note.find("left-right"), std::string::npos);
  }
  for (const double gap : {0.0, -0.1, -0.9}) {
    const robot::SelfCollision found = boxes(gap);
    ASSERT_EQ(found.ignored.size(), 1u) << gap;
    EXPECT_EQ(found.ignored[0].reason, IgnoreReason::rest);
    EXPECT_TRUE(found.overlapping.empty() && found.notes.empty());
  }
  // The nearest points may be on edges: an upright one of the left box, and a level one of the other, which is turned
  // by 45 degrees about z and then about its own y, on the diagonal.
  const robot::SelfCollision edges = two_links([](Maker& made, std::size_t left, std::size_t right) {
    made.box(left, {}, {2, 2, 2});
    made.box(right, {}, {2, 2, 2});
    const double c = std::cos(pi / 8), s = std::sin(pi / 8), along = 3 / std::sqrt(2);
    made.robot.links[right].collision[0].origin =
        RigidTransform::from_quaternion(c * c, -s * s, c * s, s * c, {along, along, 0});
  });
  ASSERT_EQ(edges.overlapping.size(), 1u);
  EXPECT_NEAR(edges.overlapping[0].rest_distance.value_or(-1), 3 - 2 * std::sqrt(2.0), 1e-12);
}

TEST(IgnoredPairs, polyhedra_around_round_shapes_do_not_make_them_touch) {
  // Polyhedra around cylinders stick out by up to 0.3 % of the radius.
  const auto cylinders = [](double gap) {
    return two_links([&](Maker& made, std::size_t left, std::size_t right) {
      made.cylinder(left, {}, 1, 1);
      made.cylinder(right, {2 + gap, 0, 0}, 1, 1);
    });
  };
  EXPECT_TRUE(cylinders(1e-4).ignored.empty());
  EXPECT_TRUE(cylinders(1e-2).ignored.empty());
  ASSERT_EQ(cylinders(-2e-2).ignored.size(), 1u);
  // Balls are exact.
  const auto balls = [](double gap) {
    Maker made;
    const std::size_t left = made.slide(0, "left", {}, {1, 0, 0}, 0, 0),
                      right = made.slide(0, "right", {}, {1, 0, 0}, 0, 0);
    robot::Shape ball;
    ball.kind = robot::Shape::Kind::sphere;
    ball.radius = 1;
    made.robot.links[left].collision = {ball};
    ball.origin.translation.x = 2 + gap;
    made.robot.links[right].collision = {ball};
    const robot::RobotSpheres spheres = robot::fit_spheres(made.robot, {.spheres = 1, .padding = 0.1});
    return robot::find_ignored(made.robot, spheres, {.samples = 100}).ignored.size();
  };
  EXPECT_EQ(balls(1e-4), 0u);
  EXPECT_EQ(balls(0), 1u);
  EXPECT_EQ(balls(-1e-4), 1u);
}

// A chain of fixed joints makes one body of a tool and a link that is not its neighbor. Their spheres overlap in every
// configuration, whatever the robot does.
TEST(IgnoredPairs, links_of_one_rigid_body_are_neighbors) {
  for (const bool is_rigid : {true, false}) {
    Maker made;
    const std::size_t arm = made.turn(0, "arm", {}, {0, 0, 1}, -1, 1), flange = made.fix(arm, "flange", {0.3, 0, 0});
    const std::size_t tool = is_rigid ? made.fix(flange, "tool", {0.3, 0, 0})
                                      : made.slide(flange, "tool", {0.3, 0, 0}, {1, 0, 0}, -0.01, 0.01);
    made.box(arm, {}, {0.5, 0.5, 0.5});
    made.box(flange, {}, {0.05, 0.05, 0.05});
    made.box(tool, {}, {0.5, 0.5, 0.5});
    const robot::RobotSpheres spheres = robot::fit_spheres(made.robot, {.spheres = 1});
    const robot::SelfCollision found = robot::find_ignored(made.robot, spheres, {.samples = 100});
    EXPECT_EQ(fate(made.robot, found, "arm", "tool"), is_rigid ? "Adjacent" : "tested");
    EXPECT_EQ(found.overlapping.size(), is_rigid ? 0u : 1u);
  }
}

TEST(IgnoredPairs, an_arm_apart_at_rest_that_hits_the_body_later_is_tested) {
  // Spheres of the body overlap with the arm at rest, the surfaces are 0.05 apart: the arm later turns into the body.
  Maker made;
  const std::size_t body = made.fix(0, "body", {}), arm = made.turn(0, "arm", {0.7, 0, 0}, {0, 1, 0}, -2, 2);
  made.box(body, {}, {1, 1, 1});
  made.box(arm, {-0.1, 0, -0.25}, {0.1, 0.2, 0.5});
  const robot::RobotSpheres spheres = robot::fit_spheres(made.robot, {.spheres = 1});
  const robot::SelfCollision found = robot::find_ignored(made.robot, spheres, {.samples = 500});
  EXPECT_EQ(fate(made.robot, found, "body", "arm"), "tested");
  ASSERT_EQ(found.overlapping.size(), 1u);
  EXPECT_NEAR(found.overlapping[0].rest_distance.value_or(-1), 0.05, 1e-12);
}

TEST(IgnoredPairs, bound_of_samples_is_three_over_their_number) {
  // Eight joints: more than a proof can divide. The arm ends at most 1 from the base, and the post is 1.03 away.
  Maker made;
  std::size_t link = 0;
  for (int i = 0; i < 8; ++i) {
    const Vec3 axis = i % 2 == 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    link = made.turn(link, "l" + std::to_string(i), {0.125, 0, 0}, axis, -0.6, 0.6);
  }
  const std::size_t post = made.fix(0, "post", {});
  made.ball(link, {}, 0.01);
  made.ball(post, {0.9, 0, 0.5}, 0.01);
  const robot::SelfCollision found = robot::find_ignored(made.robot, made.spheres, {.samples = 3000});
  EXPECT_EQ(fate(made.robot, found, "l7", "post"), "Never");
  ASSERT_GE(found.samples, 3000u);
  EXPECT_DOUBLE_EQ(found.never_bound(), 3.0 / static_cast<double>(found.samples));
  EXPECT_EQ(robot::SelfCollision{}.never_bound(), 1);
  // Without samples nothing is claimed that is not proven.
  const robot::SelfCollision proven = robot::find_ignored(made.robot, made.spheres, {.samples = 0});
  EXPECT_EQ(fate(made.robot, proven, "l7", "post"), "tested");
  EXPECT_EQ(proven.never_bound(), 1);
}

/// A chain of joints about random axes between two balls.
struct RandomChain {
  Maker made;
  std::size_t end = 0, post = 0;

  explicit RandomChain(Random& random, std::size_t joints) {
    const auto vector = [&](double scale) {
      return Vec3{random.uniform(-scale, scale), random.uniform(-scale, scale), random.uniform(-scale, scale)};
    };
    // Some joints carry the post, so that both sides of the chain move.
    const std::size_t of_post = joints / 3;
    for (std::size_t i = 0; i < joints; ++i) {
      std::size_t& at = i < of_post ? post : end;
      const double middle = random.uniform(-2, 2),
                   half = random.uniform() < 0.3 ? random.uniform(1.6, 3) : random.uniform(0.1, 1);
      const std::string name = "j" + std::to_string(i);
      at = random.uniform() < 0.25
               ? made.slide(at, name, vector(1), normalized(vector(1)), middle - half, middle + half)
               : made.turn(at, name, vector(1), normalized(vector(1)), middle - half, middle + half);
    }
    end = made.fix(end, "end", vector(1));
    post = made.fix(post, "post", vector(1));
  }

  double distance(std::span<const double> values) const {
    const std::vector<RigidTransform> poses = robot::link_poses(made.robot, values);
    return morula::distance(poses[end].translation, poses[post].translation);
  }

  /// The least distance of the centers that a search of its own finds: random points, each improved along single
  /// joints.
  double least(Random& random) const {
    double best = std::numeric_limits<double>::infinity();
    const auto& joints = made.robot.joints;
    for (int start = 0; start < 60; ++start) {
      std::vector<double> values;
      for (const std::size_t j : made.robot.independent_joints)
        values.push_back(random.uniform(joints[j].lower, joints[j].upper));
      double here = distance(values);
      for (double step = 0.5; step > 1e-4; step /= 2) {
        for (int sweep = 0; sweep < 2; ++sweep) {
          for (std::size_t c = 0; c < values.size(); ++c) {
            for (const double by : {-step, step}) {
              const double old = values[c];
              values[c] = std::clamp(old + by, joints[made.robot.independent_joints[c]].lower,
                                     joints[made.robot.independent_joints[c]].upper);
              const double there = distance(values);
              if (there < here) {
                here = there;
              } else {
                values[c] = old;
              }
            }
          }
        }
      }
      best = std::min(best, here);
    }
    return best;
  }

  robot::Verdict proven(double radius, std::size_t boxes) const {
    const robot::JointRanges ranges = robot::joint_ranges(made.robot, 10);
    const robot::PairChain chain = robot::chain_of(made.robot, ranges, end, post);
    const std::array<Sphere, 1> ball{Sphere{{}, radius}};
    const robot::SphereGroup group = robot::group_of(ball);
    return robot::prove_apart({chain, ranges, group, group}, boxes, {});
  }
};

TEST(ProveApart, holds_on_random_chains_up_to_the_distance_that_they_reach) {
  Random random(11);
  int apart = 0, chains = 0;
  for (std::size_t joints = 1; joints <= 4; ++joints) {
    for (int k = 0; k < 12; ++k) {
      const RandomChain chain(random, joints);
      const double least = chain.least(random);
      if (least < 0.2) continue;
      ++chains;
      // Balls that just meet in a configuration that the search knows are never apart.
      EXPECT_NE(chain.proven(0.5 * least * (1 + 1e-6), 3000), robot::Verdict::apart) << joints << " " << least;
      EXPECT_NE(chain.proven(0.5 * least * (1 + 1e-2), 3000), robot::Verdict::apart) << joints << " " << least;
      // A tenth less is, unless the search has missed the least distance.
      apart += chain.proven(0.5 * least * 0.9, 20'000) == robot::Verdict::apart;
    }
  }
  EXPECT_GT(chains, 15);
  EXPECT_GT(apart, chains * 2 / 3);
}

TEST(ProveApart, one_box_reaches_to_the_ends_of_every_range) {
  // Balls that overlap by little at the farthest place, in the direction in which the other ball stands.
  const auto verdict = [](const Maker& made, std::size_t arm, std::size_t post, const Vec3& at, const Vec3& other,
                          double radius) {
    const robot::JointRanges ranges = robot::joint_ranges(made.robot, 10);
    const robot::PairChain chain = robot::chain_of(made.robot, ranges, arm, post);
    const std::array<Sphere, 1> a{Sphere{at, radius}}, b{Sphere{other, radius}};
    const robot::SphereGroup group_a = robot::group_of(a), group_b = robot::group_of(b);
    // From both sides: the joint carries one link, and not the other.
    const robot::PairChain back = robot::chain_of(made.robot, ranges, post, arm);
    const robot::Verdict there = robot::prove_apart({chain, ranges, group_a, group_b}, 1, {});
    EXPECT_EQ(robot::prove_apart({back, ranges, group_b, group_a}, 1, {}), there);
    return there;
  };
  constexpr double radius = 0.01;
  for (const double missing : {-1e-4, 1e-4}) {
    SCOPED_TRACE(missing);
    const auto expect = [&](const robot::Verdict found) { EXPECT_EQ(found == robot::Verdict::apart, missing > 0); };
    const double apart = 2 * radius + missing;
    for (const double half : {0.3, 1.0, 1.5}) {
      Maker made;
      const std::size_t arm = made.turn(0, "arm", {}, {0, 0, 1}, -half, half), post = made.fix(0, "post", {});
      expect(verdict(made, arm, post, {1, 0, 0}, {std::cos(half), std::sin(half) + apart, 0}, radius));
    }
    for (const double half : {1.6, 2.0, 3.0}) {
      Maker made;
      const std::size_t arm = made.turn(0, "arm", {}, {0, 0, 1}, -half, half), post = made.fix(0, "post", {});
      expect(verdict(made, arm, post, {1, 0, 0.5}, {0, 1 + apart, 0.5}, radius));
    }
    Maker made;
    const std::size_t cart = made.slide(0, "cart", {}, {0, 0, 1}, -2, 3), post = made.fix(0, "post", {});
    expect(verdict(made, cart, post, {}, {0, 0, 3 + apart}, radius));
    expect(verdict(made, cart, post, {}, {0, 0, -2 - apart}, radius));
    // One after the other: the arm is straight at the end of its range.
    Maker two;
    const std::size_t upper = two.turn(0, "upper", {}, {0, 0, 1}),
                      lower = two.turn(upper, "lower", {1, 0, 0}, {0, 0, 1}), far = two.fix(0, "far", {});
    expect(verdict(two, lower, far, {0.5, 0, 0}, {0, 1.5 + apart, 0}, radius));
  }
}

TEST(ProveApart, allows_for_rounding) {
  // Balls that touch exactly, at places that decimals do not hold: ten links of 0.1 beside one of 1.
  Maker made;
  std::size_t link = 0;
  for (int i = 0; i < 10; ++i) link = made.fix(link, "l" + std::to_string(i), {0.1, 0.1, 0.1});
  const std::size_t post = made.fix(0, "post", {1, 1, 1.25});
  const robot::JointRanges ranges = robot::joint_ranges(made.robot, 10);
  const robot::PairChain chain = robot::chain_of(made.robot, ranges, link, post);
  const auto verdict = [&](double more) {
    const std::array<Sphere, 1> ball{Sphere{{}, 0.125 - more}};
    const robot::SphereGroup group = robot::group_of(ball);
    return robot::prove_apart({chain, ranges, group, group}, 10, {});
  };
  std::vector<robot::PlacedJoint> unused;
  const RigidTransform at = robot::place(chain.a, {}, unused), other = robot::place(chain.b, {}, unused);
  ASSERT_GT(distance(at.translation, other.translation), 0.25) << "this is what rounding makes of 0.25";
  EXPECT_NE(verdict(0), robot::Verdict::apart);
  EXPECT_EQ(verdict(1e-6), robot::Verdict::apart);
}

TEST(IgnoredPairs, same_result_for_any_number_of_workers_and_every_run) {
  const robot::Robot arm = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
  const robot::RobotSpheres spheres = robot::fit_spheres(arm, {.spheres = 6});
  const auto list = [&](unsigned threads, std::uint64_t seed) {
    Workers workers(threads);
    const robot::SelfCollision found = robot::find_ignored(arm, spheres, {.samples = 3000, .seed = seed}, workers);
    std::vector<std::array<std::size_t, 3>> pairs;
    for (const robot::IgnoredPair& p : found.ignored) pairs.push_back({p.a, p.b, static_cast<std::size_t>(p.reason)});
    pairs.push_back({found.samples, found.pairs, found.overlapping.size()});
    return std::pair(pairs, found.notes);
  };
  const auto one = list(1, 4);
  for (const unsigned threads : {1u, 2u, 3u, 8u}) EXPECT_EQ(list(threads, 4), one) << threads;
}

TEST(IgnoredPairs, tells_its_progress_and_stops_on_request) {
  const robot::Robot arm = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
  const robot::RobotSpheres spheres = robot::fit_spheres(arm, {.spheres = 2});
  double last = 0;
  robot::find_ignored(arm, spheres, {.samples = 2000, .progress = [&](double share) {
                                       EXPECT_GE(share, last);
                                       EXPECT_LE(share, 1);
                                       last = share;
                                     }});
  EXPECT_EQ(last, 1);
  for (const double at : {0.0, 0.1, 0.5}) {
    StopSource stop;
    const auto run = [&] {
      robot::find_ignored(arm, spheres, {.samples = 1'000'000, .stop = stop.get_token(), .progress = [&](double share) {
                                           if (share >= at) stop.request_stop();
                                         }});
    };
    EXPECT_THROW(run(), BuildStopped) << at;
  }
}

}  // namespace
}  // namespace morula::test
