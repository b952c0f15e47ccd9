// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bytes that are read part by part: the bytes of a file, or bytes in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace morula::detail {

class ByteSource {
 public:
  /// A file, which is opened for every part. The constructor is implicit, so that functions that take a source also
  /// take a path.
  ByteSource(std::filesystem::path file) : name_(std::move(file)), file_(name_) {}
  /// Bytes in memory, which must outlive the source; the name is for messages.
  ByteSource(std::filesystem::path name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {}

  /// `count` bytes of this source from `offset` on, which must lie inside it; the name is for messages.
  ByteSource part(std::filesystem::path name, std::uintmax_t offset, std::uintmax_t count) const;

  /// For messages.
  const std::filesystem::path& name() const { return name_; }
  /// The size, like size_of_file. Throws FileError.
  std::uintmax_t size() const;
  /// Reads `count` bytes from `offset` on, like read_part. Throws FileError, also if there are fewer.
  std::string read(std::uintmax_t offset, std::uintmax_t count) const;

 private:
  std::filesystem::path name_;
  std::filesystem::path file_{};  // file of the bytes; empty: they are in memory
  std::optional<std::string_view> bytes_{};
  std::uintmax_t begin_ = 0;  // begin of a part of a file
  std::optional<std::uintmax_t> count_{};
};

}  // namespace morula::detail
