// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fuzz.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <support/allocations.hpp>

namespace morula::fuzz {

void found(const std::string& what) {
  std::fprintf(report(), "FINDING: %s\n", what.c_str());
  std::fflush(report());
  std::abort();
}

template <class Value>
Value Bytes::raw() {
  unsigned char bytes[sizeof(Value)];
  for (unsigned char& b : bytes) b = byte();
  Value value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

float Bytes::float32() {
  return raw<float>();
}

double Bytes::float64() {
  return raw<double>();
}

MemoryMeter::MemoryMeter() : before_(test::allocated_bytes) {}

void MemoryMeter::require_modest(std::size_t input_size) const {
  constexpr std::size_t most = std::size_t{64} << 20;
  const std::size_t taken = test::allocated_bytes - before_;
  if (taken > most / 1024 * std::max<std::size_t>(1024, input_size))
    found("an input of " + std::to_string(input_size) + " bytes made a reader allocate " + std::to_string(taken));
}

void require_good_message(std::string_view message, std::string_view file) {
  if (message.substr(0, file.size()) != file)
    found("a message that does not begin with the file: " + std::string(message));
  for (const char c : message)
    if (static_cast<unsigned char>(c) < ' ') found("a message with control characters: " + std::string(message));
}

}  // namespace morula::fuzz
