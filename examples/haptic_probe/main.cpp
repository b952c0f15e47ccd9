// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two threads: a solver of springs on tetrahedra at 25 Hz, and a haptic probe at 1 kHz on the surface of these
// tetrahedra. The device point goes through the organ, deep and in jumps; the proxy stays on its side. At the end, each
// step is compared with all facets. docs/how-to/haptics.md says more.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <morula/morula.hpp>
#include <numbers>
#include <set>
#include <stdexcept>
#include <thread>

using morula::Vec3;
using Clock = std::chrono::steady_clock;

constexpr int haptic_steps = 1000, steps_per_frame = 40;  // 1 s at 1 kHz; 25 Hz
constexpr double radius = 0.05, stiffness = 300;          // of the ball that touches

// A bar of cubes, each cut into six tetrahedra around a diagonal, held at one end and moved at the other.
class Solver {
 public:
  static constexpr std::uint32_t nx = 24, ny = 6, nz = 6;
  static constexpr double cell = 0.1;

  Solver() {
    for (std::uint32_t z = 0; z <= nz; ++z)
      for (std::uint32_t y = 0; y <= ny; ++y)
        for (std::uint32_t x = 0; x <= nx; ++x) points.emplace_back(cell * x, cell * y, cell * z);
    for (std::uint32_t z = 0; z < nz; ++z)
      for (std::uint32_t y = 0; y < ny; ++y)
        for (std::uint32_t x = 0; x < nx; ++x) cut_cube({x, y, z});
    rest = points;
    velocities.assign(points.size(), {});
    std::set<std::array<std::uint32_t, 2>> edges;
    for (const morula::Tetrahedron& t : tetrahedra)
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) edges.insert({std::min(t[i], t[j]), std::max(t[i], t[j])});
    for (const auto& [a, b] : edges) springs.push_back({a, b, distance(points[a], points[b])});
  }

  // Explicit steps of a twentieth of a frame. The result depends on the number of frames alone.
  void advance_frame() {
    constexpr int substeps = 20;
    constexpr double h = 0.04 / substeps, strength = 4000, damping = 4;
    for (int k = 0; k < substeps; ++k) {
      std::vector<Vec3> forces(points.size());
      for (const Spring& spring : springs) {
        const Vec3 along = points[spring.b] - points[spring.a];
        const Vec3 force = strength * (1 - spring.length / length(along)) * along;
        forces[spring.a] += force, forces[spring.b] -= force;
      }
      time += h;
      for (std::size_t v = 0; v < points.size(); ++v) {
        velocities[v] += h * (forces[v] - damping * velocities[v]);
        points[v] += h * velocities[v];
        if (rest[v].x == 0) points[v] = rest[v], velocities[v] = {};
        if (rest[v].x > cell * (nx - 0.5)) points[v] = rest[v] + driven(time), velocities[v] = {};
      }
    }
  }

  std::vector<Vec3> points;
  std::vector<morula::Tetrahedron> tetrahedra;

 private:
  struct Spring {
    std::uint32_t a, b;
    double length;
  };
  static Vec3 driven(double t) {
    const double angle = 2 * std::numbers::pi * t;
    return {-0.15 * (1 - std::cos(angle)), 0.2 * std::sin(0.7 * angle), 0.35 * std::sin(angle)};
  }
  static std::uint32_t number(const std::array<std::uint32_t, 3>& p) {
    return (p[2] * (ny + 1) + p[1]) * (nx + 1) + p[0];
  }
  void cut_cube(const std::array<std::uint32_t, 3>& corner) {
    std::array<std::size_t, 3> axes{0, 1, 2};
    do {  // a tetrahedron for each path along the three axes
      std::array<std::uint32_t, 3> at = corner;
      morula::Tetrahedron made{number(at)};
      for (std::size_t k = 0; k < 3; ++k) ++at[axes[k]], made[k + 1] = number(at);
      tetrahedra.push_back(made);
    } while (std::next_permutation(axes.begin(), axes.end()));
  }

  std::vector<Vec3> rest, velocities;
  std::vector<Spring> springs;
  double time = 0;
};

// One state of the organ for the haptic thread: it owns all that queries read.
struct Organ {
  Organ(const morula::Mesh& surface, const morula::Body& first)
      : positions(surface.positions), body(first), collider(surface, body) {
    if (!body.update(positions)) throw std::runtime_error("bad positions");  // until here it reads those of `first`
  }
  int frame = 0;
  std::vector<Vec3> positions;
  morula::Body body;
  morula::Collider collider;
};

// The device point: onto the bar, 0.3 deep into it and along it; every 300 steps it jumps to below the bar for a while.
Vec3 device_point(int step) {
  const double share = static_cast<double>(step) / haptic_steps;
  const double down = std::min(1.0, 5 * share);
  const bool jumps = step % 300 > 280;
  return {0.3 + 1.6 * share, 0.3 + 0.1 * std::sin(40 * share), jumps ? -1.0 : 0.9 - 0.6 * down};
}

struct Step {
  int frame;
  morula::HapticStep found;
  std::vector<Vec3> path;
  double microseconds;
  bool late;
};

