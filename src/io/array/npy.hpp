// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// NumPy's array files, as far as the library needs them: float32 or float64, or integers of 32 or 64 bits, in C order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.hpp"

namespace morula::detail {

enum class NpyType { float32, float64, int32, uint32, int64, uint64 };

struct NpyArray {
  NpyType type = NpyType::float64;
  std::vector<std::uint64_t> shape{};
  std::string shape_text{};  ///< shape as in the file, in quotes
  std::size_t data_offset = 0;

  std::size_t scalar_size() const {
    return type == NpyType::float32 || type == NpyType::int32 || type == NpyType::uint32 ? 4 : 8;
  }
};

/// The required shape and type of an array.
struct NpyShape {
  /// Size of every dimension; 0: any. Only the last is checked; the others serve callers that check them with a message
  /// of their own, and the detection of axes in another order.
  std::vector<std::uint64_t> sizes;
  std::string_view words;     ///< text for messages: "(frames, vertices, 3)"
  std::string known_words{};  ///< the same text with the known sizes: "(frames, 100, 3)"; empty: `words`
  bool integers = false;      ///< true for integers; false for floating point
};

/// Reads the header, versions 1 to 3, and checks that the file has exactly the size in its header. Throws FileError;
/// for an array that would fit with its axes in another order the message has the line that transposes it.
NpyArray read_npy_header(const ByteSource& source, const NpyShape& needed);

/// The number of axes of an array of any type. Throws FileError when there is no header.
std::size_t npy_dimensions(const ByteSource& source);

/// Reads `count` numbers, from number `first` on. Throws FileError when the file has changed meanwhile.
std::vector<double> read_npy_values(const ByteSource& source, const NpyArray& array, std::uint64_t first,
                                    std::size_t count);
/// All numbers of an array of integers; numbers that do not fit 32 bits are rejected, −1 becomes `no_node` where it is
/// allowed. `what` names the array in messages: "array parent".
std::vector<std::uint32_t> read_npy_indices(const ByteSource& source, const NpyArray& array, const std::string& what,
                                            bool minus_one_is_none);

/// All bytes of a file of version 1 that precede the numbers. descr: "<f8" or "<i4".
std::string npy_start(std::string_view descr, std::span<const std::size_t> shape);
/// The bytes of a file of version 1; values.size() must be the product of the shape.
std::string npy_bytes(std::span<const double> values, std::span<const std::size_t> shape);
std::string npy_bytes(std::span<const std::int32_t> values, std::span<const std::size_t> shape);

}  // namespace morula::detail
