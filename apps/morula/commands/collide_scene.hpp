// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// `morula collide --scene`: many bodies from a file, frame by frame.
#pragma once

#include <morula/scene/scene.hpp>
#include <morula/update/rules.hpp>
#include <string>
#include <vector>

namespace morula::cli {

struct SceneRun {
  std::string file;
  SceneOptions options;
  std::vector<Rule> rules;
  std::string sph_origin;
  std::string budget;  ///< as given
  std::string output;
  std::string page;
  std::string rule;  ///< as given
  unsigned threads = 0;
  bool json = false;
};

/// Returns the exit code. Throws UsageError, naming file and key, before anything is written.
int collide_scene(const SceneRun& run);

}  // namespace morula::cli
