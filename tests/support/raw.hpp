// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Numbers as bytes, for files that tests make by hand.
#pragma once

#include <string>
#include <vector>

namespace morula::test {

/// Numbers as they lie in binary files.
template <class Value>
std::string raw(Value value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof value);
  return big_endian ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

template <class Value>
std::string raw(const std::vector<Value>& values) {
  std::string bytes;
  for (const Value value : values) bytes += raw(value);
  return bytes;
}

}  // namespace morula::test
