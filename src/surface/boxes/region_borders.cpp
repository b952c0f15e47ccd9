// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/boxes/region_borders.hpp"

#include <algorithm>
#include <array>

namespace morula::detail {
namespace {

constexpr std::uint32_t none = 0xffffffffu;

/// The facet on the other side of each edge, the edge from corner k on being edge k. None where there is no other
/// facet, or more than one, or one that runs along the edge in the same direction.
struct Neighbours {
  std::vector<std::array<std::uint32_t, 3>> across;

  explicit Neighbours(std::span<const Facet> facets) : across(facets.size()) {
    struct Side {
      std::uint32_t low, high, facet;
      std::uint8_t corner, is_upward;
    };
    std::vector<Side> sides;
    sides.reserve(3 * facets.size());
    for (std::uint32_t i = 0; i < facets.size(); ++i) {
      const Facet& f = facets[i];
      across[i].fill(none);
      for (std::uint8_t k = 0; k < 3; ++k) {
        const std::uint32_t v = f[k], w = f[(k + 1) % 3];
        sides.push_back({std::min(v, w), std::max(v, w), i, k, static_cast<std::uint8_t>(v < w ? 1 : 0)});
      }
    }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
      return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.facet < b.facet;
    });
    for (std::size_t i = 0, end = 0; i < sides.size(); i = end) {
      while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) ++end;
      if (end - i != 2) continue;
      const Side &a = sides[i], &b = sides[i + 1];
      if (a.is_upward == b.is_upward) continue;
      across[a.facet][a.corner] = b.facet;
      across[b.facet][b.corner] = a.facet;
    }
  }
};

}  // namespace

std::vector<RegionBorders> region_borders(std::span<const Facet> facets, std::span<const std::uint32_t> slot_of_vertex,
                                          std::size_t vertices, std::size_t levels) {
  const Neighbours neighbours(facets);
  std::vector<RegionBorders> borders(levels + 1);
  std::vector<std::uint32_t> next(vertices, none), starts;
  for (std::size_t level = 1; level <= levels; ++level) {
    RegionBorders& of_level = borders[level];
    of_level.loops_begin = {0};
    of_level.slots_begin = {0};
    const std::size_t size = std::size_t{8} << (3 * level);
    for (std::size_t begin = 0; begin < facets.size(); begin += size) {
      const std::size_t end = std::min(facets.size(), begin + size);
      // next[v]: where the edge of the border that leaves v goes. Two that leave one vertex end the search. As many
      // come in as go out at each vertex, since each facet has one of each: so no two come in where one goes out.
      bool has_border = true;
      starts.clear();
      for (std::size_t i = begin; i < end && has_border; ++i)
        for (std::size_t k = 0; k < 3 && has_border; ++k) {
          const std::uint32_t other = neighbours.across[i][k];
          if (other >= begin && other < end) continue;
          const std::uint32_t from = slot_of_vertex[facets[i][k]];
          has_border = next[from] == none;
          if (!has_border) break;
          next[from] = slot_of_vertex[facets[i][(k + 1) % 3]];
          starts.push_back(from);
        }
      for (const std::uint32_t start : starts) {
        if (!has_border) {
          next[start] = none;
          continue;
        }
        if (next[start] == none) continue;
        for (std::uint32_t slot = start; next[slot] != none;) {
          of_level.slots.push_back(slot);
          const std::uint32_t following = next[slot];
          next[slot] = none;
          slot = following;
        }
        of_level.slots_begin.push_back(static_cast<std::uint32_t>(of_level.slots.size()));
      }
      of_level.loops_begin.push_back(static_cast<std::uint32_t>(of_level.slots_begin.size() - 1));
    }
  }
  return borders;
}

}  // namespace morula::detail
