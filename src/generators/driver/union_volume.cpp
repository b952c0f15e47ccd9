// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/union_volume.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <morula/geometry/box.hpp>
#include <tuple>
#include <utility>

namespace morula::detail {
namespace {

bool comes_before(const Sphere& a, const Sphere& b) {
  const auto key = [](const Sphere& s) { return std::tuple(s.center.x, s.center.y, s.center.z, s.radius); };
  return key(a) < key(b);
}

Box box_of(const std::vector<Sphere>& spheres) {
  Box box;
  box.add({0, 0, 0});
  for (const Sphere& s : spheres) {
    const Vec3 reach{s.radius, s.radius, s.radius};
    box.add(s.center - reach);
    box.add(s.center + reach);
  }
  return box;
}

}  // namespace

UnionVolume::UnionVolume(const ObjectLines& lines) : lines_(lines) {
  constexpr int lines_wanted = 96;  // along the longest side
  const std::array<int, 3>& count = lines.count();
  stride_ = std::max(1, *std::max_element(count.begin(), count.end()) / lines_wanted);
  middle_ = stride_ / 2;
}

Sphere UnionVolume::in_lattice(const Sphere& s) const {
  // mutant tolerance-not-in-the-union: `s.radius - lines_.tolerance()` -> `s.radius`
  return {lines_.to_lattice(s.center), std::max(0.0, s.radius - lines_.tolerance()) / lines_.cell()};
}

int UnionVolume::number(double position) const {
  return static_cast<int>(std::floor(position / stride_));
}

double UnionVolume::outside(std::span<const Sphere> spheres) {
  std::vector<Sphere> local;
  for (const Sphere& s : spheres) local.push_back(in_lattice(s));
  std::sort(local.begin(), local.end(), comes_before);
  if (!has_room(local)) {
    make_room(local);
    last_.clear();
  }
  // A line's chords are merged in the order of where they begin, whatever sphere they belong to: equal chords give
  // equal results.
  std::vector<Sphere> changed;
  std::set_symmetric_difference(local.begin(), local.end(), last_.begin(), last_.end(), std::back_inserter(changed),
                                comes_before);
  last_ = std::move(local);
  double total = 0;
  for (int axis = 0; axis < 3; ++axis) {
    renew(axis, changed);
    for (const Row& row : axes_[static_cast<std::size_t>(axis)].rows) total += row.outside;
  }
  const double cell = lines_.cell();
  return total / 3 * stride_ * stride_ * cell * cell * cell;
}

double UnionVolume::outside(const Sphere& sphere) const {
  const Sphere local = in_lattice(sphere);
  double total = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double across = local.center[(axis + 2) % 3];
    for (int v = number(across - local.radius); v <= number(across + local.radius); ++v) {
      double row = 0;  // added row by row, as for a set
      each_chord(
          axis, v, local, [](int) { return true; },
          [&](int u, Chord chord) {
            row += outside_of({&chord, 1}, lines_.line(axis, u * stride_ + middle_, v * stride_ + middle_));
          });
      total += row;
    }
  }
  const double cell = lines_.cell();
  return total / 3 * stride_ * stride_ * cell * cell * cell;
}

bool UnionVolume::has_room(const std::vector<Sphere>& spheres) const {
  const Box box = box_of(spheres);
  for (int axis = 0; axis < 3; ++axis) {
    const Axis& a = axes_[static_cast<std::size_t>(axis)];
    const int ua = (axis + 1) % 3, va = (axis + 2) % 3;
    if (number(box.lower[ua]) < a.u_begin || number(box.upper[ua]) >= a.u_end || number(box.lower[va]) < a.v_begin ||
        number(box.upper[va]) >= a.v_end)
      return false;
  }
  return true;
}

// No sphere has a chord outside the rows and lines that its box has numbers of: each line is half a cell from those
// ends.
void UnionVolume::make_room(const std::vector<Sphere>& spheres) {
  const Box box = box_of(spheres);
  for (int axis = 0; axis < 3; ++axis) {
    Axis& a = axes_[static_cast<std::size_t>(axis)];
    const int ua = (axis + 1) % 3, va = (axis + 2) % 3;
    a.u_begin = std::min(a.u_begin, number(box.lower[ua])), a.u_end = std::max(a.u_end, number(box.upper[ua]) + 1);
    a.v_begin = std::min(a.v_begin, number(box.lower[va])), a.v_end = std::max(a.v_end, number(box.upper[va]) + 1);
    const auto row_length = static_cast<std::size_t>(a.u_end - a.u_begin),
               rows = static_cast<std::size_t>(a.v_end - a.v_begin);
    a.outside.assign(rows * row_length, 0);
    a.rows.assign(rows, {});
    chord_count_.resize(std::max(chord_count_.size(), row_length), 0);
    is_changed_.resize(std::max(is_changed_.size(), row_length), 0);
  }
}

