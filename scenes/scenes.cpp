// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdlib>
#include <scenes/scenes.hpp>
#include <stdexcept>
#include <string_view>

namespace morula::scenes {

std::vector<NamedMotion> standard_motions() {
  std::vector<NamedMotion> motions;
  for (const Deformation& deformation : Deformations{Stretch{}, Twist{}, Bend{}, Poke{}, Noise{}, Rotate{}})
    motions.push_back({describe(deformation), {deformation}});
  return motions;
}

std::optional<std::filesystem::path> corpus_folder() {
  namespace fs = std::filesystem;
  if (const char* chosen = std::getenv("MORULA_CORPUS")) {
    const fs::path folder = chosen;
    if (folder.empty()) return std::nullopt;
    if (!fs::is_directory(folder))
      throw std::invalid_argument("MORULA_CORPUS is '" + folder.string() + "', which is not a folder");
    return folder;
  }
  const fs::path folder = MORULA_DEFAULT_CORPUS;
  std::error_code unreadable;
  if (fs::is_directory(folder, unreadable)) return folder;
  return std::nullopt;
}

std::vector<std::filesystem::path> corpus_meshes() {
  constexpr std::array<std::string_view, 4> extensions{".obj", ".off", ".ply", ".stl"};
  std::vector<std::filesystem::path> meshes;
  const std::optional<std::filesystem::path> folder = corpus_folder();
  if (!folder) return meshes;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*folder)) {
    const std::string extension = entry.path().extension().string();
    if (entry.is_regular_file() && std::find(extensions.begin(), extensions.end(), extension) != extensions.end())
      meshes.push_back(entry.path());
  }
  std::sort(meshes.begin(), meshes.end());
  return meshes;
}

}  // namespace morula::scenes
