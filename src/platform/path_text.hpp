// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Paths as text in UTF-8. std::filesystem::path::string() gives the code page of the program on Windows, and throws for
// names that this code page lacks.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace morula::platform {

/// A path as text: UTF-8 on Windows, without the mark of long ones (platform::openable()); the bytes of the name
/// elsewhere.
inline std::string text_of(const std::filesystem::path& path) {
  const std::u8string text = path.u8string();
  std::string result(reinterpret_cast<const char*>(text.data()), text.size());
#ifdef _WIN32
  if (result.starts_with("\\\\?\\UNC\\")) return "\\\\" + result.substr(8);
  if (result.starts_with("\\\\?\\")) return result.substr(4);
#endif
  return result;
}

/// The path that a text in UTF-8 names; elsewhere than on Windows, any bytes.
inline std::filesystem::path path_of(std::string_view text) {
  return std::u8string_view(reinterpret_cast<const char8_t*>(text.data()), text.size());
}

}  // namespace morula::platform
