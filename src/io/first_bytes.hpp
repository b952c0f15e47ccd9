// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files with a wrong extension, recognized by their first bytes.
#pragma once

#include <string>
#include <string_view>

namespace morula::detail {

/// Whether the bytes are the begin of a pointer that Git LFS left in the place of a file.
bool is_lfs_pointer(std::string_view bytes);
inline constexpr std::string_view lfs_remedy = "is a pointer of Git LFS, not the file itself; run: git lfs pull";

/// The foreign kind of a file under this extension of a mesh (lower case, with the dot), and the remedy, as in "is
/// packed by gzip; unpack it"; empty if the first bytes are of no known foreign kind.
std::string foreign_content(std::string_view bytes, std::string_view extension);

}  // namespace morula::detail
