// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/array/inflate.hpp"

#include <array>
#include <cstdint>
#include <span>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

/// Bits of a stream, lowest first. Past the end they are 0, and `ended` is set.
class Bits {
 public:
  explicit Bits(std::string_view bytes) : bytes_(bytes) {}
  unsigned take(unsigned count) {
    unsigned value = 0;
    for (unsigned i = 0; i < count; ++i) value |= bit() << i;
    return value;
  }
  unsigned bit() {
    if (at_ / 8 >= bytes_.size()) {
      ended = true;
      return 0;
    }
    const unsigned value = (static_cast<unsigned char>(bytes_[at_ / 8]) >> (at_ % 8)) & 1u;
    ++at_;
    return value;
  }
  void to_byte() { at_ = (at_ + 7) / 8 * 8; }
  std::size_t byte() const { return at_ / 8; }

  bool ended = false;

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// A canonical code: the number of codes of each length, and their symbols in order.
class Code {
 public:
  /// Returns false if the lengths need more codes than there are.
  bool set(std::span<const std::uint8_t> lengths) {
    counts_.fill(0);
    for (const std::uint8_t length : lengths) ++counts_[length];
    counts_[0] = 0;
    int left = 1;
    std::array<std::uint16_t, 17> first{};
    for (std::size_t length = 1; length <= 15; ++length) {
      left = 2 * left - counts_[length];
      if (left < 0) return false;
      first[length + 1] = static_cast<std::uint16_t>(first[length] + counts_[length]);
    }
    for (std::size_t symbol = 0; symbol < lengths.size(); ++symbol) {
      if (lengths[symbol] != 0) symbols_[first[lengths[symbol]]++] = static_cast<std::uint16_t>(symbol);
    }
    return true;
  }
  /// The next symbol; −1 for bits that are no code.
  int read(Bits& bits) const {
    int code = 0, first = 0, index = 0;
    for (std::size_t length = 1; length <= 15; ++length) {
      code |= static_cast<int>(bits.bit());
      if (code - first < counts_[length]) return symbols_[static_cast<std::size_t>(index + code - first)];
      index += counts_[length];
      first = (first + counts_[length]) * 2;
      code *= 2;
    }
    return -1;
  }

