// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Deflated bytes made long again, as zlib packs them (RFC 1950 and 1951).
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace morula::detail {

/// The bytes that a zlib stream holds; nothing where it is damaged, its checksum is wrong, or it holds more or fewer
/// than `size`. Takes memory as bytes come, never by what is promised.
std::optional<std::string> inflate_zlib(std::string_view packed, std::size_t size);

}  // namespace morula::detail
