// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Zip archives whose files are stored as they are, uncompressed: what numpy.savez writes and we do (PKWARE APPNOTE 6.3,
// 4.3).
#pragma once

#include <cstdint>
#include <filesystem>
#include <morula/io/whole_output.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.hpp"

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

/// A file of an archive that is read.
struct ZipEntry {
  std::string name;
  std::uint64_t offset;  ///< of its bytes in the archive
  std::uint64_t size;
  std::uint32_t crc;
};
/// The files of an archive, with its 64-bit sizes too, as its directory lists them; every one lies inside the archive.
/// Throws FileError, also for files that are compressed or encrypted.
std::vector<ZipEntry> zip_entries(const ByteSource& archive);
/// The bytes of one of them; messages name it "ARCHIVE: NAME".
ByteSource zip_part(const ByteSource& archive, const ZipEntry& entry);
/// Throws FileError unless the bytes have the sum that the directory promises. Reads them a piece at a time.
void require_sound(const ByteSource& archive, const ZipEntry& entry);

}  // namespace morula::detail
