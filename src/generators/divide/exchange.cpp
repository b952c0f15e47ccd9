// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/exchange.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>

#include "generators/fit/compass_search.hpp"
#include "generators/fit/extremes.hpp"
#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/free_space.hpp"
#include "geometry/each_bit.hpp"
#include "tree/vertex_memo.hpp"

namespace morula::detail {
namespace {

// Whether the corners are inside with the rounding margin of a sphere that is fitted to them. The proof of the cover
// computes corners in another order, which moves them by roundings of their coordinates; if a body is far away, these
// are more than any share of the radius. The share excludes corners on the sphere itself, which its own region has.
bool contains(const Sphere& sphere, std::span<const Vec3> corners, double pad) {
  constexpr double share = 1e-9;
  const double farthest = farthest_distance(sphere.center, corners);
  return farthest <= sphere.radius * (1 - share) &&
         // mutant exchange-room-of-coordinates: `rounded_up_radius ... ))) <= sphere.radius` -> `(pad > 0 || true)`
         rounded_up_radius(farthest, std::max(pad, max_norm(sphere.center))) <= sphere.radius;
}

// The center of least outside volume about the points: a compass search from their middle or, if that is better, from
// `start`. radius: of the ball about the middle.
Vec3f best_center(const FreeSpace& space, const GroupPoints& points, const Vec3f& start, float radius) {
  // On a tube a center that is 2 % of a radius off the axis costs more than the rest of a thin slab's outside volume.
  constexpr float first_step = 0.06F, last_step = 0.005F;
  // The smaller of two balls without free space is better.
  constexpr float whole_volume_share = 1e-4F;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  struct Trial {
    Vec3f center;
    float cost;
  };
  const auto evaluate = [&](const Vec3f& center, float enough) {
    const float r = farthest_from(points, center);
    const float extra = whole_volume_share * r * r * r;
    return Trial{center, space.is_inside(center, r) ? space.cost(center, r, enough - extra) + extra : infinity};
  };
  Trial best = evaluate({0, 0, 0}, infinity);
  if (const Trial other = evaluate(start, best.cost); other.cost < best.cost) best = other;
  return compass_search(best, radius, first_step, last_step, evaluate).center;
}

// Whether the power of `other` can be less than that of `own` somewhere in the box: their difference is affine.
bool may_have_less_power(const Sphere& other, const Sphere& own, const Box& box) {
  const Vec3 middle = box.center(), half = 0.5 * box.extent(), slope = 2.0 * (own.center - other.center);
  const double at_middle = power(other, middle) - power(own, middle);
  const double least = at_middle - std::abs(slope.x) * half.x - std::abs(slope.y) * half.y - std::abs(slope.z) * half.z;
  const double rounding = 1e-9 * (squared_distance(other.center, middle) + other.radius * other.radius +
                                  squared_distance(own.center, middle) + own.radius * own.radius);
  return least <= rounding;
}

// The parts that one node gives to each receiver, itself included. Most polygons go unchanged: gifts name them instead
// of copies.
struct Gifts {
  struct Gift {
    std::uint32_t polygon;  // index in the node's region; higher numbers index the cut parts
    std::uint32_t to;
  };
  std::vector<Gift> gifts;
  Region parts;
  void add_polygon(std::uint32_t owner, std::size_t polygon) {
    gifts.push_back({static_cast<std::uint32_t>(polygon), owner});
  }
  void add_part(std::uint32_t owner, const Region& region, std::size_t of_polygon, std::span<const Barycentric> part) {
    add_polygon(owner, region.size() + parts.size());
    parts.add(region.facet[of_polygon], part);
  }
  // Calls visit(receiver, region, polygon of that region).
  template <class Visit>
  void each(const Region& region, const Visit& visit) const {
    for (const auto& [polygon, to] : gifts) {
      const bool is_part = polygon >= region.size();
      visit(to, is_part ? parts : region, is_part ? polygon - region.size() : polygon);
    }
  }
};

// Spheres that may take something from another.
class NearBalls {
 public:
  // facets: estimated number of queried facets.
  NearBalls(std::span<const std::uint32_t> near, std::span<const Sphere> spheres, const Sphere& own, std::size_t facets)
      : own_(own), at_vertices_(facets) {
    // Padding of the last register has more power than any ball.
    const std::size_t count = (near.size() + ball_columns_step - 1) / ball_columns_step * ball_columns_step;
    for (std::vector<double>* column : {&x_, &y_, &z_}) column->resize(count, 0);
    square_.resize(count, -std::numeric_limits<double>::infinity());
    bits_.resize((count + 63) / 64);
    for (std::size_t n = 0; n < near.size(); ++n) {
      const Sphere& s = spheres[near[n]];
      x_[n] = s.center.x, y_[n] = s.center.y, z_[n] = s.center.z, square_[n] = s.radius * s.radius;
    }
  }

