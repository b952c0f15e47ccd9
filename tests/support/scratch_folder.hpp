// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Folders for tests to write in.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace morula::test {

/// A folder that nobody else has, empty at first, removed with all that is in it at the end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file, in folders made for it if need be, and returns its path.
  std::filesystem::path file(const std::filesystem::path& name, std::string_view bytes) const;
  /// Names of all that lies directly in it, hidden ones included, sorted.
  std::vector<std::string> names() const;
  /// Removes what is in it.
  void clear() const;

 private:
  std::filesystem::path path_;
};

/// Whether this program may make symbolic links: always, but on Windows with a right that few have.
bool can_make_links();
inline constexpr const char* no_links = "this user may not make symbolic links";

/// Empty for a file that is not there.
std::string bytes_of(const std::filesystem::path& path);

}  // namespace morula::test
