// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/node_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>

#include "generators/fit/extremes.hpp"
#include "generators/fit/partition.hpp"
#include "tree/vertex_memo.hpp"

namespace morula::detail {
namespace {

// Margin about a region, in radii of its sphere: deep balls around shallow patches reach far.
constexpr double room = 1.5;
// One of two samples nearer to each other than this share of their spacing is enough.
constexpr double thinning = 0.7;

// One sample of each neighborhood: a set of cells, open addressing, insertion only.
class ThinnedPoints {
 public:
  ThinnedPoints(const Vec3& origin, double width, std::vector<Vec3>& points)
      : origin_(origin), per_cell_(1 / width), points_(points), keys_(1024, 0) {}

  void add(const Vec3& p) {
    const auto cell = [&](double v) { return static_cast<std::uint64_t>(std::clamp(v * per_cell_, 0.0, 2097151.0)); };
    const Vec3 q = p - origin_;
    // Never 0, which marks a free slot.
    if (insert((cell(q.x) << 42 | cell(q.y) << 21 | cell(q.z)) + 1)) points_.push_back(p);
  }

 private:
  bool insert(std::uint64_t key) {
    if (2 * count_ >= keys_.size()) grow();
    std::uint64_t& slot = find(key);
    if (slot == key) return false;
    slot = key;
    ++count_;
    return true;
  }
  std::uint64_t& find(std::uint64_t key) {
    std::size_t i = Random(key).next() & (keys_.size() - 1);
    while (keys_[i] != 0 && keys_[i] != key) i = (i + 1) & (keys_.size() - 1);
    return keys_[i];
  }
  void grow() {
    std::vector<std::uint64_t> old(2 * keys_.size(), 0);
    old.swap(keys_);
    for (const std::uint64_t key : old)
      if (key != 0) find(key) = key;
  }

  Vec3 origin_;
  double per_cell_;
  std::vector<Vec3>& points_;
  std::vector<std::uint64_t> keys_;
  std::size_t count_ = 0;
};

// Corners of every patch and a triangular lattice on it.
void sample(const MeshView& mesh, const Region& region, double spacing, ThinnedPoints& points) {
  constexpr int most_steps = 200;
  const double short_enough = 0.99 * spacing * spacing;
  SeenVertices seen(region.size());
  std::vector<Vec3> of_polygon;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const Triangle whole = mesh.corners(region.facet[k]);
    std::span<const Vec3> corners = whole;
    if (region.is_whole(k)) {
      for (std::size_t c = 0; c < 3; ++c)
        if (seen.is_new(mesh.facets[region.facet[k]][c])) points.add(whole[c]);
    } else {
      of_polygon.clear();
      each_corner(mesh, region, k, [&](const Vec3& p) { of_polygon.push_back(p); });
      for (const Vec3& p : of_polygon) points.add(p);
      corners = of_polygon;
    }
    const Vec3 a = corners[0];
    for (std::size_t c = 2; c < corners.size(); ++c) {
      const Vec3 p = corners[c - 1], q = corners[c];
      const double squared = std::max({squared_distance(a, p), squared_distance(p, q), squared_distance(q, a)});
      if (squared < short_enough) continue;  // n is 1
      const double longest = std::sqrt(squared);
      const int n = static_cast<int>(std::min<double>(most_steps, std::ceil(longest / spacing)));
      for (int i = 0; n > 1 && i <= n; ++i)
        for (int j = 0; j <= n - i; ++j) {
          const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
          points.add(a * (1 - u - v) + p * u + q * v);
        }
    }
  }
}

}  // namespace

FitInput fit_input(const MeshView& mesh, const ObjectShape& shape, const ObjectLines& lines) {
  return {mesh, shape, lines, largest_coordinate(shape.bounding_box())};
}

int lattice_cells(const MeshView& mesh, const ObjectShape& shape, int branching, int depth) {
  double surface = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) surface += area(mesh.corners(f));
  // Deeper levels than this share the finest lattice: memory allows no finer one.
  constexpr double most_parts = 4096, fewest = 64, most = 512;
  double parts = branching;
  for (int level = 1; level < depth; ++level) parts = std::min(most_parts, parts * branching);
  const double cell = NodeFit::Settings{}.cell * std::sqrt(surface / parts);
  const double longest = max_norm(shape.bounding_box().extent());
  return static_cast<int>(cell > 0 ? std::clamp(longest / cell, fewest, most) : fewest);
}

double area_of(const MeshView& mesh, const Region& region) {
  double total = 0;
  for (std::size_t k = 0; k < region.size(); ++k) total = area_with(total, mesh, region, k);
  return total;
}