  // One bit for each ball with less power than `own` at one of a facet's vertices: differences of powers are affine, so
  // no other ball has less at any of its points. Each vertex is computed once for most of its facets.
  std::span<const std::uint64_t> with_less_power(const MeshView& mesh, std::uint32_t facet) {
    if (bits_.size() > most_words) return at_points(mesh.corners(facet));
    Words all{};
    for (const std::uint32_t v : mesh.facets[facet]) {
      const Words& at_vertex = at_vertices_.of(v, [&] {
        Words words{};
        const Vec3 vertex = mesh.positions[v];
        const auto at_one = at_points({&vertex, 1});
        std::copy(at_one.begin(), at_one.end(), words.begin());
        return words;
      });
      for (std::size_t word = 0; word < most_words; ++word) all[word] |= at_vertex[word];
    }
    std::copy_n(all.begin(), bits_.size(), bits_.begin());
    return bits_;
  }

 private:
  static constexpr std::size_t most_words = 4;
  using Words = std::array<std::uint64_t, most_words>;

  std::span<const std::uint64_t> at_points(std::span<const Vec3> points) {
    powers_.clear();
    for (const Vec3& p : points) powers_.push_back({p.x, p.y, p.z, power(own_, p)});
    fit_kernels().with_less_power({x_.data(), y_.data(), z_.data(), square_.data(), x_.size()},
                                  reinterpret_cast<const double(*)[4]>(powers_.data()), powers_.size(), bits_.data());
    return bits_;
  }

  Sphere own_;
  std::vector<double> x_, y_, z_, square_;
  std::vector<std::array<double, 4>> powers_;
  std::vector<std::uint64_t> bits_;
  VertexMemo<Words> at_vertices_;
};

class Exchange {
 public:
  Exchange(const FitInput& input, std::vector<BuildNode>& nodes)
      : mesh_(input.mesh), lines_(input.lines), nodes_(nodes), pad_(input.pad), boxes_(nodes.size()) {}

  void visit(Workers& workers) {
    workers.run(nodes_.size(), [&](std::size_t i) {
      std::vector<Vec3> corners;
      corner_positions(mesh_, nodes_[i].region, corners);
      boxes_[i] = box_of(corners);
    });
  }

  // Needs the boxes that look() or refit() has left.
  void trade(Workers& workers) {
    std::vector<Sphere> spheres;
    for (const BuildNode& node : nodes_) spheres.push_back(node.sphere);
    std::vector<Gifts> gifts(spheres.size());
    workers.run(spheres.size(), [&](std::size_t s) { gifts[s] = give(static_cast<std::uint32_t>(s), spheres); });
    transfer(gifts);
  }

  void refit(Workers& workers) {
    std::vector<Sphere> fitted(nodes_.size());
    workers.run(nodes_.size(), [&](std::size_t i) {
      std::vector<Vec3> corners;
      corner_positions(mesh_, nodes_[i].region, corners);
      fitted[i] = fit(i, corners);
      boxes_[i] = box_of(corners);
    });
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].sphere = fitted[i];
  }

 private:
  // On fine meshes regions are a large part of a build's memory, so they get exactly the room that they need, and given
  // parts are freed at once.
  void transfer(std::vector<Gifts>& gifts) {
    std::vector<std::size_t> polygons(nodes_.size(), 0), cut_corners(nodes_.size(), 0);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      gifts[i].each(nodes_[i].region, [&](std::uint32_t to, const Region& from, std::size_t k) {
        ++polygons[to];
        cut_corners[to] += from.cut_corner_count(k);
      });
    std::vector<Region> before(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) std::swap(before[i], nodes_[i].region);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      gifts[i].each(before[i], [&](std::uint32_t to, const Region& from, std::size_t k) {
        Region& region = nodes_[to].region;
        if (region.empty()) region.reserve(polygons[to], cut_corners[to]);
        region.add(from, k);
      });
      before[i] = {};
      gifts[i] = {};
    }
  }

