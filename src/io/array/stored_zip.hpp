// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Zip archives whose files are stored uncompressed, as numpy.savez and this library write them (PKWARE APPNOTE 6.3,
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

/// CRC-32 of ISO 3309, as in zip and PNG.
class Crc32 {
 public:
  void add(std::string_view bytes);
  std::uint32_t value() const { return ~remainder_; }

 private:
  std::uint32_t remainder_ = 0xffffffffu;
};

/// An archive that is written as its files come: only the directory is kept in memory.
class StoredZip {
 public:
  /// The largest archive, bytes. A larger one does not fit the 32-bit sizes and offsets of the plain format.
  static constexpr std::uint64_t largest = 0xfffffffeu;

  explicit StoredZip(const std::filesystem::path& path) : file_(path) {}

  /// Adds a file. Names are in ASCII, each is used once.
  void add(std::string_view name, std::string_view bytes);
  /// Begins a file that comes in parts, which have `size` bytes together.
  void begin(std::string_view name, std::uint64_t size);
  void append(std::string_view bytes);
  void end();
  /// Completes the archive, which appears under its name; it must not be larger than `largest`. No dates: the same
  /// files give the same bytes.
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

/// A file of an archive from which a caller reads.
struct ZipEntry {
  std::string name;
  std::uint64_t offset;  ///< offset of its bytes in the archive
  std::uint64_t size;
  std::uint32_t crc;
};
/// The files of an archive, including those with 64-bit sizes, in the order of its directory; every one lies inside the
/// archive. Throws FileError, also for files that are compressed or encrypted.
std::vector<ZipEntry> zip_entries(const ByteSource& archive);
/// The bytes of one of these files; messages name it "ARCHIVE: NAME".
ByteSource zip_part(const ByteSource& archive, const ZipEntry& entry);
/// Throws FileError unless the bytes have the checksum of the directory. Reads them part by part.
void require_sound(const ByteSource& archive, const ZipEntry& entry);

}  // namespace morula::detail
