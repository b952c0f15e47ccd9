// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Hubbard's generator [hubbard1996]: Voronoi balls inside the object carry the samples that form them; two are merged
// into the smallest ball around the samples of both, the cheapest pair first, until few enough are left.
//
// Departures: the balls are those of the node's own samples, so every level is as finely described as the first; the
// published generator has a single set for all. If a ball reaches the surface outside the node, points of that surface
// are added to keep it inside; the cheapest merge comes out of a heap instead of a search through all.

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <tuple>

#include "generators/reduce/ball_set.hpp"
#include "generators/reduce/reducers.hpp"
#include "geometry/enclosing/sphere_support.hpp"
#include "medial/voronoi_balls.hpp"

namespace morula::detail {
namespace {

struct Group {
  SampleSet samples;
  SupportedSphere smallest;  // around the samples
  Sphere ball;               // the Voronoi ball that it began with; the smallest of joined ones
  std::vector<std::uint32_t> neighbors;
  bool alive = true;
};

// Gathered samples, so that loops read them in whole registers.
class Gathered {
 public:
  static constexpr std::size_t most = 512;
  void clear() { count_ = 0; }
  void add(const Vec3& point, const Vec3& normal) {
    const std::array<double, 6> numbers{point.x, point.y, point.z, normal.x, normal.y, normal.z};
    for (std::size_t k = 0; k < 6; ++k) columns_[k * most + count_] = numbers[k];
    ++count_;
  }
  DoublePointColumns points() const { return columns(0); }
  DoublePointColumns normals() const { return columns(3); }

 private:
  DoublePointColumns columns(std::size_t first) const {
    const double* const x = columns_.data() + first * most;
    return {x, x + most, x + 2 * most, count_};
  }
  std::size_t count_ = 0;
  std::array<double, 6 * most> columns_;
};

class Hubbard {
 public:
  explicit Hubbard(const ReducerInput& node) : node_(node) {
    const std::size_t most = std::clamp<std::size_t>(20 * node.branching, 48, Gathered::most / 2);
    const std::size_t step = std::max<std::size_t>(1, node.samples.size() / most);  // takes less than 2 · most
    for (std::size_t k = 0; k < node.samples.size(); k += step) {
      points_.push_back(node.samples[k]);
      normals_.push_back(node.normals[k]);
    }
  }

  std::vector<Sphere> run() {
    collect();
    if (alive_ > node_.branching) {
      for (std::uint32_t a = 0; a < groups_.size(); ++a)
        for (const std::uint32_t b : groups_[a].neighbors)
          if (a < b) consider(a, b);
      for (std::uint32_t a = 0; a < groups_.size(); ++a)
        if (groups_[a].neighbors.empty()) consider_overlapping(a);
    }
    while (alive_ > node_.branching) {
      if (heap_.empty()) consider_all();
      const Entry top = heap_.top();
      heap_.pop();
      if (groups_[top.a].alive && groups_[top.b].alive) join(top.a, top.b);
    }
    Reduced result;
    for (const Group& g : groups_)
      if (g.alive) result.balls.push_back(g.ball), result.distances.push_back(node_.shape.distance()(g.ball.center));
    return equally_grown(result.balls, result.distances, node_.samples);
  }

 private:
  // Interior Voronoi balls of the points, with the points that form them.
  void collect() {
    const double reach = 2 * node_.sphere.radius;
    Box box;
    box.add(node_.sphere.center - Vec3{reach, reach, reach});
    box.add(node_.sphere.center + Vec3{reach, reach, reach});
    VoronoiBalls diagram(box, node_.shape.distance());
    diagram.insert(points_);
    // The diagram keeps some of the points, in order.
    std::vector<std::uint32_t> point_of = numbered(diagram.samples());
    diagram.insert(std::span<const Vec3>(guards(diagram, box)));
    point_of.resize(diagram.samples().size(), no_sample);

    std::vector<std::uint32_t> group_of(diagram.balls().size(), no_ball);
    for (std::uint32_t s = 0; s < diagram.balls().size(); ++s) {
      const VoronoiBall& b = diagram.balls()[s];
      if (!b.alive || !(diagram.side(s) < 0)) continue;
      Group group{SampleSet(points_.size()), {}, b.ball, {}};
      for (const std::uint32_t sample : b.samples)
        if (point_of[sample] != no_sample) group.samples.add(point_of[sample]);
      if (group.samples.empty()) continue;
      gather(group.samples);
      group.smallest = enclosing_sphere_from({}, gathered_.points());
      group_of[s] = static_cast<std::uint32_t>(groups_.size());
      groups_.push_back(std::move(group));
    }
    for (std::size_t s = 0; s < diagram.balls().size(); ++s) {
      if (group_of[s] == no_ball) continue;
      for (const std::uint32_t n : diagram.balls()[s].neighbors)
        if (n != no_ball && group_of[n] != no_ball) groups_[group_of[s]].neighbors.push_back(group_of[n]);
    }
    alive_ = groups_.size();
  }