  Gifts give(std::uint32_t from, std::span<const Sphere> spheres) const {
    Gifts gifts;
    const BuildNode& own = nodes_[from];
    const Box& box = boxes_[from];
    std::vector<Vec3> corners;
    std::vector<std::uint32_t> near, allowed;
    for (std::uint32_t j = 0; j < spheres.size(); ++j)
      if (j != from && may_have_less_power(spheres[j], spheres[from], box)) near.push_back(j);
    NearBalls balls(near, spheres, spheres[from], own.region.size());
    gifts.gifts.reserve(own.region.size() + own.region.size() / 8);
    CutFacet cut;
    for (std::size_t k = 0; k < own.region.size(); ++k) {
      const std::uint32_t facet = own.region.facet[k];
      const auto polygon = own.region.polygon(k);
      const auto with_less_power = balls.with_less_power(mesh_, facet);
      if (std::none_of(with_less_power.begin(), with_less_power.end(), [](std::uint64_t word) { return word != 0; })) {
        gifts.add_polygon(from, k);
        continue;
      }
      const FacetGeometry geometry = facet_geometry(mesh_, facet);
      corners.clear();
      for (const Barycentric& b : polygon) corners.push_back(at_barycentric(geometry.corners, b));
      allowed.assign(1, from);
      each_bit(with_less_power, [&](std::size_t n) {
        const BuildNode& other = nodes_[near[n]];
        const bool has_less_power = std::any_of(corners.begin(), corners.end(), [&](const Vec3& p) {
          return power(spheres[near[n]], p) < power(spheres[from], p);
        });
        if (!has_less_power) return;
        if (other.parent == own.parent || std::all_of(other.ancestors.begin(), other.ancestors.end(),
                                                      [&](const Sphere& a) { return contains(a, corners, pad_); }))
          allowed.push_back(near[n]);
      });
      std::sort(allowed.begin(), allowed.end());
      if (allowed.size() == 1) {
        gifts.add_polygon(from, k);
        continue;
      }
      cut.clear();
      cut_by_power(geometry, polygon, spheres, allowed, cut);
      const bool whole = std::all_of(cut.owner.begin(), cut.owner.end(), [&](std::uint32_t o) { return o == from; });
      if (whole) {
        gifts.add_polygon(from, k);
        continue;
      }
      for (std::size_t part = 0; part < cut.size(); ++part) {
        corners.clear();
        for (const Barycentric& b : cut.polygon(part)) corners.push_back(at_barycentric(geometry.corners, b));
        const std::uint32_t to = cut.owner[part];
        gifts.add_part(to != from && contains(spheres[to], corners, pad_) ? to : from, own.region, k,
                       cut.polygon(part));
      }
    }
    // A node that becomes empty is lost for the level: a node that would give everything keeps everything.
    const auto is_own = [&](const Gifts::Gift& gift) { return gift.to == from; };
    if (std::any_of(gifts.gifts.begin(), gifts.gifts.end(), is_own)) return gifts;
    gifts = {};
    for (std::size_t k = 0; k < own.region.size(); ++k) gifts.add_polygon(from, k);
    return gifts;
  }

  static Box box_of(std::span<const Vec3> points) {
    Box box;
    for (const Vec3& p : points) box.add(p);
    return box;
  }

  Sphere fit(std::size_t i, std::span<const Vec3> corners) const {
    const BuildNode& node = nodes_[i];
    const double radius = farthest_distance(node.sphere.center, corners);
    if (!(radius > 0)) return node.sphere;
    // Nodes of a level overlap, on a tube by nearly all of their space: only the space of one node alone counts.
    constexpr double room = 1.3, lines_per_radius = 4;
    const Sphere around{node.sphere.center, room * radius};
    std::vector<Sphere> others;
    for (std::size_t j = 0; j < nodes_.size(); ++j) {
      const Sphere& other = nodes_[j].sphere;
      if (j != i && distance(other.center, around.center) < other.radius + around.radius) others.push_back(other);
    }
    const FreeSpace space(lines_, around, radius / lines_per_radius, std::move(others));
    const Vec3f smallest = space.to_cells(enclosing_sphere(corners).center);
    const auto in_cells = static_cast<float>(radius / space.cell());
    const Vec3 center = space.from_cells(best_center(
        space, extremes(some_corner_positions(mesh_, node.region, most_candidates), space), smallest, in_cells));
    return {center, rounded_up_radius(farthest_distance(center, corners), std::max(pad_, max_norm(center)))};
  }

  MeshView mesh_;
  const ObjectLines& lines_;
  std::vector<BuildNode>& nodes_;
  double pad_;
  std::vector<Box> boxes_;  // boxes of regions
};

}  // namespace

void exchange(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers) {
  Exchange level(input, nodes);
  level.visit(workers);
  for (int round = 0; round < rounds; ++round) {
    level.trade(workers);
    level.refit(workers);
  }
}

void settle(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers) {
  Exchange level(input, nodes);
  for (int round = 0; round < rounds; ++round) level.refit(workers);
}

}  // namespace morula::detail
