// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/byte_source.hpp"

#include <morula/io/mesh_file.hpp>

#include "io/whole_file.hpp"

namespace morula::detail {

std::uintmax_t ByteSource::size() const {
  return bytes_ ? bytes_->size() : size_of_file(name_);
}

std::string ByteSource::read(std::uintmax_t offset, std::uintmax_t count) const {
  if (!bytes_) return read_part(name_, offset, count);
  if (offset > bytes_->size() || count > bytes_->size() - offset)
    throw FileError(name_.string() + ": has fewer than " + std::to_string(offset) + " + " + std::to_string(count) +
                    " bytes");
  return std::string(bytes_->substr(offset, count));
}

}  // namespace morula::detail
