// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/union_lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

// Lines, and chords of spheres, between two checks for interruption: a line takes up to about 50 µs.
constexpr std::uint32_t lines_per_look = 64, chords_per_look = 1u << 14;

}  // namespace

UnionLines::UnionLines(const ObjectLines& lines, std::span<const Sphere> spheres, double spacing)
    : lines_(lines),
      stride_(std::max(1, static_cast<int>(spacing / lines.cell()))),
      counts_(spheres.size(), 0),
      otherwise_(spheres.size(), 0) {
  const double cell = lines.cell();
  std::vector<Sphere> in_lattice;
  Box box;
  for (const Sphere& s : spheres) {
    in_lattice.push_back({lines.to_lattice(s.center), s.radius / cell});
    const double r = in_lattice.back().radius;
    box.add(in_lattice.back().center - Vec3{r, r, r});
    box.add(in_lattice.back().center + Vec3{r, r, r});
  }
  // Spheres that reach far beyond the object would have lines by the million.
  constexpr double most_lines_across = 2048;
  if (!spheres.empty())
    stride_ = std::max(stride_, static_cast<int>(std::ceil(max_norm(box.extent()) / most_lines_across)));
  volume_per_length_ = cell * cell * cell * stride_ * stride_;
  std::size_t line_count = 0;
  for (std::size_t a = 0; a < 3 && !spheres.empty(); ++a) {
    const int ua = static_cast<int>((a + 1) % 3), va = static_cast<int>((a + 2) % 3);
    const auto first = [&](int k) { return static_cast<int>(std::floor(box.lower[k])); };
    const auto number = [&](int k) { return 1 + (static_cast<int>(std::ceil(box.upper[k])) - first(k)) / stride_; };
    axes_[a] = {first(ua), first(va), number(ua), number(va), line_count};
    line_count += static_cast<std::size_t>(axes_[a].nu) * static_cast<std::size_t>(axes_[a].nv);
  }
  seen_.assign(line_count, 0);
  outside_on_.assign(line_count, -1);
  assign_chords(in_lattice);
}

// Chords by line: first counted, then assigned.
void UnionLines::assign_chords(std::span<const Sphere> in_lattice) {
  const std::size_t line_count = seen_.size();
  std::vector<std::uint32_t> next(line_count + 1, 0);
  InterruptPoller poll_chord(chords_per_look), poll_line(lines_per_look);
  sphere_lines_begin_.push_back(0);
  for (const Sphere& s : in_lattice) {
    for (std::size_t a = 0; a < 3; ++a)
      each_line(a, s, [&](std::size_t line, double) {
        poll_chord();
        ++next[line + 1];
        sphere_lines_.push_back(static_cast<std::uint32_t>(line));
      });
    sphere_lines_begin_.push_back(static_cast<std::uint32_t>(sphere_lines_.size()));
  }
  for (std::size_t i = 1; i <= line_count; ++i) next[i] += next[i - 1];
  line_begin_ = next;
  resize_interruptibly(chords_, next[line_count]);
  for (std::size_t i = 0; i < in_lattice.size(); ++i)
    for (std::size_t a = 0; a < 3; ++a)
      each_line(a, in_lattice[i], [&](std::size_t line, double half) {
        poll_chord();
        const double middle = in_lattice[i].center[static_cast<int>(a)];
        chords_[next[line]++] = {static_cast<float>(middle - half), static_cast<float>(middle + half), 0, 0,
                                 static_cast<std::uint32_t>(i)};
      });
  for (std::size_t a = 0; a < 3; ++a)
    for (int v = 0; v < axes_[a].nv; ++v)
      for (int u = 0; u < axes_[a].nu; ++u) {
        const std::size_t i = axes_[a].first_line +
                              static_cast<std::size_t>(v) * static_cast<std::size_t>(axes_[a].nu) +
                              static_cast<std::size_t>(u);
        const auto chords = std::span(chords_).subspan(line_begin_[i], line_begin_[i + 1] - line_begin_[i]);
        if (chords.empty()) continue;
        poll_line();
        std::sort(chords.begin(), chords.end(), [](const Chord& x, const Chord& y) {
          return x.begin != y.begin ? x.begin < y.begin : x.sphere < y.sphere;
        });
        measure(a, axes_[a].first_u + u * stride_, axes_[a].first_v + v * stride_, chords);
      }
}

