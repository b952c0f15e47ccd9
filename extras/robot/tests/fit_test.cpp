// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <morula/robot/fit.hpp>
#include <support/scratch_folder.hpp>

#include "expect_covered.hpp"

namespace morula::test {
namespace {

const robot::Robot arm_robot = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
const robot::Robot gripper_robot = robot::read_robot(MORULA_ROBOTS "/gripper_description/urdf/gripper.urdf");

TEST(FitSpheres, cover_every_link_also_when_numbers_are_read_as_float) {
  for (const std::size_t count : {1, 2, 7, 24}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(arm_robot, {.spheres = count});
    ASSERT_EQ(fitted.links.size(), 7u) << "the tool has no shapes";
    expect_covered(fitted);
    for (const robot::LinkSpheres& link : fitted.links) {
      EXPECT_LE(link.spheres.size(), std::max<std::size_t>(count, link.surface.spheres.size() + 1));
      EXPECT_GE(link.figures.protrusion_max, link.figures.protrusion_p95);
      EXPECT_GE(link.figures.protrusion_p95, 0);
    }
  }
}

TEST(FitSpheres, a_link_that_is_a_sphere_gets_that_sphere) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm_robot, {.spheres = 16});
  const robot::LinkSpheres& elbow = *fitted.of(arm_robot.find_link("elbow"));
  ASSERT_EQ(elbow.spheres.size(), 1u);
  EXPECT_LT(distance(elbow.spheres[0].center, {0, 0, 0.02}), 1e-9);
  EXPECT_NEAR(elbow.spheres[0].radius, 0.06, 1e-7);
  EXPECT_GE(elbow.spheres[0].radius, 0.06);
}

TEST(FitSpheres, wishes_are_kept) {
  const robot::FitOptions plain{.spheres = 6};
  const robot::RobotSpheres base = robot::fit_spheres(gripper_robot, plain);
  robot::FitOptions o = plain;
  o.padding = 0.01;
  const robot::RobotSpheres padded = robot::fit_spheres(gripper_robot, o);
  for (std::size_t i = 0; i < base.links.size(); ++i) {
    ASSERT_EQ(padded.links[i].spheres.size(), base.links[i].spheres.size());
    for (std::size_t k = 0; k < base.links[i].spheres.size(); ++k) {
      EXPECT_NEAR(padded.links[i].spheres[k].radius, base.links[i].spheres[k].radius + 0.01, 2e-7);
    }
  }
  o = plain;
  o.min_radius = 0.02;
  for (const robot::LinkSpheres& link : robot::fit_spheres(gripper_robot, o).links) {
    for (const Sphere& s : link.spheres) EXPECT_GE(s.radius, 0.02);
  }
  o = plain;
  o.max_radius = 0.02;
  const robot::RobotSpheres small = robot::fit_spheres(gripper_robot, o);
  expect_covered(small);
  for (const robot::LinkSpheres& link : small.links) {
    for (const Sphere& s : link.spheres) EXPECT_LE(s.radius, 0.02 + 1e-6);
  }
  o = plain;
  o.skip = {"palm"};
  o.link_spheres = {{"left", 2}};
  const robot::RobotSpheres some = robot::fit_spheres(gripper_robot, o);
  EXPECT_EQ(some.of(gripper_robot.find_link("palm")), nullptr);
  EXPECT_LE(some.of(gripper_robot.find_link("left"))->spheres.size(), 2u);
  EXPECT_EQ(some.of(gripper_robot.find_link("right"))->spheres, base.of(gripper_robot.find_link("right"))->spheres);
}

TEST(FitSpheres, protrusion_asked_for_is_reached) {
  const robot::RobotSpheres fitted = robot::fit_spheres(arm_robot, {.spheres = 0, .max_protrusion = 0.01});
  expect_covered(fitted);
  for (const robot::LinkSpheres& link : fitted.links) EXPECT_LE(link.figures.protrusion_max, 0.01 + 1e-6);
}

