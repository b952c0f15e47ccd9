// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cassert>
#include <morula/update/skin.hpp>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
using namespace detail;

AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
  AffineTransform product{.columns = {}, .translation = a(b.translation)};
  for (std::size_t k = 0; k < 3; ++k) product.columns[k] = a.linear(b.columns[k]);
  return product;
}

bool is_finite(const AffineTransform& t) {
  return is_finite(t.columns[0]) && is_finite(t.columns[1]) && is_finite(t.columns[2]) && is_finite(t.translation);
}

void move_by_skin(const Skin& skin, std::span<const Vec3> rest, std::span<const AffineTransform> transforms,
                  std::span<Vec3> positions, Workers& workers) noexcept {
  const StandardFloats standard;
  const Uninterrupted whole;
  assert(rest.size() == skin.vertex_count() && positions.size() == skin.vertex_count());
  assert(transforms.size() == skin.bone_count);
  constexpr std::size_t vertices_per_chunk = 1024;
  parallel_for(workers, positions.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) positions[i] = skinned_vertex(skin, i, rest[i], transforms);
  });
}

}  // namespace morula