RegionPoints region_points(const FitInput& input, const BuildNode& node, std::size_t most, double spacing) {
  // Regions without area, or next to none compared with their sphere, still have a length. Spheres that cover a slender
  // region have diameters that add up to its length, so half of that per child is no loss; parts as narrow as the area
  // alone suggests would need millions of cells.
  const double least_width = std::max(0.02, 1 / static_cast<double>(most)) * node.sphere.radius;
  RegionPoints result;
  result.width = std::max(least_width, std::sqrt(area_of(input.mesh, node.region) / static_cast<double>(most)));
  const Vec3& c = node.sphere.center;
  const double r = node.sphere.radius;
  ThinnedPoints thinned(c - Vec3{r, r, r}, thinning * spacing * result.width, result.points);
  sample(input.mesh, node.region, spacing * result.width, thinned);
  for (const Vec3& p : result.points) result.box.add(p);
  return result;
}

NodeFit::NodeFit(const FitInput& input, const BuildNode& node, const RegionPoints& samples, std::size_t most,
                 double mean_radius, const Settings& settings, const Demand& demand)
    : input_(input), node_(node), settings_(settings) {
  Box box = samples.box;
  const double margin = room * node.sphere.radius;
  box.lower = box.lower - Vec3{margin, margin, margin};
  box.upper = box.upper + Vec3{margin, margin, margin};
  // The children's parts and the future balls limit the width; on thin bodies balls are narrower than parts, on tubes
  // they are wider.
  constexpr double most_cells = 160;
  double of_balls = mean_radius / settings.cells_per_radius, of_parts = settings.cell;
  if (settings.slab_cell.widest > 0) {
    const double widest = settings.slab_cell.widest * samples.width;
    of_balls = std::min(of_balls, std::max(widest, mean_radius / settings.slab_cell.most_per_radius));
    of_parts = std::min(of_parts, settings.slab_cell.widest);
  }
  const double cell = std::max(of_parts * samples.width, of_balls);

  grid_ = std::make_unique<OutsideGrid>(input.lines, box, std::max(cell, max_norm(box.extent()) / most_cells));
  child_width_ = static_cast<float>(samples.width / grid_->cell());
  for (const Vec3& p : samples.points) points_.push_back(grid_->to_grid(p));
  if (settings.balance > 0 && demand) {
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      points_.demand.push_back(demand(grid_->from_grid(points_[i])));
      sum += static_cast<double>(points_.demand.back());
    }
    for (float& d : points_.demand) d = static_cast<float>(d / sum);
  }
  ChildFit::Settings child_settings;
  child_settings.child_width = child_width_;
  child_settings.balance = settings.balance;
  children_ = std::make_unique<ChildFit>(*grid_, points_, input.shape, most, node.sphere, child_settings, node.seed);
}

NodeFit::Exact NodeFit::divided_anyway(std::vector<Sphere> spheres) {
  return exact_from(std::move(spheres), 1, true, true);
}

NodeFit::Exact NodeFit::exact_from(std::vector<Sphere> spheres, int rounds, bool with_cost, bool from_node_center) {
  Exact best;
  best.cost = std::numeric_limits<double>::infinity();
  std::vector<Vec3> corners;
  for (int round = 0; round < rounds; ++round) {
    Partition divided = partition(input_.mesh, node_.region, spheres);
    Exact now;
    now.leftover_patches = divided.leftover_patches;
    std::vector<GroupBall> balls;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      if (divided.regions[i].empty()) continue;
      corner_positions(input_.mesh, divided.regions[i], corners);
      // The smallest ball is the best one about a thin slab of a tube, and the search finds its center only roughly.
      const std::array<Vec3f, 3> starts{grid_->to_grid(spheres[i].center),
                                        grid_->to_grid(enclosing_sphere(corners).center),
                                        grid_->to_grid(node_.sphere.center)};
      const GroupBall fitted =
          children_->fit_to(extremes(some_corner_positions(input_.mesh, divided.regions[i], most_candidates), *grid_),
                            std::span(starts).first(from_node_center ? 3 : 2));
      const Vec3 center = grid_->from_grid(fitted.center);
      const double radius = farthest_distance(center, corners);
      balls.push_back({grid_->to_grid(center), static_cast<float>(radius / grid_->cell()), 0});
      now.spheres.push_back({center, rounded_up_radius(radius, std::max(input_.pad, max_norm(center)))});
      now.regions.push_back(std::move(divided.regions[i]));
    }
    children_->start_from_grid(balls);
    if (rounds > 1 || with_cost) now.cost = children_->objective() * grid_->cell_volume();
    spheres = now.spheres;
    if (now.cost < best.cost || round == 0) best = std::move(now);
  }
  return best;
}

Division division_of(NodeFit::Exact exact) {
  Division division;
  division.leftover_patches = exact.leftover_patches;
  for (std::size_t i = 0; i < exact.spheres.size(); ++i) {
    BuildNode child;
    child.region = std::move(exact.regions[i]);
    child.sphere = exact.spheres[i];
    division.children.push_back(std::move(child));
  }
  return division;
}

}  // namespace morula::detail
