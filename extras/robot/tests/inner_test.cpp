// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Inner spheres, held against shapes by their equations and against meshes by counting crossings of rays; clip planes,
// held against samples of what they keep.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/robot/output.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <support/meshes.hpp>
#include <support/parity.hpp>
#include <support/scratch_folder.hpp>

namespace morula::test {
namespace {

const robot::Robot the_arm = robot::read_robot(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
const robot::Robot the_gripper = robot::read_robot(MORULA_ROBOTS "/gripper_description/urdf/gripper.urdf");

/// Is a point of a link inside a shape, by the shape's own equation?
bool is_inside(const robot::Robot& robot, const robot::Shape& shape, const Vec3& point) {
  const Vec3 p = inverse(shape.origin)(point);
  const double across = std::hypot(p.x, p.y);
  switch (shape.kind) {
    case robot::Shape::Kind::box:
      return std::abs(p.x) <= 0.5 * shape.size.x && std::abs(p.y) <= 0.5 * shape.size.y &&
             std::abs(p.z) <= 0.5 * shape.size.z;
    case robot::Shape::Kind::cylinder:
      return across <= shape.radius && std::abs(p.z) <= 0.5 * shape.length;
    case robot::Shape::Kind::capsule:
      return std::hypot(across, std::max(0.0, std::abs(p.z) - 0.5 * shape.length)) <= shape.radius;
    case robot::Shape::Kind::sphere:
      return length(p) <= shape.radius;
    case robot::Shape::Kind::ellipsoid:
      return std::pow(2 * p.x / shape.size.x, 2) + std::pow(2 * p.y / shape.size.y, 2) +
                 std::pow(2 * p.z / shape.size.z, 2) <=
             1;
    case robot::Shape::Kind::mesh:
      break;
  }
  return parity_inside(robot::surface_of(robot.file, std::span(&shape, 1)).mesh, point);
}

/// Points of a sphere's surface as floats have it.
std::vector<Vec3> points_of(const Sphere& s, Random& random, int count = 60) {
  const Vec3 center(Vec3f(s.center));
  const auto radius = static_cast<double>(static_cast<float>(s.radius));
  std::vector<Vec3> points;
  for (int k = 0; k < count; ++k) {
    points.push_back(center +
                     radius * normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}));
  }
  return points;
}

TEST(InnerSpheres, every_one_is_inside_a_shape_of_its_link) {
  for (const robot::Robot* robot : {&the_arm, &the_gripper}) {
    Random random(3);
    const robot::RobotSpheres fitted = robot::fit_spheres(*robot, {.spheres = 2, .inner = 6});
    for (const robot::LinkSpheres& link : fitted.links) {
      const robot::Link& own = robot->links[link.link];
      EXPECT_FALSE(link.inner.empty()) << own.name;
      EXPECT_LE(link.inner.size(), 6u);
      EXPECT_GT(link.inner_volume, 0) << own.name;
      for (const Sphere& s : link.inner) {
        for (const Vec3& p : points_of(s, random)) {
          EXPECT_TRUE(std::any_of(own.collision.begin(), own.collision.end(), [&](const robot::Shape& shape) {
            return is_inside(*robot, shape, p);
          })) << own.name;
        }
      }
    }
  }
}

// Two meshes, each by itself a solid, and one mesh of the same facets, of which the inner ones are a cavity.
TEST(InnerSpheres, a_cavity_is_not_filled_because_another_link_has_the_same_facets) {
  const ScratchFolder folder;
  const Mesh wall = box_mesh({-1, -1, -1}, {1, 1, 1}, 2),
             hole = inverted(box_mesh({-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}));
  write_mesh(folder.path() / "wall.obj", wall);
  write_mesh(folder.path() / "hole.obj", hole);
  write_mesh(folder.path() / "both.obj", joined(wall, hole));
  robot::Robot robot;
  robot.name = "hollow";
  robot.file = folder.path() / "hollow.urdf";
  robot.root = 0;
  const auto shape = [&](const char* name) {
    robot::Shape mesh;
    mesh.file = folder.path() / name;
    return mesh;
  };
  robot.links.resize(2);
  robot.links[0].name = "solid", robot.links[0].collision = {shape("wall.obj"), shape("hole.obj")};
  robot.links[1].name = "hollow", robot.links[1].collision = {shape("both.obj")};
  const robot::RobotSpheres fitted = robot::fit_spheres(robot, {.spheres = 2, .inner = 6});
  ASSERT_EQ(fitted.links.size(), 2u);
  ASSERT_EQ(fitted.links[0].surface.mesh.facets, fitted.links[1].surface.mesh.facets);
  EXPECT_GT(fitted.links[0].inner.at(0).radius, 0.99);
  ASSERT_FALSE(fitted.links[1].inner.empty());
  for (const Sphere& s : fitted.links[1].inner) EXPECT_LE(s.radius, 0.13);  // in a corner of the wall
}

TEST(InnerSpheres, the_largest_fits_tightly_and_more_fill_more) {
  const std::size_t palm = the_gripper.find_link("palm"), forearm = the_arm.find_link("forearm");
  // The largest ball of a box touches its two nearest sides; that of a capsule has the capsule's radius.
  const auto largest = [](const robot::LinkSpheres& link) {
    double radius = 0;
    for (const Sphere& s : link.inner) radius = std::max(radius, s.radius);
    return radius;
  };
  const robot::RobotSpheres gripper = robot::fit_spheres(the_gripper, {.spheres = 2, .inner = 8});
  EXPECT_NEAR(largest(*gripper.of(palm)), 0.02, 2e-4);
  double before = 0;
  for (const std::size_t count : {1u, 4u, 16u}) {
    const robot::RobotSpheres arm = robot::fit_spheres(the_arm, {.spheres = 2, .inner = count});
    const robot::LinkSpheres& link = *arm.of(forearm);
    EXPECT_NEAR(largest(link), 0.04, 4e-4);
    EXPECT_GT(link.inner_volume, before);
    before = link.inner_volume;
  }
  // Of the capsule's volume.
  EXPECT_GT(before, 0.9 * (std::numbers::pi * 0.04 * 0.04 * 0.2 + 4.0 / 3 * std::numbers::pi * 0.04 * 0.04 * 0.04));
  EXPECT_EQ(robot::fit_spheres(the_arm, {.spheres = 2}).inner_count(), 0u) << "none where none are asked for";
}

/// A cube about a center as facets of an OBJ, each with vertices of its own; turned: facing inwards.
std::string cube(double half, const Vec3& center, bool turned, int& vertices, std::size_t facets = 12) {
  constexpr std::array<std::array<int, 3>, 12> corners{{{0, 2, 3},
                                                        {0, 3, 1},
                                                        {4, 5, 7},
                                                        {4, 7, 6},
                                                        {0, 1, 5},
                                                        {0, 5, 4},
                                                        {2, 6, 7},
                                                        {2, 7, 3},
                                                        {0, 4, 6},
                                                        {0, 6, 2},
                                                        {1, 3, 7},
                                                        {1, 7, 5}}};
  std::ostringstream text;
  for (std::size_t f = 0; f < facets; ++f) {
    for (const int c : corners[f]) {
      text << "v " << center.x + (c & 1 ? half : -half) << ' ' << center.y + (c & 2 ? half : -half) << ' '
           << center.z + (c & 4 ? half : -half) << '\n';
    }
    vertices += 3;
    text << "f " << vertices - (turned ? 0 : 2) << ' ' << vertices - 1 << ' ' << vertices - (turned ? 2 : 0) << '\n';
  }
  return text.str();
}

std::vector<Sphere> inner_of(const std::string& obj) {
  const ScratchFolder folder;
  folder.file("m.obj", obj);
  const std::filesystem::path urdf = folder.file("r.urdf",
                                                 "<robot name='r'><link name='l'><collision><geometry><mesh "
                                                 "filename='m.obj'/></geometry></collision></link></robot>");
  return robot::fit_spheres(robot::read_robot(urdf), {.spheres = 1, .inner = 12}).links.at(0).inner;
}

/// Within a cube, all of it?
bool in_cube(const Sphere& s, double half, const Vec3& center) {
  return max_norm(s.center - center) + s.radius <= half;
}
bool meets_cube(const Sphere& s, double half, const Vec3& center) {
  const auto beyond = [&](double x) { return std::max(0.0, std::abs(x) - half); };
  const Vec3 p = s.center - center;
  return length(Vec3{beyond(p.x), beyond(p.y), beyond(p.z)}) < s.radius;
}

TEST(InnerSpheres, meshes_of_unjoined_facets_cavities_and_pieces_that_face_inwards) {
  int n = 0;
  for (const Sphere& s : inner_of(cube(1, {}, false, n))) EXPECT_TRUE(in_cube(s, 1, {}));
  n = 0;
  EXPECT_FALSE(inner_of(cube(1, {}, true, n)).empty()) << "the whole faces inwards";
  n = 0;
  const std::vector<Sphere> hollow = inner_of(cube(1, {}, false, n) + cube(0.5, {}, true, n));
  EXPECT_FALSE(hollow.empty());
  for (const Sphere& s : hollow) EXPECT_TRUE(in_cube(s, 1, {}) && !meets_cube(s, 0.5, {}));
  n = 0;
  const std::vector<Sphere> apart = inner_of(cube(1, {}, false, n) + cube(0.5, {3, 0, 0}, true, n));
  EXPECT_FALSE(apart.empty());
  for (const Sphere& s : apart) EXPECT_TRUE(in_cube(s, 1, {}) || in_cube(s, 0.5, {3, 0, 0}));
  n = 0;
  // Two that overlap: no ball is kept small by a side of the other.
  const std::vector<Sphere> both = inner_of(cube(1, {}, false, n) + cube(1, {1.2, 0.1, 0.1}, false, n));
  double largest = 0;
  for (const Sphere& s : both) {
    EXPECT_TRUE(in_cube(s, 1, {}) || in_cube(s, 1, {1.2, 0.1, 0.1}));
    largest = std::max(largest, s.radius);
  }
  EXPECT_GT(largest, 0.95);
}

TEST(InnerSpheres, an_open_surface_has_no_inside_and_closed_ones_beside_it_do) {
  int n = 0;
  EXPECT_TRUE(inner_of(cube(1, {}, false, n, 10)).empty());
  n = 0;
  const std::vector<Sphere> some = inner_of(cube(1, {}, false, n, 10) + cube(0.5, {5, 0, 0}, false, n));
  EXPECT_FALSE(some.empty());
  for (const Sphere& s : some) EXPECT_TRUE(in_cube(s, 0.5, {5, 0, 0}));
}

TEST(InnerSpheres, files_have_them_in_the_place_of_those_that_cover) {
  const robot::RobotSpheres fitted = robot::fit_spheres(the_gripper, {.spheres = 2, .inner = 3});
  const robot::RobotSpheres inner = fitted.with_inner_spheres();
  ASSERT_EQ(inner.links.size(), 4u);
  for (const robot::LinkSpheres& link : inner.links) EXPECT_EQ(link.spheres, fitted.of(link.link)->inner);
  robot::OutputOptions options{.folder = "out", .inner = true};
  const robot::SelfCollision none;
  for (const robot::OutputFormat& format : robot::output_formats()) {
    const std::string text = format.write({the_gripper, inner, none, options}).at(0).bytes;
    EXPECT_EQ(text.find("they are inside the links and do not cover them") != std::string::npos,
              text.starts_with("<?xml") || text.starts_with("#"))
        << format.name;
  }
  const auto json = nlohmann::json::parse(
      robot::output_format("json")->write({the_gripper, fitted, none, {.folder = "out"}}).at(0).bytes);
  EXPECT_EQ(json["links"][0]["inner_spheres"].size(), fitted.links[0].inner.size());
  EXPECT_EQ(json["links"][0]["inner_spheres"][0]["radius"], fitted.links[0].inner[0].radius);
}

TEST(InnerSpheres, a_robot_of_inner_spheres_keeps_its_shapes_and_all_notes) {
  const ScratchFolder folder;
  Mesh open = box_mesh({-1, -1, -1}, {1, 1, 1}, 1);
  open.facets.pop_back();
  write_mesh(folder.path() / "open.obj", open);
  robot::Robot robot;
  robot.name = "mixed";
  robot.file = folder.path() / "mixed.urdf";
  robot.root = 0;
  robot.links.resize(3);
  const char* names[] = {"closed", "open", "empty"};
  for (std::size_t i = 0; i < 3; ++i) robot.links[i].name = names[i];
  robot::Shape ball, mesh;
  ball.kind = robot::Shape::Kind::sphere;
  ball.radius = 1;
  mesh.file = folder.path() / "open.obj";
  robot.links[0].visual = {ball};
  robot.links[1].visual = {mesh};
  robot.links[2].visual = {ball};
  const robot::FitOptions options{
      .spheres = 4, .visual = true, .clip = {{"empty", {{{0, 0, 1}, 2}}}}, .inner = 2, .quality = Quality::draft};
  const robot::RobotSpheres fitted = robot::fit_spheres(robot, options);
  ASSERT_EQ(fitted.links.size(), 2u);
  const robot::RobotSpheres inner = fitted.with_inner_spheres();
  ASSERT_EQ(inner.links.size(), 1u);
  EXPECT_TRUE(inner.visual);
  EXPECT_EQ(inner.links[0].notes, fitted.links[0].notes);
  ASSERT_EQ(fitted.notes.size(), 1u);
  EXPECT_EQ(inner.notes,
            (std::vector<std::string>{fitted.notes[0], "link open has no inner spheres: no surface of it is closed"}));
}

/// Are points of what a plane keeps of the link's shapes all in spheres, and is something left out?
void expect_kept_is_covered(const robot::Robot& robot, const robot::LinkSpheres& link, const robot::ClipPlane& plane,
                            double margin) {
  Random random(5);
  const robot::LinkSurface whole = robot::surface_of(robot.file, robot.links[link.link].collision);
  const auto check = [&](const Vec3& p) {
    if (dot(plane.normal, p) < plane.offset + margin) return;
    EXPECT_TRUE(std::any_of(link.spheres.begin(), link.spheres.end(), [&](const Sphere& s) {
      return distance(Vec3(Vec3f(s.center)), p) <= static_cast<double>(static_cast<float>(s.radius));
    }));
  };
  for (std::size_t f = 0; f < whole.mesh.facet_count(); ++f) {
    const auto [a, b, c] = whole.mesh.corners(f);
    for (int k = 0; k < 200; ++k) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      check(a + u * (b - a) + v * (c - a));
    }
  }
  for (const Sphere& own : whole.spheres) {
    for (const Vec3& p : points_of({own.center, own.radius * (1 - 1e-6)}, random, 500)) check(p);
  }
}

