// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots of several formats: those of the folder robots, small ones written for a test, and where their links stand.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <morula/io/mesh_file.hpp>
#include <morula/robot/robot.hpp>
#include <string>
#include <support/scratch_folder.hpp>
#include <vector>

namespace morula::test {

namespace fs = std::filesystem;

inline const std::string arm = std::string(MORULA_ROBOTS) + "/arm_description/";
inline const std::string gripper = std::string(MORULA_ROBOTS) + "/gripper_description/";
inline const std::string tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

class Formats : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) { return folder.file(name, text); }
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

inline Vec3 origin_of(const robot::Robot& r, const std::string& link, const std::vector<double>& values) {
  return robot::link_poses(r, values)[r.find_link(link)].translation;
}
inline Vec3 point_of(const robot::Robot& r, const std::string& link, const std::vector<double>& values, const Vec3& p) {
  return robot::link_poses(r, values)[r.find_link(link)](p);
}

inline void expect_near(const Vec3& a, const Vec3& b, const std::string& what) {
  EXPECT_LT(distance(a, b), 1e-14) << what << ": " << a.x << " " << a.y << " " << a.z;
}

}  // namespace morula::test
