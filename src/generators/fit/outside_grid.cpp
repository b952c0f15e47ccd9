// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/outside_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "generators/fit/fit_kernels.hpp"

namespace morula::detail {
namespace {

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

// Cells whose middle lies within `half` of `middle`: [begin, end). Positions are not far below zero, so truncation
// serves as floor.
struct Range {
  int begin, end;
};
Range middles_within(float middle, float half, int count) {
  const float lower = middle - half + 0.5F, upper = middle + half + 0.5F, last = static_cast<float>(count);
  // Proposed balls may reach far beyond the grid: positions are clamped before a number too large becomes an integer.
  return {lower > 0 ? static_cast<int>(std::min(last, lower)) : 0,
          upper > 0 ? static_cast<int>(std::min(last, upper)) : 0};
}

}  // namespace

OutsideGrid::ZeroSteps::ZeroSteps(std::size_t count) {
  std::size_t room = (count + 1) * sizeof(GridStep);
  memory_.reset(std::calloc(1, room));
  if (!memory_) throw std::bad_alloc();
  void* first = memory_.get();
  steps_ = static_cast<GridStep*>(std::align(alignof(GridStep), count * sizeof(GridStep), first, room));
}

OutsideGrid::OutsideGrid(const ObjectLines& lines, const Box& box, double cell_width) : lines_(lines) {
  place_.stride = std::max(1, static_cast<int>(std::lround(cell_width / lines.cell())));
  place_.cell = place_.stride * lines.cell();
  tolerance_ = static_cast<float>(lines.tolerance() / place_.cell);
  const Vec3 lower = lines.to_lattice(box.lower), upper = lines.to_lattice(box.upper);
  for (int k = 0; k < 3; ++k) {
    place_.first[at(k)] = static_cast<int>(std::floor(lower[k]));
    place_.lower[k] = place_.first[at(k)] + 0.5 - 0.5 * place_.stride;
    count_[at(k)] = std::max(1, static_cast<int>(std::ceil((upper[k] - place_.lower[k]) / place_.stride)));
  }
  step_ = {1, at(count_[0]), at(count_[0]) * at(count_[1])};
  const std::size_t cells = step_[2] * at(count_[2]);
  // Updates change eight cells at a time.
  balls_over_.assign(cells + sizeof(std::uint64_t), 0);
  full_along_.assign(cells + sizeof(std::uint64_t), 0);
  turned_.in_plane.assign(step_[1] + sizeof(std::uint64_t), 0);
  turned_.in_rows.assign(step_[2] + sizeof(std::uint64_t), 0);
  for (std::size_t a = 0; a < 3; ++a) {
    // Loops over four lines read past the last line; those entries count for nothing.
    const std::size_t n = at(count_[a]), line_count = cells / n;
    axes_[a].outside.reset(new OutsideCell[cells + 1]);  // four floats of the last one are read
    axes_[a].steps = ZeroSteps(cells + 4 * n);
    axes_[a].traced.assign(line_count, 0);
    axes_[a].current.assign(line_count, {});
  }
}

Vec3f OutsideGrid::to_grid(const Vec3& p) const {
  const Vec3 q = (lines_.to_lattice(p) - place_.lower) / place_.stride;
  return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z)};
}

Vec3 OutsideGrid::from_grid(const Vec3f& p) const {
  return lines_.from_lattice(place_.lower + Vec3{p.x, p.y, p.z} * static_cast<double>(place_.stride));
}

// Rows of an axis's lines that pass within `radius` of `center`: row v has lines [begin, end), and in_row is the square
// of the ball's half width there.
template <class Visit>
void OutsideGrid::each_row(std::size_t axis, const Vec3f& center, float radius, const Visit& visit) const {
  const std::size_t ua = (axis + 1) % 3, va = (axis + 2) % 3;
  const float cu = center[static_cast<int>(ua)], cv = center[static_cast<int>(va)];
  const Range rows = middles_within(cv, radius, count_[va]);
  for (int v = rows.begin; v < rows.end; ++v) {
    const float dv = static_cast<float>(v) + 0.5F - cv;
    const float in_row = radius * radius - dv * dv;
    if (!(in_row > 0)) continue;
    const Range row = middles_within(cu, std::sqrt(in_row), count_[ua]);
    visit(v, row.begin, row.end, in_row);
  }
}

