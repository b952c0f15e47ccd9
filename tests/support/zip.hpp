// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Archives of arrays as other programs write them, made byte by byte.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace morula::test {

struct ZipMember {
  std::string name, bytes;
  std::uint16_t method = 0, flags = 0;
};

/// The checksum of zip archives, bit by bit.
std::uint32_t plain_crc(const std::string& bytes);
/// As numpy.savez writes them: 64-bit sizes in the local headers, ordinary ones in the directory.
std::string zip(const std::vector<ZipMember>& members);

}  // namespace morula::test
