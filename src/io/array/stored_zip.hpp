// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Zip archives whose files are stored as they are, uncompressed: what numpy.savez writes (PKWARE APPNOTE 6.3, 4.3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <morula/io/whole_output.hpp>
#include <string>
#include <string_view>

namespace morula::detail {

/// CRC-32 of ISO 3309, as zip and PNG have it.
class Crc32 {
 public:
  void add(std::string_view bytes);
  std::uint32_t value() const { return ~remainder_; }

 private:
  std::uint32_t remainder_ = 0xffffffffu;
};

/// Written as it comes: nothing is kept but the directory.
class StoredZip {
 public:
  /// More does not fit the 32-bit sizes and offsets of the plain format.
  static constexpr std::uint64_t largest = 0xfffffffeu;

  explicit StoredZip(const std::filesystem::path& path) : file_(path) {}

  /// Names in ASCII, each once.
  void add(std::string_view name, std::string_view bytes);
  /// The same in pieces, which are `size` bytes together.
  void begin(std::string_view name, std::uint64_t size);
  void append(std::string_view bytes);
  void end();
  /// The archive appears; it must not be larger than `largest`. No dates: the same files give the same bytes.
  void commit();

 private:
  WholeFile file_;
  std::uint64_t written_ = 0;
  std::string directory_;  // central headers
  std::uint16_t count_ = 0;
  // The file being added.
  std::string name_;
  std::uint64_t offset_ = 0, size_ = 0;
  Crc32 crc_;
};

}  // namespace morula::detail
