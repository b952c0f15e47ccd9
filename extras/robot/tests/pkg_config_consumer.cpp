// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <fstream>
#include <morula/morula.hpp>
#include <morula/robot/fit.hpp>

int main() {
  std::ofstream("one_link.urdf") << R"(<robot name="one"><link name="base"><collision>
    <geometry><box size="0.4 0.2 0.1"/></geometry></collision></link></robot>)";
  const morula::robot::RobotSpheres fitted =
      morula::robot::fit_spheres(morula::robot::read_robot("one_link.urdf"), {.spheres = 4});
  std::printf("%zu links\n", fitted.links.size());
  return fitted.links.size() == 1 ? 0 : 1;
}
