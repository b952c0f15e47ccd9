// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scene files: bodies with their meshes, trees, motions, places and groups, as JSON. docs/how-to/scene.md has the keys.
#pragma once

#include <cstdint>
#include <filesystem>
#include <morula/geometry/rigid_transform.hpp>
#include <string>
#include <vector>

namespace morula::cli {

struct SceneFileBody {
  std::string name;
  std::filesystem::path mesh, tree{}, motion{};  ///< paths relative to the working folder; empty: none
  RigidTransform transform{};
  std::vector<Vec3> path{};  ///< translation per frame, relative to its transform
  bool is_static = false;
  std::uint32_t category = 1, mask = ~std::uint32_t{0};
  double weight = 1;

  bool operator==(const SceneFileBody&) const = default;
};

/// Names are relative to the scene file. With symbolic links resolved, a file lies in its folder or in one of `roots`.
/// Throws UsageError, naming file and key and with the remedy.
std::vector<SceneFileBody> read_scene_file(const std::filesystem::path& file,
                                           const std::vector<std::filesystem::path>& roots = {});

}  // namespace morula::cli
