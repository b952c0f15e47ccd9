// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <morula/update/skin_morphs.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "update/rules/skin_blend.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula {
using namespace detail;

void move_by_skin(const Skin& skin, const Modes& modes, std::span<const Vec3> rest,
                  std::span<const AffineTransform> transforms, std::span<const double> morphs,
                  std::span<Vec3> positions, Workers& workers) noexcept {
  const StandardFloats standard;
  const Uninterrupted whole;
  assert(rest.size() == skin.vertex_count() && positions.size() == skin.vertex_count());
  assert(transforms.size() == skin.bone_count);
  assert(morphs.empty() || (morphs.size() == modes.mode_count && modes.vertex_count == skin.vertex_count()));
  // Few enough vertices that their positions stay in the nearest cache while mode after mode is added.
  constexpr std::size_t vertices_per_chunk = 1024;
  parallel_for(workers, positions.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::copy(rest.begin() + static_cast<std::ptrdiff_t>(begin), rest.begin() + static_cast<std::ptrdiff_t>(end),
              positions.begin() + static_cast<std::ptrdiff_t>(begin));
    for (std::size_t j = 0; j < morphs.size(); ++j) {
      if (morphs[j] == 0) continue;
      const std::span<const Vec3> mode = modes.mode(j);
      for (std::size_t i = begin; i < end; ++i) positions[i] += morphs[j] * mode[i];
    }
    for (std::size_t i = begin; i < end; ++i) positions[i] = skinned_vertex(skin, i, positions[i], transforms);
  });
}

Skin complete_weights(const Skin& skin, double tolerance) {
  const StandardFloats standard;
  if (!(tolerance >= 0 && tolerance <= weight_tolerance))
    throw std::invalid_argument("complete_weights: tolerance " + std::to_string(tolerance) + " is not in 0…1e-6");
  if (skin.begin.empty() || skin.begin.front() != 0 || skin.begin.back() != skin.bones.size() ||
      skin.bones.size() != skin.weights.size() || !std::is_sorted(skin.begin.begin(), skin.begin.end()))
    throw std::invalid_argument("complete_weights: the skin's influences do not fit its vertices");
  const std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (skin.bone_count >= most || skin.bones.size() + skin.vertex_count() > most)
    throw std::invalid_argument("complete_weights: more influences than 32-bit indices can tell apart");
  Skin result{.bone_count = skin.bone_count + 1, .begin = {0}};
  InterruptPoller poll_interrupt(1u << 14);
  for (std::size_t v = 0; v < skin.vertex_count(); ++v) {
    poll_interrupt();
    double sum = 0;
    for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
      // The number of the new bone is free in a skin that names its own bones alone.
      if (skin.bones[k] >= skin.bone_count)
        throw std::invalid_argument("complete_weights: vertex " + std::to_string(v) + " has an influence of bone " +
                                    std::to_string(skin.bones[k]) + ", but there are " +
                                    std::to_string(skin.bone_count));
      if (!std::isfinite(skin.weights[k]))
        throw std::invalid_argument("complete_weights: the weight of vertex " + std::to_string(v) + " for bone " +
                                    std::to_string(skin.bones[k]) + " is not finite");
      sum += skin.weights[k];
      result.bones.push_back(skin.bones[k]);
      result.weights.push_back(skin.weights[k]);
    }
    if (std::abs(1 - sum) > tolerance) {
      result.bones.push_back(static_cast<std::uint32_t>(skin.bone_count));
      result.weights.push_back(1 - sum);
    }
    result.begin.push_back(static_cast<std::uint32_t>(result.bones.size()));
  }
  return result;
}

}  // namespace morula
