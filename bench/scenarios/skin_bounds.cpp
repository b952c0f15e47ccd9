// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario skin_bounds: spheres and boxes of 64 clusters of each of 1,000 characters from their bones; beside a box per
// joint of whole characters, exact bounds of skinned positions, and the same with morph targets.
#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/skin_bounds.hpp>
#include <morula/update/skin_morphs.hpp>
#include <numeric>

#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr std::size_t character_count = 1000, cluster_count = 64, joint_count = 24, checked_characters = 20;
constexpr std::size_t target_count = 8;

/// A chain of bones along the longest side of a mesh, four influences a vertex, clusters by halving.
struct Character {
  explicit Character(const Mesh& given) : mesh(given), box(bounding_box(mesh)), axis(box.longest_axis()) {
    skin = {.bone_count = joint_count, .begin = {0}};
    for (const Vec3& p : mesh.positions) add_weights(p);
    std::vector<std::uint32_t> facets(mesh.facet_count());
    std::iota(facets.begin(), facets.end(), std::uint32_t{0});
    clusters.resize(facets.size());
    halve(facets, cluster_count);
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
      for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) of_joint[skin.bones[k]].add(mesh.positions[v]);
  }
  Vec3 joint(std::size_t b) const {
    Vec3 p = box.center();
    p[axis] = box.lower[axis] + box.extent()[axis] * static_cast<double>(b) / joint_count;
    return p;
  }
  void add_weights(const Vec3& p) {
    const double at = joint_count * (p[axis] - box.lower[axis]) / box.extent()[axis] - 0.5;
    const int first = std::clamp(static_cast<int>(std::floor(at)) - 1, 0, static_cast<int>(joint_count) - 4);
    double weights[4], sum = 0;
    for (int k = 0; k < 4; ++k) sum += weights[k] = std::exp(-2 * (at - first - k) * (at - first - k)) + 1e-9;
    for (int k = 0; k < 4; ++k) {
      skin.bones.push_back(static_cast<std::uint32_t>(first + k));
      skin.weights.push_back(weights[k] / sum);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  void halve(std::span<std::uint32_t> facets, std::size_t parts) {
    if (parts == 1) {
      for (const std::uint32_t f : facets) clusters[f] = next_cluster;
      ++next_cluster;
      return;
    }
    const auto middle = [&](std::uint32_t f) {
      const auto c = mesh.corners(f);
      return c[0] + c[1] + c[2];
    };
    Box part;
    for (const std::uint32_t f : facets) part.add(middle(f));
    const int side = part.longest_axis();
    const std::size_t half = facets.size() / 2;
    std::nth_element(facets.begin(), facets.begin() + static_cast<std::ptrdiff_t>(half), facets.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a)[side] < middle(b)[side]; });
    halve(facets.first(half), parts / 2);
    halve(facets.subspan(half), parts / 2);
  }
  /// Each joint turns by up to `most` radians about a random axis.
  void add_pose(Random& random, double most, std::vector<AffineTransform>& poses) const {
    AffineTransform of_parent;
    for (std::size_t b = 0; b < joint_count; ++b) {
      const Vec3 about =
          normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} + Vec3{1e-3, 0, 0});
      const double angle = random.uniform(-most, most);
      AffineTransform turn;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 e = turn.columns[k];
        turn.columns[k] =
            e * std::cos(angle) + cross(about, e) * std::sin(angle) + about * (dot(about, e) * (1 - std::cos(angle)));
      }
      turn.translation = joint(b) - turn.linear(joint(b));
      poses.push_back(of_parent = of_parent * turn);
    }
  }

  const Mesh& mesh;
  Box box;
  int axis;
  Skin skin;
  std::vector<std::uint32_t> clusters;
  std::uint32_t next_cluster = 0;
  std::vector<Box> of_joint = std::vector<Box>(joint_count);
};

Box box_of_joints(const Character& character, std::span<const AffineTransform> pose) {
  Box result;
  for (std::size_t b = 0; b < joint_count; ++b) {
    if (character.of_joint[b].is_empty()) continue;
    const Vec3 middle = pose[b](character.of_joint[b].center()), half = character.of_joint[b].extent() * 0.5;
    Vec3 extent;
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 3; ++side)
        extent[axis] += std::abs(pose[b].columns[static_cast<std::size_t>(side)][axis]) * half[side];
    result.add(middle - extent), result.add(middle + extent);
  }
  return result;
}

