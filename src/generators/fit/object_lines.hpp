// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Object lines: where lines along the axes enter and leave the object. Outside volumes are integrated from them.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

#include "generators/fit/object_shape.hpp"

namespace morula::detail {

/// A lattice of cubic cells over the object. Lines run through the cell centers along every axis; positions are in
/// cells, so that cell i of an axis spans [i, i + 1].
class ObjectLines {
 public:
  /// cells: along the longest side of the mesh's box, at least 8.
  /// The inside of a closed and oriented object has a non-zero winding number along each line. For other objects, a
  /// cell is inside when two of the three lines through its center say so, and lines enter and leave at cell walls.
  /// Cost: O(F + lines crossed).
  ObjectLines(const MeshView& mesh, const ObjectShape& shape, int cells, Workers& workers)
      : ObjectLines(mesh, shape.bounding_box(), shape.has_volume(), cells, workers) {}
  /// closed_and_oriented: as inspect() computes it. box: of the mesh.
  ObjectLines(const MeshView& mesh, const Box& box, bool closed_and_oriented, int cells, Workers& workers);

  struct Crossing {
    float at;
    std::uint32_t facet;
  };
  /// Crossings of the line along `axis` through cell (u, v) of the other axes in cyclic order: enter, leave, enter, …
  /// None outside the lattice.
  std::span<const Crossing> line(int axis, int u, int v) const {
    const int nu = count_[(axis + 1) % 3], nv = count_[(axis + 2) % 3];
    if (u < 0 || v < 0 || u >= nu || v >= nv) return {};
    const Axis& a = axes_[static_cast<std::size_t>(axis)];
    const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(nu) + static_cast<std::size_t>(u);
    return std::span(a.crossings).subspan(a.begin[i], a.begin[i + 1] - a.begin[i]);
  }
  /// Share of the space at a lattice cell that lines along `axis` measure: the square of that component of the normal
  /// of the surface near by, a third if there is none. The three sum to 1. Any cell, on the lattice or not.
  float weight(int axis, const std::array<int, 3>& cell) const {
    std::size_t i = 0;
    for (int k = 2; k >= 0; --k) {
      const auto n = static_cast<std::size_t>(k);
      const int at = cell[n] >= 0 ? cell[n] / block_ : -1;
      if (at < 0 || at >= block_count_[n]) return 1.0F / 3;
      i = i * static_cast<std::size_t>(block_count_[n]) + static_cast<std::size_t>(at);
    }
    return weights_[i][static_cast<std::size_t>(axis)];
  }

  /// The weights along one line, for walking it: cells of the lattice from 0 on share them by `block`.
  struct WeightsAlong {
    const std::array<float, 3>* first = nullptr;
    std::size_t step = 0;
    std::size_t axis = 0;
    int block = 1, blocks = 0;  // block: cells of a block; blocks: 0 for a line outside the lattice
    float operator[](int i) const {
      return i < 0 || i >= blocks ? 1.0F / 3 : first[static_cast<std::size_t>(i) * step][axis];
    }
  };
  WeightsAlong weights_along(int axis, int u, int v) const {
    const auto a = static_cast<std::size_t>(axis), ua = (a + 1) % 3, va = (a + 2) % 3;
    const std::array<std::size_t, 3> step{
        1, static_cast<std::size_t>(block_count_[0]),
        static_cast<std::size_t>(block_count_[0]) * static_cast<std::size_t>(block_count_[1])};
    WeightsAlong result{nullptr, step[a], a, block_, 0};
    if (u < 0 || v < 0 || u / block_ >= block_count_[ua] || v / block_ >= block_count_[va]) return result;
    result.first =
        &weights_[static_cast<std::size_t>(u / block_) * step[ua] + static_cast<std::size_t>(v / block_) * step[va]];
    result.blocks = block_count_[a];
    return result;
  }

  Vec3 to_lattice(const Vec3& p) const { return (p - origin_) * per_cell_; }
  Vec3 from_lattice(const Vec3& p) const { return origin_ + p * cell_; }
  double cell() const { return cell_; }
  /// A length by which the outside volumes that are integrated from these lines reduce every radius: spheres that have
  /// to cover only within a tolerance are written that much smaller. Mesh units, 0 or more; 0 until it is set.
  double tolerance() const { return tolerance_; }
  void set_tolerance(double tolerance) { tolerance_ = tolerance; }
  const std::array<int, 3>& count() const { return count_; }

 private:
  struct Axis {
    std::vector<std::uint32_t> begin;  // first index per line, and one more
    std::vector<Crossing> crossings;
  };
  Axis trace(const MeshView& mesh, const std::vector<Vec3>& vertices, int axis, bool reliable) const;
  void vote();
  void weigh(const MeshView& mesh, const std::vector<Vec3>& vertices);

  Vec3 origin_;
  double cell_, per_cell_, tolerance_ = 0;
  std::array<int, 3> count_;
  std::array<Axis, 3> axes_;
  int block_ = 1;  // lattice cells along a block of equal weights
  std::array<int, 3> block_count_{};
  std::vector<std::array<float, 3>> weights_;
};

}  // namespace morula::detail
