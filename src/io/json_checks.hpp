// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Checks of untrusted JSON: every error names the file. For sources that use nlohmann-json.
#pragma once

#include <filesystem>
#include <morula/io/mesh_file.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace morula::detail {

class JsonFile {
 public:
  /// Throws FileError with the line when the text is not JSON.
  JsonFile(const std::filesystem::path& path, std::string_view text);

  const nlohmann::json& root() const { return root_; }
  /// `owner` names the object in messages.
  const nlohmann::json& member(const nlohmann::json& object, const char* key, const std::string& owner) const;
  std::uint64_t unsigned_member(const nlohmann::json& object, const char* key, const std::string& owner) const;
  /// A flag; a missing member counts as false.
  bool flag(const nlohmann::json& object, const char* key, const std::string& owner) const;
  /// Frees the lists of the root, element by element, and checks in between whether to go on: millions of them take
  /// tenths of a second. The root may not be used afterwards.
  void forget_lists();
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::string name_;
  nlohmann::json root_;
};

}  // namespace morula::detail
