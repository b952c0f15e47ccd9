// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Names of files as descriptions of robots have them: UTF-8 on every system, and URIs among them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "platform/path_text.hpp"

namespace morula::robot {

/// A path as a description names it: UTF-8 with slashes.
inline std::string name_of_path(const std::filesystem::path& path) {
  const std::u8string text = path.generic_u8string();
  return {reinterpret_cast<const char*>(text.data()), text.size()};
}

/// Whether a name does not depend on the folder of the file that has it: a URI or an absolute path.
inline bool is_absolute_name(std::string_view name) {
  return name.find("://") != std::string_view::npos || platform::path_of(name).is_absolute();
}

}  // namespace morula::robot