TEST(ClipPlanes, what_is_kept_is_covered_and_the_rest_is_left_out) {
  int cut = 0;
  for (const char* name : {"base", "shoulder", "elbow", "forearm", "flange"}) {
    const std::size_t link = the_arm.find_link(name);
    const robot::ClipPlane plane{normalized(Vec3{0.3, -0.2, 1}), 0.04};
    const robot::RobotSpheres fitted = robot::fit_spheres(the_arm, {.spheres = 6, .clip = {{name, {plane}}}});
    EXPECT_TRUE(fitted.covered());
    expect_kept_is_covered(the_arm, *fitted.of(link), plane, 0);
    const robot::RobotSpheres whole = robot::fit_spheres(the_arm, {.spheres = 6});
    EXPECT_LE(fitted.of(link)->figures.solid.volume, whole.of(link)->figures.solid.volume) << name;
    cut += fitted.of(link)->figures.solid.volume < whole.of(link)->figures.solid.volume ? 1 : 0;
    double beyond = 0;
    for (const Sphere& s : fitted.of(link)->spheres) {
      beyond = std::max(beyond, plane.offset - dot(plane.normal, s.center) + s.radius);
    }
    EXPECT_NEAR(fitted.of(link)->figures.beyond_clip.value(), beyond, 1e-12);
    EXPECT_FALSE(whole.of(link)->figures.beyond_clip.has_value());
    // Others stay as they are.
    for (const robot::LinkSpheres& other : fitted.links) {
      EXPECT_TRUE(other.link == link || other.spheres == whole.of(other.link)->spheres);
    }
  }
  EXPECT_GE(cut, 3) << "planes that cut something";
}

