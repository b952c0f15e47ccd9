// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Union lines: the empty space that many spheres take in together, along lines of all three axes.
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

/// Spheres of which each may count or not. For one thread at a time.
class UnionLines {
 public:
  /// lines: borrowed. spacing: wanted between lines, mesh units; at least a lattice cell. Without chosen spheres.
  UnionLines(const ObjectLines& lines, std::span<const Sphere> spheres, double spacing);

  void count(std::size_t sphere, bool whether);
  /// Lines that have a chord of it.
  std::size_t line_count(std::size_t sphere) const {
    return sphere_lines_begin_[sphere + 1] - sphere_lines_begin_[sphere];
  }
  bool counts(std::size_t sphere) const { return counts_[sphere] != 0; }

  /// Empty space in the union of those that count. Volumes are of mesh units cubed.
  double outside() const;
  /// How much of it there would be more (or, negative, less) if these counted and those did not. For lists without
  /// repetitions.
  double change(std::span<const std::uint32_t> added, std::span<const std::uint32_t> removed);
  /// Empty space in the union of those that count or of those given, but not in both unions.
  double difference(std::span<const std::uint8_t> others) const;

 private:
  struct Chord {
    float begin, end;                        // lattice coordinates
    float outside_to_begin, outside_to_end;  // weighted empty space from the line's first chord on
    std::uint32_t sphere;
  };
  struct Axis {
    int first_u = 0, first_v = 0, nu = 0, nv = 0;  // lines (first + i · stride) of the lattice
    std::size_t first_line = 0;
  };
  template <class Visit>
  void each_line(std::size_t axis, const Sphere& in_lattice, const Visit& visit) const;
  void deal_chords(std::span<const Sphere> in_lattice);
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
  std::vector<std::uint32_t> line_begin_;  // of chords_, per line of all three axes
  std::vector<Chord> chords_;              // of a line from low to high
  std::vector<std::uint32_t> sphere_lines_begin_, sphere_lines_;
  std::vector<std::uint8_t> counts_;
  std::vector<std::uint8_t> otherwise_;  // scratch of change()
  std::vector<std::uint32_t> seen_;      // per line
  std::uint32_t stamp_ = 0;
  std::vector<double> outside_on_;  // per line, of those that count; negative: not known
};

}  // namespace morula::detail