TEST(FitSpheres, messages_name_the_arguments) {
  const auto said = [](const robot::FitOptions& options) -> std::string {
    try {
      robot::fit_spheres(gripper_robot, options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said({.padding = -1}), "padding: -1 is not a number from 0 on");
  EXPECT_EQ(said({.min_radius = std::nan("")}), "min_radius: nan is not a number from 0 on");
  EXPECT_EQ(said({.max_radius = 0}), "max_radius: 0 is not a number above 0");
  EXPECT_EQ(said({.min_radius = 2, .max_radius = 1}), "max_radius: 1 is below min_radius, 2");
  EXPECT_EQ(said({.max_protrusion = -2}), "max_protrusion: -2 is not a number above 0");
  EXPECT_EQ(said({.clip_margin = 0}), "clip_margin: 0 is not a number above 0");
  EXPECT_EQ(said({.density = 0}), "density: 0 is not a number above 0");
  EXPECT_EQ(said({.spheres = 0}), "spheres: 0 requires max_protrusion or max_protrusion_share");
  EXPECT_EQ(said({.link_spheres = {{"palm", 0}}}), "link_spheres: 0 of link palm; skip the link instead");
  EXPECT_EQ(said({.skip = {"plam"}}), "skip: the robot has no link plam");
}

TEST(FitSpheres, progress_ascends_and_ends_at_1_once) {
  Workers three(3);
  for (const std::optional<std::size_t> total : {std::optional<std::size_t>(), std::optional<std::size_t>(30)}) {
    std::vector<double> shares;
    robot::FitOptions o{.spheres = 2, .max_total = total, .quality = Quality::draft};
    o.link_spheres = {{"forearm", 3}};
    o.progress = [&](double share, const std::string&) { shares.push_back(share); };
    const robot::RobotSpheres fitted = robot::fit_spheres(arm_robot, o, three);
    ASSERT_FALSE(shares.empty());
    EXPECT_GT(shares[0], 0);
    for (std::size_t i = 1; i < shares.size(); ++i) EXPECT_LT(shares[i - 1], shares[i]);
    EXPECT_EQ(shares.back(), 1);
    const auto groups = static_cast<std::size_t>(
        std::count_if(fitted.links.begin(), fitted.links.end(),
                      [](const robot::LinkSpheres& link) { return link.same_shape_as == robot::none; }));
    EXPECT_EQ(shares.size(), total ? 2 * groups - 1 : groups) << "the link with a number of its own takes no share";
  }
}

TEST(FitSpheres, links_alike_share_and_one_refitted_alone_keeps_the_others) {
  const robot::RobotSpheres fitted = robot::fit_spheres(gripper_robot, {.spheres = 5});
  const robot::LinkSpheres &left = *fitted.of(gripper_robot.find_link("left")),
                           &right = *fitted.of(gripper_robot.find_link("right"));
  EXPECT_EQ(right.same_shape_as, left.link);
  EXPECT_EQ(right.spheres, left.spheres);
  robot::FitOptions o{.spheres = 9};
  for (const robot::LinkSpheres& link : fitted.links) {
    if (gripper_robot.links[link.link].name != "left")
      o.fixed_spheres[gripper_robot.links[link.link].name] = link.spheres;
  }
  const robot::RobotSpheres again = robot::fit_spheres(gripper_robot, o);
  for (std::size_t i = 0; i < again.links.size(); ++i) {
    const bool refitted = again.links[i].link == left.link;
    EXPECT_EQ(again.links[i].spheres == fitted.links[i].spheres, !refitted);
  }
  // What is kept is judged by the shapes, not believed.
  o.fixed_spheres["palm"] = {Sphere{{0, 0, 0}, 0.01}};
  const robot::RobotSpheres bare = robot::fit_spheres(gripper_robot, o);
  EXPECT_FALSE(bare.covered());
  EXPECT_NEAR(bare.of(gripper_robot.find_link("palm"))->figures.uncovered_distance,
              std::sqrt(0.05 * 0.05 + 0.03 * 0.03 + 0.02 * 0.02) - 0.01, 1e-6);
}

TEST(FitSpheres, kept_spheres_cover_only_where_they_do_so_as_floats) {
  robot::Robot ball;
  ball.name = "ball";
  ball.root = 0;
  ball.links.resize(1);
  ball.links[0].name = "ball";
  robot::Shape shape;
  shape.kind = robot::Shape::Kind::sphere;
  shape.radius = 0.7;  // as a float it is less
  ball.links[0].collision = {shape};
  const auto kept = [&](double radius) {
    return robot::fit_spheres(ball, {.fixed_spheres = {{"ball", {Sphere{{0, 0, 0}, radius}}}}});
  };
  EXPECT_FALSE(kept(0.7).covered());
  EXPECT_GT(kept(0.7).links[0].figures.uncovered_distance, 0);
  EXPECT_LT(kept(0.7).links[0].figures.uncovered_distance, 1e-6);
  EXPECT_NEAR(kept(0.45).links[0].figures.uncovered_distance, 0.25, 1e-6);
  EXPECT_TRUE(kept(0.701).covered());
  EXPECT_EQ(kept(0.701).links[0].figures.uncovered_distance, 0);
  // The sphere that reaches farthest out of all given ones counts, next to a polyhedron that is covered.
  robot::Robot both = ball;
  robot::Shape box;
  box.kind = robot::Shape::Kind::box;
  box.size = {0.2, 0.2, 0.2};
  shape.origin.translation = {3, 0, 0};
  both.links[0].collision = {shape, box};
  const std::vector<Sphere> given{{{0, 0, 0}, 1}, {{3, 0, 0.5}, 0.7}};
  const robot::RobotSpheres apart = robot::fit_spheres(both, {.fixed_spheres = {{"ball", given}}});
  EXPECT_FALSE(apart.covered());
  EXPECT_NEAR(apart.links[0].figures.uncovered_distance, 0.5, 1e-6);
  shape.origin = {};
  // So for polyhedra: the corner of a box, and the sphere through it.
  shape.kind = robot::Shape::Kind::box;
  shape.size = {2.4, 3.2, 0.0001};
  ball.links[0].collision = {shape};
  const double corner = length(0.5 * shape.size) * (1 + 1e-15);
  ASSERT_LT(static_cast<float>(corner), length(0.5 * shape.size));
  EXPECT_FALSE(kept(corner).covered());
  EXPECT_GT(kept(corner).links[0].figures.uncovered_distance, 0);
  EXPECT_TRUE(kept(corner * (1 + 1e-6)).covered());
}

TEST(FitSpheres, same_bits_for_any_number_of_workers) {
  Workers three(3);
  const robot::RobotSpheres one = robot::fit_spheres(arm_robot, {.max_total = 50}),
                            many = robot::fit_spheres(arm_robot, {.max_total = 50}, three);
  ASSERT_EQ(one.links.size(), many.links.size());
  for (std::size_t i = 0; i < one.links.size(); ++i) EXPECT_EQ(one.links[i].spheres, many.links[i].spheres);
}

TEST(FitSpheres, refuses_what_makes_no_sense) {
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.skip = {"nobody"}}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.link_spheres = {{"base", 0}}}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.padding = -1}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.min_radius = 2, .max_radius = 1}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.spheres = 0}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.fixed_spheres = {{"base", {}}}}), std::invalid_argument);
  // Absent limits are absent, not 0.
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.max_total = 0}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.max_protrusion = 0}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.max_protrusion_share = 0}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.max_radius = 0}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(arm_robot, {.clip_margin = 0}), std::invalid_argument);
}

