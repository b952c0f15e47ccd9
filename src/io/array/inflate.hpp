// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Inflates a zlib stream (RFC 1950 and 1951). Own code, so that file reading needs no library on any platform; zlib is
// the oracle of its tests.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace morula::detail {

/// The bytes that a zlib stream holds; none if it is damaged, its checksum is wrong, or it holds more or fewer than
/// `size` bytes. Memory grows with the bytes read, never by a promised size.
std::optional<std::string> inflate_zlib(std::string_view packed, std::size_t size);

}  // namespace morula::detail
