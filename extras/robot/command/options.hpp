// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Arguments of morula robot, and the options of the library that they stand for.
#pragma once

#include <filesystem>
#include <morula/robot/output.hpp>
#include <optional>
#include <string>
#include <vector>

#include "shared/options.hpp"

namespace morula::cli {

struct RobotArguments {
  std::string robot, output;
  std::optional<std::size_t> spheres, max_total;
  std::string max_protrusion;  // a length, or a share as "1%"
  std::vector<std::string> links, skip, refit, package_paths, tools, formats, tree_kinds, clips, xacro_arguments;
  std::string keep, srdf, xacro = "xacro";
  double padding = 0, min_radius = 0, tolerance = 0;
  std::vector<double> tolerances;  // of the table
  std::optional<double> max_uncovered;
  std::optional<double> max_radius, clip_margin;
  std::optional<double> density;  // not given: that of FitOptions, and only for the report
  std::string geometry = "collision";
  std::string method{name(robot::FitOptions{}.method)}, quality;  // empty: that of FitOptions
  std::size_t samples = robot::SelfCollisionOptions{}.samples;
  std::size_t seed = 1, inner = 0;
  bool self_collision = false;
  bool page = false, all_formats = false, trees = false, json = false;  // trees: as --tree link
  unsigned threads = 0;
};

/// Adds an option for each member to `command`.
void add_robot_options(CLI::App& command, RobotArguments& o);
/// Throws UsageError when options contradict each other. Called before any file is read.
void require_sense(const RobotArguments& o);
std::vector<const robot::OutputFormat*> chosen_formats(const RobotArguments& o);
/// Throws UsageError for unknown links, FileError for the file of --keep.
robot::FitOptions fit_options(const RobotArguments& o, const robot::Robot& robot);
/// Folders of packages: those of --package-path, then those of the environment of ROS.
std::vector<std::filesystem::path> package_paths(const RobotArguments& o);
/// kind: "link" or "robot".
bool writes_tree(const RobotArguments& o, std::string_view kind);

}  // namespace morula::cli
