// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A view of a vertex array that the caller owns: float or double, any stride, any order, no copy.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

namespace morula {

/// Mesh vertices [begin, end).
struct VertexRange {
  std::uint32_t begin, end;
};

class PositionView {
 public:
  PositionView(std::span<const Vec3f> positions) : PositionView(positions.data(), positions.size(), sizeof(Vec3f)) {}
  PositionView(std::span<const Vec3> positions) : PositionView(positions.data(), positions.size(), sizeof(Vec3)) {}
  PositionView(const std::vector<Vec3f>& positions) : PositionView(std::span<const Vec3f>(positions)) {}
  PositionView(const std::vector<Vec3>& positions) : PositionView(std::span<const Vec3>(positions)) {}

  /// A view of `count` vertices: x, y, z of vertex i start stride_bytes × i after the first. The data must outlive the
  /// view.
  static PositionView strided(const float* first, std::size_t count, std::size_t stride_bytes) {
    return {first, count, stride_bytes, false};
  }
  static PositionView strided(const double* first, std::size_t count, std::size_t stride_bytes) {
    return {first, count, stride_bytes, true};
  }
  /// A view of a surface inside a larger node array: vertex i is nodes[index[i]]. An entry may occur more than once.
  ///
  /// nodes: any view that is not indexed itself. Nodes and index must outlive the view. A view stays valid for all
  /// frames if their memory stays in place.
  /// Throws std::invalid_argument, naming the first entry that is not a node. Cost: linear in the index.
  static PositionView indexed(const PositionView& nodes, std::span<const std::uint32_t> index);

  std::size_t size() const { return count_; }
  bool is_double() const { return is_double_; }
  Vec3 operator[](std::size_t i) const {
    const std::byte* p = address(i);
    if (is_double_) return load<double>(p);
    return Vec3(load<float>(p));
  }
  /// A copy in double, one vertex after another.
  std::vector<Vec3> to_vector() const;
  /// True for floats without gaps between vertices.
  bool is_packed_float() const { return !is_double_ && !index_ && stride_bytes_ == sizeof(Vec3f); }
  /// Address of the x of vertex i, a float or a double; y and z follow it.
  const std::byte* address(std::size_t i) const { return first_ + (index_ ? index_[i] : i) * stride_bytes_; }

 private:
  PositionView(const Vec3f* first, std::size_t count, std::size_t stride) : PositionView(first, count, stride, false) {}
  PositionView(const Vec3* first, std::size_t count, std::size_t stride) : PositionView(first, count, stride, true) {}
  PositionView(const void* first, std::size_t count, std::size_t stride_bytes, bool is_double)
      : first_(static_cast<const std::byte*>(first)),
        count_(count),
        stride_bytes_(stride_bytes),
        is_double_(is_double) {}
  template <class Scalar>
  static Vector3<Scalar> load(const std::byte* p) {
    Scalar s[3];
    std::memcpy(s, p, sizeof s);
    return {s[0], s[1], s[2]};
  }

  const std::byte* first_;
  std::size_t count_;
  std::size_t stride_bytes_;
  const std::uint32_t* index_ = nullptr;  // nullptr: vertex i is the i-th of the array
  bool is_double_;
};

}  // namespace morula
