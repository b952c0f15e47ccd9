// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --scene`: many bodies from a file, frame by frame.
#pragma once

#include <filesystem>
#include <morula/scene/scene.hpp>
#include <string>
#include <vector>

namespace morula::cli {

struct SceneRun {
  std::string file;
  std::vector<std::filesystem::path> roots;  ///< besides its own folder
  SceneOptions options;
  std::string rule;  ///< one, or one per level with commas between
  std::string sph_origin;
  std::string budget;  ///< as given
  std::string output;
  std::string page;
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError, naming file and key, before anything is written.
int collide_scene(const SceneRun& run);

}  // namespace morula::cli