TEST(ClipPlanes, with_a_margin_no_sphere_reaches_beyond) {
  const std::vector<robot::ClipPlane> planes{{{0, 0, 1}, 0.0}, {{-1, 0, 0}, -0.12}};
  for (const double margin : {0.01, 0.03}) {
    const robot::RobotSpheres fitted = robot::fit_spheres(
        the_arm, {.spheres = 8, .clip = {{"base", planes}, {"elbow", planes}}, .clip_margin = margin, .inner = 5});
    EXPECT_TRUE(fitted.covered());
    for (const char* name : {"base", "elbow"}) {
      const robot::LinkSpheres& link = *fitted.of(the_arm.find_link(name));
      EXPECT_EQ(link.figures.beyond_clip, 0.0);
      for (const robot::ClipPlane& plane : planes) {
        for (const std::vector<Sphere>* set : {&link.spheres, &link.inner}) {
          EXPECT_FALSE(set->empty());
          for (const Sphere& s : *set) {
            EXPECT_GE(dot(plane.normal, s.center) - s.radius, plane.offset);
            EXPECT_GE(dot(plane.normal, Vec3(Vec3f(s.center))) - static_cast<double>(static_cast<float>(s.radius)),
                      plane.offset);
          }
        }
      }
      // Points that both planes keep.
      Random random(7);
      const robot::LinkSurface whole = robot::surface_of(the_arm.file, the_arm.links[link.link].collision);
      std::size_t checked = 0;
      for (std::size_t f = 0; f < whole.mesh.facet_count(); ++f) {
        const auto [a, b, c] = whole.mesh.corners(f);
        for (int k = 0; k < 200; ++k) {
          double u = random.uniform(), v = random.uniform();
          if (u + v > 1) u = 1 - u, v = 1 - v;
          const Vec3 p = a + u * (b - a) + v * (c - a);
          if (p.z < margin || p.x > 0.12 - margin) continue;
          ++checked;
          EXPECT_TRUE(std::any_of(link.spheres.begin(), link.spheres.end(),
                                  [&](const Sphere& s) { return distance(s.center, p) <= s.radius; }));
        }
      }
      EXPECT_TRUE(checked > 500 || whole.mesh.facets.empty());
    }
  }
}

