// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Accessors of a glTF file: numbers from its buffers, all inside the buffers.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <string>
#include <vector>

#include "io/gltf/document.hpp"
#include "io/gltf/tinygltf.hpp"

namespace morula::gltf {

/// A reader of accessors. It throws FileError by the document; owner: the owner of the numbers, for messages.
class Accessors {
 public:
  /// bytes: number of bytes of the text and of all buffers.
  Accessors(const Document& document, const morula_tinygltf::Model& model, std::size_t bytes)
      : document_(document), model_(model), most_numbers_(most_numbers_per_byte * bytes) {}

  std::size_t count_of(int index, const std::string& owner) const { return at(index, owner).count; }

  /// Reads finite numbers, in groups by the type. type: the only accepted type, a constant of tinygltf.
  std::vector<double> numbers(int index, int type, const std::string& owner) const;
  std::vector<Vec3> vectors(int index, const std::string& owner) const;
  std::vector<std::uint32_t> indices(int index, int type, const std::string& owner) const;

 private:
  struct Strided {
    const unsigned char* first;
    std::size_t stride;
    int type;
    std::size_t size;

    double number(std::size_t i, std::size_t k, bool normalized) const;
  };

  const morula_tinygltf::Accessor& at(int index, const std::string& owner) const;
  std::size_t size_of(int type, const std::string& owner) const;
  /// The place of `count` groups of numbers, which are all inside their buffer.
  Strided strided(int view_index, std::uint64_t offset, int type, std::size_t width, std::uint64_t count,
                  bool may_have_stride, const std::string& owner) const;
  void replace_sparse(const morula_tinygltf::Accessor& a, std::size_t width, std::vector<double>& values,
                      const std::string& owner) const;

  static constexpr std::size_t most_numbers_per_byte = 1024;
  const Document& document_;
  const morula_tinygltf::Model& model_;
  std::size_t most_numbers_;
  mutable std::size_t numbers_ = 0;
};

}  // namespace morula::gltf
