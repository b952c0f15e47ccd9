// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <morula/io/mesh_file.hpp>
#include <morula/query/signed_distance.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

/// The balls of a file, by its header's promise: four little-endian doubles a row.
std::vector<Sphere> balls_in(const std::string& bytes) {
  const std::string end = "property double radius\nend_header\n";
  const std::size_t begin = bytes.find(end) + end.size();
  std::vector<Sphere> balls((bytes.size() - begin) / sizeof(Sphere));
  std::memcpy(balls.data(), bytes.data() + begin, balls.size() * sizeof(Sphere));
  return balls;
}

TEST(MedialCommand, writes_balls_that_fit_inside_and_reports_them) {
  const Workbench bench;
  bench.require("sample torus -o torus.obj --resolution 24");
  const Mesh mesh = read_mesh(bench / "torus.obj");
  const SignedDistance shape(mesh);
  for (const std::string kind : {"shrinking", "voronoi"}) {
    const nlohmann::json report =
        bench.require("medial torus.obj -o balls.ply --samples 300 --json --kind " + kind).json();
    const std::string bytes = bench.read("balls.ply");
    EXPECT_EQ(bytes.rfind("ply\nformat binary_little_endian 1.0\nelement vertex ", 0), 0u);
    const std::vector<Sphere> balls = balls_in(bytes);
    EXPECT_EQ(report["balls"], balls.size());
    EXPECT_EQ(report["kind"], kind);
    EXPECT_GT(balls.size(), 200u);
    double smallest = balls[0].radius, largest = smallest;
    for (const Sphere& ball : balls) {
      smallest = std::min(smallest, ball.radius);
      largest = std::max(largest, ball.radius);
      EXPECT_TRUE(shape.is_inside(ball.center));
      if (kind == "shrinking") {
        EXPECT_LE(shape(ball.center), -ball.radius * (1 - 1e-12));
      }
    }
    EXPECT_EQ(report["radius"]["smallest"], smallest);
    EXPECT_EQ(report["radius"]["largest"], largest);
    EXPECT_LE(report["radius"]["median"], largest);
  }
}

TEST(MedialCommand, same_file_for_any_number_of_threads_and_another_for_another_seed) {
  const Workbench bench;
  bench.require("sample limb -o limb.obj --resolution 16");
  bench.require("medial limb.obj -o one.ply --samples 500 --threads 1");
  bench.require("medial limb.obj -o three.ply --samples 500 --threads 3");
  bench.require("medial limb.obj -o other.ply --samples 500 --seed 2");
  EXPECT_EQ(bench.read("one.ply"), bench.read("three.ply"));
  EXPECT_NE(bench.read("one.ply"), bench.read("other.ply"));
}

TEST(MedialCommand, inside_out_is_read_the_right_way_round) {
  const Workbench bench;
  bench.write("out.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  bench.write("in.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n");
  const nlohmann::json out = bench.require("medial out.obj -o out.ply --samples 100 --json").json();
  const nlohmann::json in = bench.require("medial in.obj -o in.ply --samples 100 --json").json();
  EXPECT_EQ(out["balls"], 100);
  EXPECT_EQ(in["balls"], 100);
}

TEST(MedialCommand, a_mesh_without_inside_has_no_balls_and_the_exit_code_says_so) {
  const Workbench bench;
  bench.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandResult result = bench.run("medial flat.obj -o balls.ply");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.out.find("none: nothing of the mesh is inside"), std::string::npos) << result.out;
  EXPECT_TRUE(bench.run("medial flat.obj -o balls.ply --json").json()["radius"]["median"].is_null());
}

TEST(MedialCommand, bad_use_writes_nothing) {
  const Workbench bench;
  bench.require("sample bar -o bar.obj --resolution 4");
  const auto before = bench.listing();
  const auto refuses = [&](const std::string& arguments, const std::string& reason) {
    const CommandResult result = bench.run("medial " + arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_NE(result.err.find(reason), std::string::npos) << result.err;
  };
  refuses("bar.obj -o balls.obj", "balls are written as .ply");
  refuses("bar.obj -o nowhere/balls.ply", "there is no folder nowhere");
  refuses("bar.obj -o balls.ply --kind voronio", "did you mean voronoi?");
  refuses("bar.obj -o balls.ply --samples 0", "is not a whole number from 1 to 10000000");
  refuses("missing.obj -o balls.ply", "missing.obj");
  EXPECT_EQ(bench.listing(), before);
}

}  // namespace
}  // namespace morula::test