// Spheres of any size around the cut reach beyond the plane: to divide them is in vain.
TEST(ClipPlanes, a_margin_that_padding_or_rounding_takes_is_refused) {
  robot::Robot box;
  box.root = 0;
  box.links.resize(1);
  box.links[0].name = "block";
  robot::Shape shape;
  shape.kind = robot::Shape::Kind::box;
  shape.size = {1, 1, 1};
  box.links[0].collision = {shape};
  const auto fitted = [&](double margin, double padding, double min_radius, double offset) {
    return robot::fit_spheres(box, {.spheres = 4,
                                    .padding = padding,
                                    .min_radius = min_radius,
                                    .clip = {{"block", {{{0, 0, 1}, offset}}}},
                                    .clip_margin = margin});
  };
  for (const double padding : {0.0, 0.05}) {
    try {
      fitted(padding + 0.9e-6, padding, 0, 0);
      ADD_FAILURE() << "a margin that is too small was taken";
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      EXPECT_NE(text.find("clip margin"), std::string::npos) << text;
      EXPECT_NE(text.find("link block"), std::string::npos) << text;
      EXPECT_NE(text.find(padding > 0 ? "take 0.050001," : "take 1e-06,"), std::string::npos) << text;
    }
  }
  const robot::RobotSpheres good = fitted(0.1, 0.05, 0, 0);
  EXPECT_TRUE(good.covered());
  EXPECT_EQ(good.links[0].figures.beyond_clip, 0.0);
  ASSERT_EQ(good.links[0].notes.size(), 1u);
  EXPECT_NE(good.links[0].notes[0].find("so that none reaches beyond"), std::string::npos);
  // What lies far from its plane needs no margin; spheres that are kept are only measured.
  EXPECT_EQ(fitted(1e-9, 0.05, 0, -5).links[0].figures.beyond_clip, 0.0);
  const robot::RobotSpheres kept = robot::fit_spheres(box, {.fixed_spheres = {{"block", {Sphere{{0, 0, 0.25}, 1}}}},
                                                            .clip = {{"block", {{{0, 0, 1}, 0}}}},
                                                            .clip_margin = 1e-9});
  EXPECT_EQ(kept.links[0].figures.beyond_clip, 0.75);

  // Radii that are enlarged leave no way either: that ends before thousands of spheres, and a note says so.
  const robot::RobotSpheres large = fitted(0.01, 0, 0.1, 0);
  EXPECT_TRUE(large.covered());
  EXPECT_LT(large.links[0].spheres.size(), 500u);
  EXPECT_GT(large.links[0].figures.beyond_clip, 0.0);
  ASSERT_EQ(large.links[0].notes.size(), 1u);
  EXPECT_NE(large.links[0].notes[0].find("spheres reach beyond its clip planes"), std::string::npos);
}