template <class Visit>
void OutsideGrid::each_line(std::size_t axis, const Vec3f& center, float radius, const Visit& visit) const {
  const std::size_t row_length = at(count_[(axis + 1) % 3]);
  each_row(axis, center, radius, [&](int v, int begin, int end, float) {
    for (int u = begin; u < end; ++u) visit(u, v, at(v) * row_length + at(u));
  });
}

// Eight bytes of a row as one number.
constexpr std::size_t eight = sizeof(std::uint64_t);
static std::uint64_t load(const std::uint8_t* from) {
  std::uint64_t bytes;
  std::memcpy(&bytes, from, eight);
  return bytes;
}
static void store(std::uint64_t bytes, std::uint8_t* to) {
  std::memcpy(to, &bytes, eight);
}
// A one in each byte that is not zero.
static std::uint64_t not_zero(std::uint64_t bytes) {
  constexpr std::uint64_t seven_bits = 0x7f7f7f7f7f7f7f7fU, ones = 0x0101010101010101U;
  return (bytes | ((bytes & seven_bits) + seven_bits)) >> 7 & ones;
}

// Eight cells of a row at a time. A count that is full stays so, and none falls below nothing: no byte reaches into the
// next. Steps depend on the object and on which cells any ball has: a line keeps its steps unless one of its cells gets
// its first ball or loses its last one, and has space there to count. If balls share most of their cells, few lines
// change.
void OutsideGrid::change(const Spheref& ball, int by) {
  static constexpr std::array<std::uint8_t, 2 * eight> first_ones{1, 1, 1, 1, 1, 1, 1, 1};
  const std::size_t nx = at(count_[0]), ny = at(count_[1]), nz = at(count_[2]);
  const auto each_x = [&](std::uint8_t* turned, const auto& visit) {
    for (std::size_t x = 0; x < nx; x += eight) {
      if (load(turned + x) == 0) continue;
      for (std::size_t k = x; k < x + eight; ++k)
        if (turned[k] != 0) visit(k);
      store(0, turned + x);
    }
  };
  Range turned_rows{count_[1], 0};
  const Range zs = middles_within(ball.center.z, ball.radius, count_[2]);
  for (int z = zs.begin; z < zs.end; ++z) {
    const float dz = static_cast<float>(z) + 0.5F - ball.center.z;
    const float in_plane = ball.radius * ball.radius - dz * dz;
    if (!(in_plane > 0)) continue;
    bool any_in_plane = false;
    const Range ys = middles_within(ball.center.y, std::sqrt(in_plane), count_[1]);
    for (int y = ys.begin; y < ys.end; ++y) {
      const float dy = static_cast<float>(y) + 0.5F - ball.center.y;
      const float in_line = in_plane - dy * dy;
      if (!(in_line > 0)) continue;
      const Range xs = middles_within(ball.center.x, std::sqrt(in_line), count_[0]);
      const std::size_t row = at(z) * step_[2] + at(y) * step_[1];
      std::uint64_t along_x = 0, along_others = 0;
      for (std::size_t x = at(xs.begin); x < at(xs.end); x += eight) {
        const std::uint64_t before = load(&balls_over_[row + x]), room = by > 0 ? ~before : before;
        const std::uint64_t in_row = load(&first_ones[eight - std::min(eight, at(xs.end) - x)]);
        const std::uint64_t changes = in_row & not_zero(room), after = by > 0 ? before + changes : before - changes;
        store(after, &balls_over_[row + x]);
        const std::uint64_t turned = not_zero(before) ^ not_zero(after), full = load(&full_along_[row + x]);
        // mutant steps-kept-along-y: `(full >> 1)` -> `full`
        // mutant steps-kept-along-z: `2` -> `1`
        const std::uint64_t along_y = turned & ~(full >> 1), along_z = turned & ~(full >> 2);
        // mutant steps-kept-along-x: `full` -> `(full >> 1)`
        along_x |= turned & ~full;
        along_others |= along_y | along_z;
        store(load(&turned_.in_plane[x]) | along_y, &turned_.in_plane[x]);
        store(load(&turned_.in_rows[at(y) * nx + x]) | along_z, &turned_.in_rows[at(y) * nx + x]);
      }
      if (along_x != 0) axes_[0].current[at(z) * ny + at(y)] = {};
      if (along_others == 0) continue;
      any_in_plane = true;
      turned_rows = {std::min(turned_rows.begin, y), std::max(turned_rows.end, y + 1)};
    }
    if (any_in_plane) each_x(turned_.in_plane.data(), [&](std::size_t x) { axes_[1].current[x * nz + at(z)] = {}; });
  }
  // The last eight bytes of a row may reach into the next one, whose lines are numbered on from there.
  for (int y = turned_rows.begin; y < turned_rows.end; ++y)
    each_x(&turned_.in_rows[at(y) * nx], [&](std::size_t x) { axes_[2].current[at(y) * nx + x] = {}; });
}

