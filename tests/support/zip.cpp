// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "zip.hpp"

#include "raw.hpp"

namespace morula::test {

std::uint32_t plain_crc(const std::string& bytes) {
  std::uint32_t remainder = 0xffffffffu;
  for (const char c : bytes)
    for (int bit = 0; bit < 8; ++bit) {
      const bool low = ((remainder ^ (static_cast<unsigned char>(c) >> bit)) & 1) != 0;
      remainder = (remainder >> 1) ^ (low ? 0xedb88320u : 0);
    }
  return ~remainder;
}

std::string zip(const std::vector<ZipMember>& members) {
  std::string archive, directory;
  for (const ZipMember& m : members) {
    const std::string dates(4, '\x21');
    const auto size = static_cast<std::uint32_t>(m.bytes.size());
    const auto offset = static_cast<std::uint32_t>(archive.size());
    archive += "PK\3\4" + raw(std::uint16_t{45}) + raw(m.flags) + raw(m.method) + dates + raw(plain_crc(m.bytes)) +
               raw(0xffffffffu) + raw(0xffffffffu) + raw(static_cast<std::uint16_t>(m.name.size())) +
               raw(std::uint16_t{20}) + m.name + raw(std::uint16_t{1}) + raw(std::uint16_t{16}) +
               raw(std::uint64_t{size}) + raw(std::uint64_t{size}) + m.bytes;
    directory += "PK\1\2" + raw(std::uint16_t{45}) + raw(std::uint16_t{45}) + raw(m.flags) + raw(m.method) + dates +
                 raw(plain_crc(m.bytes)) + raw(size) + raw(size) + raw(static_cast<std::uint16_t>(m.name.size())) +
                 raw(std::uint16_t{0}) + std::string(6, '\0') + raw(0u) + raw(offset) + m.name;
  }
  const auto count = static_cast<std::uint16_t>(members.size());
  return archive + directory + "PK\5\6" + std::string(4, '\0') + raw(count) + raw(count) +
         raw(static_cast<std::uint32_t>(directory.size())) + raw(static_cast<std::uint32_t>(archive.size())) +
         std::string(2, '\0');
}

}  // namespace morula::test
