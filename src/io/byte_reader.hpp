// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A reader of untrusted binary files. Shared by binary PLY, STL, .npy and .morula.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <morula/io/mesh_file.hpp>
#include <string>
#include <string_view>
#include <type_traits>

#include "platform/path_text.hpp"

namespace morula::detail {

static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);

/// The value whose bytes lie at `bytes`, in the given order.
template <class Value>
requires(std::is_arithmetic_v<Value>) Value load(const char* bytes, std::endian order = std::endian::little) {
  std::array<char, sizeof(Value)> raw;
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = bytes[order == std::endian::native ? i : raw.size() - 1 - i];
  return std::bit_cast<Value>(raw);
}

/// Appends the bytes of the value, lowest first.
template <class Value>
requires(std::is_arithmetic_v<Value>) void store(std::string& bytes, Value value) {
  auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(value);
  if (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// Every error is a FileError "FILE: byte N: what is wrong; remedy", N counted from the start of the file.
class ByteReader {
 public:
  /// bytes: the whole file or its tail; base: the place of its first byte in the file. The bytes must outlive the
  /// reader.
  ByteReader(const std::filesystem::path& path, std::string_view bytes, std::endian order, std::size_t base = 0)
      : path_(path), bytes_(bytes), order_(order), base_(base) {}

  /// `what` completes "the file ends inside …".
  template <class Value>
  Value read(std::string_view what) {
    require(sizeof(Value), what);
    const Value value = load<Value>(bytes_.data() + at_, order_);
    at_ += sizeof(Value);
    return value;
  }
  void skip(std::size_t count, std::string_view what) {
    require(count, what);
    at_ += count;
  }
  std::size_t bytes_left() const { return bytes_.size() - at_; }
  [[noreturn]] void fail(const std::string& problem) const {
    throw FileError(platform::text_of(path_) + ": byte " + std::to_string(base_ + at_) + ": " + problem);
  }

 private:
  void require(std::size_t count, std::string_view what) const {
    if (count > bytes_left())
      fail("the file ends inside " + std::string(what) + "; it was cut short, or its counts are wrong");
  }

  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::endian order_;
  std::size_t base_;
};

}  // namespace morula::detail