TEST(ClipPlanes, a_link_beyond_gets_no_spheres_and_nonsense_is_refused) {
  const robot::RobotSpheres fitted =
      robot::fit_spheres(the_gripper, {.spheres = 3, .clip = {{"palm", {{{0, 0, 1}, 1.0}}}}});
  EXPECT_EQ(fitted.of(the_gripper.find_link("palm")), nullptr);
  ASSERT_EQ(fitted.notes.size(), 1u);
  EXPECT_NE(fitted.notes[0].find("link palm lies beyond its clip planes"), std::string::npos);
  // One that keeps all changes nothing.
  const robot::RobotSpheres all =
      robot::fit_spheres(the_gripper, {.spheres = 3, .clip = {{"palm", {{{0, 0, 1}, -1.0}}}}});
  const robot::RobotSpheres plain = robot::fit_spheres(the_gripper, {.spheres = 3});
  for (const robot::LinkSpheres& link : plain.links) EXPECT_EQ(all.of(link.link)->spheres, link.spheres);
  EXPECT_THROW(robot::fit_spheres(the_gripper, {.clip = {{"nobody", {}}}}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(the_gripper, {.clip = {{"palm", {{{0, 0, 2}, 0}}}}}), std::invalid_argument);
  EXPECT_THROW(robot::fit_spheres(the_gripper, {.clip_margin = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace morula::test
