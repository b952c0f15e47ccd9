// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of robots in the file formats of other programs.
#pragma once

#include <morula/robot/self_collision.hpp>

namespace morula::robot {

struct OutputOptions {
  std::filesystem::path folder;                 ///< folder of the files, from which meshes get relative names
  std::vector<std::string> tool_frames{};       ///< empty: guess_tool
  std::optional<std::filesystem::path> srdf{};  ///< existing SRDF that the written one extends
  std::uint64_t seed = 1;                       ///< seed of the sampled configurations
  double density = 1000;                        ///< density for MorphIt's masses of links without a mass
  /// true: also in files for simulators, links without a mass get the mass of their spheres at this density. false:
  /// they get mass 0, or 1e-6 if the format requires a mass.
  bool fill_masses = false;
  bool inner = false;  ///< the spheres are inside the links and do not cover them; formats with comments note it
};

/// The data of a robot that files contain.
struct Description {
  const Robot& robot;
  const RobotSpheres& spheres;
  const SelfCollision& self_collision;
  const OutputOptions& options;
};

struct OutputFile {
  std::string name;  ///< name in the folder, possibly with folders below it
  std::string bytes;
};

struct OutputFormat {
  std::string_view name;  ///< name for the command
  std::string_view files;
  std::string_view reader;  ///< program that reads it
  std::vector<OutputFile> (*write)(const Description&);
};
/// All formats, in the order of the documentation.
std::span<const OutputFormat> output_formats();
/// The format of this name; nullptr if there is none.
const OutputFormat* output_format(std::string_view name);

/// The link at the end of the longest chain of independent joints; of equals the first.
std::string guess_tool(const Robot& robot);

/// Reads the spheres of a spheres.json, by link. Throws FileError.
std::map<std::string, std::vector<Sphere>> read_robot_spheres(const std::filesystem::path& path);

}  // namespace morula::robot