// Lines that a sphere has a chord on, and half of its length. The lattice's lines are at the middles of cells.
template <class Visit>
void UnionLines::each_line(std::size_t axis, const Sphere& s, const Visit& visit) const {
  const Axis& lines = axes_[axis];
  const double cu = s.center[static_cast<int>((axis + 1) % 3)] - 0.5 - lines.first_u;
  const double cv = s.center[static_cast<int>((axis + 2) % 3)] - 0.5 - lines.first_v;
  const auto first = [&](double low) { return std::max(0, static_cast<int>(std::ceil(low / stride_))); };
  const auto last = [&](double high, int n) { return std::min(n - 1, static_cast<int>(std::floor(high / stride_))); };
  for (int v = first(cv - s.radius); v <= last(cv + s.radius, lines.nv); ++v) {
    const double dv = v * stride_ - cv, in_row = s.radius * s.radius - dv * dv;
    if (!(in_row > 0)) continue;
    const double half_row = std::sqrt(in_row);
    for (int u = first(cu - half_row); u <= last(cu + half_row, lines.nu); ++u) {
      const double du = u * stride_ - cu, square = in_row - du * du;
      if (!(square > 0)) continue;
      visit(lines.first_line + static_cast<std::size_t>(v) * static_cast<std::size_t>(lines.nu) +
                static_cast<std::size_t>(u),
            std::sqrt(square));
    }
  }
}

// Walks along a line from chord end to chord end, adding up the length outside the object.
void UnionLines::measure(std::size_t axis, int u, int v, std::span<Chord> chords) const {
  struct End {
    float at;
    float* outside;
  };
  // Chords come in the order of where they begin, so nearly in that of where they end.
  thread_local std::vector<End> begins, closings, ends;
  begins.clear(), closings.clear();
  for (Chord& c : chords) {
    begins.push_back({c.begin, &c.outside_to_begin});
    closings.push_back({c.end, &c.outside_to_end});
  }
  const auto is_before = [](const End& x, const End& y) { return x.at < y.at; };
  // Insertion sort takes the square of their number if chords lie in others.
  constexpr std::size_t few = 64;
  if (closings.size() > few) std::sort(closings.begin(), closings.end(), is_before);
  for (std::size_t i = 1; i < closings.size(); ++i) {
    const End closing = closings[i];
    std::size_t to = i;
    for (; to > 0 && is_before(closing, closings[to - 1]); --to) closings[to] = closings[to - 1];
    closings[to] = closing;
  }
  ends.resize(2 * chords.size());
  std::merge(begins.begin(), begins.end(), closings.begin(), closings.end(), ends.begin(), is_before);
  const auto crossings = lines_.line(static_cast<int>(axis), u, v);
  const ObjectLines::WeightsAlong weights = lines_.weights_along(static_cast<int>(axis), u, v);
  const auto block = static_cast<float>(weights.block), blocks_end = block * static_cast<float>(weights.blocks);
  std::size_t next_crossing = 0;  // the number of those behind is odd inside
  float at = ends[0].at;
  double sum = 0;
  for (const End& end : ends) {
    while (at < end.at) {
      while (next_crossing < crossings.size() && crossings[next_crossing].at <= at) ++next_crossing;
      float to = end.at;
      if (next_crossing < crossings.size()) to = std::min(to, crossings[next_crossing].at);
      if (next_crossing % 2 == 0) {
        int in_block = -1;
        if (at < 0) {
          to = std::min(to, 0.0F);
        } else if (at < blocks_end) {
          in_block = static_cast<int>(at / block);
          // If rounding puts a block's end into the block, the next one begins there all the same.
          if (const float block_end = static_cast<float>(in_block + 1) * block; block_end > at)
            to = std::min(to, block_end);
        }
        sum += static_cast<double>(weights[in_block] * (to - at));
      }
      at = to;
    }
    *end.outside = static_cast<float>(sum);
  }
}