std::vector<Box> exact_boxes(const Character& character, std::span<const Vec3> positions) {
  std::vector<Box> result(cluster_count);
  for (std::size_t f = 0; f < character.mesh.facet_count(); ++f)
    for (const std::uint32_t v : character.mesh.facets[f]) result[character.clusters[f]].add(positions[v]);
  return result;
}

/// Targets that lift the half of the body beyond a plane across its axis, each vertex by another length.
Modes lifts(const Character& character) {
  Modes targets{character.mesh.vertex_count(), target_count, {}};
  Random random(6);
  for (std::size_t j = 0; j < target_count; ++j)
    for (const Vec3& p : character.mesh.positions) {
      const double height = 0.02 * character.box.diagonal() * random.uniform(0.5, 1);
      const bool is_beyond = p[character.axis] > character.box.center()[character.axis];
      targets.displacements.push_back(is_beyond ? height * Vec3{0.2, 1, static_cast<double>(j) / target_count}
                                                : Vec3{});
    }
  return targets;
}

bool contains(const Spheref& s, const Vec3& p) {
  return distance(Vec3(s.center), p) <= static_cast<double>(s.radius);
}
bool contains(const Boxf& b, const Vec3& p) {
  const Vec3 lower(b.lower), upper(b.upper);
  return min(lower, p) == lower && max(upper, p) == upper;
}

}  // namespace

namespace {

/// The characters with morph targets; plain: seconds without them.
Result run_morphed(const Input& input, const Settings& settings, const Character& character,
                   std::span<const AffineTransform> poses, double plain) {
  Result result{.scenario = "skin-bounds", .item = "the same with 8 morph targets in half of it", .mesh = input.name};
  const Modes targets = lifts(character);
  SkinBounds bounds(input.mesh, character.skin, targets, character.clusters, *settings.workers);
  std::vector<double> morphs;
  Random random(5);
  for (std::size_t k = 0; k < character_count * target_count; ++k) morphs.push_back(random.uniform(-1, 1));
  std::vector<Spheref> spheres(character_count * cluster_count), whole_spheres(character_count);
  std::vector<Boxf> boxes(spheres.size()), whole_boxes(character_count);
  result.seconds = timed(settings, [&] {
    require(bounds.bounds(poses, morphs, {spheres, boxes, whole_spheres, whole_boxes}, *settings.workers));
  });
  std::size_t outside = 0;
  std::vector<Vec3> positions(input.mesh.vertex_count());
  for (std::size_t c = 0; c < checked_characters; ++c) {
    move_by_skin(character.skin, targets, input.mesh.positions, poses.subspan(c * joint_count, joint_count),
                 std::span(morphs).subspan(c * target_count, target_count), positions, *settings.workers);
    for (std::size_t f = 0; f < input.mesh.facet_count(); ++f)
      for (const std::uint32_t v : input.mesh.facets[f]) {
        const std::size_t k = c * cluster_count + character.clusters[f];
        outside += contains(spheres[k], positions[v]) && contains(boxes[k], positions[v]) ? 0 : 1;
      }
  }
  result.expect(outside == 0, "morphed vertices outside the bounds");
  result.figures = {{"over no targets, time", median(result.seconds) / plain},
                    {"targets/cluster", static_cast<double>(bounds.data().targets.size()) / cluster_count}};
  return result;
}

}  // namespace

