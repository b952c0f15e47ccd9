// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bytes of files: read without waiting, and hashed.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace morula::cli {

/// 128 bits: FNV-1a from two beginnings. It finds damage, and files that differ; it is no defense against forgery.
class Hash128 {
 public:
  void take(std::string_view bytes);
  /// 32 hexadecimal digits.
  std::string text() const;

 private:
  std::array<std::uint64_t, 2> hash_{0xcbf29ce484222325u, 0x84222325cbf29ce4u};
};
std::string hash_of_bytes(std::string_view bytes);

/// The reason why no file can be read there: "is a FIFO, not a file". None for a file. Opens nothing.
std::optional<std::string> why_no_file(const std::filesystem::path& path);

/// The bytes of a file, up to `limit` of them. None if there is no file, it cannot be read, or it is larger. The
/// function does not wait for FIFOs and devices.
std::optional<std::string> bytes_of_file(const std::filesystem::path& path, std::uintmax_t limit = UINTMAX_MAX);
/// Hashes a file. Returns the reason if it cannot be read.
std::optional<std::string> hash_file(const std::filesystem::path& path, Hash128& hash);

}  // namespace morula::cli
