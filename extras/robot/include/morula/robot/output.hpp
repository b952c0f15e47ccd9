// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots' spheres as files of other programs.
#pragma once

#include <morula/robot/self_collision.hpp>

namespace morula::robot {

struct OutputOptions {
  std::filesystem::path folder;            ///< where the files will be: relative names of meshes are written from there
  std::vector<std::string> tool_frames{};  ///< none: guess_tool
  std::optional<std::filesystem::path> srdf{};  ///< what the SRDF that is written adds to
  std::uint64_t seed = 1;                       ///< of the sampled configurations
  double density = 1000;                        ///< for MorphIt's masses of links that have none
  /// In files of simulators, too, links without a mass weigh as much as their spheres of this density. Otherwise they
  /// weigh nothing, or where the format does not allow that 1e-6.
  bool fill_masses = false;
  bool inner = false;  ///< the spheres are inside the links and do not cover them, which files with comments say
};

/// Everything that is written about a robot.
struct Description {
  const Robot& robot;
  const RobotSpheres& spheres;
  const SelfCollision& self_collision;
  const OutputOptions& options;
};

struct OutputFile {
  std::string name;  ///< in the folder, with folders below it
  std::string bytes;
};

struct OutputFormat {
  std::string_view name;  ///< as the command takes it
  std::string_view files;
  std::string_view reader;  ///< who reads it
  std::vector<OutputFile> (*write)(const Description&);
};
/// All of them, in the order of the documentation.
std::span<const OutputFormat> output_formats();
/// Nothing where there is none of this name.
const OutputFormat* output_format(std::string_view name);

/// The link at the end of the longest chain of joints that move by themselves; of equals the first.
std::string guess_tool(const Robot& robot);

/// The spheres of a spheres.json, by link. Throws FileError.
std::map<std::string, std::vector<Sphere>> read_robot_spheres(const std::filesystem::path& path);

}  // namespace morula::robot
