// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Clearance: the least distance of random configurations of an arm, its nearest pair and gradient, against a loop over
// all spheres, obstacles and tested pairs of spheres, with the same distances of the mesh.
#include <algorithm>
#include <cmath>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/configurations.hpp>

#include "planning.hpp"

namespace morula::bench {
namespace {

using robot::Clearance;

struct Loop {
  const robot::Robot& robot;
  const robot::RobotSpheres& spheres;
  const robot::SelfCollision& self;
  const std::vector<robot::ObstacleBox>& boxes;
  const SignedDistance& mesh;
  std::vector<std::pair<std::size_t, std::size_t>> pairs{};
  std::vector<std::vector<Sphere>> moved{};

  void list_pairs() {
    moved.resize(spheres.links.size());
    for (std::size_t a = 0; a < moved.size(); ++a) {
      for (std::size_t b = a + 1; b < moved.size(); ++b) {
        const auto of_links = std::minmax(spheres.links[a].link, spheres.links[b].link);
        if (std::none_of(self.ignored.begin(), self.ignored.end(),
                         [&](const auto& pair) { return std::minmax(pair.a, pair.b) == of_links; }))
          pairs.emplace_back(a, b);
      }
    }
  }
  static double from_box(const robot::ObstacleBox& box, const Vec3& center) {
    const Vec3 p = box.pose.inverse_rotate(center - box.pose.translation);
    double squared = 0, inside = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double beyond = std::abs(p[k]) - box.half[k];
      if (beyond > 0) squared += beyond * beyond;
      inside = std::max(inside, beyond);
    }
    return squared > 0 ? std::sqrt(squared) : inside;
  }
  double operator()(std::span<const double> values) {
    const std::vector<RigidTransform> poses = link_poses(robot, values);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < moved.size(); ++i) {
      moved[i].clear();
      for (const Sphere& s : spheres.links[i].spheres) {
        const Sphere at{poses[spheres.links[i].link](s.center), s.radius};
        moved[i].push_back(at);
        for (const robot::ObstacleBox& box : boxes) least = std::min(least, from_box(box, at.center) - at.radius);
        least = std::min(least, mesh(at.center) - at.radius);
      }
    }
    for (const auto& [a, b] : pairs) {
      for (const Sphere& s : moved[a]) {
        for (const Sphere& t : moved[b]) least = std::min(least, distance(s.center, t.center) - s.radius - t.radius);
      }
    }
    return least;
  }
};

}  // namespace

Result run_clearance(std::size_t configurations, const Settings& settings) {
  const ArmAmongObstacles given(configurations, settings);
  const SignedDistance to_mesh(given.mesh);
  const robot::ConfigurationQuery query(given.robot, given.spheres, given.self);
  Loop loop{given.robot, given.spheres, given.self, given.boxes, to_mesh};
  loop.list_pairs();
  std::vector<Clearance> found(configurations), limited(configurations);
  std::vector<double> gradients(given.values.size()), by_loop(configurations), loop_seconds, plain_seconds,
      limited_seconds;
  constexpr double limit = 0.05;
  Result result{.scenario = "clearance", .item = "configurations", .mesh = "arm"};
  const std::size_t coordinates = query.coordinates();
  // In turn, so that what disturbs one disturbs the others.
  for (int repeat = 0; repeat < settings.repeats; ++repeat) {
    result.seconds.push_back(
        seconds_of([&] { query.clearance(given.values, given.world, found, gradients, {}, serial_workers()); }));
    plain_seconds.push_back(
        seconds_of([&] { query.clearance(given.values, given.world, found, {}, {}, serial_workers()); }));
    limited_seconds.push_back(seconds_of(
        [&] { query.clearance(given.values, given.world, limited, gradients, {.limit = limit}, serial_workers()); }));
    loop_seconds.push_back(seconds_of([&] {
      for (std::size_t i = 0; i < configurations; ++i)
        by_loop[i] = loop(std::span(given.values).subspan(i * coordinates, coordinates));
    }));
  }
  std::size_t wrong = 0, contacts = 0;
  for (std::size_t i = 0; i < configurations; ++i) {
    const Clearance& c = found[i];
    wrong += !(std::abs(c.distance - by_loop[i]) <= 1e-12 && c.lower <= c.distance && c.distance <= c.upper);
    wrong += limited[i].distance != std::min(c.distance, limit);
    contacts += c.distance < 0;
  }
  const double own = median(result.seconds), count = static_cast<double>(configurations);
  result.figures = {{"us a configuration", 1e6 * own / count},
                    {"us without gradients", 1e6 * median(plain_seconds) / count},
                    {"us with a limit of 5 cm", 1e6 * median(limited_seconds) / count},
                    {"plain loop / one call", median(loop_seconds) / own},
                    {"share in contact", static_cast<double>(contacts) / count}};
  result.expect(wrong == 0, "one call and the loop disagree");
  return result;
}

}  // namespace morula::bench