std::vector<Result> run_skin_bounds(const Input& input, const Settings& settings) {
  Result ours{.scenario = "skin-bounds", .item = "1,000 characters, 64 clusters, 24 bones", .mesh = input.name};
  Result joints{.scenario = "skin-bounds", .item = "a box per joint, whole characters", .mesh = input.name};
  Result exact{
      .scenario = "skin-bounds", .item = "exact boxes of skinned positions, 20 characters", .mesh = input.name};
  if (input.mesh.facet_count() < 4 * cluster_count || bounding_box(input.mesh).extent()[0] == 0) {
    ours.note = "the mesh is too small";
    return {ours};
  }
  const Character character(input.mesh);
  SkinBounds bounds(input.mesh, character.skin, character.clusters, *settings.workers);
  std::vector<AffineTransform> poses;
  Random random(4);
  for (std::size_t c = 0; c < character_count; ++c) character.add_pose(random, 0.3, poses);
  const auto pose = [&](std::size_t c) { return std::span(poses).subspan(c * joint_count, joint_count); };

  std::vector<Spheref> spheres(character_count * cluster_count), whole_spheres(character_count);
  std::vector<Boxf> boxes(spheres.size()), whole_boxes(character_count);
  ours.seconds = timed(settings, [&] {
    require(bounds.bounds(poses, {spheres, boxes, whole_spheres, whole_boxes}, *settings.workers));
  });
  std::vector<Box> of_joints(character_count);
  joints.seconds = timed(settings, [&] {
    for (std::size_t c = 0; c < character_count; ++c) of_joints[c] = box_of_joints(character, pose(c));
  });
  std::vector<std::vector<Vec3>> positions(checked_characters, std::vector<Vec3>(input.mesh.vertex_count()));
  std::vector<std::vector<Box>> least(checked_characters);
  exact.seconds = timed(settings, [&] {
    for (std::size_t c = 0; c < checked_characters; ++c) {
      move_by_skin(character.skin, input.mesh.positions, pose(c), positions[c], *settings.workers);
      least[c] = exact_boxes(character, positions[c]);
    }
  });

  std::size_t outside = 0;
  std::vector<double> radii, diagonals, whole, whole_of_joints;
  for (std::size_t c = 0; c < checked_characters; ++c) {
    Box all;
    for (std::size_t f = 0; f < input.mesh.facet_count(); ++f)
      for (const std::uint32_t v : input.mesh.facets[f]) {
        const std::size_t k = c * cluster_count + character.clusters[f];
        const Vec3& p = positions[c][v];
        const bool inside = contains(spheres[k], p) && contains(boxes[k], p) && contains(whole_spheres[c], p) &&
                            contains(whole_boxes[c], p);
        outside += inside ? 0 : 1;
      }
    for (std::size_t k = 0; k < cluster_count; ++k) {
      const Boxf& b = boxes[c * cluster_count + k];
      const Box& small = least[c][k];
      all.add(small);
      double farthest = 0;
      for (std::size_t f = 0; f < input.mesh.facet_count(); ++f)
        if (character.clusters[f] == k)
          for (const std::uint32_t v : input.mesh.facets[f])
            farthest = std::max(farthest, distance(positions[c][v], small.center()));
      radii.push_back(static_cast<double>(spheres[c * cluster_count + k].radius) / farthest);
      diagonals.push_back(length(Vec3(b.upper) - Vec3(b.lower)) / small.diagonal());
    }
    whole.push_back(length(Vec3(whole_boxes[c].upper) - Vec3(whole_boxes[c].lower)) / all.diagonal());
    whole_of_joints.push_back(of_joints[c].diagonal() / all.diagonal());
  }
  ours.expect(outside == 0, "skinned vertices outside the bounds");
  const auto at = [](std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  const double characters = static_cast<double>(character_count);
  const double seconds = median(ours.seconds);
  const double of_exact = median(exact.seconds) / static_cast<double>(checked_characters) * characters;
  ours.figures = {{"ns/cluster", 1e9 * seconds / characters / static_cast<double>(cluster_count)},
                  {"rows/cluster", static_cast<double>(bounds.data().rows.size()) / static_cast<double>(cluster_count)},
                  {"exact over this, time", of_exact / seconds},
                  {"joints over this, time", median(joints.seconds) / seconds},
                  {"radius over that of a sphere about the exact box, median", at(radii, 0.5)},
                  {"95 %", at(radii, 0.95)},
                  {"largest", at(radii, 1)},
                  {"diagonal of boxes over exact, median", at(diagonals, 0.5)},
                  {"diagonal, 95 %", at(diagonals, 0.95)},
                  {"diagonal, largest", at(diagonals, 1)},
                  {"whole boxes over exact, median", at(whole, 0.5)}};
  joints.figures = {{"ns/character", 1e9 * median(joints.seconds) / characters},
                    {"whole boxes over exact, median", at(whole_of_joints, 0.5)}};
  exact.figures = {{"us/character", 1e6 * of_exact / characters}};
  return {ours, run_morphed(input, settings, character, poses, seconds), joints, exact};
}

}  // namespace morula::bench