// Traces where the object leaves space on the middle line of each cell.
void OutsideGrid::trace(std::size_t axis, int u, int v, std::size_t line) {
  const std::size_t ua = (axis + 1) % 3, va = (axis + 2) % 3;
  const int n = count_[axis];
  OutsideCell* const cells = &axes_[axis].outside[line * at(n)];
  for (int w = 0; w < n; ++w) cells[w] = {0, 1, 1};
  const int lattice_u = place_.lattice_line(ua, u), lattice_v = place_.lattice_line(va, v);
  const auto crossings = lines_.line(static_cast<int>(axis), lattice_u, lattice_v);
  const auto in_cells = [&](float position) {
    return std::clamp(static_cast<float>((position - place_.lower[static_cast<int>(axis)]) / place_.stride), 0.0F,
                      static_cast<float>(n));
  };
  // A cell that is entered and left again, with empty space on both sides, counts evenly: slope −1 marks it.
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const float enter = in_cells(crossings[i].at), leave = in_cells(crossings[i + 1].at);
    if (!(enter < leave)) continue;
    const int last = std::min(n - 1, static_cast<int>(leave));
    for (int w = static_cast<int>(enter); w <= last; ++w) {
      OutsideCell& cell = cells[w];
      const float from = std::max(enter - static_cast<float>(w), 0.0F);
      const float to = std::min(leave - static_cast<float>(w), 1.0F);
      const float end = cell.start + cell.total;
      if (from <= cell.start) {
        const float cut = std::clamp(to - cell.start, 0.0F, cell.total);
        cell.start += cut;
        cell.total -= cut;
      } else if (to >= end) {
        cell.total -= std::clamp(end - from, 0.0F, cell.total);
      } else {
        cell.total -= to - from;
        cell.slope = -1;
      }
    }
  }
  const ObjectLines::WeightsAlong weights = lines_.weights_along(static_cast<int>(axis), lattice_u, lattice_v);
  for (int w = 0, lattice = place_.first[axis]; w < n; ++w, lattice += place_.stride) {
    OutsideCell& cell = cells[w];
    if (!(cell.total > 0)) {
      cell = {0, 0, 0};
      full_along_[at(u) * step_[ua] + at(v) * step_[va] + at(w) * step_[axis]] |= static_cast<std::uint8_t>(1u << axis);
      continue;
    }
    const float weight = weights[lattice >= 0 ? lattice / weights.block : -1];
    if (cell.slope < 0) {
      cell = {0, weight * cell.total, weight * cell.total};
    } else {
      cell.slope = weight;
      cell.total *= weight;
    }
  }
  axes_[axis].traced[line] = 1;
}

