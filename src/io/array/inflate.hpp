// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Decompresses bytes that zlib compressed (RFC 1950 and 1951).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace morula::detail {

/// The bytes that a zlib stream holds; none if it is damaged, its checksum is wrong, or it holds more or fewer than
/// `size` bytes. Memory grows with the bytes read, never by a promised size.
std::optional<std::string> inflate_zlib(std::string_view packed, std::size_t size);

}  // namespace morula::detail
