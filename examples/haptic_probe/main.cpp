// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A probe at 1 kHz on a limb that bends and twists: signed distance every step, a penalty force with damping.
// docs/how-to/responses.md says more.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <morula/morula.hpp>
#include <numbers>

using morula::Vec3;

constexpr double step_seconds = 0.001;
constexpr int steps = 3000, steps_per_frame = 16;  // the limb's simulation runs at some 60 Hz

// Where the hand holds the device: down into the limb, along it, and out again.
Vec3 hand(double share) {
  const double down = std::min({1.0, 5 * share, 5 * (1 - share)});
  return {-1.2 + 2.0 * share, 0.0, 1.2 - 1.3 * down};
}

// The ball that the hand pulls by a spring, as haptic devices do; it is what touches.
struct Ball {
  static constexpr double radius = 0.15, mass = 0.05, pull = 200, pull_damping = 6;
  Vec3 center = hand(0), velocity;

  void step(const Vec3& target, const Vec3& contact_force) {
    const Vec3 force = pull * (target - center) - pull_damping * velocity + contact_force;
    velocity += step_seconds / mass * force;
    center += step_seconds * velocity;
  }
};

// Pushes, never pulls: stiffness times depth, and damping against the surface's own velocity.
Vec3 penalty(const morula::Probe& probe, const Vec3& relative_velocity) {
  constexpr double stiffness = 2000, damping = 10;
  if (!probe.touches) return {};
  return std::max(0.0, stiffness * probe.depth - damping * dot(relative_velocity, probe.normal)) * probe.normal;
}

// The same answer from all facets of the limb as it is now?
bool agrees(const morula::Probe& probe, const morula::Mesh& limb, const Vec3& center) {
  double squared_distance = std::numeric_limits<double>::infinity(), solid_angle = 0;
  for (std::size_t facet = 0; facet < limb.facet_count(); ++facet) {
    const morula::Triangle corners = limb.corners(facet);
    squared_distance = std::min(squared_distance, closest_point(corners, center).squared_distance);
    solid_angle += morula::solid_angle(corners, center);
  }
  const double distance = std::sqrt(squared_distance);
  const bool inside = solid_angle > 2 * std::numbers::pi;  // of 4π: half a turn of the winding number
  return std::abs(std::abs(probe.distance) - distance) < 1e-9 && probe.inside == inside;
}

double largest_move(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  double squared = 0;
  for (std::size_t v = 0; v < from.size(); ++v) squared = std::max(squared, squared_distance(from[v], to[v]));
  return std::sqrt(squared);
}

int main() {
  const morula::Mesh mesh = morula::sample_body("limb");
  morula::Body body(mesh, morula::build(mesh, {.method = morula::Method::grid, .depth = 3}));
  morula::Collider limb(mesh, body);
  morula::InsideQuery inside(limb);
  morula::Mesh now = mesh;                   // the limb of this frame
  std::vector<Vec3> before = now.positions;  // and of the last one

  Ball ball;
  morula::Probe probe;
  std::vector<double> microseconds;
  double deepest = 0, strongest = 0, nearest = 0;  // nearest: a bound of the center's distance, where it is now
  int touching = 0, checked = 0, faults = 0;
  const auto fault = [&](int step, const char* what) { std::printf("step %d: %s\n", step, what), ++faults; };
  std::printf("%zu facets, %zu spheres\n%8s %8s %8s %8s\n", mesh.facet_count(), body.spheres().size(), "ms", "distance",
              "depth", "force");

  for (int step = 0; step < steps; ++step) {
    if (step % steps_per_frame == 0) {
      const double t = 0.5 - 0.5 * std::cos(4 * 3.14159265358979 * step / steps);  // out and back, twice
      before = std::move(now.positions);
      now.positions = morula::deform(mesh, {morula::Bend{35}, morula::Twist{60}}, t);
      if (!body.update(now.positions)) return 1;
      // The center was farther from the surface than any point of it has moved: none has passed through it.
      if (step > 0 && largest_move(before, now.positions) >= nearest) fault(step, "the surface came too fast");
    }

    const auto start = std::chrono::steady_clock::now();
    probe = inside.probe({ball.center, Ball::radius});
    microseconds.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    if (!probe.status) return 1;

    Vec3 surface_velocity;
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t v = mesh.facets[probe.nearest.facet][corner];
      surface_velocity += probe.nearest.barycentric[corner] * (now.positions[v] - before[v]);
    }
    surface_velocity *= 1 / (steps_per_frame * step_seconds);
    const Vec3 force = penalty(probe, ball.velocity - surface_velocity);

    // No tunneling: the center is outside, and on its way nothing was in between.
    if (probe.inside) fault(step, "the probe's center is inside");
    const Vec3 last = ball.center;
    ball.step(hand((step + 1.0) / steps), force);
    nearest = probe.distance - distance(last, ball.center);
    const morula::RayHit hit = first_hit(limb, {last, ball.center - last, 1});
    if (!hit.status || hit.first) fault(step, "the probe went through the surface");
    if (step % 20 == 0 && ++checked && !agrees(probe, now, last)) fault(step, "another answer than brute force");

    touching += probe.touches;
    deepest = std::max(deepest, probe.depth);
    strongest = std::max(strongest, length(force));
    if (step % 250 == 0)
      std::printf("%8d %8.4f %8.4f %8.2f\n", step, probe.distance, std::max(0.0, probe.depth), length(force));
  }
  if (touching < steps / 2) fault(steps, "the probe hardly touched");

  std::sort(microseconds.begin(), microseconds.end());
  std::printf("touching in %d of %d steps; at most %.4f deep, of a radius of %.2f; at most a force of %.1f\n", touching,
              steps, deepest, Ball::radius, strongest);
  std::printf("%d answers the same as brute force's; a query took %.1f us in the median, %.1f us at 99 %%\n", checked,
              microseconds[steps / 2], microseconds[steps * 99 / 100]);
  return faults == 0 ? 0 : 1;
}
