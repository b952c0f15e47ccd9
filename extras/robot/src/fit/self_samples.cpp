// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/self_samples.hpp"

#include <algorithm>
#include <morula/collide/containment.hpp>
#include <morula/collide/distance.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <set>
#include <stdexcept>

#include "fit/clip.hpp"
#include "fit/pair_chain.hpp"
#include "fit/rounding.hpp"

namespace morula::robot {

namespace {

/// The shapes of a link as one mesh; the spheres, if there is none.
Mesh solid_mesh(const LinkSpheres& link) {
  Mesh mesh = link.surface.mesh;
  for (const Sphere& s : link.surface.empty() ? link.spheres : link.surface.spheres)
    append_mesh(mesh, ball_mesh_of(s, RoundShapes::inside));
  return mesh;
}

}  // namespace

struct LinkSolids::Solid {
  Mesh mesh;
  Body body;
  std::vector<std::uint32_t> components;
  std::unique_ptr<SignedDistance> inside;  // nullptr: the surface has no inside

  explicit Solid(const LinkSpheres& link)
      : mesh(solid_mesh(link)),
        body(mesh, build(mesh, {.method = Method::octree}, serial_workers())),
        components(component_vertices(mesh)) {
    if (inspect(mesh).has_volume()) inside = std::make_unique<SignedDistance>(mesh);
  }
};

LinkSolids::LinkSolids(const RobotSpheres& spheres, Workers& workers) : solids_(spheres.links.size()) {
  workers.run(spheres.links.size(), [&](std::size_t i) { solids_[i] = std::make_unique<Solid>(spheres.links[i]); });
}

LinkSolids::~LinkSolids() = default;

bool LinkSolids::collide(std::size_t a, const RigidTransform& at_a, std::size_t b, const RigidTransform& at_b) const {
  const Solid &first = *solids_[a], &second = *solids_[b];
  Collider of_a(first.mesh, first.body), of_b(second.mesh, second.body);
  of_a.set_transform(relative_to(at_b, at_a));
  const morula::DistanceBounds bounds = distance(of_a, of_b, {.stop_above = 0});
  if (bounds.crossing) return true;
  const auto contains = [](const Solid& outer, const Solid& inner, const RigidTransform& to_outer) {
    return outer.inside && std::any_of(inner.components.begin(), inner.components.end(), [&](std::uint32_t v) {
             return outer.inside->is_inside(to_outer(inner.mesh.positions[v]));
           });
  };
  // mutant robot-rates-inside: `contains(second` -> `false && contains(second`
  return contains(second, first, relative_to(at_b, at_a)) || contains(first, second, relative_to(at_a, at_b));
}

std::vector<std::vector<RigidTransform>> sampled_poses(const Robot& robot, const RobotSpheres& spheres,
                                                       std::size_t samples, std::uint64_t seed) {
  double size = 0;
  for (const LinkSpheres& link : spheres.links) size += extent_of(link.spheres);
  for (const Joint& joint : robot.joints) size += length(joint.origin.translation);
  const JointRanges ranges = joint_ranges(robot, size);
  Random random(seed);
  std::vector<std::vector<RigidTransform>> poses;
  std::vector<double> values(ranges.coordinates.size());
  for (std::size_t k = 0; k < samples; ++k) {
    for (std::size_t c = 0; c < values.size(); ++c)
      values[c] = random.uniform(ranges.coordinates[c].lower, ranges.coordinates[c].upper);
    poses.push_back(link_poses(robot, values));
  }
  return poses;
}

std::vector<PlacePair> tested_pairs(const RobotSpheres& spheres, std::span<const IgnoredPair> ignored) {
  std::set<std::pair<std::size_t, std::size_t>> left_out;
  for (const IgnoredPair& pair : ignored) left_out.insert(std::minmax(pair.a, pair.b));
  std::vector<PlacePair> pairs;
  for (std::size_t a = 0; a < spheres.links.size(); ++a) {
    for (std::size_t b = a + 1; b < spheres.links.size(); ++b) {
      if (left_out.count(std::minmax(spheres.links[a].link, spheres.links[b].link)) == 0) pairs.emplace_back(a, b);
    }
  }
  return pairs;
}

std::vector<bool> counted_pairs(std::span<const std::vector<std::size_t>> collisions, std::size_t pairs) {
  constexpr double nearly_all = 0.95;
  std::vector<std::size_t> times(pairs, 0);
  for (const auto& sample : collisions)
    for (const std::size_t p : sample) ++times[p];
  std::vector<bool> counted;
  for (const std::size_t n : times)
    counted.push_back(static_cast<double>(n) < nearly_all * static_cast<double>(collisions.size()));
  return counted;
}

}  // namespace morula::robot
