// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Specimen of seeds and fuzzers: a body that files are read for.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <string>
#include <string_view>

namespace morula::fuzz {

/// A tetrahedron: the smaller the files that belong to a mesh, the more of them are tried.
const Mesh& specimen_mesh();

/// A folder for this process alone, removed at its end.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Removes what is in it.
  void clear() const;
  void write(const std::filesystem::path& name, std::string_view bytes) const;

 private:
  std::filesystem::path path_;
};

}  // namespace morula::fuzz
