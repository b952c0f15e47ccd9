// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Compass search: steps along the coordinates, shorter and shorter, as long as one of them is better.
#pragma once

#include <array>
#include <cstddef>
#include <morula/geometry/vector.hpp>

namespace morula::detail {

/// Trial: has a `center` and a `cost`. evaluate(center, enough) returns one; a cost above `enough` may be any such
/// number. Steps are shares of `unit`, halved from `first_step` as long as they are above `last_step`.
template <class Trial, class Evaluate>
Trial compass_search(Trial best, float unit, float first_step, float last_step, const Evaluate& evaluate) {
  constexpr std::array<Vec3f, 6> directions{Vec3f{1, 0, 0},  Vec3f{-1, 0, 0}, Vec3f{0, 1, 0},
                                            Vec3f{0, -1, 0}, Vec3f{0, 0, 1},  Vec3f{0, 0, -1}};
  constexpr int most_moves = 12;  // most moves of one length
  std::size_t first = 0;
  for (float step = first_step; step > last_step; step *= 0.5F) {
    std::size_t back = directions.size();  // direction back to the start of the last move of this length: its cost is
                                           // computed already, and worse
    for (int moves = 0; moves < most_moves; ++moves) {
      bool improved = false;
      for (std::size_t k = 0; k < directions.size() && !improved; ++k) {
        const std::size_t d = (first + k) % directions.size();
        if (d == back) continue;
        const Trial trial = evaluate(best.center + directions[d] * (step * unit), best.cost);
        if (trial.cost < best.cost) best = trial, first = d, back = d ^ 1, improved = true;
      }
      if (!improved) break;
    }
  }
  return best;
}

}  // namespace morula::detail
