// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/exchange.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>

#include "generators/fit/compass_search.hpp"
#include "generators/fit/extremes.hpp"
#include "generators/fit/fit_kernels.hpp"
#include "generators/fit/free_space.hpp"

namespace morula::detail {
namespace {

// Inside by more than the rounding of cut points.
bool contains(const Sphere& sphere, std::span<const Vec3> corners) {
  const double radius = sphere.radius * (1 - 1e-9);
  return std::all_of(corners.begin(), corners.end(),
                     [&](const Vec3& p) { return squared_distance(sphere.center, p) <= radius * radius; });
}

// Where the ball around the points takes in least of the space: a compass search from its middle or, where that is
// better, from `start`. radius: of the ball about the middle.
Vec3f best_center(const FreeSpace& space, const GroupPoints& points, const Vec3f& start, float radius) {
  // On a tube a centre that is 2 % of a radius off the axis costs more than all else that a thin slab takes in.
  constexpr float first_step = 0.06F, last_step = 0.005F;
  // Of two balls without free space the smaller is better.
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

// What one node gives to whom, itself included.
struct Given {
  std::uint32_t to;
  std::uint32_t facet;
  std::uint32_t corner_begin, corner_end;
};
struct Gifts {
  std::vector<Given> parts;
  std::vector<Barycentric> corners;
  void add(std::uint32_t to, std::uint32_t facet, std::span<const Barycentric> polygon) {
    const auto begin = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    parts.push_back({to, facet, begin, static_cast<std::uint32_t>(corners.size())});
  }
};

// Spheres that may take something from another.
class NearBalls {
 public:
  NearBalls(std::span<const std::uint32_t> near, std::span<const Sphere> spheres) {
    // Those that fill up the last register have more power than any.
    const std::size_t count = (near.size() + ball_columns_step - 1) / ball_columns_step * ball_columns_step;
    for (std::vector<double>* column : {&x_, &y_, &z_}) column->resize(count, 0);
    square_.resize(count, -std::numeric_limits<double>::infinity());
    bits_.resize((count + 63) / 64);
    for (std::size_t n = 0; n < near.size(); ++n) {
      const Sphere& s = spheres[near[n]];
      x_[n] = s.center.x, y_[n] = s.center.y, z_[n] = s.center.z, square_[n] = s.radius * s.radius;
    }
  }

  // Those with less power than `own` at one of the corners, in order.
  template <class Visit>
  void each_with_less_power(std::span<const Vec3> corners, const Sphere& own, const Visit& visit) {
    powers_.clear();
    for (const Vec3& p : corners) powers_.push_back({p.x, p.y, p.z, power(own, p)});
    fit_kernels().with_less_power({x_.data(), y_.data(), z_.data(), square_.data(), x_.size()},
                                  reinterpret_cast<const double(*)[4]>(powers_.data()), powers_.size(), bits_.data());
    for (std::size_t word = 0; word < bits_.size(); ++word)
      for (std::uint64_t left = bits_[word]; left != 0; left &= left - 1)
        visit(64 * word + static_cast<std::size_t>(std::countr_zero(left)));
  }

 private:
  std::vector<double> x_, y_, z_, square_;
  std::vector<std::array<double, 4>> powers_;
  std::vector<std::uint64_t> bits_;
};

class Exchange {
 public:
  Exchange(const FitInput& input, std::vector<BuildNode>& nodes)
      : mesh_(input.mesh), lines_(input.lines), nodes_(nodes), pad_(input.pad) {}

  void trade(Workers& workers) {
    std::vector<Sphere> spheres;
    for (const BuildNode& node : nodes_) spheres.push_back(node.sphere);
    std::vector<Gifts> gifts(spheres.size());
    workers.run(spheres.size(), [&](std::size_t s) { gifts[s] = give(static_cast<std::uint32_t>(s), spheres); });
    for (BuildNode& node : nodes_) node.region = {};
    for (const Gifts& g : gifts)
      for (const Given& part : g.parts)
        nodes_[part.to].region.add(
            part.facet, std::span(g.corners).subspan(part.corner_begin, part.corner_end - part.corner_begin));
  }

  void refit(Workers& workers) {
    std::vector<Sphere> fitted(nodes_.size());
    workers.run(nodes_.size(), [&](std::size_t i) { fitted[i] = fit(i); });
    for (std::size_t i = 0; i < nodes_.size(); ++i) nodes_[i].sphere = fitted[i];
  }

 private:
  Gifts give(std::uint32_t from, std::span<const Sphere> spheres) const {
    Gifts gifts;
    const BuildNode& own = nodes_[from];
    // Where another node's power is less than this one's, which is not positive, its sphere reaches: only spheres that
    // meet this one can take anything.
    std::vector<std::uint32_t> near, allowed;
    for (std::uint32_t j = 0; j < spheres.size(); ++j)
      if (j != from && distance(spheres[j].center, spheres[from].center) < spheres[j].radius + spheres[from].radius)
        near.push_back(j);
    NearBalls balls(near, spheres);
    std::vector<Vec3> corners;
    CutFacet cut;
    for (std::size_t k = 0; k < own.region.size(); ++k) {
      const std::uint32_t facet = own.region.facet[k];
      const FacetGeometry geometry = facet_geometry(mesh_, facet);
      const auto polygon = own.region.polygon(k);
      corners.clear();
      for (const Barycentric& b : polygon) corners.push_back(at_barycentric(geometry.corners, b));
      allowed.assign(1, from);
      balls.each_with_less_power(corners, spheres[from], [&](std::size_t n) {
        const BuildNode& other = nodes_[near[n]];
        if (other.parent == own.parent || std::all_of(other.ancestors.begin(), other.ancestors.end(),
                                                      [&](const Sphere& a) { return contains(a, corners); }))
          allowed.push_back(near[n]);
      });
      std::sort(allowed.begin(), allowed.end());
      if (allowed.size() == 1) {
        gifts.add(from, facet, polygon);
        continue;
      }
      cut.clear();
      cut_by_power(geometry, polygon, spheres, allowed, cut);
      const bool whole = std::all_of(cut.owner.begin(), cut.owner.end(), [&](std::uint32_t o) { return o == from; });
      if (whole) {
        gifts.add(from, facet, polygon);
        continue;
      }
      for (std::size_t piece = 0; piece < cut.size(); ++piece) {
        corners.clear();
        for (const Barycentric& b : cut.polygon(piece)) corners.push_back(at_barycentric(geometry.corners, b));
        const std::uint32_t to = cut.owner[piece];
        gifts.add(to != from && contains(spheres[to], corners) ? to : from, facet, cut.polygon(piece));
      }
    }
    // A place that is given up is lost for the level: who would give everything keeps everything.
    const bool keeps_some =
        std::any_of(gifts.parts.begin(), gifts.parts.end(), [&](const Given& g) { return g.to == from; });
    if (keeps_some) return gifts;
    Gifts all;
    for (std::size_t k = 0; k < own.region.size(); ++k) all.add(from, own.region.facet[k], own.region.polygon(k));
    return all;
  }

  Sphere fit(std::size_t i) const {
    const BuildNode& node = nodes_[i];
    std::vector<Vec3> corners;
    corner_positions(mesh_, node.region, corners);
    const double radius = farthest_distance(node.sphere.center, corners);
    if (!(radius > 0)) return node.sphere;
    // Nodes of a level overlap, on a tube by nearly all they have: what counts is the space that no other has.
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
    const Vec3 center = space.from_cells(best_center(space, extremes(corners, space), smallest, in_cells));
    return {center, rounded_up_radius(farthest_distance(center, corners), std::max(pad_, max_norm(center)))};
  }

  const Mesh& mesh_;
  const ObjectLines& lines_;
  std::vector<BuildNode>& nodes_;
  double pad_;
};

}  // namespace

void exchange(const FitInput& input, std::vector<BuildNode>& nodes, int rounds, Workers& workers) {
  Exchange level(input, nodes);
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
