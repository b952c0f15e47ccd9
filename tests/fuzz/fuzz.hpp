// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What all fuzzers share: the entry that libFuzzer and the plain driver call, bytes as numbers, and how a finding ends
// the program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace morula::fuzz {

/// Where findings are printed: what stderr was when this was called first.
std::FILE* report();
/// What the library's programs print is of no interest: both streams lead nowhere from now on. Only findings, and what
/// sanitizers say, are still seen.
void silence();

/// Prints the promise that was broken and aborts: a finding for both drivers.
[[noreturn]] void found(const std::string& what);
inline void require(bool holds, const char* what) {
  if (!holds) found(what);
}

/// Input as a stream of small numbers; zeros once it is used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

  bool empty() const { return at_ == end_; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  std::uint8_t byte() { return empty() ? std::uint8_t{0} : *at_++; }
  /// 0…bound - 1; bound at most 256.
  std::size_t below(std::size_t bound) { return byte() % bound; }
  bool flag() { return (byte() & 1) != 0; }
  float float32();
  double float64();
  std::string_view rest() const { return {reinterpret_cast<const char*>(at_), left()}; }

 private:
  template <class Value>
  Value raw();

  const std::uint8_t* at_;
  const std::uint8_t* end_;
};

/// While it lives, counts what operator new is asked for. What a reader takes must stand in proportion to its input.
class MemoryMeter {
 public:
  MemoryMeter();
  /// A finding unless all allocations together, freed or not, were 64 MiB or less, and for inputs above 1 kB so much
  /// more as they are longer.
  void require_modest(std::size_t input_size) const;

 private:
  std::size_t before_;
};

/// A message is one line that begins with the file's name.
void require_good_message(std::string_view message, std::string_view file);

}  // namespace morula::fuzz
