// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/deform/deformation.hpp>
#include <morula/io/motion_file.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

TEST(DeformCommand, composes_in_the_order_of_the_command_line) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 6");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  bench.require("deform limb.obj -o a --twist 90 --bend 60 --twist -45 --axis x --frames 3");
  bench.require("deform limb.obj -o b.npy --bend 60 --twist -45 --twist 90 --axis x --frames 3");
  const Twist quarter{.degrees = 90, .axis = Axis::x};
  const Twist back{.degrees = -45, .axis = Axis::x};
  const Bend bend{.degrees = 60, .axis = Axis::x};
  EXPECT_EQ(Motion(bench / "a", mesh).frame(1), deform(mesh, {quarter, bend, back}, 1.0));
  EXPECT_EQ(Motion(bench / "b.npy", mesh).frame(1), deform(mesh, {bend, back, quarter}, 1.0));
}

TEST(DeformCommand, passes_every_parameter_on) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 6");
  const Mesh mesh = read_mesh(bench / "limb.obj");
  bench.require(
      "deform limb.obj -o a.npy --stretch 1.5 --shrink 0 --noise 0.1 --noise-wavelength 0.5 --seed 9 --rotate 30 "
      "--poke "
      "--poke-center 0,0.5,1 --poke-push 0,0.1,-0.1 --poke-radius 0.4 --axis y --frames 2 --one-way");
  const Deformations expected{
      Stretch{.factor = 1.5, .shrink = 0, .axis = Axis::y}, Noise{.amplitude = 0.1, .wavelength = 0.5, .seed = 9},
      Rotate{.degrees = 30, .axis = Axis::y}, Poke{.center = {0, 0.5, 1}, .push = {0, 0.1, -0.1}, .radius = 0.4}};
  EXPECT_EQ(Motion(bench / "a.npy", mesh).frame(1), deform(mesh, expected, 1.0));
}

TEST(DeformCommand, goes_out_and_comes_back_bit_for_bit) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 6");
  const auto json = bench.require("deform limb.obj -o motion --twist 180 --frames 5 --json").json();
  EXPECT_EQ(json["parameters"], nlohmann::json({0.0, 0.5, 1.0, 0.5, 0.0}));
  EXPECT_EQ(bench.read("motion/0000.obj"), bench.read("motion/0004.obj"));
  EXPECT_NE(bench.read("motion/0000.obj"), bench.read("motion/0002.obj"));
  const Mesh mesh = read_mesh(bench / "limb.obj");
  EXPECT_EQ(Motion(bench / "motion", mesh).frame(4), mesh.positions);
}

TEST(DeformCommand, never_mixes_frames_of_two_motions) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  bench.require("deform bar.obj -o motion --twist 90 --frames 5");
  bench.require("deform bar.obj -o motion --twist 120 --frames 5");
  const auto before = bench.listing();
  const CommandResult shorter = bench.run("deform bar.obj -o motion --twist 90 --frames 3");
  EXPECT_EQ(shorter.exit_code, 2);
  EXPECT_NE(shorter.err.find("would be read as one of the frames"), std::string::npos) << shorter.err;
  EXPECT_EQ(bench.run("deform bar.obj -o motion --twist 90 --frames 5 --format ply").exit_code, 2);
  EXPECT_EQ(bench.listing(), before);
}

TEST(DeformCommand, impossible_deformations_leave_nothing_behind) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const auto before = bench.listing();
  EXPECT_EQ(bench.run("deform bar.obj -o motion --frames 5").exit_code, 2);
  EXPECT_EQ(bench.run("deform bar.obj -o motion --twist 90 --frames 2").exit_code, 2);
  EXPECT_EQ(bench.run("deform bar.obj -o motion --stretch 0").exit_code, 2);
  // Along its short side the bar would fold over itself.
  const CommandResult folds = bench.run("deform bar.obj -o motion --bend 180 --axis y");
  EXPECT_EQ(folds.exit_code, 2);
  EXPECT_EQ(folds.err.rfind("morula: error: ", 0), 0u) << folds.err;
  EXPECT_EQ(bench.listing(), before);
}

}  // namespace
}  // namespace morula::test
