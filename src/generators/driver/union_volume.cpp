// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/union_volume.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {
namespace {

struct Chord {
  double from, to;
};

// What merged chords have outside the object. crossings: enter, leave, enter, …
double outside_of(std::vector<Chord>& chords, std::span<const ObjectLines::Crossing> crossings) {
  std::sort(chords.begin(), chords.end(), [](const Chord& a, const Chord& b) { return a.from < b.from; });
  double sum = 0;
  std::size_t inside = 0;
  const auto add = [&](const Chord& chord) {
    sum += chord.to - chord.from;
    // Merged chords come in order, and so do the object's parts.
    for (std::size_t i = inside; i + 1 < crossings.size(); i += 2) {
      const double enter = crossings[i].at, leave = crossings[i + 1].at;
      if (enter >= chord.to) break;
      sum -= std::max(0.0, std::min(leave, chord.to) - std::max(enter, chord.from));
      if (leave <= chord.to) inside = i + 2;
    }
  };
  Chord merged = chords.front();
  for (const Chord& next : chords) {
    if (next.from > merged.to) {
      add(merged);
      merged = next;
    }
    merged.to = std::max(merged.to, next.to);
  }
  add(merged);
  return sum;
}

}  // namespace

double union_outside(const ObjectLines& lines, std::span<const Sphere> spheres) {
  constexpr int lines_wanted = 96;  // along the longest side
  const std::array<int, 3>& count = lines.count();
  const int stride = std::max(1, *std::max_element(count.begin(), count.end()) / lines_wanted);
  const int middle = stride / 2;
  double total = 0;
  std::vector<std::vector<Chord>> row;
  for (int axis = 0; axis < 3; ++axis) {
    const int u_axis = (axis + 1) % 3, v_axis = (axis + 2) % 3;
    std::vector<Sphere> local;
    double u_low = 0, u_high = 0, v_low = 0, v_high = 0;
    for (const Sphere& s : spheres) {
      local.push_back({lines.to_lattice(s.center), s.radius / lines.cell()});
      const auto& [c, r] = local.back();
      u_low = std::min(u_low, c[u_axis] - r), u_high = std::max(u_high, c[u_axis] + r);
      v_low = std::min(v_low, c[v_axis] - r), v_high = std::max(v_high, c[v_axis] + r);
    }
    const auto number = [&](double position) { return static_cast<int>(std::floor(position / stride)); };
    const int u_begin = number(u_low), u_end = number(u_high) + 1;
    row.resize(static_cast<std::size_t>(u_end - u_begin));
    for (int v = number(v_low); v <= number(v_high); ++v) {
      const int v_line = v * stride + middle;
      for (const Sphere& s : local) {
        const double dv = v_line + 0.5 - s.center[v_axis];
        const double in_row = s.radius * s.radius - dv * dv;
        if (!(in_row > 0)) continue;
        const double half = std::sqrt(in_row);
        const int last = number(s.center[u_axis] + half);
        for (int u = number(s.center[u_axis] - half); u <= last; ++u) {
          const double du = u * stride + middle + 0.5 - s.center[u_axis];
          const double in_line = in_row - du * du;
          if (!(in_line > 0)) continue;
          const double chord = std::sqrt(in_line);
          row[static_cast<std::size_t>(u - u_begin)].push_back({s.center[axis] - chord, s.center[axis] + chord});
        }
      }
      for (int u = u_begin; u < u_end; ++u) {
        std::vector<Chord>& chords = row[static_cast<std::size_t>(u - u_begin)];
        if (chords.empty()) continue;
        total += outside_of(chords, lines.line(axis, u * stride + middle, v_line));
        chords.clear();
      }
    }
  }
  const double cell = lines.cell();
  return total / 3 * stride * stride * cell * cell * cell;
}

}  // namespace morula::detail
