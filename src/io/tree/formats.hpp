// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tree formats, one reader and writer each, from and to bytes in memory. docs/reference/formats.md describes them.
#pragma once

#include <filesystem>
#include <morula/io/tree_file.hpp>
#include <string>
#include <string_view>

namespace morula::detail {

/// The result of read_tree and read_covered_tree for a file with these bytes; the extension of the path gives the
/// format.
TreeFile tree_of_bytes(const std::filesystem::path& path, std::string_view bytes, const ReadTreeOptions& options);
CoveredTree built_of_file(const std::filesystem::path& path, TreeFile file, const MeshView& mesh, Workers& workers);
/// The same for a file that has its cover, as all of read_native have.
CoveredTree covered_by_file(const std::filesystem::path& path, TreeFile file, const MeshView& mesh);

/// Readers check all data that they use; the trees that they return have passed validate(). path is for messages.
SphereTree read_sph(const std::filesystem::path& path, std::string_view text, const Vec3& origin);
SphereTree read_json_tree(const std::filesystem::path& path, std::string_view text);
TreeFile read_native(const std::filesystem::path& path, std::string_view bytes);

/// Trees and covers must be valid. path is for errors. Throws FileError when the format cannot hold the tree.
std::string sph_text(const std::filesystem::path& path, const SphereTree& tree);
std::string json_tree_text(const SphereTree& tree);
std::string native_bytes(const CoveredTree& model);

/// Throws FileError with the first finding of validate(), if there is one.
void require_valid(const std::filesystem::path& path, const SphereTree& tree);

}  // namespace morula::detail
