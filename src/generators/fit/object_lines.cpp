// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/object_lines.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/triangles/scan_triangle.hpp"

namespace morula::detail {
namespace {

struct RawCrossing {
  std::uint32_t line;
  float at;
  std::int32_t change;  // change of the winding number going up
  std::uint32_t facet;
};

// First cell whose middle is at or above a position.
int first_middle_at_or_above(double position, int count) {
  return static_cast<int>(std::clamp(std::ceil(position - 0.5), 0.0, static_cast<double>(count)));
}

}  // namespace

ObjectLines::ObjectLines(const MeshView& mesh, const Box& box, bool closed_and_oriented, int cells, Workers& workers) {
  // A body that is one point, or so small relative to its coordinates that the radii of its spheres are mostly padding
  // against their rounding, gets cells that the padding fits in.
  constexpr double least_share = 0x1p-44;
  const double rounding = least_share * largest_coordinate(box);
  const double extent = std::max(max_norm(box.extent()), rounding);
  const double longest = extent > 0 ? extent : 1;
  cell_ = longest / cells;
  per_cell_ = cells / longest;
  for (int axis = 0; axis < 3; ++axis)
    count_[static_cast<std::size_t>(axis)] =
        std::max(1, static_cast<int>(std::ceil(box.extent()[axis] * per_cell_ - 1e-9)));
  const Vec3 half{0.5 * count_[0] * cell_, 0.5 * count_[1] * cell_, 0.5 * count_[2] * cell_};
  origin_ = box.center() - half;

  std::vector<Vec3> vertices(mesh.vertex_count());
  parallel_for(workers, vertices.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) vertices[v] = to_lattice(mesh.positions[v]);
  });
  workers.run(
      3, [&](std::size_t axis) { axes_[axis] = trace(mesh, vertices, static_cast<int>(axis), closed_and_oriented); });
  if (!closed_and_oriented) vote();
  weigh(mesh, vertices);
}

ObjectLines::Axis ObjectLines::trace(const MeshView& mesh, const std::vector<Vec3>& vertices, int axis,
                                     bool reliable) const {
  const int axis_u = (axis + 1) % 3, axis_v = (axis + 2) % 3;
  const int nu = count_[static_cast<std::size_t>(axis_u)], nv = count_[static_cast<std::size_t>(axis_v)];
  std::vector<RawCrossing> raw;
  const LineLattice lattice{axis_u, axis_v, axis, 0.5, nu, 0, nv};
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const Facet& facet = mesh.facets[f];
    scan_triangle({vertices[facet[0]], vertices[facet[1]], vertices[facet[2]]}, lattice,
                  [&](int u, int v, double w, bool leaves) {
                    raw.push_back({static_cast<std::uint32_t>(v * nu + u), static_cast<float>(w), leaves ? -1 : 1,
                                   static_cast<std::uint32_t>(f)});
                  });
  }
  // Sorted by line, then by position. Crossings are assigned to the lines first, because nearly all lines hold two or
  // four.
  const std::size_t lines = static_cast<std::size_t>(nu) * static_cast<std::size_t>(nv);
  std::vector<std::uint32_t> next(lines + 1, 0);
  for (const RawCrossing& r : raw) ++next[r.line + 1];
  for (std::size_t i = 1; i <= lines; ++i) next[i] += next[i - 1];
  std::vector<RawCrossing> sorted(raw.size());
  for (const RawCrossing& r : raw) sorted[next[r.line]++] = r;

  Axis result;
  result.begin.assign(lines + 1, 0);
  std::size_t i = 0;
  for (std::size_t line = 0; line < lines; ++line) {
    const std::size_t begin = i;
    while (i < sorted.size() && sorted[i].line == line) ++i;
    const auto first = sorted.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = sorted.begin() + static_cast<std::ptrdiff_t>(i);
    std::sort(first, last, [](const RawCrossing& x, const RawCrossing& y) {
      return x.at != y.at ? x.at < y.at : x.facet < y.facet;
    });
    // An unreliable surface is read by parity, and coincident facets are one.
    constexpr float same_place = 1e-5F;
    int winding = 0;
    for (auto r = first; r != last; ++r) {
      if (!reliable && r != first && r->at - (r - 1)->at < same_place) continue;
      const bool was_inside = winding != 0;
      winding += reliable ? r->change : (was_inside ? -1 : 1);
      if (was_inside != (winding != 0)) result.crossings.push_back({r->at, r->facet});
    }
    if ((result.crossings.size() - result.begin[line]) % 2 != 0) result.crossings.pop_back();
    result.begin[line + 1] = static_cast<std::uint32_t>(result.crossings.size());
  }
  return result;
}

