// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/sampling.hpp>
#include <unordered_set>

#include <morula/medial/medial_balls.hpp>

#include "build/exchange.hpp"
#include "build/extremes.hpp"
#include "build/group.hpp"
#include "build/medial_seeds.hpp"
#include "build/partition.hpp"
#include "build/top_down.hpp"

namespace morula {
namespace {

double now_s() { return double(clock()) / CLOCKS_PER_SEC; }
double param(const char* name, double fallback) {
  const char* v = std::getenv(name);
  return v ? std::atof(v) : fallback;
}

double area_of(const Mesh& mesh, const Region& region) {
  double total = 0;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const Triangle t = mesh.corners(region.facet[k]);
    const auto polygon = region.polygon(k);
    const Vec3 first = at_barycentric(t, polygon[0]);
    for (std::size_t c = 2; c < polygon.size(); ++c)
      total += area({first, at_barycentric(t, polygon[c - 1]), at_barycentric(t, polygon[c])});
  }
  return total;
}

// Points of a region: a lattice on every patch and its corners, one of each neighbourhood.
class PointCollector {
 public:
  PointCollector(const OutsideGrid& grid, float thin, GroupPoints& points) : grid_(grid), per_cell_(1 / thin), points_(points) {}
  void add(const Vec3& p) {
    const Vec3f q = grid_.to_grid(p);
    const auto key = [&](float v) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v * per_cell_)) + (1 << 20)) & 0x1fffff; };
    if (seen_.insert(key(q.x) << 42 | key(q.y) << 21 | key(q.z)).second) points_.push_back(q);
  }

 private:
  const OutsideGrid& grid_;
  float per_cell_;
  GroupPoints& points_;
  std::unordered_set<std::uint64_t> seen_;
};

void collect(const Mesh& mesh, const Region& region, double spacing, PointCollector& collector) {
  for (std::size_t k = 0; k < region.size(); ++k) {
    const Triangle t = mesh.corners(region.facet[k]);
    const auto polygon = region.polygon(k);
    for (const Barycentric& b : polygon) collector.add(at_barycentric(t, b));
    const Vec3 a = at_barycentric(t, polygon[0]);
    for (std::size_t c = 2; c < polygon.size(); ++c) {
      const Vec3 p = at_barycentric(t, polygon[c - 1]), q = at_barycentric(t, polygon[c]);
      const double longest = std::sqrt(std::max({squared_distance(a, p), squared_distance(p, q), squared_distance(q, a)}));
      const int n = std::min(200, static_cast<int>(std::ceil(longest / spacing)));
      for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= n - i; ++j) {
          if (n <= 1) continue;
          const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
          collector.add(a * (1 - u - v) + p * u + q * v);
        }
    }
  }
}

class OwnDivider {
 public:
  OwnDivider(const Mesh& mesh, const BuildOptions& options, const SignedDistance& shape, const ObjectLines& lines, const MedialBalls* medial, const PowerDiagram* leaves=nullptr, const std::vector<float>* demands=nullptr)
      : medial_(medial), leaves_(leaves), demands_(demands), fast_(leaves==nullptr), depth_(options.depth), mesh_(mesh), branching_(static_cast<std::size_t>(options.branching)), pad_(largest_coordinate(mesh)), shape_(shape), lines_(lines) {}

