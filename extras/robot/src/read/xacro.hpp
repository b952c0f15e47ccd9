// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Macros of robots' files (xacro), which the program of that name expands.
#pragma once

#include <morula/robot/robot.hpp>
#include <string>
#include <vector>

#include "read/xml.hpp"

namespace morula::robot {

/// The first element, or the root for an attribute with "${" or "$(", that only xacro understands; nullptr: none.
const tinyxml2::XMLElement* find_xacro(const Xml& xml);

/// Runs the program of the options on the file, without a shell, and returns what it prints. Throws FileError, with a
/// remedy, if there is no such program, if it fails, with its message, or if it prints more than a file may hold;
/// std::invalid_argument for arguments that are not NAME:=VALUE.
std::string expand_xacro(const std::filesystem::path& file, int line, const ReadOptions& options);

/// The files that the program reads for this one, without it: what it prints for `--deps`, in the order of their names.
/// Empty if the program fails, as one without that option does.
std::vector<std::filesystem::path> files_of_xacro(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace morula::robot