bool crosses(const Vec3& p, const Vec3& q, const morula::Triangle& t) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    return dot(cross(b - a, c - a), d - a);
  };
  if (volume(t[0], t[1], t[2], p) * volume(t[0], t[1], t[2], q) > 0) return false;
  const double u = volume(p, q, t[0], t[1]), v = volume(p, q, t[1], t[2]), w = volume(p, q, t[2], t[0]);
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

// Compares a step with all facets: the proxy is outside, the ball free, and no facet was in its way.
const char* fault_of(const Step& step, const std::vector<morula::Facet>& facets, const std::vector<Vec3>& positions) {
  if (!step.found.status) return "rejected";
  if (step.found.jammed) return "jammed";
  double squared = 1e300, angle = 0;
  for (const morula::Facet& f : facets) {
    const morula::Triangle t{positions[f[0]], positions[f[1]], positions[f[2]]};
    squared = std::min(squared, closest_point(t, step.found.proxy).squared_distance);
    angle += morula::solid_angle(t, step.found.proxy);
    for (std::size_t k = 2; k < step.path.size(); ++k)
      if (crosses(step.path[k - 1], step.path[k], t)) return "the proxy went through a facet";
  }
  if (angle > 2 * std::numbers::pi) return "the proxy is inside";
  return squared < radius * radius ? "the ball is in the surface" : nullptr;
}

std::vector<Step> run_haptics(morula::Snapshots<Organ>& organs) {
  std::vector<Step> steps;
  steps.reserve(haptic_steps);
  morula::HapticProbe probe({.radius = radius, .stiffness = stiffness, .smooth_normals = true, .friction = 0.1});
  const auto begin = Clock::now();
  for (int k = 0; k < haptic_steps; ++k) {
    const auto due = begin + std::chrono::milliseconds(k);
    std::this_thread::sleep_until(due);
    organs.refresh();
    const Organ& organ = organs.front();
    const auto start = Clock::now();
    const morula::HapticStep found = probe.step(organ.collider, device_point(k));
    const auto end = Clock::now();
    steps.push_back({organ.frame,
                     found,
                     {probe.path().begin(), probe.path().end()},
                     std::chrono::duration<double, std::micro>(end - start).count(),
                     end > due + std::chrono::milliseconds(1)});
  }
  return steps;
}

int main() {
  Solver solver;
  const morula::UsedVertices surface = morula::solid_surface(solver.points, solver.tetrahedra);
  const morula::Body first(surface.mesh, morula::build(surface.mesh, {.method = morula::Method::grid, .depth = 3}));
  morula::Snapshots<Organ> organs(surface.mesh, first);
  std::vector<std::vector<Vec3>> frames{surface.mesh.positions};  // for the comparison at the end; the solver's
  std::printf("%zu tetrahedra, %zu facets, %zu spheres\n", solver.tetrahedra.size(), surface.mesh.facet_count(),
              first.spheres().size());

  bool is_good = true;
  std::thread solving([&] {
    const auto begin = Clock::now();
    for (int frame = 1; frame < haptic_steps / steps_per_frame; ++frame) {
      solver.advance_frame();
      Organ& next = organs.back();
      next.frame = frame;
      for (std::size_t v = 0; v < next.positions.size(); ++v) next.positions[v] = solver.points[surface.index[v]];
      if (!next.body.update(next.positions)) is_good = false;
      organs.publish();
      frames.push_back(next.positions);
      std::this_thread::sleep_until(begin + frame * std::chrono::milliseconds(steps_per_frame));
    }
  });
  const std::vector<Step> steps = run_haptics(organs);
  solving.join();

  int faults = is_good ? 0 : 1, touching = 0, late = 0, unsettled = 0;
  double deepest = 0, strongest = 0;
  std::vector<double> times;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const Step& step = steps[k];
    const auto& positions = frames[static_cast<std::size_t>(step.frame)];
    if (const char* fault = fault_of(step, surface.mesh.facets, positions))
      std::printf("step %zu, frame %d: %s\n", k, step.frame, fault), ++faults;
    touching += step.found.touches, late += step.late, unsettled += !step.found.settled;
    deepest = std::max(deepest, distance(step.found.proxy, device_point(static_cast<int>(k))));
    strongest = std::max(strongest, length(step.found.force));
    times.push_back(step.microseconds);
  }
  if (2 * touching < haptic_steps) std::printf("it hardly touched\n"), ++faults;
  std::sort(times.begin(), times.end());
  std::printf("%d steps on %d frames, %d touching, %d not settled; %d late by more than 1 ms\n", haptic_steps,
              steps.back().frame, touching, unsettled, late);
  std::printf("device point at most %.3f from the proxy, force at most %.1f; the proxy outside in all steps: %s\n",
              deepest, strongest, faults == 0 ? "yes" : "no");
  std::printf("a step took %.1f us in the median, %.1f us at 99 %%, at most %.1f us\n", times[times.size() / 2],
              times[times.size() * 99 / 100], times.back());
  return faults == 0 ? 0 : 1;
}
