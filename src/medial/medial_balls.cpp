// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/scale.hpp>
#include <morula/medial/medial_balls.hpp>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "medial/shrunken_balls.hpp"
#include "medial/voronoi_balls.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t leaf_size = 8;

// A k-d tree of the centers, without nodes: a range's middle element divides it, and axes follow from boxes on the
// way.
class CenterTree {
 public:
  explicit CenterTree(const std::vector<Sphere>& balls) : balls_(balls), order_(balls.size()), axis_(balls.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    divide(0, order_.size());
  }

  using Found = std::pair<double, std::uint32_t>;  // squared distance, ball
  // The nearest `count` of other balls, nearest first.
  void nearest(std::uint32_t ball, std::size_t count, std::vector<Found>& found) const {
    found.clear();
    search(0, order_.size(), ball, count, found);
  }

 private:
  void divide(std::size_t begin, std::size_t end) {
    if (end - begin <= leaf_size) return;
    Box box;
    for (std::size_t i = begin; i < end; ++i) box.add(balls_[order_[i]].center);
    const int axis = box.longest_axis();
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const double x = balls_[a].center[axis], y = balls_[b].center[axis];
      return x < y || (x == y && a < b);
    });
    axis_[middle] = axis;
    divide(begin, middle);
    divide(middle + 1, end);
  }

  void consider(std::uint32_t other, std::uint32_t ball, std::size_t count, std::vector<Found>& found) const {
    if (other == ball) return;
    const Found candidate{squared_distance(balls_[ball].center, balls_[other].center), other};
    if (found.size() == count) {
      if (!(candidate < found.back())) return;
      found.pop_back();
    }
    found.insert(std::upper_bound(found.begin(), found.end(), candidate), candidate);
  }

  void search(std::size_t begin, std::size_t end, std::uint32_t ball, std::size_t count,
              std::vector<Found>& found) const {
    if (end - begin <= leaf_size) {
      for (std::size_t i = begin; i < end; ++i) consider(order_[i], ball, count, found);
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const int axis = axis_[middle];
    const double off = balls_[ball].center[axis] - balls_[order_[middle]].center[axis];
    const auto left = [&] { search(begin, middle, ball, count, found); };
    const auto right = [&] { search(middle + 1, end, ball, count, found); };
    off < 0 ? left() : right();
    consider(order_[middle], ball, count, found);
    // A center that is exactly as far may have a lower index.
    if (found.size() == count && off * off > found.back().first) return;
    off < 0 ? right() : left();
  }

  const std::vector<Sphere>& balls_;
  std::vector<std::uint32_t> order_;
  std::vector<int> axis_;  // axis of the division at the middle of a range
};

// Fills neighbor_begin and neighbors from pairs of balls, given in one direction or both and any number of times.
// Each ball's neighbors come in ascending order.
void set_neighbors(MedialBalls& medial, std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs) {
  const std::size_t given = pairs.size();
  for (std::size_t i = 0; i < given; ++i) pairs.emplace_back(pairs[i].second, pairs[i].first);
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  medial.neighbor_begin.assign(medial.balls.size() + 1, 0);
  medial.neighbors.clear();
  for (const auto& [from, to] : pairs) {
    ++medial.neighbor_begin[from + 1];
    medial.neighbors.push_back(to);
  }
  std::partial_sum(medial.neighbor_begin.begin(), medial.neighbor_begin.end(), medial.neighbor_begin.begin());
}

// Neighbors are balls that overlap, one of them among the `count` nearest centers of the other (ties: lower index).
// Same bits for any number of workers. Cost: O(n log n).
void connect_overlapping(MedialBalls& medial, std::size_t count, Workers& workers) {
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  const std::vector<Sphere>& balls = medial.balls;
  const CenterTree tree(balls);
  constexpr std::size_t grain = 256;
  std::vector<Pairs> parts((balls.size() + grain - 1) / grain);
  parallel_for(workers, balls.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<CenterTree::Found> found;
    for (std::size_t i = begin; i < end; ++i) {
      const auto ball = static_cast<std::uint32_t>(i);
      tree.nearest(ball, count, found);
      for (const auto& [squared, other] : found) {
        const double reach = balls[ball].radius + balls[other].radius;
        if (squared < reach * reach) parts[begin / grain].emplace_back(ball, other);
      }
    }
  });
  Pairs pairs;
  for (const Pairs& part : parts) pairs.insert(pairs.end(), part.begin(), part.end());
  set_neighbors(medial, std::move(pairs));
}

constexpr std::size_t neighbor_count = 8;

}  // namespace

MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            WorkersOrAll given) {
  Workers& workers = given;
  MedialBalls medial;
  medial.balls = shrunken_balls(shape, points, normals, BallSharing::none, workers);
  connect_overlapping(medial, neighbor_count, workers);
  return medial;
}

MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples) {
  const StandardFloats standard;
  Box box;
  for (const Vec3& sample : samples) {
    if (is_finite(sample)) box.add(sample);
  }
  if (!box.is_empty() && !(has_usable_scale({box.lower, 0}) && has_usable_scale({box.upper, 0})))
    throw std::invalid_argument("voronoi_balls: a sample has a number beyond 1e30");
  MedialBalls medial;
  if (box.is_empty()) return medial;
  VoronoiBalls voronoi(box, shape);
  voronoi.insert(samples);

  const std::vector<VoronoiBall>& all = voronoi.balls();
  const auto is_medial = [&](std::uint32_t slot) { return all[slot].alive && voronoi.side(slot) < 0; };
  std::vector<std::uint32_t> number(all.size(), no_ball);
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (!is_medial(slot)) continue;
    number[slot] = static_cast<std::uint32_t>(medial.balls.size());
    medial.balls.push_back(all[slot].ball);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (number[slot] == no_ball) continue;
    for (const std::uint32_t neighbor : all[slot].neighbors) {
      if (neighbor != no_ball && number[neighbor] != no_ball) pairs.emplace_back(number[slot], number[neighbor]);
    }
  }
  set_neighbors(medial, std::move(pairs));
  return medial;
}

}  // namespace morula