// Sums of three numbers a block, each spread twice over the block's neighbors along every axis.
static void spread_to_neighbors(std::vector<float>& sums, const std::array<std::size_t, 3>& step,
                                const std::array<int, 3>& block_count) {
  std::vector<float> spread(sums.size());
  // Each block and its two neighbors along an axis: numbers `apart` entries away in both directions, in a row of the
  // block's own.
  for (int pass = 0; pass < 2; ++pass)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t apart = 3 * step[axis], row = apart * static_cast<std::size_t>(block_count[axis]);
      for (std::size_t begin = 0; begin < sums.size(); begin += row) {
        const float* const from = sums.data() + begin;
        float* const to = spread.data() + begin;
        if (row == apart) {
          std::copy_n(from, row, to);
          continue;
        }
        const std::size_t last = row - apart;
        for (std::size_t i = 0; i < apart; ++i) to[i] = from[i] + from[i + apart];
        for (std::size_t i = apart; i < last; ++i) to[i] = from[i] + from[i - apart] + from[i + apart];
        for (std::size_t i = last; i < row; ++i) to[i] = from[i] + from[i - apart];
      }
      sums.swap(spread);
    }
}

// Normals where lines cross the surface, spread over neighboring blocks.
void ObjectLines::weigh(const MeshView& mesh, const std::vector<Vec3>& vertices) {
  constexpr int most_blocks = 64;
  const int longest = *std::max_element(count_.begin(), count_.end());
  block_ = (longest + most_blocks - 1) / most_blocks;
  for (std::size_t k = 0; k < 3; ++k) block_count_[k] = (count_[k] + block_ - 1) / block_;
  const std::array<std::size_t, 3> step{
      1, static_cast<std::size_t>(block_count_[0]),
      static_cast<std::size_t>(block_count_[0]) * static_cast<std::size_t>(block_count_[1])};
  const std::size_t blocks = step[2] * static_cast<std::size_t>(block_count_[2]);
  std::vector<float> sums(3 * blocks, 0.0F);
  // Squares of a facet's unit normal: most facets are crossed many times. Facets without area have none.
  constexpr float not_known = -1;
  std::vector<std::array<float, 3>> squares(mesh.facet_count(), {not_known, 0, 0});
  const auto squares_of = [&](std::uint32_t f) -> const std::array<float, 3>& {
    std::array<float, 3>& of = squares[f];
    if (of[0] != not_known) return of;
    const Facet& facet = mesh.facets[f];
    const Vec3 n = cross(vertices[facet[1]] - vertices[facet[0]], vertices[facet[2]] - vertices[facet[0]]);
    const double square = dot(n, n);
    for (int k = 0; k < 3; ++k)
      of[static_cast<std::size_t>(k)] = square > 0 ? static_cast<float>(n[k] * n[k] / square) : 0;
    return of;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t ua = (axis + 1) % 3, va = (axis + 2) % 3;
    for (int v = 0; v < count_[va]; ++v)
      for (int u = 0; u < count_[ua]; ++u) {
        const auto crossings = line(static_cast<int>(axis), u, v);
        if (crossings.empty()) continue;
        float* const first = &sums[3 * (static_cast<std::size_t>(u / block_) * step[ua] +
                                        static_cast<std::size_t>(v / block_) * step[va])];
        for (const Crossing& c : crossings) {
          const std::array<float, 3>& of = squares_of(c.facet);
          const int w = std::clamp(static_cast<int>(c.at), 0, count_[axis] - 1);
          float* const sum = first + 3 * static_cast<std::size_t>(w / block_) * step[axis];
          for (std::size_t k = 0; k < 3; ++k) sum[k] += of[k];
        }
      }
  }
  spread_to_neighbors(sums, step, block_count_);
  weights_.resize(blocks);
  for (std::size_t i = 0; i < blocks; ++i) {
    const float *const w = &sums[3 * i], sum = w[0] + w[1] + w[2];
    for (std::size_t k = 0; k < 3; ++k) weights_[i][k] = sum > 0 ? w[k] / sum : 1.0F / 3;
  }
}