void OutsideGrid::prepare(const Vec3f& center, float reach, float overlap_weight) {
  if (overlap_weight != prepared_.overlap_weight) {
    for (Axis& a : axes_) std::fill(a.current.begin(), a.current.end(), Extent{});
    prepared_.overlap_weight = overlap_weight;
  }
  prepared_.center = center;
  prepared_.reach = reach;
  for (std::size_t a = 0; a < 3; ++a) {
    // Every line gets the same range: lines near the rim of the ball need less, but computing how much costs more. The
    // range is a bit longer than requested: the next request is seldom far away, and a range that begins earlier is
    // computed from scratch.
    const float middle = center[static_cast<int>(a)], along = 1.2F * reach;
    const Extent needed{
        static_cast<std::uint16_t>(std::clamp(middle - along, 0.0F, static_cast<float>(count_[a] - 1))),
        static_cast<std::uint16_t>(std::clamp(middle + along + 1, 1.0F, static_cast<float>(count_[a])))};
    const std::size_t row_length = at(count_[(a + 1) % 3]);
    Axis& own = axes_[a];
    const std::size_t n = at(count_[a]), ua = (a + 1) % 3, va = (a + 2) % 3;
    each_row(a, center, reach, [&](int v, int begin, int end, float) {
      const std::size_t row = at(v) * row_length;
      for (int u = begin; u < end;) {
        // Lines without any step yet need the same range; the others join it to theirs. Steps are sums from the
        // beginning of a line's range: if that stays, the steps that it has are the needed ones.
        const Extent has = own.current[row + at(u)];
        const bool is_fresh = has.begin >= has.end;
        if (!is_fresh && has.begin <= needed.begin && has.end >= needed.end) {
          ++u;
          continue;
        }
        const Extent extent =
            is_fresh ? needed : Extent{std::min(needed.begin, has.begin), std::max(needed.end, has.end)};
        const bool is_longer = !is_fresh && extent.begin == has.begin;
        const int first = u;
        do {
          if (own.traced[row + at(u)] == 0) trace(a, u, v, row + at(u));
          own.current[row + at(u)] = extent;
          ++u;
        } while (u < end && own.current[row + at(u)] == has);
        const std::size_t line = row + at(first);
        const OpenLines open{&own.outside[line * n],
                             n,
                             &balls_over_[at(first) * step_[ua] + at(v) * step_[va]],
                             step_[ua],
                             step_[a],
                             &own.steps[line * n],
                             at(u - first)};
        fit_kernels().make_steps(open, is_longer ? has.end : extent.begin, extent.end, overlap_weight, is_longer);
      }
    });
  }
}

bool OutsideGrid::is_prepared(const Vec3f& center, float radius) const {
  const Vec3f off = center - prepared_.center;
  const float slack = prepared_.reach - radius;
  return slack >= 0 && off.x * off.x + off.y * off.y + off.z * off.z <= slack * slack;
}

bool OutsideGrid::is_inside(const Vec3f& center, float radius) const {
  for (int k = 0; k < 3; ++k)
    if (!(center[k] - radius >= 0 && center[k] + radius <= static_cast<float>(count_[at(k)]))) return false;
  return true;
}

float OutsideGrid::cost(const Vec3f& center, float radius, float enough) const {
  float sum = 0;
  if (!(reduced(radius) > 0)) return sum;
  for (std::size_t a = 0; a < 3 && sum <= enough; ++a) {
    const std::size_t ua = (a + 1) % 3, va = (a + 2) % 3;
    sum += fit_kernels().outside(
        {axes_[a].steps.get(), count_[a], count_[ua], count_[va]},
        {center[static_cast<int>(a)], center[static_cast<int>(ua)], center[static_cast<int>(va)], reduced(radius)});
  }
  return sum;
}

