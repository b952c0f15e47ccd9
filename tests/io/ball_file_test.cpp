// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <morula/io/mesh_file.hpp>
#include <morula/io/spheres_file.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

TEST(BallFile, is_ply_with_four_doubles_a_ball) {
  const ScratchFolder folder;
  const std::vector<Sphere> balls{{{0.1, -2, 3e300}, 1.5}, {{-0.0, 1e-310, 7}, 0}};
  write_balls(folder.path() / "balls.ply", balls);
  const std::string bytes = bytes_of(folder.path() / "balls.ply");
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty double radius\nend_header\n";
  ASSERT_EQ(bytes.size(), header.size() + 64);
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  std::vector<Sphere> read(2);
  std::memcpy(read.data(), bytes.data() + header.size(), 64);
  EXPECT_EQ(read, balls);
  write_balls(folder.path() / "none.ply", {});
  EXPECT_NE(bytes_of(folder.path() / "none.ply").find("element vertex 0\n"), std::string::npos);
}

TEST(BallFile, what_cannot_be_written_is_refused_and_the_old_file_stays) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder.path() / "balls.ply";
  write_balls(path, std::vector<Sphere>{{{1, 2, 3}, 4}});
  const std::string before = bytes_of(path);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(write_balls(path, std::vector<Sphere>{{{0, 0, 0}, 1}, {{0, 0, 0}, infinity}}), std::invalid_argument);
  EXPECT_THROW(write_balls(path, std::vector<Sphere>{{{0, infinity, 0}, 1}}), std::invalid_argument);
  EXPECT_EQ(bytes_of(path), before);
  EXPECT_THROW(write_balls(folder.path() / "balls.obj", {}), FileError);
  EXPECT_THROW(write_balls(folder.path() / "nowhere" / "balls.ply", {}), FileError);
}

}  // namespace
}  // namespace morula::test