 private:
  std::array<int, 16> counts_{};
  std::array<std::uint16_t, 320> symbols_{};
};

constexpr std::array<std::uint16_t, 29> length_base{3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                                    31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
constexpr std::array<std::uint8_t, 29> length_bits{0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2,
                                                   2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0};
constexpr std::array<std::uint16_t, 30> distance_base{1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                                      33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                                      1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
constexpr std::array<std::uint8_t, 30> distance_bits{0, 0, 0, 0, 1, 1, 2, 2,  3,  3,  4,  4,  5,  5,  6,
                                                     6, 7, 7, 8, 8, 9, 9, 10, 10, 11, 11, 12, 12, 13, 13};

bool read_codes(Bits& bits, Code& lengths, Code& distances) {
  const std::size_t length_count = bits.take(5) + 257, distance_count = bits.take(5) + 1,
                    order_count = bits.take(4) + 4;
  if (length_count > 286 || distance_count > 30) return false;
  constexpr std::array<std::uint8_t, 19> order{16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  std::array<std::uint8_t, 320> widths{};
  for (std::size_t i = 0; i < order_count; ++i) widths[order[i]] = static_cast<std::uint8_t>(bits.take(3));
  Code widths_code;
  if (!widths_code.set(std::span(widths).first(19))) return false;
  widths.fill(0);
  for (std::size_t i = 0; i < length_count + distance_count;) {
    const int symbol = widths_code.read(bits);
    if (symbol < 0 || bits.ended) return false;
    if (symbol < 16) {
      widths[i++] = static_cast<std::uint8_t>(symbol);
      continue;
    }
    if (symbol == 16 && i == 0) return false;
    const std::uint8_t value = symbol == 16 ? widths[i - 1] : std::uint8_t{0};
    std::size_t repeat = symbol == 16 ? 3 + bits.take(2) : symbol == 17 ? 3 + bits.take(3) : 11 + bits.take(7);
    if (i + repeat > length_count + distance_count) return false;
    for (; repeat > 0; --repeat) widths[i++] = value;
  }
  return lengths.set(std::span(widths).first(length_count)) &&
         distances.set(std::span(widths).subspan(length_count, distance_count));
}

bool read_block(Bits& bits, const Code& lengths, const Code& distances, std::string& out, std::size_t size) {
  InterruptPoller poll_interrupt(1u << 14);
  for (;;) {
    poll_interrupt();
    const int symbol = lengths.read(bits);
    if (symbol < 0 || bits.ended) return false;
    if (symbol == 256) return true;
    if (symbol < 256) {
      if (out.size() == size) return false;
      out += static_cast<char>(symbol);
      continue;
    }
    const auto row = static_cast<std::size_t>(symbol - 257);
    if (row >= length_base.size()) return false;
    const std::size_t length = length_base[row] + bits.take(length_bits[row]);
    const int column = distances.read(bits);
    if (column < 0 || static_cast<std::size_t>(column) >= distance_base.size()) return false;
    const auto place = static_cast<std::size_t>(column);
    const std::size_t distance = distance_base[place] + bits.take(distance_bits[place]);
    if (distance > out.size() || length > size - out.size() || bits.ended) return false;
    for (std::size_t i = 0; i < length; ++i) out += out[out.size() - distance];
  }
}

bool inflate(Bits& bits, std::string_view packed, std::string& out, std::size_t size) {
  for (bool last = false; !last;) {
    last = bits.bit() != 0;
    const unsigned kind = bits.take(2);
    if (bits.ended || kind == 3) return false;
    if (kind == 0) {
      bits.to_byte();
      const unsigned length = bits.take(16), complement = bits.take(16);
      if (bits.ended || (length ^ 0xffffu) != complement || length > size - out.size()) return false;
      if (length > packed.size() - bits.byte()) return false;
      check_interrupt();
      for (unsigned i = 0; i < length; ++i) out += static_cast<char>(bits.take(8));
      continue;
    }
    Code lengths, distances;
    if (kind == 1) {
      std::array<std::uint8_t, 288> widths{};
      for (std::size_t i = 0; i < widths.size(); ++i) widths[i] = i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8;
      lengths.set(widths);
      widths.fill(5);
      distances.set(std::span(widths).first(30));
    } else if (!read_codes(bits, lengths, distances)) {
      return false;
    }
    if (!read_block(bits, lengths, distances, out, size)) return false;
  }
  return true;
}

}  // namespace

std::optional<std::string> inflate_zlib(std::string_view packed, std::size_t size) {
  if (packed.size() < 6) return std::nullopt;
  const auto byte = [&](std::size_t i) { return static_cast<unsigned>(static_cast<unsigned char>(packed[i])); };
  // The header requires deflate, a window of at most 32 kB, and no preset dictionary.
  if ((byte(0) & 15u) != 8 || (byte(0) >> 4) > 7 || (byte(0) * 256 + byte(1)) % 31 != 0 || (byte(1) & 32u) != 0)
    return std::nullopt;
  Bits bits(packed.substr(2));
  std::string out;
  if (!inflate(bits, packed.substr(2), out, size) || out.size() != size) return std::nullopt;
  bits.to_byte();
  std::uint32_t sum = 0;
  for (int i = 0; i < 4; ++i) sum = sum << 8 | bits.take(8);
  if (bits.ended) return std::nullopt;
  std::uint32_t a = 1, b = 0;
  InterruptPoller poll_interrupt(1u << 20);
  for (const char c : out) {
    poll_interrupt();
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  if ((b << 16 | a) != sum) return std::nullopt;
  return out;
}

}  // namespace morula::detail
