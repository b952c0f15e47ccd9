// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The fit of one node's children: what every generator but octree ends in. Spheres are moved over samples of the node's
// region to where they take in least empty space together, then made exact.
#pragma once

#include <functional>
#include <memory>

#include "generators/driver/top_down.hpp"
#include "generators/fit/child_fit.hpp"

namespace morula::detail {

/// What the fits of a build share. Borrowed by them.
struct FitInput {
  MeshView mesh;
  const ObjectShape& shape;
  const ObjectLines& lines;
  double pad;  ///< largest coordinate, for rounding radii up
};
FitInput fit_input(const MeshView& mesh, const ObjectShape& shape, const ObjectLines& lines);
/// Cells along the longest side that ObjectLines needs for a build of this depth and branching.
int lattice_cells(const MeshView& mesh, const ObjectShape& shape, int branching, int depth);

/// Demand of a surface point for spheres of later levels; any unit.
using Demand = std::function<float(const Vec3&)>;

/// Samples of a node's region, evenly spread, for any number of fits.
struct RegionPoints {
  double width = 0;  ///< of one child's part of the region, mesh units
  Box box;           ///< of the region
  std::vector<Vec3> points;
};
/// most: children. spacing: of the samples, in widths of a child's part.
RegionPoints region_points(const FitInput& input, const BuildNode& node, std::size_t most, double spacing);

class NodeFit {
 public:
  struct Settings {
    double spacing = 0.1;         ///< of samples, in widths of a child's part of the region
    double cell = 0.2;            ///< narrowest grid cell, in the same
    double cells_per_radius = 4;  ///< of the mean ball, where that is wider
    /// Width of grid cells about balls on a tube, which are much wider than their slabs: lines of wider cells pass a
    /// slab by on both sides.
    struct SlabCell {
      double widest = 0;            ///< in widths of a part; 0: as for other balls
      double most_per_radius = 16;  ///< of the mean ball
    };
    SlabCell slab_cell{};
    float balance = 0;  ///< weight of demand that is shared out unevenly
    int exact_rounds = 3;
  };
  /// mean_radius: of the balls to come, mesh units; sets the width of the grid's cells.
  NodeFit(const FitInput& input, const BuildNode& node, const RegionPoints& samples, std::size_t most,
          double mean_radius, const Settings& settings, const Demand& demand = {});

  ChildFit& children() { return *children_; }
  OutsideGrid& grid() { return *grid_; }
  const GroupPoints& points() const { return points_; }
  /// Width of a child's part of the region, in cells.
  float child_width() const { return child_width_; }

  struct Exact {
    std::vector<Sphere> spheres;  // padded
    std::vector<Region> regions;  // none empty
    std::size_t leftover_patches = 0;
    double cost = 0;  // outside volume, and what balance adds; mesh units; 0 where none is wanted
  };
  /// The region divided exactly among the children's balls, each ball fitted again to what it owns; the best of some
  /// rounds. The children are left with that result. wants_cost: it will be compared with others.
  Exact exact(bool wants_cost = true) {
    return exact_from(children_->spheres(), settings_.exact_rounds, wants_cost, false);
  }
  /// Once, from other spheres, each also tried at the node's own center: what one ball does as well as many.
  Exact divided_anyway(std::vector<Sphere> spheres);

 private:
  Exact exact_from(std::vector<Sphere> spheres, int rounds, bool wants_cost, bool from_node_center);

  const FitInput& input_;
  const BuildNode& node_;
  Settings settings_;
  std::unique_ptr<OutsideGrid> grid_;
  GroupPoints points_;
  float child_width_;
  std::unique_ptr<ChildFit> children_;
};

double area_of(const MeshView& mesh, const Region& region);
Division division_of(NodeFit::Exact exact);

}  // namespace morula::detail
