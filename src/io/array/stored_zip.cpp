// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/array/stored_zip.hpp"

#include <array>
#include <cassert>

#include "io/byte_reader.hpp"

namespace morula::detail {
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

constexpr std::uint32_t local_header = 0x04034b50;
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

void Crc32::add(std::string_view bytes) {
  static constexpr std::array<std::uint32_t, 256> table = crc_table();
  for (const char c : bytes)
    remainder_ = (remainder_ >> 8) ^ table[(remainder_ ^ static_cast<unsigned char>(c)) & 0xffu];
}

void StoredZip::add(std::string_view name, std::string_view bytes) {
  begin(name, bytes.size());
  append(bytes);
  end();
}

void StoredZip::begin(std::string_view name, std::uint64_t size) {
  assert(written_ + size <= largest);
  name_ = name;
  offset_ = written_;
  size_ = size;
  crc_ = {};
  std::string header;
  store(header, local_header);
  store_entry(header, name_, 0, static_cast<std::uint32_t>(size_));
  header += name_;
  file_.write(header);
  written_ += header.size();
}

void StoredZip::append(std::string_view bytes) {
  crc_.add(bytes);
  file_.write(bytes);
  written_ += bytes.size();
}

void StoredZip::end() {
  const std::uint32_t crc = crc_.value();
  const auto size = static_cast<std::uint32_t>(size_);
  std::string header;
  store(header, local_header);
  store_entry(header, name_, crc, size);
  assert(written_ == offset_ + header.size() + name_.size() + size_);
  file_.overwrite(offset_, header);  // only now is the sum known

  store(directory_, std::uint32_t{0x02014b50});
  store(directory_, version_needed);  // made by
  store_entry(directory_, name_, crc, size);
  store(directory_, std::uint16_t{0});  // comment
  store(directory_, std::uint16_t{0});  // disk
  store(directory_, std::uint16_t{0});  // internal attributes
  store(directory_, std::uint32_t{0});  // external attributes
  store(directory_, static_cast<std::uint32_t>(offset_));
  directory_ += name_;
  ++count_;
}

void StoredZip::commit() {
  std::string end = directory_;
  store(end, std::uint32_t{0x06054b50});
  store(end, std::uint32_t{0});  // this disk, and that of the directory
  store(end, count_);
  store(end, count_);
  store(end, static_cast<std::uint32_t>(directory_.size()));
  store(end, static_cast<std::uint32_t>(written_));
  store(end, std::uint16_t{0});  // comment
  assert(written_ + end.size() <= largest);
  file_.write(end);
  file_.commit();
}

}  // namespace morula::detail
