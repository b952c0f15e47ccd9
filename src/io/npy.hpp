// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// NumPy's array files, as far as motions need them: float32 or float64, shape (frames, vertices, 3), C order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace morula {

struct NpyArray {
  bool is_double = false;
  std::uint64_t frame_count = 0;
  std::uint64_t vertex_count = 0;
  std::size_t data_offset = 0;
};

/// Reads the header, versions 1 to 3, and checks that the file has exactly the size it promises. Throws FileError.
NpyArray read_npy_header(const std::filesystem::path& path);

/// A float64 array file of version 1; values.size() must be frame_count × vertex_count × 3.
std::string npy_bytes(std::span<const double> values, std::size_t frame_count, std::size_t vertex_count);

}  // namespace morula
