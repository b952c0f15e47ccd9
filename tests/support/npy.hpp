// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// NumPy's arrays as files, made byte by byte.
#pragma once

#include <cstdint>
#include <string>
#include <support/raw.hpp>
#include <vector>

namespace morula::test {

/// A file of that version with that dictionary as its header, right or wrong.
inline std::string npy_with_header(const std::string& dictionary, const std::string& data, int version = 1) {
  const std::string length = version == 1 ? raw(static_cast<std::uint16_t>(dictionary.size()))
                                          : raw(static_cast<std::uint32_t>(dictionary.size()));
  return "\x93NUMPY" + std::string(1, static_cast<char>(version)) + std::string(1, '\0') + length + dictionary + data;
}

/// descr: as "<f8"; shape: as "(3, 4)".
inline std::string npy(const std::string& descr, const std::string& shape, const std::string& data) {
  return npy_with_header("{'descr': '" + descr + "', 'fortran_order': False, 'shape': " + shape + ", }\n", data);
}

template <class Value>
std::string npy(const std::string& descr, const std::string& shape, const std::vector<Value>& values) {
  return npy(descr, shape, raw(values));
}

}  // namespace morula::test
