// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that are not what their names say, known by their first bytes.
#pragma once

#include <string>
#include <string_view>

namespace morula::detail {

/// The bytes begin a pointer that Git LFS left in the place of a file.
bool is_lfs_pointer(std::string_view bytes);
inline constexpr std::string_view lfs_remedy = "is a pointer of Git LFS, not the file itself; run: git lfs pull";

/// What a file is that has no business under this extension of a mesh (lower case, with the dot), and what to do, as in
/// "is packed by gzip; unpack it"; empty where nothing speaks against it.
std::string foreign_content(std::string_view bytes, std::string_view extension);

}  // namespace morula::detail
