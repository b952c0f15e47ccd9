// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Union lines: the volume that many spheres cover together outside the object, along lines of all three axes.
//
// On each line the spheres' chords are merged, so a layer that is much thinner than a cell is seen, and space that
// several spheres share counts once. Axes are weighted as in OutsideGrid.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Spheres of which each may count or not. An object serves one thread at a time.
class UnionLines {
 public:
  /// lines: borrowed. spacing: requested distance between lines, mesh units; at least a lattice cell. No sphere counts
  /// at first.
  UnionLines(const ObjectLines& lines, std::span<const Sphere> spheres, double spacing);

  void count(std::size_t sphere, bool whether);
  /// Number of lines that have a chord of the sphere.
  std::size_t line_count(std::size_t sphere) const {
    return sphere_lines_begin_[sphere + 1] - sphere_lines_begin_[sphere];
  }
  bool counts(std::size_t sphere) const { return counts_[sphere] != 0; }

  /// Empty space in the union of the spheres that count. Volumes are in mesh units cubed.
  double outside() const;
  /// The increase (or, negative, decrease) of outside() if `added` counted and `removed` did not. The lists have no
  /// repetitions.
  double change(std::span<const std::uint32_t> added, std::span<const std::uint32_t> removed);
  /// Empty space in the union of the spheres that count or in that of the given ones, but not in both.
  double difference(std::span<const std::uint8_t> others) const;

 private:
  struct Chord {
    float begin, end;                        // lattice coordinates
    float outside_to_begin, outside_to_end;  // weighted empty space from the line's first chord up to the ends
    std::uint32_t sphere;
  };
  struct Axis {
    int first_u = 0, first_v = 0, nu = 0, nv = 0;  // numbers of lines: (first + i · stride) of the lattice
    std::size_t first_line = 0;
  };
  template <class Visit>
  void each_line(std::size_t axis, const Sphere& in_lattice, const Visit& visit) const;
  void assign_chords(std::span<const Sphere> in_lattice);
  void measure(std::size_t axis, int u, int v, std::span<Chord> chords) const;
  std::span<const Chord> line(std::size_t i) const {
    return std::span(chords_).subspan(line_begin_[i], line_begin_[i + 1] - line_begin_[i]);
  }
  template <class Counts>
  static double merged(std::span<const Chord> chords, const Counts& counts);
  double outside_on(std::size_t i);

  const ObjectLines& lines_;
  int stride_;
  double volume_per_length_;
  std::array<Axis, 3> axes_;
  std::vector<std::uint32_t> line_begin_;  // first index into chords_, per line of all three axes
  std::vector<Chord> chords_;              // chords of a line, from low to high
  std::vector<std::uint32_t> sphere_lines_begin_, sphere_lines_;
  std::vector<std::uint8_t> counts_;
  std::vector<std::uint8_t> otherwise_;  // stamp of the last change() that counted the line, per line
  std::vector<std::uint32_t> seen_;      // lines that are seen, a number per line
  std::uint32_t stamp_ = 0;
  std::vector<double> outside_on_;  // outside volume on each line, of the spheres that count; negative: not computed
};

}  // namespace morula::detail
