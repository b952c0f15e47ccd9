// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// NumPy's array files, as far as the library needs them: float32 or float64 in C order; int32 is only written.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.hpp"

namespace morula::detail {

struct NpyArray {
  bool is_double = false;
  std::vector<std::uint64_t> shape{};
  std::string shape_text{};  ///< as the file has it, in quotes
  std::size_t data_offset = 0;

  std::size_t scalar_size() const { return is_double ? 8 : 4; }
};

/// What an array has to look like.
struct NpyShape {
  std::size_t dimensions;
  std::uint64_t last;      ///< size of the last dimension; 0: any
  std::string_view words;  ///< for messages: "(frames, vertices, 3)"
};

/// Reads the header, versions 1 to 3, and checks that the file has exactly the size it promises. Throws FileError.
NpyArray read_npy_header(const ByteSource& source, const NpyShape& needed);

/// `count` numbers, the first of them after `first` others. Throws FileError when the file has changed meanwhile.
std::vector<double> read_npy_values(const ByteSource& source, const NpyArray& array, std::uint64_t first,
                                    std::size_t count);

/// Everything that comes before the numbers in a file of version 1. descr: "<f8" or "<i4".
std::string npy_start(std::string_view descr, std::span<const std::size_t> shape);
/// Files of version 1; values.size() must be the product of the shape.
std::string npy_bytes(std::span<const double> values, std::span<const std::size_t> shape);
std::string npy_bytes(std::span<const std::int32_t> values, std::span<const std::size_t> shape);

}  // namespace morula::detail
