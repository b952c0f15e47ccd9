// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cmath>
#include <morula/update/skin.hpp>
#include <numeric>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "parallel/interruptible_sort.hpp"
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

std::vector<std::uint32_t> skin_labels(const Skin& skin) {
  const StandardFloats standard;
  for (std::size_t v = 0; v < skin.vertex_count(); ++v)
    for (std::uint32_t i = skin.begin[v]; i < skin.begin[v + 1]; ++i)
      // mutant skin-labels-nan: `std::isnan(skin.weights[i])` -> `false`
      if (std::isnan(skin.weights[i]))
        throw std::invalid_argument("the weight of vertex " + std::to_string(v) + " for bone " +
                                    std::to_string(skin.bones[i]) + " is not a number");
  const auto bones = [&](std::uint32_t v) {
    return std::span(skin.bones).subspan(skin.begin[v], skin.begin[v + 1] - skin.begin[v]);
  };
  const auto weights = [&](std::uint32_t v) {
    return std::span(skin.weights).subspan(skin.begin[v], skin.begin[v + 1] - skin.begin[v]);
  };
  const auto comes_first = [&](std::uint32_t v, std::uint32_t w) {
    const auto a = bones(v), b = bones(w);
    const auto p = weights(v), q = weights(w);
    if (!std::equal(a.begin(), a.end(), b.begin(), b.end()))
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  };
  std::vector<std::uint32_t> sorted(skin.vertex_count()), labels(skin.vertex_count());
  std::iota(sorted.begin(), sorted.end(), std::uint32_t{0});
  sort_interruptibly(sorted, comes_first);
  for (std::size_t i = 1; i < sorted.size(); ++i)
    labels[sorted[i]] = labels[sorted[i - 1]] + (comes_first(sorted[i - 1], sorted[i]) ? 1 : 0);
  return labels;
}

Skin skin_of_vertices(const Skin& skin, std::span<const std::uint32_t> vertices) {
  Skin result{.bone_count = skin.bone_count, .begin = {0}};
  InterruptPoller poll_interrupt(1u << 14);
  for (const std::uint32_t v : vertices) {
    poll_interrupt();
    if (v >= skin.vertex_count())
      throw std::invalid_argument("vertex " + std::to_string(v) + " is not one of the " +
                                  std::to_string(skin.vertex_count()) + " of the skin");
    for (std::uint32_t i = skin.begin[v]; i < skin.begin[v + 1]; ++i) {
      result.bones.push_back(skin.bones[i]);
      result.weights.push_back(skin.weights[i]);
    }
    result.begin.push_back(static_cast<std::uint32_t>(result.bones.size()));
  }
  return result;
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