// Cells that are inside by two of the three lines through them.
void ObjectLines::vote() {
  const std::array<std::size_t, 3> n{static_cast<std::size_t>(count_[0]), static_cast<std::size_t>(count_[1]),
                                     static_cast<std::size_t>(count_[2])};
  std::vector<std::uint8_t> votes(n[0] * n[1] * n[2], 0);
  const std::array<std::size_t, 3> step{1, n[0], n[0] * n[1]};
  // Most lines of a slender object have nothing inside: those are not walked cell by cell.
  std::array<std::vector<bool>, 3> has_inside;
  for (std::size_t axis = 0; axis < 3; ++axis) has_inside[axis].assign(n[(axis + 1) % 3] * n[(axis + 2) % 3], false);
  const auto mark = [&](const std::array<std::size_t, 3>& cell) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      has_inside[axis][cell[(axis + 2) % 3] * n[(axis + 1) % 3] + cell[(axis + 1) % 3]] = true;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
    for (std::size_t v = 0; v < n[v_axis]; ++v)
      for (std::size_t u = 0; u < n[u_axis]; ++u) {
        const auto crossings = line(static_cast<int>(axis), static_cast<int>(u), static_cast<int>(v));
        for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
          const auto end = static_cast<std::size_t>(first_middle_at_or_above(crossings[i + 1].at, count_[axis]));
          for (auto w = static_cast<std::size_t>(first_middle_at_or_above(crossings[i].at, count_[axis])); w < end;
               ++w) {
            if (++votes[u * step[u_axis] + v * step[v_axis] + w * step[axis]] < 2) continue;
            std::array<std::size_t, 3> cell{};
            cell[u_axis] = u, cell[v_axis] = v, cell[axis] = w;
            mark(cell);
          }
        }
      }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
    Axis voted;
    voted.begin.push_back(0);
    for (std::size_t v = 0; v < n[v_axis]; ++v)
      for (std::size_t u = 0; u < n[u_axis]; ++u) {
        const auto crossings = line(static_cast<int>(axis), static_cast<int>(u), static_cast<int>(v));
        // The facet whose normal stands for a wall: the nearest of the line's own.
        const auto facet_near = [&](std::size_t w) {
          std::uint32_t nearest = 0;
          float least = std::numeric_limits<float>::infinity();
          for (const Crossing& c : crossings)
            if (const float d = std::abs(c.at - static_cast<float>(w)); d < least) least = d, nearest = c.facet;
          return nearest;
        };
        bool inside = false;
        for (std::size_t w = 0; has_inside[axis][v * n[u_axis] + u] && w <= n[axis]; ++w) {
          const bool now = w < n[axis] && votes[u * step[u_axis] + v * step[v_axis] + w * step[axis]] >= 2;
          if (now != inside) voted.crossings.push_back({static_cast<float>(w), facet_near(w)});
          inside = now;
        }
        voted.begin.push_back(static_cast<std::uint32_t>(voted.crossings.size()));
      }
    axes_[axis] = std::move(voted);  // the other axes' lines are still the voting ones; only votes are read here
  }
}

}  // namespace morula::detail
