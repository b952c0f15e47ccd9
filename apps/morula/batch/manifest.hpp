// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Manifest: which meshes a batch is of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace morula::cli {

struct ManifestRow {
  std::string name;            ///< what the table calls it: as the manifest has it, or the path within the folder
  std::filesystem::path mesh;  ///< where it is
};

/// The rows of a folder (every mesh below it, by name), of a .csv with a column `mesh`, `path` or `file` (and `name`,
/// perhaps), or of any other text: one path a line, lines that begin with # left out. Paths are relative to the
/// manifest's folder. Throws UsageError, naming the line, for what cannot be read, and for a manifest without rows.
std::vector<ManifestRow> read_manifest(const std::filesystem::path& path);

/// "2/8": the second of eight parts of equal size, taken in turn.
struct Shard {
  std::size_t number = 1, count = 1;

  bool has(std::size_t row) const { return row % count == number - 1; }
  bool is_all() const { return count == 1; }
};
Shard parse_shard(const std::string& text);

/// What a result is known by: 128 bits of the file's bytes, the options, and the version, in hexadecimal. Files alike
/// share a result. Throws FileError when the file cannot be read.
std::string content_key(const std::filesystem::path& mesh, std::string_view options);

}  // namespace morula::cli
