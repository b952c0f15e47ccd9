// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of a robot in the file formats of planners, simulators and other programs.
#pragma once

#include <morula/robot/self_collision.hpp>

namespace morula::robot {

struct OutputOptions {
  std::filesystem::path folder;                 ///< folder of the files; names of meshes in them are relative to it
  std::vector<std::string> tool_frames{};       ///< names of the links at the tool; empty: guess_tool()
  std::optional<std::filesystem::path> srdf{};  ///< an existing SRDF file whose contents the written SRDF also has
  std::uint64_t seed = 1;  ///< SelfCollisionOptions::seed of the ignored pairs, which files mention
  double density = 1000;   ///< density of links without a mass, mass per mesh unit³
  /// true: in files for simulators, links without a mass get the mass of their spheres at `density`. false: they get
  /// mass 0, or 1e-6 if the format requires a mass. Files for MorphIt always have masses.
  bool fill_masses = false;
  bool inner = false;  ///< true: the spheres are inner ones, which do not cover; formats with comments say so
};

/// The data that files contain. It borrows all members.
struct Description {
  const Robot& robot;
  const RobotSpheres& spheres;
  const SelfCollision& self_collision;
  const OutputOptions& options;
};

/// A file of a format, before it is written.
struct OutputFile {
  std::string name;   ///< path relative to OutputOptions::folder
  std::string bytes;  ///< contents
};

/// A file format for robots of spheres.
struct OutputFormat {
  std::string_view name;    ///< name of the format in the command, such as "curobo"
  std::string_view files;   ///< names of its files, separated by spaces; ROBOT and LINK stand for names
  std::string_view reader;  ///< programs that read it, or its contents
  std::vector<OutputFile> (*write)(const Description&);  ///< makes the files, and writes nothing to the disk
};
/// All formats, in the order of extras/robot/docs/robot_files.md.
std::span<const OutputFormat> output_formats();
/// The format of this name; nullptr if there is none.
const OutputFormat* output_format(std::string_view name);

/// A guess for the tool: the name of the link that the most independent joints carry, the first of equals in
/// Robot::order; or of its parent, such as a gripper's palm, if other joints move links of that parent too.
std::string guess_tool(const Robot& robot);

/// Reads the spheres of a spheres.json that the format "json" wrote, by the names of links. Throws FileError for a file
/// that cannot be read, has another format, or has a sphere with a radius of 0 or less or a number of 1e30 or more.
std::map<std::string, std::vector<Sphere>> read_robot_spheres(const std::filesystem::path& path);

}  // namespace morula::robot