template <class Counts>
double UnionLines::merged(std::span<const Chord> chords, const Counts& counts) {
  // The counting chords follow no pattern: all go through the same steps, and the other chords change nothing.
  double sum = 0;
  float end = -std::numeric_limits<float>::infinity(), outside_from = 0, outside_to = 0;
  for (const Chord& c : chords) {
    const bool is_counted = counts(c.sphere), is_apart = is_counted & (c.begin > end),
               reaches_on = is_counted & (c.end > end);
    sum += is_apart ? static_cast<double>(outside_to) - static_cast<double>(outside_from) : 0.0;
    outside_from = is_apart ? c.outside_to_begin : outside_from;
    outside_to = reaches_on ? c.outside_to_end : outside_to;
    end = reaches_on ? c.end : end;
  }
  return sum + (static_cast<double>(outside_to) - static_cast<double>(outside_from));
}

double UnionLines::outside() const {
  double sum = 0;
  InterruptPoller poll_line(lines_per_look);
  for (std::size_t i = 0; i + 1 < line_begin_.size(); ++i) {
    if (line_begin_[i] == line_begin_[i + 1]) continue;
    poll_line();
    sum += merged(line(i), [&](std::uint32_t s) { return counts_[s] != 0; });
  }
  return sum * volume_per_length_;
}

void UnionLines::count(std::size_t sphere, bool whether) {
  if (counts(sphere) == whether) return;
  counts_[sphere] = whether ? 1 : 0;
  for (std::uint32_t k = sphere_lines_begin_[sphere]; k < sphere_lines_begin_[sphere + 1]; ++k)
    outside_on_[sphere_lines_[k]] = -1;
}

// Many changes are evaluated before one is made.
double UnionLines::outside_on(std::size_t i) {
  if (outside_on_[i] < 0) outside_on_[i] = merged(line(i), [&](std::uint32_t s) { return counts_[s] != 0; });
  return outside_on_[i];
}

double UnionLines::change(std::span<const std::uint32_t> added, std::span<const std::uint32_t> removed) {
  check_interrupt();
  InterruptPoller poll_line(lines_per_look);
  ++stamp_;
  otherwise_ = counts_;
  for (const std::uint32_t s : added) otherwise_[s] = 1;
  for (const std::uint32_t s : removed) otherwise_[s] = 0;
  double sum = 0;
  for (const auto& list : {added, removed})
    for (const std::uint32_t s : list)
      for (std::uint32_t k = sphere_lines_begin_[s]; k < sphere_lines_begin_[s + 1]; ++k) {
        const std::uint32_t i = sphere_lines_[k];
        if (seen_[i] == stamp_) continue;
        seen_[i] = stamp_;
        poll_line();
        sum += merged(line(i), [&](std::uint32_t c) { return otherwise_[c] != 0; }) - outside_on(i);
      }
  return sum * volume_per_length_;
}

double UnionLines::difference(std::span<const std::uint8_t> others) const {
  double sum = 0;
  InterruptPoller poll_line(lines_per_look);
  for (std::size_t i = 0; i + 1 < line_begin_.size(); ++i) {
    if (line_begin_[i] == line_begin_[i + 1]) continue;
    poll_line();
    const auto chords = line(i);
    sum += 2 * merged(chords, [&](std::uint32_t s) { return counts_[s] != 0 || others[s] != 0; }) -
           merged(chords, [&](std::uint32_t s) { return counts_[s] != 0; }) -
           merged(chords, [&](std::uint32_t s) { return others[s] != 0; });
  }
  return sum * volume_per_length_;
}

}  // namespace morula::detail
