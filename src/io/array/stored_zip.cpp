// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/array/stored_zip.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "io/byte_reader.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

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
constexpr std::uint16_t first_of_january_1980 = 0x0021;  // the earliest day of the format

// Writes the common part of local and central headers, from the version needed on.
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
  file_.overwrite(offset_, header);  // the checksum is known at the end

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

namespace {

constexpr std::uint32_t central_header = 0x02014b50, end_of_directory = 0x06054b50;
constexpr std::uint32_t end_of_directory_64 = 0x06064b50, locator_64 = 0x07064b50;
constexpr std::size_t end_size = 22, locator_size = 20, end_size_64 = 56, local_size = 30, central_size = 46;
constexpr std::uint32_t elsewhere = 0xffffffffu;  // marks a number that is in a 64-bit field

[[noreturn]] void fail(const ByteSource& archive, const std::string& problem) {
  throw FileError(platform::text_of(archive.name()) + ": " + problem);
}

/// The place and the size of the directory, bytes.
struct Directory {
  std::uint64_t begin, size;
};

Directory find_directory(const ByteSource& archive) {
  const std::uint64_t size = archive.size();
  constexpr std::uint64_t longest_comment = 0xffff;
  const std::string tail_text =
      archive.read(size - std::min(size, end_size + longest_comment), std::min(size, end_size + longest_comment));
  const std::string_view tail = tail_text;
  if (size < end_size) fail(archive, "is not a NumPy archive: too short; write one with numpy.savez");
  for (std::size_t at = tail.size() - end_size;; --at) {
    const char* const end = tail.data() + at;
    if (load<std::uint32_t>(end) == end_of_directory && load<std::uint16_t>(end + 20) == tail.size() - at - end_size) {
      Directory found{load<std::uint32_t>(end + 16), load<std::uint32_t>(end + 12)};
      std::uint64_t limit = size - tail.size() + at;
      const bool wide = found.begin == elsewhere || found.size == elsewhere || load<std::uint16_t>(end + 10) == 0xffff;
      if (wide && limit >= locator_size) {
        const std::string locator = archive.read(limit - locator_size, locator_size);
        const std::uint64_t place = load<std::uint64_t>(locator.data() + 8);
        if (load<std::uint32_t>(locator.data()) == locator_64) {
          if (place > limit || limit - place < end_size_64) fail(archive, "the end of the archive lies outside of it");
          const std::string wide_end = archive.read(place, end_size_64);
          if (load<std::uint32_t>(wide_end.data()) != end_of_directory_64)
            fail(archive, "the archive's 64-bit end is not where it is said to be");
          found = {load<std::uint64_t>(wide_end.data() + 48), load<std::uint64_t>(wide_end.data() + 40)};
          limit = place;
        }
      }
      if (found.begin > limit || found.size > limit - found.begin)
        fail(archive, "the archive's directory reaches past its end; the file was cut short");
      return found;
    }
    if (at == 0) break;
  }
  fail(archive, "is not a NumPy archive, or was cut short: it has no directory; write one with numpy.savez");
}

/// Sizes and offsets that do not fit 32 bits are in an extra field, in this order, and only those.
void take_wide_numbers(std::string_view extra, std::uint64_t& size, std::uint64_t& compressed, std::uint64_t& offset) {
  while (extra.size() >= 4) {
    const auto kind = load<std::uint16_t>(extra.data());
    const std::size_t length = load<std::uint16_t>(extra.data() + 2);
    if (length > extra.size() - 4) return;
    std::string_view field = extra.substr(4, length);
    extra.remove_prefix(4 + length);
    if (kind != 1) continue;
    for (std::uint64_t* const number : {&size, &compressed, &offset}) {
      if (*number != elsewhere || field.size() < 8) continue;
      *number = load<std::uint64_t>(field.data());
      field.remove_prefix(8);
    }
    return;
  }
}

}  // namespace

std::vector<ZipEntry> zip_entries(const ByteSource& archive) {
  const Directory where = find_directory(archive);
  const std::string bytes = archive.read(where.begin, where.size);
  std::string_view directory = bytes;
  std::vector<ZipEntry> entries;
  while (!directory.empty()) {
    if (directory.size() < central_size || load<std::uint32_t>(directory.data()) != central_header)
      fail(archive, "the archive's directory is damaged at entry " + std::to_string(entries.size()));
    const char* const at = directory.data();
    const std::size_t name_size = load<std::uint16_t>(at + 28), extra_size = load<std::uint16_t>(at + 30),
                      comment_size = load<std::uint16_t>(at + 32);
    if (name_size + extra_size + comment_size > directory.size() - central_size)
      fail(archive, "the archive's directory is cut short at entry " + std::to_string(entries.size()));
    const std::string name(directory.substr(central_size, name_size));
    const auto flags = load<std::uint16_t>(at + 8), method = load<std::uint16_t>(at + 10);
    std::uint64_t compressed = load<std::uint32_t>(at + 20), size = load<std::uint32_t>(at + 24),
                  offset = load<std::uint32_t>(at + 42);
    take_wide_numbers(directory.substr(central_size + name_size, extra_size), size, compressed, offset);
    if ((flags & 1) != 0) fail(archive, in_quotes(name) + " in it is encrypted");
    if (method != 0)
      fail(archive, in_quotes(name) + " in it is compressed; save the arrays with numpy.savez, not savez_compressed");
    if (compressed != size) fail(archive, in_quotes(name) + " in it has two sizes");
    // Its own header repeats the name, and may have another extra field.
    if (offset > where.begin || where.begin - offset < local_size)
      fail(archive, in_quotes(name) + " in it lies outside of the archive");
    const std::string local = archive.read(offset, local_size);
    const std::uint64_t before =
        local_size + std::uint64_t{load<std::uint16_t>(local.data() + 26)} + load<std::uint16_t>(local.data() + 28);
    if (load<std::uint32_t>(local.data()) != local_header || before > where.begin - offset ||
        size > where.begin - offset - before)
      fail(archive, in_quotes(name) + " in it reaches past the archive's directory; the file was cut short");
    entries.push_back({name, offset + before, size, load<std::uint32_t>(at + 16)});
    directory.remove_prefix(central_size + name_size + extra_size + comment_size);
  }
  return entries;
}

ByteSource zip_part(const ByteSource& archive, const ZipEntry& entry) {
  const std::string quoted = in_quotes(entry.name);
  const std::string name = platform::text_of(archive.name()) + ": " + quoted.substr(1, quoted.size() - 2);
  return archive.part(platform::path_of(name), entry.offset, entry.size);
}

void require_sound(const ByteSource& archive, const ZipEntry& entry) {
  constexpr std::uint64_t chunk = std::uint64_t{1} << 20;
  Crc32 sum;
  for (std::uint64_t done = 0; done < entry.size; done += chunk) {
    check_interrupt();
    sum.add(archive.read(entry.offset + done, std::min(chunk, entry.size - done)));
  }
  if (sum.value() != entry.crc)
    fail(archive, in_quotes(entry.name) + " in it is damaged: its checksum differs; write or copy the file again");
}

}  // namespace morula::detail
