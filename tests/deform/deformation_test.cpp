// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What holds for every deformation of every mesh.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <scenes/scenes.hpp>
#include <stdexcept>
#include <support/meshes.hpp>

namespace morula {
namespace {

using scenes::NamedMotion;
using test::NamedMesh;

bool same_bits(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

double largest_difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, distance(a[i], b[i]));
  return largest;
}

std::vector<NamedMotion> motions() {
  std::vector<NamedMotion> all = scenes::standard_motions();
  all.push_back({"all together", {Stretch{1.5, 0.5}, Twist{90}, Bend{45}, Poke{}, Noise{}, Rotate{30}}});
  return all;
}

std::string message_of(const Mesh& mesh, const Deformations& deformations, double t = 1) {
  try {
    deform(mesh, deformations, t);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing thrown";
}

TEST(Deform, parameter_zero_returns_rest_bit_for_bit) {
  for (const NamedMesh& named : test::all_meshes())
    for (const NamedMotion& motion : motions())
      EXPECT_TRUE(same_bits(deform(named.mesh, motion.deformations, 0), named.mesh.positions))
          << named.name << ", " << motion.name;
  // A negative zero is a bit, too.
  const Mesh mesh{{{-0.0, 0, 0}, {1, -0.0, 0}, {0, 1, -0.0}}, {{0, 1, 2}}};
  EXPECT_TRUE(same_bits(deform(mesh, {Stretch{}, Bend{}, Noise{}}, 0), mesh.positions));
}

TEST(Deform, no_deformation_is_the_identity) {
  const Mesh mesh = sample_body("bar", 8);
  EXPECT_TRUE(same_bits(deform(mesh, {}, 0.7), mesh.positions));
}

TEST(Deform, moves_every_mesh_and_keeps_it_finite) {
  for (const NamedMesh& named : test::all_meshes())
    for (const NamedMotion& motion : motions()) {
      const std::vector<Vec3> moved = deform(named.mesh, motion.deformations, 1);
      ASSERT_EQ(moved.size(), named.mesh.vertex_count());
      for (const Vec3& p : moved) EXPECT_TRUE(is_finite(p)) << named.name << ", " << motion.name;
      // Few vertices may all lie outside the ball that a poke moves.
      if (named.mesh.facet_count() < 100 && std::holds_alternative<Poke>(motion.deformations[0])) continue;
      EXPECT_GT(largest_difference(moved, named.mesh.positions), 1e-4 * bounding_box(named.mesh).diagonal())
          << named.name << ", " << motion.name;
    }
}

TEST(Deform, way_back_equals_way_out_bit_for_bit) {
  const Mesh mesh = sample_body("limb", 12);
  for (const std::size_t count : {std::size_t{25}, std::size_t{8}}) {
    const std::vector<double> parameters = frame_parameters(count);
    for (const NamedMotion& motion : motions()) {
      std::vector<std::vector<Vec3>> frames;
      for (const double t : parameters) frames.push_back(deform(mesh, motion.deformations, t));
      for (std::size_t i = 0; i < count; ++i) EXPECT_TRUE(same_bits(frames[i], frames[count - 1 - i])) << motion.name;
      EXPECT_TRUE(same_bits(frames.back(), mesh.positions)) << motion.name;
      EXPECT_FALSE(same_bits(frames[count / 2], frames[count / 2 - 2])) << motion.name;
    }
  }
}

// Scaling by a power of two rounds nothing, so any absolute length hidden in a formula would show.
TEST(Deform, commutes_with_scaling_bit_for_bit) {
  const Mesh mesh = sample_body("limb", 12);
  for (const double factor : {0x1p-20, 0x1p+20})
    for (const NamedMotion& motion : motions()) {
      std::vector<Vec3> expected = deform(mesh, motion.deformations, 0.6);
      for (Vec3& p : expected) p *= factor;
      EXPECT_TRUE(same_bits(deform(test::scaled(mesh, factor), motion.deformations, 0.6), expected)) << motion.name;
    }
}

TEST(Deform, is_continuous_from_rest) {
  const Mesh mesh = sample_body("limb", 12);
  const double diagonal = bounding_box(mesh).diagonal();
  for (const NamedMotion& motion : motions()) {
    double last = 0;
    for (const double t : {1e-18, 1e-12, 1e-6, 1e-3}) {
      const double moved = largest_difference(deform(mesh, motion.deformations, t), mesh.positions);
      EXPECT_LE(moved, 10 * t * diagonal + 1e-15 * diagonal) << motion.name << " at " << t;
      EXPECT_GE(moved, last) << motion.name << " at " << t;
      last = moved;
    }
    EXPECT_GT(last, 1e-6 * diagonal) << motion.name;
  }
}

// x → y → z → x, as a mesh and as an axis.
TEST(Deform, other_axes_are_permutations_of_x_bit_for_bit) {
  const Mesh along_x = sample_body("limb", 12);
  const auto shifted = [](std::vector<Vec3> positions, int steps) {
    for (Vec3& p : positions)
      for (int step = 0; step < steps; ++step) p = {p.z, p.x, p.y};
    return positions;
  };
  const auto along = [](Axis axis) {
    return std::vector<Deformation>{Stretch{1.7, 0.3, axis}, Twist{77, axis}, Bend{66, axis}, Rotate{55, axis}};
  };
  for (int steps = 0; steps < 3; ++steps) {
    const Mesh mesh{shifted(along_x.positions, steps), along_x.facets};
    const std::vector<Deformation> on_x = along(Axis::x), on_other = along(static_cast<Axis>(steps)),
                                   automatic = along(Axis::automatic);
    for (std::size_t i = 0; i < on_x.size(); ++i) {
      const std::vector<Vec3> expected = shifted(deform(along_x, {on_x[i]}, 0.8), steps);
      EXPECT_TRUE(same_bits(deform(mesh, {on_other[i]}, 0.8), expected)) << describe(on_other[i]);
      EXPECT_TRUE(same_bits(deform(mesh, {automatic[i]}, 0.8), expected)) << "automatic " << describe(on_other[i]);
    }
  }
}

TEST(Deform, composition_applies_one_after_the_other_with_the_rest_box) {
  const Mesh mesh = sample_body("limb", 12);
  const std::vector<Vec3>& rest = mesh.positions;
  EXPECT_LT(largest_difference(deform(mesh, {Rotate{30}, Rotate{60}}, 1), deform(mesh, {Rotate{90}}, 1)), 1e-14);
  EXPECT_LT(largest_difference(deform(mesh, {Stretch{4}, Stretch{0.25}}, 1), rest), 1e-14);
  EXPECT_LT(largest_difference(deform(mesh, {Twist{120}, Twist{-120}}, 1), rest), 1e-14);
  EXPECT_GT(largest_difference(deform(mesh, {Twist{120}, Bend{90}}, 1), deform(mesh, {Bend{90}, Twist{120}}, 1)), 0.1);
  // The box is the rest one: stretched to twice its length, the outer quarters lie beyond the range of a twist, whose
  // angle then stays at its ends' values.
  const Mesh bar = sample_body("bar", 16);
  const std::vector<Vec3> long_bar = deform(bar, {Stretch{2, 0}}, 1);
  const std::vector<Vec3> twisted = deform(bar, {Stretch{2, 0}, Twist{180}}, 1);
  for (std::size_t i = 0; i < long_bar.size(); ++i) {
    const Vec3 p = long_bar[i];
    if (p.x <= -2) {
      EXPECT_EQ(twisted[i], p);
    }
    if (p.x >= 2) {
      EXPECT_LT(distance(twisted[i], {p.x, -p.y, -p.z}), 1e-15);
    }
  }
}

TEST(Deform, unused_vertices_move_unless_they_are_not_finite) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  Mesh mesh = test::icosphere(1);
  const std::size_t used = mesh.vertex_count();
  mesh.positions.insert(mesh.positions.end(), {{0.5, 0, 0.8}, {nan, 0, 0}, {0, infinity, 0}, {1e300, 1e300, 1e300}});
  for (const NamedMotion& motion : motions()) {
    const std::vector<Vec3> moved = deform(mesh, motion.deformations, 1);
    EXPECT_NE(moved[used], mesh.positions[used]) << motion.name;
    EXPECT_TRUE(std::isnan(moved[used + 1].x) && moved[used + 1].y == 0) << motion.name;
    EXPECT_EQ(moved[used + 2], mesh.positions[used + 2]) << motion.name;
    // They have no influence on the others.
    const std::vector<Vec3> alone = deform(test::icosphere(1), motion.deformations, 1);
    EXPECT_TRUE(same_bits({moved.begin(), moved.begin() + static_cast<std::ptrdiff_t>(used)}, alone)) << motion.name;
  }
}

TEST(Deform, parameters_out_of_range_are_named) {
  const Mesh mesh = sample_body("bar", 4);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<Deformation, std::string>> bad{
      {Stretch{0}, "stretch factor 0 is not in 0.001…1000"},
      {Stretch{-2}, "stretch factor -2"},
      {Stretch{nan}, "stretch factor nan"},
      {Stretch{2, 2.5}, "stretch shrink 2.5 is not in -1…2"},
      {Twist{36001}, "twist degrees 36001"},
      {Bend{361}, "bend degrees 361 is not in -360…360"},
      {Poke{{0, 0, 11}, {}, 0.2}, "poke center z 11"},
      {Poke{{0, 0, 0}, {0, -12, 0}, 0.2}, "poke push y -12"},
      {Poke{{0, 0, 0}, {}, 0}, "poke radius 0 is not in 0.001…10"},
      {Noise{-0.1}, "noise amplitude -0.1"},
      {Noise{0.1, 0}, "noise wavelength 0 is not in 0.01…10"},
      {Rotate{-40000}, "rotate degrees -40000"},
  };
  for (const auto& [deformation, expected] : bad)
    for (const double t : {0.0, 0.5, 1.0}) {
      const std::string message = message_of(mesh, {Rotate{}, deformation}, t);
      EXPECT_EQ(message.substr(0, expected.size()), expected);
    }
  EXPECT_EQ(message_of(mesh, {Rotate{}}, 1.5), "deformation parameter 1.5 is not in 0…1");
  EXPECT_EQ(message_of(mesh, {}, -0.5), "deformation parameter -0.5 is not in 0…1");
  EXPECT_EQ(message_of(mesh, {}, nan).substr(0, 25), "deformation parameter nan");
}

TEST(Deform, twist_and_bend_need_extent_along_their_axis) {
  const Mesh plate = test::grid_plate(3);
  for (const double t : {0.0, 0.5, 1.0}) {
    EXPECT_EQ(message_of(plate, {Twist{90, Axis::z}}, t), "twist 90 z: the mesh has no extent along z");
    EXPECT_EQ(message_of(plate, {Bend{90, Axis::z}}, t), "bend 90 z: the mesh has no extent along z");
  }
  EXPECT_NO_THROW(deform(plate, {Rotate{90, Axis::z}, Stretch{2, 0.5, Axis::z}}, 1));
}

TEST(Deform, mesh_without_extent_only_stays) {
  const Mesh point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}, {{0, 1, 2}}};
  EXPECT_TRUE(same_bits(deform(point, {Stretch{}, Poke{}, Noise{}, Rotate{}}, 1), point.positions));
}

