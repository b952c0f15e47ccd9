// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>

#include "write/text.hpp"

namespace morula::robot {

namespace {

constexpr std::array formats{
    OutputFormat{"json", "spheres.json", "everything: spheres, figures, ignored pairs", write_json},
    OutputFormat{"csv", "spheres.csv links.csv", "tables", write_csv},
    OutputFormat{"curobo", "curobo.yml", "cuRobo 0.8 and later", write_curobo},
    OutputFormat{"curobo-0.7", "curobo_0.7.yml", "cuRobo up to 0.7", write_curobo_old},
    OutputFormat{"xrdf-1", "ROBOT.1.0.xrdf", "XRDF 1.0: Isaac ROS, cuRobo", write_xrdf_1},
    OutputFormat{"xrdf-2", "ROBOT.2.0.xrdf", "XRDF 2.0: cuMotion, Isaac Sim", write_xrdf_2},
    OutputFormat{"urdf", "ROBOT_spherized.urdf", "every reader of URDF", write_urdf},
    OutputFormat{"srdf", "ROBOT.srdf", "MoveIt: spheres and ignored pairs", write_srdf},
    OutputFormat{"vamp", "vamp/ROBOT_spherized.urdf .srdf .json", "VAMP through cricket", write_vamp},
    OutputFormat{"mjcf", "ROBOT.mjcf.xml", "MuJoCo", write_mjcf},
    OutputFormat{"sdf", "ROBOT.sdf", "Gazebo, Drake", write_sdf},
    OutputFormat{"foam", "foam.json", "tools of foam", write_foam},
    OutputFormat{"ballpark", "ballpark.json", "ballpark, pyroki", write_ballpark},
    OutputFormat{"morphit", "morphit/LINK.json", "tools of MorphIt", write_morphit},
    OutputFormat{"bubblify", "bubblify.yml", "bubblify's editor", write_bubblify},
};

}  // namespace

std::span<const OutputFormat> output_formats() {
  return formats;
}

const OutputFormat* output_format(std::string_view name) {
  for (const OutputFormat& format : formats) {
    if (format.name == name) return &format;
  }
  return nullptr;
}

}  // namespace morula::robot
