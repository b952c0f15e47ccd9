// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Manifest: the meshes of a batch, and the key of each.
#pragma once

#include <filesystem>
#include <morula/io/file_reference.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula::cli {

/// The text that replaces the mesh's name in messages of results, whose name differs between rows that share a result.
inline constexpr std::string_view mesh_mark = "{mesh}";

struct ManifestRow {
  std::string name;            ///< name in the manifest, or the path within the folder; bytes, perhaps not UTF-8
  std::string reference;       ///< the mesh as written there; for a folder's rows the same as `name`
  std::filesystem::path mesh;  ///< file of the mesh
  std::string rejection{};     ///< message for a row that the listing of a folder rejects; else empty
};

/// The rows of a folder, of a .csv with a column `mesh`, `path` or `file` (and `name`, perhaps), or of any other text:
/// one path a line, lines that begin with # left out. Paths are relative to the manifest's folder. A folder's rows, by
/// name, are everything below it with the extension of a mesh, and what may hide meshes: folders that cannot be listed,
/// links to folders, links that lead nowhere. Throws UsageError, naming the line, for a file that cannot be read, and
/// for a manifest without rows.
std::vector<ManifestRow> read_manifest(const std::filesystem::path& path);
/// The same for the text of a manifest, whose paths are relative to `folder`.
std::vector<ManifestRow> rows_of_manifest(const std::string& text, bool is_csv, const std::filesystem::path& folder);

/// "2/8": the second of eight parts of equal size, taken in turn.
struct Shard {
  std::size_t number = 1, count = 1;

  bool has(std::size_t row) const { return row % count == number - 1; }
  bool is_all() const { return count == 1; }
};
Shard parse_shard(const std::string& text);

/// A row's result has a key, 128 bits in hexadecimal, or there is none, and a message gives the reason.
struct RowKey {
  std::string key, message;
};

/// The key of a file: of its bytes, its extension, the options and the version. Files that are alike share a result.
/// The buffers that a .gltf or .glb names in its folder count as parts of it. roots: the folders in which it has to
/// lie; null: anywhere.
RowKey key_of_file(const ManifestRow& row, const std::vector<std::string>& words, const FileRoots* roots);
/// The same for bytes: of the mesh, and of the buffers that it names, in its order.
std::string key_of_bytes(std::span<const std::string_view> files, const std::string& extension,
                         const std::vector<std::string>& words);
/// The files that a .gltf or .glb names as its buffers, as they are written; empty for all other meshes.
std::vector<std::string> buffers_of(std::string_view mesh, const std::string& extension);

}  // namespace morula::cli
