// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Folders that hold one file per frame.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// Files with one of these extensions (lower case, with the dot) whose name matches `pattern`, in name order with runs
/// of digits compared as numbers. In a pattern * stands for any characters, ? for one. Hidden files are left out.
///
/// Throws FileError when the folder cannot be read, and when a frame is missing: where all names are the same but for
/// one number, the numbers have to go up in equal steps.
std::vector<std::filesystem::path> frame_files(const std::filesystem::path& folder, std::string_view pattern,
                                               const std::set<std::string>& extensions);

}  // namespace morula
