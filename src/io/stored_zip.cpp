// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/stored_zip.hpp"

#include <array>
#include <cassert>

#include "io/byte_reader.hpp"

namespace morula {
namespace {

constexpr std::array<std::uint32_t, 256> crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ (remainder & 1 ? 0xedb88320u : 0u);
    table[byte] = remainder;
  }
  return table;
}

constexpr std::uint16_t version_needed = 20;
constexpr std::uint16_t first_of_january_1980 = 0x0021;  // the earliest day that the format knows

// What local and central headers have in common, from the version needed on.
void store_entry(std::string& to, std::string_view name, std::uint32_t crc, std::uint32_t size) {
  store(to, version_needed);
  store(to, std::uint16_t{0});  // flags
  store(to, std::uint16_t{0});  // method: stored
  store(to, std::uint16_t{0});  // time
  store(to, first_of_january_1980);
  store(to, crc);
  store(to, size);  // compressed
  store(to, size);
  store(to, static_cast<std::uint16_t>(name.size()));
  store(to, std::uint16_t{0});  // extra field
}

}  // namespace

std::uint32_t crc32(std::string_view bytes) {
  static constexpr std::array<std::uint32_t, 256> table = crc_table();
  std::uint32_t remainder = 0xffffffffu;
  for (const char c : bytes) remainder = (remainder >> 8) ^ table[(remainder ^ static_cast<unsigned char>(c)) & 0xffu];
  return ~remainder;
}

void StoredZip::add(std::string_view name, std::string_view bytes) {
  assert(bytes_.size() + bytes.size() <= largest);
  const std::uint32_t crc = crc32(bytes);
  const auto size = static_cast<std::uint32_t>(bytes.size());
  const auto offset = static_cast<std::uint32_t>(bytes_.size());
  store(bytes_, std::uint32_t{0x04034b50});
  store_entry(bytes_, name, crc, size);
  bytes_ += name;
  bytes_ += bytes;

  store(directory_, std::uint32_t{0x02014b50});
  store(directory_, version_needed);  // made by
  store_entry(directory_, name, crc, size);
  store(directory_, std::uint16_t{0});  // comment
  store(directory_, std::uint16_t{0});  // disk
  store(directory_, std::uint16_t{0});  // internal attributes
  store(directory_, std::uint32_t{0});  // external attributes
  store(directory_, offset);
  directory_ += name;
  ++count_;
}

std::string StoredZip::finish() {
  const auto directory_offset = static_cast<std::uint32_t>(bytes_.size());
  bytes_ += directory_;
  store(bytes_, std::uint32_t{0x06054b50});
  store(bytes_, std::uint32_t{0});  // this disk, and that of the directory
  store(bytes_, count_);
  store(bytes_, count_);
  store(bytes_, static_cast<std::uint32_t>(directory_.size()));
  store(bytes_, directory_offset);
  store(bytes_, std::uint16_t{0});  // comment
  assert(bytes_.size() <= largest);
  return std::move(bytes_);
}

}  // namespace morula
