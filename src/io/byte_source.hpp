// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bytes that are read part by part: a file's, or some that are in memory already.
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
  /// A file, which is opened for every part. Implicit, so that what takes a source takes a path.
  ByteSource(std::filesystem::path file) : name_(std::move(file)), file_(name_) {}
  /// Bytes that must outlive the source; the name is for messages.
  ByteSource(std::filesystem::path name, std::string_view bytes) : name_(std::move(name)), bytes_(bytes) {}

  /// `count` bytes of this source from `offset` on, which must lie inside it; the name is for messages.
  ByteSource part(std::filesystem::path name, std::uintmax_t offset, std::uintmax_t count) const;

  /// For messages.
  const std::filesystem::path& name() const { return name_; }
  /// As size_of_file. Throws FileError.
  std::uintmax_t size() const;
  /// As read_part: `count` bytes from `offset` on. Throws FileError, also where there are fewer.
  std::string read(std::uintmax_t offset, std::uintmax_t count) const;

 private:
  std::filesystem::path name_;
  std::filesystem::path file_{};  // where the bytes are, unless they are in memory
  std::optional<std::string_view> bytes_{};
  std::uintmax_t begin_ = 0;  // of a part of a file
  std::optional<std::uintmax_t> count_{};
};

}  // namespace morula::detail