  Division operator()(const BuildNode& node) const {
    const int starts = fast_ ? 1 : static_cast<int>(param(node.level == 0 ? "M_K1" : node.level == 1 ? "M_K2" : "M_K3", node.level == 0 ? 4 : 1));
    Division best;
    double least = std::numeric_limits<double>::infinity();
    Random seeds(node.seed);
    for (int k = 0; k < starts; ++k) {
      BuildNode copy = node;
      copy.seed = seeds.next();
      double cost = 0;
      Division d = divide(copy, cost);
      if (cost < least) least = cost, best = std::move(d);
    }
    return best;
  }
  Division divide(const BuildNode& node, double& cost) const {
    const double spacing = std::sqrt(area_of(mesh_, node.region) / static_cast<double>(branching_));
    if (!(spacing > 0)) return {};
    std::vector<Vec3> corners;
    corner_positions(mesh_, node.region, corners);
    Box box;
    for (const Vec3& p : corners) box.add(p);
    const double margin = param("M_MARGIN", 1.5) * node.sphere.radius;
    box.lower = box.lower - Vec3{margin, margin, margin};
    box.upper = box.upper + Vec3{margin, margin, margin};
    OutsideGrid coarse(lines_, box, param("M_CELL0", 0.35) * spacing);
    GroupPoints coarse_points;
    PointCollector collector(coarse, static_cast<float>(param("M_THIN", 0.07) * spacing / coarse.cell()), coarse_points);
    collect(mesh_, node.region, param("M_SPACING", 0.1) * spacing, collector);
    double mean_radius = 0;
    std::vector<Sphere> first;
    {
      Group split(coarse, coarse_points, shape_, branching_, node.sphere, {}, node.seed);
      split.split_from_one();
      split.sweep(0.6F, true);
      split.sweep(0.6F, true);
      first = split.spheres();
      for (const Sphere& sp : first) mean_radius += sp.radius / static_cast<double>(first.size());
    }
    const double wanted = std::max(param("M_CELL", 0.2) * spacing, mean_radius / param("M_RCELL", 4));
    OutsideGrid grid(lines_, box, wanted);
    GroupPoints points;
    for (std::size_t i = 0; i < coarse_points.size(); ++i) points.push_back(grid.to_grid(coarse.from_grid(coarse_points[i])));

    Group::Settings settings;
    settings.part = static_cast<float>(spacing / grid.cell());
    const bool balanced = leaves_ != nullptr && node.level + 1 < depth_;
    if (balanced) {
      settings.balance = static_cast<float>(param(node.level == 0 ? "M_BAL1" : "M_BAL2", node.level == 0 ? 2.5 : 2.0));
      double sum = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        points.demand.push_back((*demands_)[leaves_->owner(grid.from_grid(points[i]))]);
        sum += points.demand.back();
      }
      for (float& d : points.demand) d = static_cast<float>(d / sum);
    }
    static double acc[8]; double t0 = now_s(); const bool timing = param("M_TIME", 0) > 1;
    auto lap = [&](int i) { const double t = now_s(); acc[i] += t - t0; t0 = t; };
    Group group(grid, points, shape_, branching_, node.sphere, settings, node.seed);
    const auto tell=[&](const char* w){ if (param("M_PRINT",0)>1) { double o=group.objective(); double c=0; int n=0; for (const auto& b : group.balls()) c+=b.cost, n+=b.radius>0; std::fprintf(stderr,"  %s: U %.1f sum %.1f n %d\n",w,o,c,n);} };
    group.take(first); tell("split"); lap(0);
    const float splitting = 0.6F, later = 0.15F;
    group.sweep(splitting, true);
    for (int i = 0; i < static_cast<int>(param("M_SWEEPS", 4)); ++i) { group.sweep(later, true); tell("sweep"); }
    lap(1);
    if (!fast_ && param("M_SEEDS", 1) > 0) {
      GroupPoints few;
      const std::size_t stride = 1 + points.size() / static_cast<std::size_t>(param("M_SEEDPTS", 300));
      for (std::size_t i = 0; i < points.size(); i += stride) few.push_back(points[i]);
      const std::vector<GroupBall> candidates = medial_candidates(node, grid, few, static_cast<float>(spacing / grid.cell()));
      for (const Dilation d : {Dilation::length, Dilation::square}) {
        group.try_seeds(medial_seeds(candidates, few, branching_, d), static_cast<int>(param("M_SRIN", 2)), static_cast<int>(param("M_SSW", 2)));
        tell(d == Dilation::length ? "seeds length" : "seeds square");
      }
    }
    lap(2);
    if (!fast_ && param("M_RIN", 1) > 0) { group.try_inscribed(4, 6); tell("rin"); }
    lap(3);
    group.try_changes(static_cast<int>(fast_ ? 0 : param(node.level == 0 ? "M_T1" : node.level == 1 ? "M_T2" : "M_T3", 12))); tell("trials"); lap(4);
    if (!fast_ && param("M_RIN", 1) > 1) group.try_inscribed(4, 6);
    auto result = exact(node, grid, points, group, cost);
    lap(5);
    if (timing) std::fprintf(stderr, "split %.3f sweeps %.3f seeds %.3f rin %.3f trials %.3f exact %.3f\n", acc[0], acc[1], acc[2], acc[3], acc[4], acc[5]);
    return result;
  }

 private:
  // Medial balls that touch the region, in grid coordinates; an even choice of some when they are many.
  std::vector<GroupBall> medial_candidates(const BuildNode& node, const OutsideGrid& grid, const GroupPoints& points, float spacing) const {
    std::vector<GroupBall> found;
    for (const Sphere& ball : medial_->balls) {
      if (squared_distance(ball.center, node.sphere.center) > node.sphere.radius * node.sphere.radius) continue;
      const Vec3f c = grid.to_grid(ball.center);
      const float r = static_cast<float>(ball.radius / grid.cell());
      float nearest = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < points.size(); ++i) {
        const float dx = points.x[i] - c.x, dy = points.y[i] - c.y, dz = points.z[i] - c.z;
        nearest = std::min(nearest, dx * dx + dy * dy + dz * dz);
      }
      if (std::sqrt(nearest) < r + static_cast<float>(param("M_TOUCH", 0.25)) * spacing) found.push_back({c, r, 0});
    }
    const auto most = static_cast<std::size_t>(param("M_CAND", 300));
    if (found.size() <= most) return found;
    std::vector<GroupBall> some;
    for (std::size_t k = 0; k < most; ++k) some.push_back(found[k * found.size() / most]);
    return some;
  }

  Division exact(const BuildNode& node, OutsideGrid& grid, const GroupPoints& points, Group& group, double& cost) const {
    const double sampled = group.objective();
    std::vector<Sphere> spheres = group.spheres();
    Partition best;
    std::vector<Sphere> best_spheres;
    double least = std::numeric_limits<double>::infinity();
    double first = 0;
    const int rounds = static_cast<int>(fast_ ? 0 : param("M_EXACT", 3));
    std::vector<Vec3> corners;
    for (int round = 0; round <= rounds; ++round) {
      Partition divided = partition(mesh_, node.region, spheres);
      std::vector<Sphere> fitted;
      std::vector<GroupBall> balls;
      for (std::size_t i = 0; i < spheres.size(); ++i) {
        if (divided.regions[i].empty()) continue;
        corner_positions(mesh_, divided.regions[i], corners);
        Vec3 center = spheres[i].center;
        center = grid.from_grid(group.refit_to(extremes(corners, grid), grid.to_grid(center)).center);
        const Sphere s{center, farthest_distance(center, corners)};
        fitted.push_back(s);
        balls.push_back({grid.to_grid(s.center), static_cast<float>(s.radius / grid.cell()), 0});
        if (i != fitted.size() - 1) divided.regions[fitted.size() - 1] = std::move(divided.regions[i]);
      }
      divided.regions.resize(fitted.size());
      group.take_in_grid(balls);
      const double now = group.objective();
      if (round == 0) first = now;
      spheres = fitted;
      if (now < least) {
        least = now;
        best = std::move(divided);
        best_spheres = fitted;
      }
    }
    if (param("M_DEM", 0) > 0 && !fast_ && node.level == 2) {
      double total = 0;
      for (std::size_t i = 0; i < points.size(); ++i) total += (*demands_)[leaves_->owner(grid.from_grid(points[i]))];
      total *= area_of(mesh_, node.region) / static_cast<double>(points.size());
      std::fprintf(stderr, "DEM %g %g\n", total, std::sqrt(least * std::pow(grid.cell(), 3)));
    }
    if (param("M_SUM", 0) > 0 && !fast_) { static double acc[9][4]; const double c3 = std::pow(grid.cell(), 3); auto* q = acc[node.level]; q[0] += sampled * c3; q[1] += first * c3; q[2] += least * c3; q[3]++; std::fprintf(stderr, "LEVEL %d n %g sampled %g exact0 %g exact %g\n", node.level, q[3], q[0], q[1], q[2]); }
    if (param("M_PRINT", 0) > 0) std::fprintf(stderr, "sampled %g exact first %g best %g  n %zu points %zu\n", sampled, first, least * std::pow(grid.cell(), 3) * 1e9, best_spheres.size(), points.size());
    cost = least * std::pow(grid.cell(), 3);
    Division division;
    division.leftover_patches = best.leftover_patches;
    for (std::size_t i = 0; i < best_spheres.size(); ++i) {
      Sphere sphere = best_spheres[i];
      sphere.radius = rounded_up_radius(sphere.radius, std::max(pad_, largest_component(sphere.center)));
      division.children.push_back({std::move(best.regions[i]), sphere, {}, {}, {}, {}, {}});
    }
    return division;
  }

  const MedialBalls* medial_;
  const PowerDiagram* leaves_;
  const std::vector<float>* demands_;
  bool fast_;
  int depth_;
  const Mesh& mesh_;
  std::size_t branching_;
  double pad_;
  const SignedDistance& shape_;
  const ObjectLines& lines_;
};

}  // namespace

