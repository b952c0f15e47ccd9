// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Union volume: the volume of a set of spheres outside the object, overlaps counted once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Integrates along lines of all three axes, on which the chords of all spheres are merged: exact along each line. Mesh
/// units cubed. Radii are reduced by the lines' tolerance. The result for a set has the same bits whatever sets were
/// measured earlier. An object serves one thread at a time.
class UnionVolume {
 public:
  explicit UnionVolume(const ObjectLines& lines);  ///< lines: borrowed
  /// Cost: O(lines × spheres over each), for lines that meet a sphere which only one of this set and the last one has.
  double outside(std::span<const Sphere> spheres);
  /// Outside volume of one sphere by itself. The state of outside() stays. Cost: O(lines over it).
  double outside(const Sphere& sphere) const;

 private:
  struct Chord {
    double from, to;
  };
  // Lines [begin, end) of a row that a sphere has met, and the outside volume on them.
  struct Row {
    int begin = 0, end = 0;
    double outside = 0;
  };
  struct Axis {
    int u_begin = 0, u_end = 0, v_begin = 0, v_end = 0;
    std::vector<double> outside;  // per line, row by row
    std::vector<Row> rows;
  };
  Sphere in_lattice(const Sphere& sphere) const;
  int number(double position) const;
  bool has_room(const std::vector<Sphere>& spheres) const;
  void make_room(const std::vector<Sphere>& spheres);
  void renew(int axis, std::span<const Sphere> changed);
  void renew_row(int axis, int v, std::span<const Sphere> spheres, std::span<const Sphere> changed);
  template <class Visit>
  void each_in_row(int axis, int v, const Sphere& sphere, const Visit& visit) const;
  template <class Wanted, class Visit>
  void each_chord(int axis, int v, const Sphere& sphere, const Wanted& is_wanted, const Visit& visit) const;
  static double outside_of(std::span<Chord> chords, std::span<const ObjectLines::Crossing> crossings);

  const ObjectLines& lines_;
  int stride_, middle_;
  std::vector<Sphere> last_;  // spheres in lattice coordinates, sorted
  std::array<Axis, 3> axes_;
  // Chords of the lines of one row.
  std::vector<Chord> chords_;  // room for one of each sphere on each line
  std::vector<std::uint32_t> chord_count_;
  std::vector<std::uint8_t> is_changed_;
};

}  // namespace morula::detail
