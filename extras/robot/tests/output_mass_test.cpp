// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Masses and inertias in the files of simulators, as the simulators read them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <regex>
#include <sstream>
#include <support/scratch_folder.hpp>

#include "fitted.hpp"

namespace morula::test {
namespace {

TEST(RobotOutput, masses_of_simulators_are_the_robots_own) {
  const std::string mjcf = fitted_arm().text("mjcf");
  EXPECT_NE(mjcf.find("mass=\"4\""), std::string::npos);
  // The forearm's inertia is given along turned axes: x and z change places.
  EXPECT_NE(mjcf.find("mass=\"1.5\" fullinertia=\"0.011"), std::string::npos) << mjcf;
  EXPECT_NE(fitted_arm().text("sdf").find("<mass>1.5</mass>"), std::string::npos);
  EXPECT_NE(fitted_gripper().text("mjcf").find("joint1=\"right_slide\" joint2=\"left_slide\" polycoef=\"0 1 0 0 0\""),
            std::string::npos);
}

/// What MuJoCo reads of a body, judged by its rules.
struct Weighed {
  double mass = 0;
  std::array<double, 3> moments{};  // ascending
};

/// Eigenvalues of a symmetric matrix, by the roots of its characteristic polynomial.
std::array<double, 3> eigenvalues(const std::array<double, 6>& m) {
  const auto [xx, yy, zz, xy, xz, yz] = m;  // in MuJoCo's order
  const double mean = (xx + yy + zz) / 3;
  const double p2 = (xx - mean) * (xx - mean) + (yy - mean) * (yy - mean) + (zz - mean) * (zz - mean) +
                    2 * (xy * xy + xz * xz + yz * yz);
  if (p2 == 0) return {mean, mean, mean};
  const double p = std::sqrt(p2 / 6);
  const double a = (xx - mean) / p, b = (yy - mean) / p, c = (zz - mean) / p, d = xy / p, e = xz / p, f = yz / p;
  const double r = (a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e)) / 2;
  const double angle = std::acos(std::max(-1.0, std::min(1.0, r))) / 3;
  std::array<double, 3> all{};
  for (int k = 0; k < 3; ++k)
    all[static_cast<std::size_t>(k)] = mean + 2 * p * std::cos(angle + 2 * std::acos(-1.0) * k / 3);
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<double> numbers_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> all;
  for (double value = 0; in >> value;) all.push_back(value);
  return all;
}

/// By the names of bodies; those without <inertial> are not among them.
std::map<std::string, Weighed> weighed(const std::string& mjcf) {
  std::map<std::string, Weighed> all;
  const std::regex pattern("<body name=\"([^\"]*)\"|<inertial ([^>]*)/>");
  std::string body;
  for (std::sregex_iterator it(mjcf.begin(), mjcf.end(), pattern), end; it != end; ++it) {
    if ((*it)[1].matched) {
      body = (*it)[1];
      continue;
    }
    const std::string attributes = (*it)[2];
    const auto value = [&](const std::string& name) {
      std::smatch found;
      return std::regex_search(attributes, found, std::regex(name + "=\"([^\"]*)\"")) ? found[1].str() : "";
    };
    Weighed& own = all[body];
    own.mass = std::stod(value("mass"));
    if (const std::vector<double> full = numbers_of(value("fullinertia")); full.size() == 6) {
      own.moments = eigenvalues({full[0], full[1], full[2], full[3], full[4], full[5]});
    } else {
      const std::vector<double> diagonal = numbers_of(value("diaginertia"));
      EXPECT_EQ(diagonal.size(), 3u) << attributes;
      std::copy(diagonal.begin(), diagonal.end(), own.moments.begin());
      std::sort(own.moments.begin(), own.moments.end());
    }
  }
  return all;
}

/// A base, and a body that a joint of this type carries, of this inertia.
std::map<std::string, Weighed> weighed_body(const std::string& inertial, const std::string& joint = "revolute",
                                            bool fill_masses = false) {
  const ScratchFolder scratch;
  const std::string box = "<collision><geometry><box size='1 1 1'/></geometry></collision>";
  scratch.file("r.urdf", "<robot name='r'><link name='a'>" + box + "</link><link name='b'>" + inertial + box +
                             "</link><joint name='j' type='" + joint +
                             "'><parent link='a'/><child link='b'/><origin xyz='0 0 2'/><limit lower='-1' upper='1'/>"
                             "</joint></robot>");
  Fitted fitted((scratch.path() / "r.urdf").string());
  fitted.options.fill_masses = fill_masses;
  return weighed(fitted.text("mjcf"));
}

std::string inertial_of(const std::string& mass, const std::string& entries) {
  return "<inertial><origin xyz='0.1 0 0' rpy='0.3 0.2 0.1'/><mass value='" + mass + "'/><inertia " + entries +
         "/></inertial>";
}

TEST(RobotOutput, inertias_of_mjcf_are_those_that_mujoco_takes) {
  struct Case {
    const char* mass;
    const char* entries;
    double kept;  // the largest moment, which stays; 0: none is known
  };
  for (const Case& c : std::vector<Case>{
           {"1e-7", "ixx='3e-22' iyy='3e-22' izz='5e-22'", 0},
           {"1e-16", "ixx='1' iyy='1' izz='1'", 1},
           {"1e-300", "ixx='1e-300' iyy='1e-300' izz='1e-300'", 0},
           {"2", "ixx='1' iyy='1' izz='3'", 3},
           {"2", "ixx='1' iyy='1' izz='2'", 2},
           {"2", "ixx='1' iyy='1' izz='0'", 1},
           {"2", "ixx='1e6' iyy='1e-9' izz='1e-9'", 1e6},
           {"2", "ixx='1' iyy='1' izz='1' ixy='1'", 2},
           {"2", "ixx='0' iyy='0' izz='0'", 0},
           {"2", "ixx='-1' iyy='1' izz='1'", 0},
           {"2", "ixx='1' iyy='1' izz='1' ixy='5'", 0},
           {"2", "ixx='1e18' iyy='1e18' izz='2e18'", 2e18},
           {"2", "ixx='0.3' iyy='0.3' izz='0.4'", 0.4},
       }) {
    for (const char* joint : {"revolute", "fixed"}) {
      const auto all = weighed_body(inertial_of(c.mass, c.entries), joint);
      ASSERT_EQ(all.count("b"), 1u) << c.entries;
      const Weighed& b = all.at("b");
      EXPECT_GE(b.mass, 1e-15) << c.mass;
      EXPECT_NEAR(b.mass, std::stod(c.mass), 1e-12) << "no mass is added";
      EXPECT_GE(b.moments[0], 1e-15) << c.entries;
      EXPECT_GE(b.moments[0] + b.moments[1], b.moments[2]) << c.entries;
      if (c.kept > 0) {
        EXPECT_NEAR(b.moments[2], c.kept, 1e-9 * c.kept) << c.entries;
      }
      EXPECT_EQ(all.count("a"), 0u) << "what does not move needs no mass";
    }
  }
  // A + B < C: both are raised alike.
  const Weighed flat = weighed_body(inertial_of("2", "ixx='1' iyy='1.5' izz='3'")).at("b");
  EXPECT_NEAR(flat.moments[0], 1.25, 1e-9);
  EXPECT_NEAR(flat.moments[1], 1.75, 1e-9);
  // Of a box of edge 1: about a sixth of its mass.
  const Weighed box = weighed_body(inertial_of("6", "")).at("b");
  EXPECT_GT(box.moments[0], 1);
  EXPECT_LT(box.moments[2], 3);
}

TEST(RobotOutput, links_without_a_mass_weigh_nothing_unless_asked) {
  const auto moving = weighed_body("");
  ASSERT_EQ(moving.count("b"), 1u) << "MuJoCo takes no body that moves without a mass";
  EXPECT_LE(moving.at("b").mass, 1e-6);
  EXPECT_GE(moving.at("b").mass, 1e-15);
  EXPECT_GE(moving.at("b").moments[0], 1e-15);
  EXPECT_EQ(moving.size(), 1u);
  EXPECT_TRUE(weighed_body("", "fixed").empty());
  EXPECT_TRUE(weighed_body("<inertial><mass value='0'/></inertial>", "fixed").empty());
  const auto filled = weighed_body("", "fixed", true);
  ASSERT_EQ(filled.size(), 2u);
  EXPECT_GT(filled.at("b").mass, 1000) << "spheres around a box of edge 1";
  EXPECT_LT(filled.at("b").mass, 10000);
  // A body without a mass moves where one that is fixed to it has some.
  const ScratchFolder scratch;
  const std::string ball = "<collision><geometry><sphere radius='1'/></geometry></collision>";
  scratch.file("r.urdf",
               "<robot name='r'><link name='a'/><link name='b'>" + ball +
                   "</link><link name='c'><inertial><mass value='3'/><inertia ixx='1' iyy='1' izz='1'/></inertial>" +
                   ball +
                   "</link><joint name='j' type='continuous'><parent link='a'/><child link='b'/></joint>"
                   "<joint name='k' type='fixed'><parent link='b'/><child link='c'/></joint></robot>");
  const Fitted fitted((scratch.path() / "r.urdf").string());
  const auto carried = weighed(fitted.text("mjcf"));
  ASSERT_EQ(carried.size(), 1u);
  EXPECT_EQ(carried.at("c").mass, 3);
  // In SDF a link that says nothing weighs 1.
  const std::string sdf = fitted.text("sdf");
  double sum = 0;
  const std::regex mass("<mass>([^<]*)</mass>");
  for (std::sregex_iterator it(sdf.begin(), sdf.end(), mass), end; it != end; ++it) sum += std::stod((*it)[1]);
  EXPECT_EQ(std::distance(std::sregex_iterator(sdf.begin(), sdf.end(), mass), std::sregex_iterator()), 3);
  EXPECT_NEAR(sum, 3, 1e-5);
}
}  // namespace
}  // namespace morula::test
