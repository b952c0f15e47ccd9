// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Inputs and motions by name, so that tests, benchmarks and the demo speak of the same things.
#pragma once

#include <filesystem>
#include <morula/deform/deformation.hpp>
#include <optional>
#include <string>
#include <vector>

namespace morula::scenes {

struct NamedMotion {
  std::string name;  ///< as describe() says it, such as "bend 90"
  Deformations deformations;
};

/// Stretch to twice the length, twist by 180°, bend by 90°, poke, noise, rotate by 90°: one of each kind, all along the
/// longest side. Every one of them is valid for every mesh that is not a single point.
std::vector<NamedMotion> standard_motions();

/// Where the downloaded meshes are: the environment variable MORULA_CORPUS, else build/corpus in the source folder.
/// Nothing when MORULA_CORPUS is unset and that folder does not exist, or when MORULA_CORPUS is set but empty.
/// Throws std::invalid_argument when MORULA_CORPUS names something that is not a folder.
std::optional<std::filesystem::path> corpus_folder();

/// All .obj, .off, .ply and .stl files in or below the corpus folder, sorted by path; none without the folder.
std::vector<std::filesystem::path> corpus_meshes();

}  // namespace morula::scenes