TEST(Deform, describe_says_what_and_how_much) {
  EXPECT_EQ(describe(Stretch{}), "stretch 2");
  EXPECT_EQ(describe(Twist{-180}), "twist -180");
  EXPECT_EQ(describe(Bend{22.5, Axis::z}), "bend 22.5 z");
  EXPECT_EQ(describe(Poke{{}, {0.3, 0, 0.4}, 0.1}), "poke 0.5");
  EXPECT_EQ(describe(Noise{}), "noise 0.05");
  EXPECT_EQ(describe(Rotate{90, Axis::y}), "rotate 90 y");
}

// The promise "same bits on every machine", kept by comparing with what one machine computed.
TEST(Deform, bits_are_the_golden_ones) {
  Mesh mesh = sample_body("limb", 12);
  const std::vector<std::uint64_t> golden{0xcfc3db1c89a98fb5u, 0x4f852d72496d29ceu, 0x8c87516519e5bca2u,
                                          0x4fac94c057bc4b64u, 0xe71e4ff1342703fau, 0xe3a74dfe966709c8u,
                                          0x5261efd0d070df0bu};
  std::vector<std::uint64_t> hashes;
  const std::vector<Vec3> rest = mesh.positions;
  for (const NamedMotion& motion : motions()) {
    mesh.positions = rest;
    mesh.positions = deform(mesh, motion.deformations, 0.7);
    hashes.push_back(mesh_hash(mesh));
  }
  EXPECT_EQ(hashes, golden);
}

}  // namespace
}  // namespace morula
