// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Octree [liu1988, hubbard1993]: a cube is halved on each axis, and cells that the surface enters become children. Each
// sphere is then the smallest around its cell's content; the circumspheres of the literature are larger.

#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>

#include "generators/driver/join.hpp"
#include "generators/driver/top_down.hpp"
#include "generators/fit/object_lines.hpp"
#include "generators/fit/partition.hpp"
#include "generators/methods.hpp"
#include "geometry/inspect_sides.hpp"

namespace morula::detail {
namespace {

// Axes nearly as long as the longest are halved, so that cells become cubes; a cube falls into eight.
constexpr double near_longest = 0.75;

std::vector<Box> sub_cells(const Box& cell) {
  const Vec3 extent = cell.extent();
  const double longest = extent[cell.longest_axis()];
  std::array<int, 3> count{};
  for (int axis = 0; axis < 3; ++axis) count[axis] = extent[axis] > near_longest * longest ? 2 : 1;
  std::vector<Box> cells;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x) {
        const std::array<int, 3> at{x, y, z};
        Box sub = cell;
        const Vec3 middle = cell.center();
        for (int axis = 0; axis < 3; ++axis)
          if (count[axis] == 2) (at[axis] == 0 ? sub.upper : sub.lower)[axis] = middle[axis];
        cells.push_back(sub);
      }
  return cells;
}

// Cells of one size in a lattice have equal circumspheres, and the power diagram of equal spheres is the lattice: the
// common partition cuts exactly along the cell walls. The sphere is a hair larger, so that rounding leaves no corner of
// a cell outside.
Sphere circumsphere(const Box& cell) {
  return {cell.center(), 0.5 * (1 + 1e-9) * cell.diagonal()};
}

class OctreeDivider {
 public:
  OctreeDivider(const MeshView& mesh, const BuildRun& run)
      : mesh_(mesh), branching_(static_cast<std::size_t>(run.branching)), pad_(run.largest_coordinate()) {}

  Division operator()(const BuildNode& node) const {
    std::vector<BuildNode> cells = occupied(node);
    // A cell whose content lies in one sub-cell is replaced by that one: chains of single children waste levels.
    constexpr int most_halvings = 60;
    for (int i = 0; i < most_halvings && cells.size() == 1; ++i) cells = occupied(cells[0]);
    // More children than eight allow: look one or two halvings deeper, then join close cells.
    for (int i = 0; i < 2 && cells.size() > 1 && 2 * cells.size() <= branching_; ++i) {
      std::vector<BuildNode> finer;
      for (const BuildNode& cell : cells)
        for (BuildNode& sub : occupied(cell)) finer.push_back(std::move(sub));
      cells = std::move(finer);
    }
    while (cells.size() > branching_) join_closest(cells);
    return {std::move(cells), 0};
  }

 private:
  BuildNode made(Region region, const Box& cell) const {
    std::vector<Vec3> points;
    corner_positions(mesh_, region, points);
    const Sphere smallest = enclosing_sphere(points);
    const double radius = rounded_up_radius(smallest.radius, std::max(pad_, max_norm(smallest.center)));
    return {std::move(region), {smallest.center, radius}, cell, {}, {}, {}, {}};
  }

  std::vector<BuildNode> occupied(const BuildNode& node) const {
    const std::vector<Box> cells = sub_cells(node.cell);
    std::vector<Sphere> spheres;
    for (const Box& cell : cells) spheres.push_back(circumsphere(cell));
    Partition parts = partition(mesh_, node.region, spheres);
    std::vector<BuildNode> children;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!parts.regions[i].empty()) children.push_back(made(std::move(parts.regions[i]), cells[i]));
    return children;
  }

  // Joins the two whose common sphere is smallest.
  void join_closest(std::vector<BuildNode>& cells) const {
    std::size_t first = 0, second = 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < cells.size(); ++i)
      for (std::size_t j = i + 1; j < cells.size(); ++j) {
        const double radius = common_radius(cells[i].sphere, cells[j].sphere);
        if (radius < least) least = radius, first = i, second = j;
      }
    BuildNode both = joined(cells[first], cells[second], {});
    cells[first] = made(std::move(both.region), both.cell);
    cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(second));
  }

  MeshView mesh_;
  std::size_t branching_;
  double pad_;
};

}  // namespace

CoveredTree build_octree(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  const Box& box = run.box();
  const double half = 0.5 * max_norm(box.extent());
  const Box cube{box.center() - Vec3{half, half, half}, box.center() + Vec3{half, half, half}};
  const OctreeDivider divide(mesh, run);
  if (is_worst_first(run)) return top_down(mesh, run, {.divide = divide, .root_cell = cube}, workers);
  // About four cells to the radius of a leaf, within the memory limit.
  double surface = 0, parts = 8;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) surface += area(mesh.corners(f));
  for (int level = 1; level < run.depth; ++level) parts = std::min(4096.0, 8 * parts);
  const double cell = 0.3 * std::sqrt(surface / parts);
  const int cells = cell > 0 ? static_cast<int>(std::clamp(max_norm(box.extent()) / cell, 64.0, 512.0)) : 64;
  const ObjectLines lines(mesh, box, inspect_sides(mesh, connectivity(mesh)).has_volume(), cells, workers);
  return top_down(mesh, run, {.divide = divide, .root_cell = cube, .lines = &lines}, workers);
}

}  // namespace morula::detail