float OutsideGrid::new_outside(const Spheref& whole) {
  const Spheref ball{whole.center, reduced(whole.radius)};
  // Line by line: thirds of cells added to one large float would be rounded the same way each time.
  double total = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t ua = (a + 1) % 3, va = (a + 2) % 3;
    const int n = count_[a];
    const float middle = ball.center[static_cast<int>(a)];
    each_line(a, ball.center, ball.radius, [&](int u, int v, std::size_t line) {
      if (axes_[a].traced[line] == 0) trace(a, u, v, line);
      const float du = static_cast<float>(u) + 0.5F - ball.center[static_cast<int>(ua)];
      const float dv = static_cast<float>(v) + 0.5F - ball.center[static_cast<int>(va)];
      const float chord = std::sqrt(std::max(0.0F, ball.radius * ball.radius - du * du - dv * dv));
      const float from = std::clamp(middle - chord, 0.0F, static_cast<float>(n)),
                  to = std::clamp(middle + chord, 0.0F, static_cast<float>(n));
      const OutsideCell* const cells = &axes_[a].outside[line * at(n)];
      const std::uint8_t* const over = &balls_over_[at(u) * step_[ua] + at(v) * step_[va]];
      const int last = std::min(n - 1, static_cast<int>(to));
      float sum = 0;
      for (int w = static_cast<int>(from); w <= last; ++w) {
        if (over[at(w) * step_[a]] != 0) continue;
        const OutsideCell& cell = cells[w];
        const auto up_to = [&](float position) {
          return std::min(cell.slope * std::max(position - static_cast<float>(w) - cell.start, 0.0F), cell.total);
        };
        sum += up_to(std::min(to, static_cast<float>(w + 1))) - up_to(std::max(from, static_cast<float>(w)));
      }
      total += static_cast<double>(sum);
    });
  }
  return static_cast<float>(total);
}

double OutsideGrid::outside_together(std::span<const Spheref> balls) {
  double total = 0;
  std::vector<std::array<float, 2>> on_line;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t ua = (a + 1) % 3, va = (a + 2) % 3;
    const std::size_t row_length = at(count_[ua]);
    const int n = count_[a];
    chords_.first.resize(std::max(chords_.first.size(), row_length * at(count_[va])), -1);
    chords_.all.clear();
    chords_.lines_met.clear();
    for (const Spheref& whole : balls) {
      const Spheref ball{whole.center, reduced(whole.radius)};
      const float cu = ball.center[static_cast<int>(ua)], middle = ball.center[static_cast<int>(a)];
      each_row(a, ball.center, ball.radius, [&](int v, int begin, int end, float in_row) {
        for (int u = begin; u < end; ++u) {
          const float du = static_cast<float>(u) + 0.5F - cu, square = in_row - du * du;
          if (!(square > 0)) continue;
          const float half = std::sqrt(square);
          std::int32_t& first = chords_.first[at(v) * row_length + at(u)];
          if (first < 0) chords_.lines_met.push_back({u, v});
          chords_.all.push_back({std::clamp(middle - half, 0.0F, static_cast<float>(n)),
                                 std::clamp(middle + half, 0.0F, static_cast<float>(n)), first});
          first = static_cast<std::int32_t>(chords_.all.size() - 1);
        }
      });
    }
    for (const auto& [u, v] : chords_.lines_met) {
      const std::size_t line = at(v) * row_length + at(u);
      on_line.clear();
      for (std::int32_t c = chords_.first[line]; c >= 0; c = chords_.all[at(c)].next)
        on_line.push_back({chords_.all[at(c)].from, chords_.all[at(c)].to});
      chords_.first[line] = -1;
      std::sort(on_line.begin(), on_line.end());
      if (axes_[a].traced[line] == 0) trace(a, u, v, line);
      const OutsideCell* const cells = &axes_[a].outside[line * at(n)];
      float sum = 0;
      const auto add = [&](float from, float to) {
        const int last = std::min(n - 1, static_cast<int>(to));
        for (int w = static_cast<int>(from); w <= last; ++w) {
          const OutsideCell& cell = cells[w];
          if (!(cell.total > 0)) continue;
          const auto up_to = [&](float position) {
            return std::min(cell.slope * std::max(position - static_cast<float>(w) - cell.start, 0.0F), cell.total);
          };
          sum += up_to(std::min(to, static_cast<float>(w + 1))) - up_to(std::max(from, static_cast<float>(w)));
        }
      };
      std::array<float, 2> merged = on_line[0];
      for (const std::array<float, 2>& chord : on_line)
        if (chord[0] <= merged[1]) {
          merged[1] = std::max(merged[1], chord[1]);
        } else {
          add(merged[0], merged[1]);
          merged = chord;
        }
      add(merged[0], merged[1]);
      total += static_cast<double>(sum);
    }
  }
  return total;
}

}  // namespace morula::detail
