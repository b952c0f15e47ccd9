// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario haptic: steps of a haptic probe, and of a tool of 50 balls, that slide over a body at a depth, over the body
// at rest and over one that bends by a frame every 40 steps; compared with all facets.
#include <algorithm>
#include <cmath>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <numbers>
#include <scenes/brute_force.hpp>
#include <scenes/median.hpp>

#include "frames.hpp"

namespace morula::bench {
namespace {

constexpr int step_count = 1000, steps_per_frame = 40, checked_steps = 50;

/// The device points of a turn around the body: each is below the point of the surface that is nearest to a point of
/// an ellipse around the body.
std::vector<Vec3> device_points(const Collider& body, double radius) {
  const Sphere root = body.sphere_state().sphere(0);
  std::vector<Vec3> points;
  TouchQuery query;
  for (int k = 0; k < step_count; ++k) {
    const auto [sin, cos] = sin_cos(2 * std::numbers::pi * k / step_count);
    const Vec3 around = root.center + root.radius * Vec3{cos, 0.4 * sin, sin};
    const Touch& found = query.run(body, Sphere{around, 0}, {.nearest = true});
    require(found.status);
    const Vec3 nearest = found.deepest->point.point;
    points.push_back(nearest - (0.02 * root.radius + radius) * normalized(around - nearest));
  }
  return points;
}

struct ProbeRun {
  std::vector<HapticStep> steps;
  std::vector<double> seconds;
};

ProbeRun run_steps(const HapticOptions& options, Body& body, const Collider& collider, const std::vector<Frame>& frames,
                   const std::vector<Vec3>& devices) {
  ProbeRun run;
  HapticProbe probe(options);
  const Sphere root = collider.sphere_state().sphere(0);
  const Vec3 away = root.center + 3 * root.radius * normalized(devices.front() - root.center);
  require(probe.step(collider, away).status);
  for (int k = 0; k < step_count; ++k) {
    if (k % steps_per_frame == 0 && !frames.empty())
      require(body.update(frames[static_cast<std::size_t>(k / steps_per_frame) % frames.size()]));
    HapticStep step;
    run.seconds.push_back(seconds_of([&] { step = probe.step(collider, devices[static_cast<std::size_t>(k)]); }));
    require(step.status);
    run.steps.push_back(step);
  }
  return run;
}

/// Compares some steps with all facets, at the positions of their frames.
void check(const Mesh& mesh, const std::vector<Frame>& frames, const HapticOptions& options, const ProbeRun& run,
           Result& result) {
  const bool has_volume = inspect(mesh).has_volume();
  Mesh now = mesh;
  int inside = 0, near = 0;
  for (int k = 0; k < step_count; k += step_count / checked_steps) {
    if (!frames.empty()) {
      const Frame& frame = frames[static_cast<std::size_t>(k / steps_per_frame) % frames.size()];
      std::transform(frame.begin(), frame.end(), now.positions.begin(), [](const Vec3f& p) { return Vec3(p); });
    }
    const Vec3& proxy = run.steps[static_cast<std::size_t>(k)].proxy;
    inside += has_volume && brute_force::winding_number(now, proxy) > 0.5;
    near += distance(brute_force::closest_point(now, proxy).point, proxy) < options.radius;
  }
  result.expect(inside == 0, "a proxy is inside");
  result.expect(near == 0, "a facet is nearer to a proxy than its radius");
  result.expect(std::none_of(run.steps.begin(), run.steps.end(), [](const HapticStep& s) { return s.jammed; }),
                "a proxy is jammed");
}

Result haptic_result(const std::string& item, const Input& input, const CoveredTree& model,
                     const HapticOptions& options, const std::vector<Frame>& frames, const Settings& settings) {
  Result result{.scenario = "haptic", .item = item, .mesh = input.name};
  Body body(input.mesh, model);
  const Collider collider(input.mesh, body);
  const std::vector<Vec3> devices = device_points(collider, options.radius);
  ProbeRun run;
  bool is_same = true;
  timed(settings, [&] {
    require(body.update(input.mesh.positions));
    ProbeRun next = run_steps(options, body, collider, frames, devices);
    for (std::size_t k = 0; k < run.steps.size(); ++k) is_same = is_same && run.steps[k].proxy == next.steps[k].proxy;
    run = std::move(next);
    result.seconds.insert(result.seconds.end(), run.seconds.begin(), run.seconds.end());
  });
  result.expect(is_same, "another run has other proxies");
  check(input.mesh, frames, options, run, result);
  std::size_t touching = 0, settled = 0, moves = 0, spheres = 0, facets = 0;
  for (const HapticStep& step : run.steps) {
    touching += step.touches, settled += step.settled, moves += step.moves;
    spheres += step.sphere_tests, facets += step.facet_tests;
  }
  std::vector<double> sorted = result.seconds;
  std::sort(sorted.begin(), sorted.end());
  result.figures = {{"us/step", 1e6 * median(result.seconds)},
                    {"us at 99 %", 1e6 * sorted[sorted.size() * 99 / 100]},
                    {"touching", static_cast<double>(touching) / step_count},
                    {"settled", static_cast<double>(settled) / step_count},
                    {"moves/step", static_cast<double>(moves) / step_count},
                    {"sphere tests/step", static_cast<double>(spheres) / step_count},
                    {"facet tests/step", static_cast<double>(facets) / step_count}};
  return result;
}

/// A rod of 50 balls.
std::vector<Sphere> tool_balls(double size) {
  std::vector<Sphere> balls;
  for (int k = 0; k < 50; ++k)
    balls.push_back({{0.3 * size * (k / 49.0 - 0.5), 0.01 * size * (k % 2), 0.01 * size * (k / 2 % 2)}, 0.02 * size});
  return balls;
}

/// The rod turns as it goes around, at the device points of a ball.
RigidTransform tool_pose(const Vec3& at, int step) {
  return RigidTransform::from_axis({1, 2, 3}, 4 * std::numbers::pi * step / step_count, at);
}

/// Compares some poses with all facets, at the positions of their frames.
void check_tool(const Mesh& mesh, const std::vector<Frame>& frames, const std::vector<Sphere>& balls,
                const std::vector<RigidTransform>& proxies, Result& result) {
  Mesh now = mesh;
  const bool has_volume = inspect(now).has_volume();
  int inside = 0, near = 0;
  for (int k = 0; k < step_count; k += step_count / checked_steps) {
    if (!frames.empty()) {
      const Frame& frame = frames[static_cast<std::size_t>(k / steps_per_frame) % frames.size()];
      std::transform(frame.begin(), frame.end(), now.positions.begin(), [](const Vec3f& p) { return Vec3(p); });
    }
    for (std::size_t b = 0; b < balls.size(); b += 7) {
      const Vec3 at = proxies[static_cast<std::size_t>(k)](balls[b].center);
      inside += has_volume && brute_force::winding_number(now, at) > 0.5;
      near += distance(brute_force::closest_point(now, at).point, at) < balls[b].radius;
    }
  }
  result.expect(inside == 0, "a ball is inside");
  result.expect(near == 0, "a facet is nearer to a ball than its radius");
}

Result tool_result(const std::string& item, const Input& input, const CoveredTree& model,
                   const std::vector<Frame>& frames, const Settings& settings) {
  Result result{.scenario = "haptic", .item = item, .mesh = input.name};
  Body body(input.mesh, model);
  const Collider collider(input.mesh, body);
  const Sphere root = collider.sphere_state().sphere(0);
  const std::vector<Sphere> balls = tool_balls(root.radius);
  const std::vector<Vec3> devices = device_points(collider, 0.02 * root.radius);
  std::vector<RigidTransform> proxies;
  int touching = 0, settled = 0, jammed = 0;
  std::size_t moves = 0, contacts = 0;
  bool is_same = true;
  timed(settings, [&] {
    require(body.update(input.mesh.positions));
    HapticTool tool(balls);
    const Vec3 away = root.center + 3 * root.radius * normalized(devices.front() - root.center);
    require(tool.step(collider, tool_pose(away, 0)).status);
    touching = settled = jammed = 0, moves = contacts = 0;
    std::vector<RigidTransform> found;
    for (int k = 0; k < step_count; ++k) {
      if (k % steps_per_frame == 0 && !frames.empty())
        require(body.update(frames[static_cast<std::size_t>(k / steps_per_frame) % frames.size()]));
      const RigidTransform device = tool_pose(devices[static_cast<std::size_t>(k)], k);
      HapticToolStep step;
      result.seconds.push_back(seconds_of([&] { step = tool.step(collider, device); }));
      require(step.status);
      touching += step.touches, settled += step.settled, jammed += step.jammed;
      moves += step.moves, contacts += step.contacts.size();
      found.push_back(step.proxy);
    }
    is_same = is_same && (proxies.empty() || proxies == found);
    proxies = found;
  });
  result.expect(is_same, "another run has other poses");
  result.expect(jammed == 0, "the tool is jammed");
  check_tool(input.mesh, frames, balls, proxies, result);
  std::vector<double> sorted = result.seconds;
  std::sort(sorted.begin(), sorted.end());
  result.figures = {{"us/step", 1e6 * median(result.seconds)},
                    {"us at 99 %", 1e6 * sorted[sorted.size() * 99 / 100]},
                    {"touching", static_cast<double>(touching) / step_count},
                    {"settled", static_cast<double>(settled) / step_count},
                    {"moves/step", static_cast<double>(moves) / step_count},
                    {"contacts/step", static_cast<double>(contacts) / step_count}};
  return result;
}

}  // namespace

std::vector<Result> run_haptic(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  const double size = model.tree.spheres[0].radius;
  std::vector<Result> results;
  for (const double share : {0.0, 0.02}) {
    const HapticOptions options{.radius = share * size, .stiffness = 300, .smooth_normals = true};
    const std::string shape = share == 0 ? "point" : "ball";
    results.push_back(haptic_result(shape + ", at rest", input, model, options, {}, settings));
    results.push_back(
        haptic_result(shape + ", a frame per 40 steps", input, model, options, bend_and_back(input.mesh), settings));
  }
  results.push_back(tool_result("tool of 50 balls, at rest", input, model, {}, settings));
  results.push_back(
      tool_result("tool of 50 balls, a frame per 40 steps", input, model, bend_and_back(input.mesh), settings));
  return results;
}

}  // namespace morula::bench
