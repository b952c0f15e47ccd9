// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// FNV-1a over values, with a fixed byte order, so that hashes of equal data agree between machines.
#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <morula/geometry/sphere.hpp>

namespace morula::detail {

class Hasher {
 public:
  void add(std::unsigned_integral auto value) {
    for (unsigned shift = 0; shift < 8 * sizeof value; shift += 8)
      state_ = (state_ ^ ((value >> shift) & 0xffu)) * 0x100000001b3u;
  }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) { add(std::bit_cast<std::uint32_t>(value)); }
  template <class Scalar>
  void add(const Vector3<Scalar>& v) {
    add(v.x), add(v.y), add(v.z);
  }
  template <class Scalar>
  void add(const BasicSphere<Scalar>& s) {
    add(s.center), add(s.radius);
  }
  std::uint64_t value() const { return state_; }

 private:
  std::uint64_t state_ = 0xcbf29ce484222325u;
};

}  // namespace morula::detail
