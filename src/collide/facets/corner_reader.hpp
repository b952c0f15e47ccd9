// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The corners of facets, read in place, number by number, so that compilers keep them in registers.
#pragma once

#include <cstring>
#include <morula/collide/collider.hpp>

namespace morula::detail {

class CornerReader {
 public:
  explicit CornerReader(const Collider& collider)
      : facets_(collider.mesh_facets().data()),
        unposed_(collider.stored_positions() == nullptr ? &collider : nullptr),
        positions_(unposed_ == nullptr ? *collider.stored_positions() : PositionView(std::span<const Vec3f>())),
        is_double_(positions_.is_double()) {}

  /// The corners of a facet in the body's own coordinates.
  Triangle operator()(std::uint32_t facet) const {
    const Facet& f = facets_[facet];
    if (is_double_) return {corner<double>(f[0]), corner<double>(f[1]), corner<double>(f[2])};
    if (unposed_ != nullptr) return {unposed_->posed(f[0]), unposed_->posed(f[1]), unposed_->posed(f[2])};
    return {corner<float>(f[0]), corner<float>(f[1]), corner<float>(f[2])};
  }

 private:
  template <class Scalar>
  Vec3 corner(std::uint32_t vertex) const {
    const std::byte* const p = positions_.address(vertex);
    Scalar x, y, z;
    std::memcpy(&x, p, sizeof x);
    std::memcpy(&y, p + sizeof x, sizeof y);
    std::memcpy(&z, p + 2 * sizeof x, sizeof z);
    return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
  }

  const Facet* facets_;
  const Collider* unposed_;  // not nullptr if the body computes positions when they are read
  PositionView positions_;
  bool is_double_;
};

}  // namespace morula::detail
