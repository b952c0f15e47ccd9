// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "parallel/interruptible_sort.hpp"
#include "parallel/interruption.hpp"
#include "surface/boxes/tree_state.hpp"

namespace morula::detail {
namespace {

constexpr std::uint32_t none = 0xffffffffu;

/// A side of a facet: that of facet side / 3, from its corner side % 3 on.
using Side = std::uint32_t;
Side side_after(Side s) {
  return s % 3 == 2 ? s - 2 : s + 1;
}

/// The opposite side of each side: it belongs to another facet and runs in the other direction. There is none if the
/// edge has no other side, more than one, or one in the same direction.
std::vector<Side> opposite_sides(std::span<const Facet> facets) {
  struct Edge {
    std::uint32_t low, high;
    Side side;
    bool is_upward;
  };
  std::vector<Edge> edges;
  edges.reserve(3 * facets.size());
  InterruptPoller poll_interrupt(1u << 16);
  for (std::uint32_t i = 0; i < facets.size(); ++i) {
    poll_interrupt();
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t v = facets[i][k], w = facets[i][(k + 1) % 3];
      edges.push_back({std::min(v, w), std::max(v, w), 3 * i + k, v < w});
    }
  }
  sort_interruptibly(edges, [](const Edge& a, const Edge& b) {
    return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.side < b.side;
  });
  std::vector<Side> opposite(3 * facets.size(), none);
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    poll_interrupt();
    while (end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high) ++end;
    const Edge &a = edges[i], &b = edges[end - 1];
    if (end - i != 2 || a.is_upward == b.is_upward) continue;
    opposite[a.side] = b.side;
    opposite[b.side] = a.side;
  }
  return opposite;
}

/// A disc of n facets has about 4 sqrt(n) edges at its border; one with islands and holes, twice that. A region with a
/// far longer border is not connected, and its test would take long: time grows with the square of the number of edges.
std::size_t most_border_edges(std::size_t facets) {
  return 64 + static_cast<std::size_t>(16 * std::sqrt(static_cast<double>(facets)));
}

}  // namespace

std::vector<RegionBorders> region_borders(std::span<const Facet> facets, std::span<const std::uint32_t> slot_of_vertex,
                                          std::size_t levels) {
  const std::vector<Side> opposite = opposite_sides(facets);
  std::vector<RegionBorders> borders(levels + 1);
  std::vector<std::uint8_t> is_in_loop;
  InterruptPoller poll_interrupt(1u << 16);
  for (std::size_t level = 1; level <= levels; ++level) {
    RegionBorders& of_level = borders[level];
    of_level.loops_begin = {0};
    of_level.slots_begin = {0};
    is_in_loop.assign(3 * facets.size(), 0);
    const std::size_t size = std::size_t{24} << (3 * level);  // number of sides
    for (std::size_t begin = 0; begin < opposite.size(); begin += size) {
      const std::size_t end = std::min(opposite.size(), begin + size);
      const std::size_t first_loop = of_level.slots_begin.size(), first_slot = of_level.slots.size();
      const auto is_border = [&](Side s) { return opposite[s] < begin || opposite[s] >= end; };
      for (Side start = static_cast<Side>(begin); start < end; ++start) {
        poll_interrupt();
        if (!is_border(start) || is_in_loop[start] != 0) continue;
        // The fan of facets round the vertex at its end leads from each edge of the border to one other edge that
        // leaves that vertex. No two edges lead to the same one, so the first edge that recurs is the start.
        for (Side s = start; is_in_loop[s] == 0;) {
          is_in_loop[s] = 1;
          of_level.slots.push_back(slot_of_vertex[facets[s / 3][s % 3]]);
          for (s = side_after(s); !is_border(s); s = side_after(opposite[s])) {
          }
        }
        of_level.slots_begin.push_back(static_cast<std::uint32_t>(of_level.slots.size()));
      }
      // mutant region-borders-long: `most_border_edges((end - begin) / 3)` -> `(std::size_t{1} << 60)`
      if (of_level.slots.size() - first_slot > most_border_edges((end - begin) / 3)) {
        of_level.slots.resize(first_slot);
        of_level.slots_begin.resize(first_loop);
      }
      of_level.loops_begin.push_back(static_cast<std::uint32_t>(of_level.slots_begin.size() - 1));
    }
  }
  return borders;
}

}  // namespace morula::detail
