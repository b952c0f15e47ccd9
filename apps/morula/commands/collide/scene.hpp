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
  std::vector<std::filesystem::path> roots;  ///< allowed folders besides its own
  SceneOptions options;
  std::string rule;  ///< one rule, or one per level, separated by commas
  std::string sph_origin;
  std::string budget;  ///< budget as given
  std::string output;
  std::string page;
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError, naming file and key, before anything is written.
int collide_scene(const SceneRun& run);

}  // namespace morula::cli