// Lines of a row near a sphere: [first, last], and the square of half its width there.
template <class Visit>
void UnionVolume::each_in_row(int axis, int v, const Sphere& sphere, const Visit& visit) const {
  const double dv = v * stride_ + middle_ + 0.5 - sphere.center[(axis + 2) % 3];
  const double in_row = sphere.radius * sphere.radius - dv * dv;
  if (!(in_row > 0)) return;
  const double middle = sphere.center[(axis + 1) % 3], half = std::sqrt(in_row);
  visit(number(middle - half), number(middle + half), in_row);
}

// Calls visit for the sphere's chords on the requested lines u of a row.
template <class Wanted, class Visit>
void UnionVolume::each_chord(int axis, int v, const Sphere& sphere, const Wanted& is_wanted, const Visit& visit) const {
  each_in_row(axis, v, sphere, [&](int first, int last, double in_row) {
    const double middle = sphere.center[(axis + 1) % 3], along = sphere.center[axis];
    for (int u = first; u <= last; ++u) {
      if (!is_wanted(u)) continue;
      const double du = u * stride_ + middle_ + 0.5 - middle, in_line = in_row - du * du;
      if (!(in_line > 0)) continue;
      const double half = std::sqrt(in_line);
      visit(u, Chord{along - half, along + half});
    }
  });
}

// Only rows that a changed sphere reaches, and only spheres that have a number of such a row and of a line next to it:
// a changed sphere renews whole lines by their numbers, also a line that lies just outside the sphere.
void UnionVolume::renew(int axis, std::span<const Sphere> changed) {
  if (changed.empty()) return;
  struct Numbers {
    int u_first, u_last, v_first, v_last;
  };
  const auto numbers_of = [&](const Sphere& s) {
    const double u = s.center[(axis + 1) % 3], v = s.center[(axis + 2) % 3], r = s.radius;
    return Numbers{number(u - r), number(u + r), number(v - r), number(v + r)};
  };
  Numbers all = numbers_of(changed.front());
  for (const Sphere& s : changed) {
    const Numbers n = numbers_of(s);
    all = {std::min(all.u_first, n.u_first), std::max(all.u_last, n.u_last), std::min(all.v_first, n.v_first),
           std::max(all.v_last, n.v_last)};
  }
  std::vector<Sphere> near;
  for (const Sphere& s : last_) {
    const Numbers n = numbers_of(s);
    // mutant union-volume-near: `n.u_first <= all.u_last && n.u_last >=` -> `n.u_first < all.u_last && n.u_last >`
    if (n.u_first <= all.u_last && n.u_last >= all.u_first && n.v_first <= all.v_last && n.v_last >= all.v_first)
      near.push_back(s);
  }
  for (int v = all.v_first; v <= all.v_last; ++v) renew_row(axis, v, near, changed);
}

void UnionVolume::renew_row(int axis, int v, std::span<const Sphere> spheres, std::span<const Sphere> changed) {
  Axis& a = axes_[static_cast<std::size_t>(axis)];
  const auto row = static_cast<std::size_t>(v - a.v_begin), row_length = static_cast<std::size_t>(a.u_end - a.u_begin);
  int begin = a.u_end - a.u_begin, end = 0;  // range of the lines that change
  for (const Sphere& s : changed)
    each_in_row(axis, v, s, [&](int first_line, int last_line, double) {
      const int first = first_line - a.u_begin, last = last_line - a.u_begin;
      std::fill(is_changed_.begin() + first, is_changed_.begin() + last + 1, std::uint8_t{1});
      begin = std::min(begin, first), end = std::max(end, last + 1);
    });
  if (begin >= end) return;
  const std::size_t most = spheres.size();
  chords_.resize(std::max(chords_.size(), row_length * most));
  for (const Sphere& s : spheres)
    each_chord(
        axis, v, s, [&](int u) { return is_changed_[static_cast<std::size_t>(u - a.u_begin)] != 0; },
        [&](int u, const Chord& chord) {
          const auto line = static_cast<std::size_t>(u - a.u_begin);
          chords_[line * most + chord_count_[line]++] = chord;
        });
  for (int u = begin; u < end; ++u) {
    const auto line = static_cast<std::size_t>(u);
    if (is_changed_[line] == 0) continue;
    is_changed_[line] = 0;
    const auto chords = std::span(chords_).subspan(line * most, std::exchange(chord_count_[line], 0u));
    a.outside[row * row_length + line] =
        chords.empty()
            ? 0
            : outside_of(chords, lines_.line(axis, (u + a.u_begin) * stride_ + middle_, v * stride_ + middle_));
  }
  Row& whole = a.rows[row];
  whole.begin = whole.begin < whole.end ? std::min(whole.begin, begin) : begin;
  whole.end = std::max(whole.end, end);
  whole.outside = 0;
  for (int u = whole.begin; u < whole.end; ++u)
    whole.outside += a.outside[row * row_length + static_cast<std::size_t>(u)];
}

// Length of merged chords outside the object. crossings: enter, leave, enter, …
double UnionVolume::outside_of(std::span<Chord> chords, std::span<const ObjectLines::Crossing> crossings) {
  if (chords.size() > 1)
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

}  // namespace morula::detail
