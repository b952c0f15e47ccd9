// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Samples that claims are about, and how values are hashed.
#pragma once

#include <concepts>
#include <morula/geometry/status.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "geometry/hash.hpp"

namespace morula::bits {

/// Of anything made of numbers.
class Sum {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> Sum& add(T value) {
    if constexpr (std::is_floating_point_v<T>)
      hasher_.add(value);
    else
      hasher_.add(static_cast<std::uint64_t>(value));
    return *this;
  }
  template <class Scalar>
  Sum& add(const Vector3<Scalar>& v) {
    hasher_.add(v);
    return *this;
  }
  template <class Scalar>
  Sum& add(const BasicSphere<Scalar>& s) {
    hasher_.add(s);
    return *this;
  }
  Sum& add(const SurfacePoint& p) { return add(p.facet).add(p.barycentric).add(p.point); }
  template <class T, std::size_t count>
  Sum& add(const std::array<T, count>& items) {
    for (const T& item : items) add(item);
    return *this;
  }
  template <class T>
  Sum& add(const std::vector<T>& items) {
    add(items.size());
    for (const T& item : items) add(item);
    return *this;
  }
  template <class T>
  Sum& add(const std::optional<T>& item) {
    add(item.has_value());
    return item ? add(*item) : *this;
  }
  std::uint64_t value() const { return hasher_.value(); }

 private:
  detail::Hasher hasher_;
};

/// Throws std::runtime_error with the message of a refused call: what is hashed after it would be of another frame.
inline void require(const Status& status) {
  if (!status) throw std::runtime_error(message(status));
}

/// A sample body, or one with every seventh facet missing: "open limb".
Mesh sample(std::string_view name, int resolution);
std::uint64_t hash_of(const CoveredTree& model);

}  // namespace morula::bits