  // Samples of the diagram are a subset of the points, both in the same order, moved by no more than the lattice's
  // rounding.
  std::vector<std::uint32_t> numbered(const std::vector<Vec3>& samples) const {
    std::vector<std::uint32_t> numbers;
    const double near = 1e-5 * node_.sphere.radius;
    std::uint32_t next = 0;
    for (const Vec3& s : samples) {
      while (next < points_.size() && squared_distance(points_[next], s) > near * near) ++next;
      if (next == points_.size()) break;
      numbers.push_back(next++);
    }
    numbers.resize(samples.size(), no_sample);
    return numbers;
  }

  // Closest surface points of the balls that stick out furthest.
  std::vector<Vec3> guards(const VoronoiBalls& diagram, const Box& box) const {
    std::vector<std::tuple<double, std::uint32_t, Vec3>> order;
    for (std::uint32_t s = 0; s < diagram.balls().size(); ++s) {
      const VoronoiBall& b = diagram.balls()[s];
      if (!b.alive || !(diagram.side(s) < 0)) continue;
      // If the surface is about as far as the samples, its exact distance is not needed.
      constexpr double rounding = 1e-9;
      const auto closest = diagram.closest_within(s, 0.9 * (1 + rounding) * b.ball.radius);
      if (closest && b.ball.radius + closest->distance > 0.1 * b.ball.radius)
        order.emplace_back(-(b.ball.radius + closest->distance), s, closest->point);
    }
    std::sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
      return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
    });
    const std::size_t most = points_.size() / 3;
    std::vector<Vec3> result;
    for (const auto& [negative, s, p] : order) {
      if (result.size() >= most) break;
      bool inside = true;
      for (int axis = 0; axis < 3; ++axis) inside = inside && p[axis] >= box.lower[axis] && p[axis] <= box.upper[axis];
      if (inside) result.push_back(p);
    }
    return result;
  }

  void gather(const SampleSet& samples) {
    gathered_.clear();
    samples.for_each([&](std::size_t k) { gathered_.add(points_[k], normals_[k]); });
  }
  // The smallest ball around the gathered samples of two groups; the search begins with that of the larger.
  SupportedSphere around_gathered(std::uint32_t a, std::uint32_t b) const {
    const SupportedSphere &one = groups_[a].smallest, &other = groups_[b].smallest;
    return enclosing_sphere_from(one.sphere.radius < other.sphere.radius ? other : one, gathered_.points());
  }

  // The cost of a pair: how far one of the samples, going along its normal, travels inside the ball around both.
  void consider(std::uint32_t a, std::uint32_t b) {
    both_ = groups_[a].samples;
    both_ |= groups_[b].samples;
    gather(both_);
    const Sphere ball = around_gathered(a, b).sphere;
    heap_.push(
        {fit_kernels().farthest_exit(gathered_.points(), gathered_.normals(), ball), std::min(a, b), std::max(a, b)});
  }
  void consider_overlapping(std::uint32_t a) {
    for (std::uint32_t b = 0; b < groups_.size(); ++b)
      if (b != a && groups_[b].alive &&
          distance(groups_[a].ball.center, groups_[b].ball.center) < groups_[a].ball.radius + groups_[b].ball.radius)
        consider(a, b);
  }
  void consider_all() {
    for (std::uint32_t a = 0; a < groups_.size(); ++a)
      for (std::uint32_t b = a + 1; b < groups_.size(); ++b)
        if (groups_[a].alive && groups_[b].alive) consider(a, b);
  }

  void join(std::uint32_t a, std::uint32_t b) {
    SampleSet both = std::move(groups_[a].samples);
    both |= groups_[b].samples;
    std::vector<std::uint32_t> neighbors = std::move(groups_[a].neighbors);
    neighbors.insert(neighbors.end(), groups_[b].neighbors.begin(), groups_[b].neighbors.end());
    std::sort(neighbors.begin(), neighbors.end());
    neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
    groups_[a].alive = groups_[b].alive = false;
    std::erase_if(neighbors, [&](std::uint32_t n) { return !groups_[n].alive; });
    const auto made = static_cast<std::uint32_t>(groups_.size());
    gather(both);
    const SupportedSphere smallest = around_gathered(a, b);
    groups_.push_back({std::move(both), smallest, smallest.sphere, std::move(neighbors)});
    --alive_;
    if (alive_ <= node_.branching) return;
    const std::vector<std::uint32_t>& besides = groups_[made].neighbors;
    for (const std::uint32_t n : besides) {
      groups_[n].neighbors.push_back(made);
      consider(n, made);
    }
    if (besides.empty()) consider_overlapping(made);
  }

  struct Entry {
    double cost;
    std::uint32_t a, b;
    bool operator<(const Entry& other) const { return std::tie(other.cost, other.a, other.b) < std::tie(cost, a, b); }
  };

  const ReducerInput& node_;
  std::vector<Vec3> points_, normals_;  // samples of the node and their normals; the diagram's number of them
  std::vector<Group> groups_;
  std::size_t alive_ = 0;
  std::priority_queue<Entry> heap_;
  Gathered gathered_;
  SampleSet both_;
};

}  // namespace

Proposals propose_hubbard(const ReducerInput& node) {
  if (node.samples.size() < 4 || !(node.sphere.radius > 0)) return {};
  std::vector<Sphere> spheres = Hubbard(node).run();
  if (spheres.empty()) return {};
  return {{"hubbard", std::move(spheres)}};
}

}  // namespace morula::detail
