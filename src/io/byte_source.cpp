// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/byte_source.hpp"

#include <morula/io/mesh_file.hpp>

#include "io/whole_file.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {

ByteSource ByteSource::part(std::filesystem::path name, std::uintmax_t offset, std::uintmax_t count) const {
  ByteSource part = *this;
  part.name_ = std::move(name);
  if (bytes_) {
    part.bytes_ = bytes_->substr(offset, count);
  } else {
    part.begin_ += offset;
    part.count_ = count;
  }
  return part;
}

std::uintmax_t ByteSource::size() const {
  if (count_) return *count_;
  return bytes_ ? bytes_->size() : size_of_file(file_);
}

std::string ByteSource::read(std::uintmax_t offset, std::uintmax_t count) const {
  if (!bytes_ && !count_) return read_part(file_, offset, count);
  const std::uintmax_t size = count_ ? *count_ : bytes_->size();
  if (offset > size || count > size - offset)
    throw FileError(platform::text_of(name_) + ": has fewer than " + std::to_string(offset) + " + " +
                    std::to_string(count) + " bytes");
  if (count_) return read_part(file_, begin_ + offset, count);
  return std::string(bytes_->substr(offset, count));
}

}  // namespace morula::detail
