// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whole files, read into memory. For written files see morula/io/whole_output.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <morula/io/whole_output.hpp>
#include <string>
#include <string_view>

namespace morula::detail {

/// Size in bytes. Throws FileError when the file is missing, a folder, no regular file, or unreadable.
std::uintmax_t size_of_file(const std::filesystem::path& path);

/// All its bytes. Throws FileError like size_of_file, or when it is too large for memory.
std::string read_whole(const std::filesystem::path& path);

/// Reads `count` bytes from `offset` on, which must lie inside the file. Throws FileError.
std::string read_part(const std::filesystem::path& path, std::uintmax_t offset, std::uintmax_t count);

/// Bytes read or written between two checks for interruption.
inline constexpr std::size_t bytes_per_look = std::size_t{1} << 22;

/// The system's text for an errno.
std::string reason(int error);

/// The extension with its dot, in lower case.
std::string lower_extension(const std::filesystem::path& path);

/// Text from a file or a name as a message may show it: in quotes, without control characters, of limited length.
std::string in_quotes(std::string_view text);

}  // namespace morula::detail
