// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Zip archives whose files are stored as they are, uncompressed: what numpy.savez writes (PKWARE APPNOTE 6.3, 4.3).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace morula {

/// CRC-32 of ISO 3309, as zip and PNG have it.
std::uint32_t crc32(std::string_view bytes);

class StoredZip {
 public:
  /// More does not fit the 32-bit sizes and offsets of the plain format.
  static constexpr std::uint64_t largest = 0xfffffffeu;

  /// Names in ASCII, each once.
  void add(std::string_view name, std::string_view bytes);
  /// The archive, which must not be larger than `largest`; nothing may be added afterwards. No dates: the same files
  /// give the same bytes.
  std::string finish();

 private:
  std::string bytes_;      // local headers and files
  std::string directory_;  // central headers
  std::uint16_t count_ = 0;
};

}  // namespace morula
