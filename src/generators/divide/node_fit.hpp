// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The fit of one node's children: the last step of every generator except octree. Spheres are moved over samples of the
// node's region until they cover least empty space together; then they are made exact.
#pragma once

#include <functional>
#include <memory>

#include "generators/driver/top_down.hpp"
#include "generators/fit/child_fit.hpp"

namespace morula::detail {

/// Inputs that the fits of a build share. Fits borrow them.
struct FitInput {
  MeshView mesh;
  const ObjectShape& shape;
  const ObjectLines& lines;
  double pad;  ///< largest |coordinate|, for rounding radii up
};
FitInput fit_input(const MeshView& mesh, const ObjectShape& shape, const ObjectLines& lines);
/// Cells along the longest side that ObjectLines needs for a build of this depth and branching.
int lattice_cells(const MeshView& mesh, const ObjectShape& shape, int branching, int depth);

/// Demand of a surface point for spheres of later levels; any unit.
using Demand = std::function<float(const Vec3&)>;

/// Samples of a node's region, evenly spread, for any number of fits.
struct RegionPoints {
  double width = 0;  ///< width of one child's part of the region, mesh units
  Box box;           ///< box of the region
  std::vector<Vec3> points;
};
/// most: greatest number of children. spacing: distance of samples, in widths of a child's part.
RegionPoints region_points(const FitInput& input, const BuildNode& node, std::size_t most, double spacing);

class NodeFit {
 public:
  struct Settings {
    double spacing = 0.1;         ///< distance of samples, in widths of a child's part of the region
    double cell = 0.2;            ///< width of the narrowest grid cell, in widths of a child's part
    double cells_per_radius = 4;  ///< cells per radius of the mean ball, if that cell is the wider one
    /// Width of grid cells about balls on a tube. Such balls are much wider than their slabs, and lines of wider cells
    /// miss a slab on both sides.
    struct SlabCell {
      double widest = 0;            ///< largest width, in widths of a part; 0: as for other balls
      double most_per_radius = 16;  ///< most cells per radius of the mean ball
    };
    SlabCell slab_cell{};
    float balance = 0;  ///< weight of unevenly shared demand
    int exact_rounds = 3;
  };
  /// mean_radius: estimate for the children's balls, mesh units; sets the width of the grid's cells.
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
    double cost = 0;  // outside volume, and the balance term; mesh units; 0 if no cost is requested
  };
  /// Divides the region exactly among the children's balls and fits each ball again to its own part; returns the best
  /// of a few rounds. The children keep that result. with_cost: the result will be compared with others.
  Exact exact(bool with_cost = true) {
    return exact_from(children_->spheres(), settings_.exact_rounds, with_cost, false);
  }
  /// Divides once, among other spheres, each of which is also tried at the node's own center: for nodes that one ball
  /// fits as well as many.
  Exact divided_anyway(std::vector<Sphere> spheres);

 private:
  Exact exact_from(std::vector<Sphere> spheres, int rounds, bool with_cost, bool from_node_center);

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
