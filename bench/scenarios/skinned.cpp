// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario skinned: the rule `skinned` for a body with 24 bones and four weights a vertex, and `exact` on the positions
// that the bones make.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>

#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr std::size_t bone_count = 24, weights_per_vertex = 4;
constexpr std::size_t posed_frames = 9;
constexpr double largest_angle = 0.5;  // of each joint, in radians

struct Skeleton {
  std::vector<Vec3> joints;
  std::vector<std::size_t> parents;  // earlier ones; of the first: itself
  double gap = 0;                    // the largest distance of a vertex from the nearest joint
};

// Joints far apart from each other; each hangs on the nearest of the earlier ones.
Skeleton skeleton_of(const Mesh& mesh) {
  Skeleton s;
  std::vector<double> distances(mesh.vertex_count(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (s.joints.size() < bone_count) {
    const Vec3 joint = mesh.positions[next];
    std::size_t parent = 0;
    for (std::size_t b = 1; b < s.joints.size(); ++b)
      if (distance(s.joints[b], joint) < distance(s.joints[parent], joint)) parent = b;
    s.joints.push_back(joint), s.parents.push_back(parent);
    for (std::size_t v = 0; v < distances.size(); ++v)
      distances[v] = std::min(distances[v], distance(mesh.positions[v], joint));
    next = static_cast<std::size_t>(std::max_element(distances.begin(), distances.end()) - distances.begin());
  }
  s.gap = distances[next];
  return s;
}

// Weights fall to zero where a joint is farther than the nearest one by 0.6 of the gap.
Skin skin_of(const Mesh& mesh, const Skeleton& skeleton) {
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t b = 0; b < bone_count; ++b) near.emplace_back(distance(p, skeleton.joints[b]), b);
    std::partial_sort(near.begin(), near.begin() + weights_per_vertex, near.end());
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t k = 0; k < weights_per_vertex; ++k) {
      const double share = std::max(0.0, 1 - (near[k].first - near[0].first) / (0.6 * skeleton.gap));
      weights.push_back(share * share * share);
      sum += weights.back();
    }
    for (std::size_t k = 0; k < weights_per_vertex && weights[k] > 0; ++k)
      skin.bones.push_back(near[k].second), skin.weights.push_back(weights[k] / sum);
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

AffineTransform turned_about(const Vec3& center, const Vec3& axis, double angle) {
  AffineTransform t;
  for (int k = 0; k < 3; ++k) {
    Vec3 e;
    e[k] = 1;
    t.columns[static_cast<std::size_t>(k)] =
        e * std::cos(angle) + cross(axis, e) * std::sin(angle) + axis * (dot(axis, e) * (1 - std::cos(angle)));
  }
  t.translation = center - t.linear(center);
  return t;
}

// Every joint turns about an axis of its own, out and back: the first and the last frame are at rest.
std::vector<AffineTransform> pose_of(const Skeleton& skeleton, std::size_t frame) {
  Random random(5);
  const double part = 1 - std::abs(1 - 2 * static_cast<double>(frame) / (posed_frames - 1));
  std::vector<AffineTransform> pose;
  for (std::size_t b = 0; b < bone_count; ++b) {
    const Vec3 axis = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, {1, 0, 0});
    const double angle = largest_angle * part * random.uniform(-1, 1);
    const AffineTransform own = part == 0 ? AffineTransform{} : turned_about(skeleton.joints[b], axis, angle);
    pose.push_back(b == 0 ? own : pose[skeleton.parents[b]] * own);
  }
  return pose;
}

// Quantiles of the leaves' radii over those of `exact`.
void add_radii(const CoveredTree& model, std::vector<double> ratios, Result& result) {
  std::sort(ratios.begin(), ratios.end());
  if (ratios.empty()) return;
  result.figures.push_back({"leaf radius, median", ratios[ratios.size() / 2]});
  result.figures.push_back({"95 %", ratios[ratios.size() * 95 / 100]});
  result.figures.push_back({"largest", ratios.back()});
  result.figures.push_back({"spheres", static_cast<double>(model.tree.node_count())});
}

}  // namespace

std::vector<Result> run_skinned(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  const Skeleton skeleton = skeleton_of(input.mesh);
  const Skin skin = skin_of(input.mesh, skeleton);
  Body skinned(input.mesh, model, {.rules = {Rule::skinned}, .skin = skin}, *settings.workers);
  Body exact(input.mesh, model, {}, *settings.workers);
  Result by_bones{.scenario = "skinned", .item = "skinned, 24 bones", .mesh = input.name};
  Result by_positions{.scenario = "skinned", .item = "exact on skinned positions", .mesh = input.name};

  // What the timed frames have to reproduce, found on one thread.
  std::vector<std::vector<AffineTransform>> poses;
  std::vector<std::vector<Vec3>> positions;
  std::vector<std::uint64_t> hashes, exact_hashes;
  std::vector<double> ratios;
  for (std::size_t f = 0; f < posed_frames; ++f) {
    poses.push_back(pose_of(skeleton, f));
    move_by_skin(skin, input.mesh.positions, poses[f], positions.emplace_back(input.mesh.vertex_count()));
    require(skinned.update_skinned(poses[f]));
    require(exact.update(positions[f]));
    by_bones.expect(skinned.certify(positions[f]).worst_excess <= 0, "surface outside the spheres");
    hashes.push_back(skinned.hash());
    exact_hashes.push_back(exact.hash());
    for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
      if (model.tree.is_leaf(node) && exact.spheres()[node].radius > 0)
        ratios.push_back(static_cast<double>(skinned.spheres()[node].radius / exact.spheres()[node].radius));
  }
  by_bones.expect(hashes.front() == hashes.back(), "back at rest the spheres are not those of rest");

  bool same = true, exact_same = true;
  timed(settings, [&] {
    for (std::size_t f = 0; f < posed_frames; ++f) {
      by_bones.seconds.push_back(seconds_of([&] { require(skinned.update_skinned(poses[f], *settings.workers)); }));
      by_positions.seconds.push_back(seconds_of([&] { require(exact.update(positions[f], *settings.workers)); }));
      same = same && skinned.hash() == hashes[f];
      exact_same = exact_same && exact.hash() == exact_hashes[f];
    }
  });
  by_bones.expect(same, "other spheres than on one thread, or than before");
  by_positions.expect(exact_same, "other spheres than on one thread, or than before");
  by_bones.figures = {{"of the time of exact", median(by_bones.seconds) / median(by_positions.seconds)}};
  add_radii(model, std::move(ratios), by_bones);
  return {by_bones, by_positions};
}

}  // namespace morula::bench