TEST(FitSpheres, every_method_fits_with_the_options_as_they_are) {
  for (const Method method : all_methods()) {
    const robot::RobotSpheres fitted =
        robot::fit_spheres(gripper_robot, {.spheres = 6, .skip = {"left"}, .method = method});
    EXPECT_TRUE(fitted.covered()) << name(method);
    const robot::RobotSpheres standard =
        robot::fit_spheres(gripper_robot, {.spheres = 6,
                                           .skip = {"left"},
                                           .method = method,
                                           .quality = method == Method::optimized ? Quality::fast : Quality::standard});
    ASSERT_EQ(fitted.links.size(), standard.links.size());
    for (std::size_t i = 0; i < fitted.links.size(); ++i)
      EXPECT_EQ(fitted.links[i].spheres, standard.links[i].spheres) << name(method);
  }
  try {
    robot::fit_spheres(gripper_robot, {.method = Method::grid, .quality = Quality::fast});
    ADD_FAILURE() << "a quality that the method does not have";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(),
                 "quality fast is for method optimized; method grid has one way only: leave the quality out");
  }
}

TEST(FitSpheres, flat_shapes_are_covered_and_empty_ones_passed_over) {
  const ScratchFolder scratch;
  scratch.file("nothing.stl", std::string(80, ' '));
  scratch.file("none.stl", std::string(84, '\0'));
  const auto fitted = [&](const std::string& shapes) {
    scratch.file("r.urdf",
                 "<robot name='r'><link name='a'><collision><geometry><sphere radius='1'/></geometry>"
                 "</collision></link><link name='b'>" +
                     shapes +
                     "</link><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>");
    const robot::Robot read = robot::read_robot(scratch.path() / "r.urdf");
    return robot::fit_spheres(read, {.spheres = 4, .quality = Quality::draft});
  };
  const auto shape = [](const std::string& geometry) {
    return "<collision><geometry>" + geometry + "</geometry></collision>";
  };
  for (const char* flat : {"<box size='1 2 0'/>", "<box size='0 1 2'/>", "<cylinder radius='1' length='0'/>"}) {
    const robot::RobotSpheres spheres = fitted(shape(flat));
    ASSERT_EQ(spheres.links.size(), 2u) << flat;
    EXPECT_TRUE(spheres.links[1].figures.covered) << flat;
    EXPECT_LE(spheres.links[1].spheres.size(), 4u) << flat;
    expect_covered<double>(spheres.links[1], 1);
  }
  for (const char* file : {"nothing.stl", "none.stl"}) {
    const std::string mesh = shape(std::string("<mesh filename='") + file + "'/>");
    const robot::RobotSpheres spheres = fitted(mesh);
    EXPECT_EQ(spheres.links.size(), 1u);
    ASSERT_EQ(spheres.notes.size(), 2u);
    EXPECT_EQ(spheres.notes[0], std::string("link b: mesh ") + file + " (line 1) has no facet and is left out");
    const robot::RobotSpheres both = fitted(mesh + shape("<box size='1 1 1'/>"));
    ASSERT_EQ(both.links.size(), 2u);
    EXPECT_EQ(both.notes.size(), 1u);
  }
  // Cut short is not empty.
  scratch.file("cut.stl", std::string(80, ' ') + std::string("\2\0\0\0", 4));
  EXPECT_THROW(fitted(shape("<mesh filename='cut.stl'/>")), FileError);
}

}  // namespace
}  // namespace morula::test
