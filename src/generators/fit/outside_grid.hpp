// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Outside grid: the empty space that a ball covers and no sibling covers already. Every fit minimizes it.
//
// A ball's outside volume is integrated along lines of all three axes at once. A point of empty space belongs to axis k
// with weight n_k², n the normal of the surface next to it: the weights sum to 1, and each thin layer between ball and
// surface is seen by the lines that cross it squarely. Lines along one axis alone miss or overrate the layers that they
// run along, by more than the layers themselves once those are thinner than a cell.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <memory>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// A part of space in cells, a whole number of lattice cells of ObjectLines wide, around one node. Coordinates are
/// cells of this grid from its lower corner. An object serves one thread at a time: lines are computed when they are
/// first needed. Balls are counted and measured with radii that are smaller by the lines' tolerance; is_inside() and
/// prepare() take the radii as they are.
class OutsideGrid {
 public:
  /// box: where balls may be, mesh coordinates. cell_width: requested, mesh units. lines: borrowed.
  OutsideGrid(const ObjectLines& lines, const Box& box, double cell_width);

  double cell() const { return place_.cell; }
  double cell_volume() const { return cell() * cell() * cell(); }
  Vec3f to_grid(const Vec3& p) const;
  Vec3 from_grid(const Vec3f& p) const;

  /// Counts the space of a ball as covered. remove() undoes that.
  void add(const Spheref& ball) { change({ball.center, reduced(ball.radius)}, 1); }
  void remove(const Spheref& ball) { change({ball.center, reduced(ball.radius)}, -1); }

  /// Prepares cost() for balls inside the ball of radius `reach` about `center`. overlap_weight: weight of the space
  /// that a counted ball covers, 0…1.
  void prepare(const Vec3f& center, float reach, float overlap_weight);
  /// Whether cost() is defined for this ball.
  bool is_prepared(const Vec3f& center, float radius) const;
  bool is_inside(const Vec3f& center, float radius) const;  ///< the ball is inside the grid
  /// Outside volume of a ball in cells. The ball must be inside the prepared ball and inside the grid. Costs above
  /// `enough` may be returned as any number above it.
  float cost(const Vec3f& center, float radius, float enough = std::numeric_limits<float>::infinity()) const;
  /// The same for one ball without preparation, with overlap_weight = 0: slower than cost(), cheaper than prepare().
  float new_outside(const Spheref& ball);
  /// Outside volume of the union of balls, which need not be counted in the grid: their chords are merged on each line,
  /// so a layer thinner than a cell that one of them covers counts although others contain the cell's middle.
  double outside_together(std::span<const Spheref> balls);

 private:
  // Position of the cells among those of the object's lines; the constructor computes it.
  struct Place {
    int stride = 1;              // lattice cells to a cell
    double cell = 0;             // width of a cell, mesh units
    std::array<int, 3> first{};  // lattice lines through the middles of the first cells
    Vec3 lower;                  // lattice coordinates of the grid's lower corner

    int lattice_line(std::size_t axis, int line) const { return first[axis] + line * stride; }
  };
  // Cells that a ball's change turns from no ball to some or back, where lines have space: change() fills it and leaves
  // it 0.
  struct Turned {
    std::vector<std::uint8_t> in_plane, in_rows;  // per x, per (y, x)
  };
  struct Chord {
    float from, to;
    std::int32_t next;  // next chord on the same line
  };
  // Chords of balls on the lines of one axis: outside_together() fills it for one axis after the other.
  struct Chords {
    std::vector<Chord> all;
    std::vector<std::int32_t> first;            // per line; −1 but while it looks
    std::vector<std::array<int, 2>> lines_met;  // that have some
  };
  // Inputs of the steps: prepare() writes them.
  struct Prepared {
    float overlap_weight = -1;
    Vec3f center{};
    float reach = -1;
  };
  struct Extent {
    std::uint16_t begin = 0, end = 0;
    bool operator==(const Extent&) const = default;
  };
  // Zeros that cost nothing before they are read: around slender bodies most lines are never read, and their steps
  // would be hundreds of megabytes.
  class ZeroSteps {
   public:
    ZeroSteps() = default;
    explicit ZeroSteps(std::size_t count);
    GridStep* get() const { return steps_; }
    GridStep& operator[](std::size_t i) const { return steps_[i]; }

   private:
    struct Free {
      void operator()(void* memory) const { std::free(memory); }
    };
    std::unique_ptr<void, Free> memory_;
    GridStep* steps_ = nullptr;
  };
  struct Axis {
    std::unique_ptr<OutsideCell[]> outside;  // line (u, v) is [(v · nu + u) · n …), n cells
    ZeroSteps steps;
    std::vector<std::uint8_t> traced;  // per line: outside is known
    std::vector<Extent> current;       // per line: where steps are up to date
  };
  // mutant tolerance-not-in-the-grid: `radius - tolerance_` -> `radius`
  float reduced(float radius) const { return std::max(0.0F, radius - tolerance_); }
  void change(const Spheref& ball, int by);
  void trace(std::size_t axis, int u, int v, std::size_t line);
  template <class Visit>
  void each_row(std::size_t axis, const Vec3f& center, float radius, const Visit& visit) const;
  template <class Visit>
  void each_line(std::size_t axis, const Vec3f& center, float radius, const Visit& visit) const;

  const ObjectLines& lines_;
  Place place_;
  float tolerance_;  // in cells
  std::array<int, 3> count_{};
  std::array<std::size_t, 3> step_{};     // steps of balls_over_
  std::vector<std::uint8_t> balls_over_;  // per cell, x fastest
  std::vector<std::uint8_t> full_along_;  // per cell: bit k where the line of axis k is known to leave no space
  std::array<Axis, 3> axes_;
  Prepared prepared_;
  // Scratch.
  Turned turned_;
  Chords chords_;
};

}  // namespace morula::detail
