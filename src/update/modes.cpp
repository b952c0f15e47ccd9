// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <morula/update/modes.hpp>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;

void move_by_modes(const Modes& modes, std::span<const Vec3> rest, std::span<const double> coordinates,
                   std::span<Vec3> positions, Workers& workers) noexcept {
  const StandardFloats standard;
  const Uninterrupted whole;
  assert(rest.size() == modes.vertex_count && positions.size() == modes.vertex_count);
  assert(coordinates.size() == modes.mode_count);
  // Few enough vertices that their positions stay in the nearest cache while mode after mode is added.
  constexpr std::size_t vertices_per_chunk = 1024;
  parallel_for(workers, positions.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::copy(rest.begin() + static_cast<std::ptrdiff_t>(begin), rest.begin() + static_cast<std::ptrdiff_t>(end),
              positions.begin() + static_cast<std::ptrdiff_t>(begin));
    for (std::size_t j = 0; j < coordinates.size(); ++j) {
      if (coordinates[j] == 0) continue;
      const std::span<const Vec3> mode = modes.mode(j);
      for (std::size_t i = begin; i < end; ++i) positions[i] += coordinates[j] * mode[i];
    }
  });
}

}  // namespace morula
