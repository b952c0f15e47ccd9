// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Accessors of a glTF file: numbers out of its buffers, every one of them inside.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <string>
#include <vector>

#include "io/gltf/document.hpp"
#include "io/gltf/tinygltf.hpp"

namespace morula::gltf {

/// Throws FileError in the document's words; owner: whose numbers they are.
class Accessors {
 public:
  /// bytes: of the text and of all buffers.
  Accessors(const Document& document, const morula_tinygltf::Model& model, std::size_t bytes)
      : document_(document), model_(model), most_numbers_(most_numbers_per_byte * bytes) {}

  std::size_t count_of(int index, const std::string& owner) const { return at(index, owner).count; }

  /// type: of tinygltf, the only one that is taken. Finite numbers, as many as the type has a group.
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
  /// Where `count` groups of numbers are; all of them are inside their buffer.
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
