// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A glTF file as tinygltf decodes it: structures whose indices, sizes and types are not checked yet.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/gltf/tinygltf.hpp"

namespace morula::gltf {

struct LoadedModel {
  morula_tinygltf::Model model;
  std::size_t bytes;               ///< number of bytes of the text and of all buffers
  std::vector<std::string> notes;  ///< notes on extensions that are used and not read
};

/// bytes: of a .gltf or a .glb, distinguished by their first bytes. Buffers in other files next to it are read. Throws
/// FileError.
LoadedModel load_model(const std::filesystem::path& path, std::string_view bytes);

}  // namespace morula::gltf
