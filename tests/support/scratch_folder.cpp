// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "support/scratch_folder.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>

namespace morula::test {
namespace fs = std::filesystem;

ScratchFolder::ScratchFolder() {
  const std::string stem = "morula-test-" + std::to_string(std::random_device()()) + "-";
  // One that is there already belongs to somebody else.
  for (int n = 0; path_.empty() || !fs::create_directory(path_); ++n)
    path_ = fs::temp_directory_path() / (stem + std::to_string(n));
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path ScratchFolder::file(const fs::path& name, std::string_view bytes) const {
  const fs::path path = path_ / name;
  fs::create_directories(path.parent_path());
  // Some file systems wait for the disk when a file is cut to nothing and written again; a new one does not matter.
  fs::remove(path);
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return path;
}

std::vector<std::string> ScratchFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

void ScratchFolder::clear() const {
  for (const auto& entry : fs::directory_iterator(path_)) fs::remove_all(entry);
}

bool can_make_links() {
#ifdef _WIN32
  static const bool can = [] {
    const ScratchFolder folder;
    std::error_code error;
    fs::create_symlink("target", folder.path() / "link", error);
    return fs::is_symlink(folder.path() / "link", error);
  }();
  return can;
#else
  return true;
#endif
}

std::string bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace morula::test