Built build_own(const Mesh& mesh, const BuildOptions& options, Workers& workers) {
  double t0 = now_s(); auto lap = [&](const char* w) { if (param("M_TIME", 0) > 0) std::fprintf(stderr, "   %s %.3f\n", w, now_s() - t0); t0 = now_s(); };
  const SignedDistance shape(mesh, workers);
  double total_area = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) total_area += area(mesh.corners(static_cast<std::uint32_t>(f)));
  const double finest = std::sqrt(total_area / std::min(4096.0, std::pow(options.branching, std::max(1, options.depth))));
  const double longest = largest_component(bounding_box(mesh).extent());
  const int cells = static_cast<int>(std::clamp(longest / std::max(1e-300, param("M_CELL", 0.2) * finest), 32.0, param("M_MAXCELLS", 512)));
  lap("distance");
  const ObjectLines lines(mesh, shape, cells, workers);
  lap("lines");
  std::vector<Vec3> from, normals;
  for (const SurfaceSample& sample : sample_surface(mesh, static_cast<std::size_t>(param("M_MEDIAL", 8000)), options.seed)) {
    const Triangle t = mesh.corners(sample.facet);
    from.push_back(sample.point);
    normals.push_back(normalized(cross(t[1] - t[0], t[2] - t[0])) * shape.orientation());
  }
  const MedialBalls medial = shrinking_balls(shape, from, normals, workers);
  lap("medial");
  Built pre = top_down(mesh, options, {}, OwnDivider(mesh, options, shape, lines, &medial), workers);
  if (param("M_FAST", 0) > 0) return pre;
  const std::vector<Sphere> leaves = level_set_spheres(pre.tree, pre.tree.level_count() - 1);
  const std::vector<std::uint32_t> leaf_nodes = level_set(pre.tree, pre.tree.level_count() - 1);
  std::vector<float> demands;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    // cost of the leaf, per unit of its area
    const Sphere& s = leaves[i];
    Box box;
    box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    OutsideGrid grid(lines, box, 0.3 * s.radius);
    const Vec3f c = grid.to_grid(s.center);
    const float r = static_cast<float>(s.radius / grid.cell());
    const double cost = grid.new_outside({c, r}) * std::pow(grid.cell(), 3);
    double leaf_area = 0;
    const auto node = leaf_nodes[i];
    for (std::uint32_t p = pre.cover.region_begin[node]; p < pre.cover.region_end[node]; ++p) {
      const auto patch = pre.cover.patch(p);
      const auto at = [&](std::uint32_t k) { return corner_position(pre.cover, patch[k], mesh.positions); };
      for (std::uint32_t k = 2; k < patch.size(); ++k) leaf_area += area({at(0), at(k - 1), at(k)});
    }
    demands.push_back(static_cast<float>(std::sqrt(std::max(cost, 1e-30)) / std::max(leaf_area, 1e-30)));
  }
  const PowerDiagram diagram(leaves);
  lap("pre");
  const LevelHook relax = [&](std::vector<BuildNode>& nodes) {
    if (nodes[0].level >= 2 && param("M_RELAX", 3) > 0) exchange(mesh, lines, nodes, static_cast<int>(param("M_RELAX", 3)), workers);
    lap("level");
  };
  return top_down(mesh, options, {}, OwnDivider(mesh, options, shape, lines, &medial, &diagram, &demands), workers, relax);
}

}  // namespace morula
