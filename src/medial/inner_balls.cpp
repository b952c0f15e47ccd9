// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/medial/medial_balls.hpp>

#include "medial/shrunken_balls.hpp"
#include "parallel/interruption.hpp"

namespace morula {

namespace {

// The points of a lattice over the box of some balls, with a flag of the points in chosen balls.
class FilledLattice {
 public:
  explicit FilledLattice(std::span<const Sphere> balls) {
    constexpr int points = 40;  // lattice points along the longest side: the gain of a ball is measured by them
    for (const Sphere& ball : balls) {
      box_.add(ball.center - Vec3{ball.radius, ball.radius, ball.radius});
      box_.add(ball.center + Vec3{ball.radius, ball.radius, ball.radius});
    }
    edge_ = box_.extent()[box_.longest_axis()] / points;
    if (!tells_balls_apart()) return;
    for (int axis = 0; axis < 3; ++axis)
      sides_[static_cast<std::size_t>(axis)] =
          std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(box_.extent()[axis] / edge_)));
    filled_.resize(sides_[0] * sides_[1] * sides_[2], 0);
  }

  // False for balls that are no larger than the rounding of coordinates, or not finite: these have no lattice.
  bool tells_balls_apart() const { return edge_ > 0 && std::isfinite(edge_); }
  // Points in the ball that no chosen one contains.
  std::size_t gain(const Sphere& ball) const {
    std::size_t points = 0;
    each_point(ball, [&](std::size_t point) { points += filled_[point] == 0 ? 1 : 0; });
    return points;
  }
  void fill(const Sphere& ball) {
    each_point(ball, [&](std::size_t point) { filled_[point] = 1; });
  }

 private:
  template <class Visit>
  void each_point(const Sphere& ball, const Visit& visit) const {
    std::array<std::size_t, 3> begin{}, end{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<std::size_t>(axis);
      const double low = (ball.center[axis] - ball.radius - box_.lower[axis]) / edge_ - 0.5;
      const double high = (ball.center[axis] + ball.radius - box_.lower[axis]) / edge_ + 0.5;
      begin[a] = static_cast<std::size_t>(std::max(0.0, std::floor(low)));
      end[a] = std::min(sides_[a], static_cast<std::size_t>(std::max(0.0, std::ceil(high))));
    }
    const double square = ball.radius * ball.radius;
    for (std::size_t i = begin[0]; i < end[0]; ++i)
      for (std::size_t j = begin[1]; j < end[1]; ++j)
        for (std::size_t k = begin[2]; k < end[2]; ++k) {
          const Vec3 p = box_.lower + edge_ * Vec3{static_cast<double>(i) + 0.5, static_cast<double>(j) + 0.5,
                                                   static_cast<double>(k) + 0.5};
          if (squared_distance(p, ball.center) <= square) visit((i * sides_[1] + j) * sides_[2] + k);
        }
  }

  Box box_;
  double edge_;
  std::array<std::size_t, 3> sides_{};
  std::vector<char> filled_;
};

}  // namespace

std::vector<Sphere> inner_ball_candidates(const MeshView& mesh, const SignedDistance& object,
                                          const InnerBallOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  if (!object.has_volume()) return {};
  std::vector<Vec3> points, normals;
  for (const SurfacePoint& sample : sample_surface(mesh, options.candidates, options.seed)) {
    points.push_back(sample.point);
    normals.push_back(object.orientation() * normalized(area_vector(mesh.corners(sample.facet))));
  }
  std::vector<Sphere> balls;
  detail::InterruptPoller poll_interrupt(16);
  for (Sphere ball : detail::shrunken_balls(object, points, normals, detail::BallSharing::none, workers)) {
    poll_interrupt();
    ball.radius -= options.margin;
    if (options.max_radius) ball.radius = std::min(ball.radius, *options.max_radius);
    if (!(ball.radius > 0 && ball.radius >= options.min_radius)) continue;
    // The distance to the surface is exact. Its sign may err where a surface passes through itself; the number of times
    // that a closed surface winds round a point away from it is a whole one.
    if (object.orientation() * object.bvh().winding_number(ball.center) > 0.5) balls.push_back(ball);
  }
  return balls;
}

std::vector<Sphere> fullest_balls(std::span<const Sphere> balls, std::size_t count, const StopToken& stop) {
  if (balls.empty()) return {};
  FilledLattice lattice(balls);
  if (!lattice.tells_balls_apart()) {
    if (count == 0) return {};
    return {*std::max_element(balls.begin(), balls.end(),
                              [](const Sphere& a, const Sphere& b) { return a.radius < b.radius; })};
  }
  std::vector<std::size_t> gains(balls.size());
  detail::InterruptPoller poll_interrupt(16);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    poll_interrupt();
    gains[i] = lattice.gain(balls[i]);
  }
  // Gains only fall, so an older gain is a bound: the heap's top is computed again until it stays.
  std::vector<std::size_t> heap(balls.size());
  for (std::size_t i = 0; i < heap.size(); ++i) heap[i] = i;
  const auto later = [&](std::size_t a, std::size_t b) {
    if (gains[a] != gains[b]) return gains[a] < gains[b];
    // Among equals the larger ball, then the first.
    return balls[a].radius != balls[b].radius ? balls[a].radius < balls[b].radius : a > b;
  };
  std::make_heap(heap.begin(), heap.end(), later);
  std::vector<Sphere> chosen;
  while (!heap.empty() && chosen.size() < count && !stop.stop_requested()) {
    poll_interrupt();
    std::pop_heap(heap.begin(), heap.end(), later);
    const std::size_t i = heap.back();
    const std::size_t now = lattice.gain(balls[i]);
    if (now != gains[i]) {
      gains[i] = now;
      std::push_heap(heap.begin(), heap.end(), later);
      continue;
    }
    heap.pop_back();
    // No gain is left; but a body too thin for the lattice still gets its largest ball.
    if (now == 0 && !chosen.empty()) break;
    chosen.push_back(balls[i]);
    lattice.fill(balls[i]);
  }
  return chosen;
}

}  // namespace morula
