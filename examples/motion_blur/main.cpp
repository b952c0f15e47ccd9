// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motion blur: bounds of a skinned arm while the shutter is open, from its poses at the beginning and at the end. A
// renderer may interpolate vertices along straight lines, or rotations of joints by slerp. The spheres hold for
// straight lines as they are; for slerp they are widened by a bound of the arcs. Both are checked at sampled times.
#include <cmath>
#include <cstdio>
#include <morula/collide/moving_spheres.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/morula.hpp>

using namespace morula;

namespace {

constexpr std::size_t joints = 3;
constexpr int samples = 32;

/// A turn about a fixed axis through a joint: slerp between two of them is the turn by an angle between.
struct Joint {
  Vec3 at, axis;
  double start, end;  // radians
};

/// The limb of sample_body(), along x, with a bone behind each joint.
struct Arm {
  Mesh mesh = sample_body("limb", 32);
  Skin skin{.bone_count = joints, .begin = {0}};
  std::array<Joint, joints> chain;

  Arm() {
    const Box box = bounding_box(mesh);
    const auto along = [&](double share) { return Vec3{box.lower.x + share * box.extent().x, 0, 0}; };
    chain = {Joint{along(0), {0, 0, 1}, -0.2, -0.08}, Joint{along(0.4), {0, 0.6, 0.8}, 0.1, 0.25},
             Joint{along(0.75), {0, 0, 1}, -0.3, -0.1}};
    for (const Vec3& p : mesh.positions) {
      // Evenly over a fifth of the length, from bone to bone.
      const auto beyond = [&](std::size_t k) {
        return std::clamp((p.x - chain[k].at.x) / (0.2 * box.extent().x) + 0.5, 0.0, 1.0);
      };
      const double second = beyond(1), third = beyond(2), weights[]{1 - second, second - third, third};
      for (std::uint32_t b = 0; b < joints; ++b)
        if (weights[b] > 0) skin.bones.push_back(b), skin.weights.push_back(weights[b]);
      skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
    }
  }

  /// The bones at a time of the shutter, from 0 to 1, with rotations interpolated by slerp.
  std::vector<AffineTransform> bones(double t) const {
    std::vector<AffineTransform> result;
    AffineTransform above;
    for (const Joint& joint : chain) {
      const RigidTransform r = RigidTransform::from_axis(joint.axis, (1 - t) * joint.start + t * joint.end);
      AffineTransform turn{{r.rotate({1, 0, 0}), r.rotate({0, 1, 0}), r.rotate({0, 0, 1})}, {}};
      turn.translation = joint.at - turn.linear(joint.at);
      result.push_back(above = above * turn);
    }
    return result;
  }
  std::vector<Vec3> positions(double t) const {
    std::vector<Vec3> result(mesh.vertex_count());
    move_by_skin(skin, mesh.positions, bones(t), result);
    return result;
  }

  /// The largest distance of a vertex from the straight line between its two positions. A bone's points move with all
  /// joints up to its own; the distance from a joint is at most that along the chain, however the chain bends. A blend
  /// of several bones, with weights of at least 0, deviates by no more than the one that deviates most.
  double deviation() const {
    std::array<double, joints> angles, reaches{};
    for (std::size_t k = 0; k < joints; ++k) angles[k] = std::abs(chain[k].end - chain[k].start);
    double largest = 0;
    for (std::size_t bone = 0; bone < joints; ++bone) {
      double reach = 0;
      for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
        for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k)
          if (skin.bones[k] == bone) reach = std::max(reach, length(mesh.positions[v] - chain[bone].at));
      for (std::size_t k = bone + 1; k-- > 0;) {
        reaches[k] = reach;
        if (k > 0) reach += length(chain[k].at - chain[k - 1].at);
      }
      largest = std::max(largest, arc_deviation(std::span(angles).first(bone + 1), std::span(reaches).first(bone + 1)));
    }
    return largest;
  }
};

/// The number of corners outside the spheres of their nodes at a time, on all levels.
std::size_t outside(const Cover& cover, const MovingSpheres& moving, double t, const std::vector<Vec3>& positions) {
  std::size_t count = 0;
  for (std::uint32_t node = 0; node < moving.size(); ++node) {
    const Sphere s = moving.sphere(node, t);
    for (const std::uint32_t corner : cover.region_corners(node))
      count += length(corner_position(cover, corner, positions) - s.center) > s.radius;
  }
  return count;
}

}  // namespace

int main() {
  const Arm arm;
  // [motion_blur]
  Body body(arm.mesh, build(arm.mesh), {.rules = {Rule::skinned}, .skin = arm.skin});
  const Collider collider(body.sphere_state());
  MovingSpheres moving;
  if (!body.update_skinned(arm.bones(0)) || !moving.set_start(collider)) return 1;
  if (!body.update_skinned(arm.bones(1)) || !moving.set_end(collider)) return 1;
  // [end]

  const std::vector<Vec3> start = arm.positions(0), end = arm.positions(1);
  const double deviation = arm.deviation();
  MovingSpheres widened = moving;
  widened.widen(deviation);
  std::size_t straight_outside = 0, arcs_outside = 0, arcs_outside_plain = 0, box_outside = 0;
  double farthest = 0;
  Box swept, exact;
  for (std::uint32_t node = 0; node < widened.size(); ++node)
    if (widened.tree().is_leaf(node)) swept.add(widened.swept_box(node));
  for (int i = 0; i <= samples; ++i) {
    const double t = static_cast<double>(i) / samples;
    std::vector<Vec3> straight = start;
    for (std::size_t v = 0; v < straight.size(); ++v) straight[v] += t * (end[v] - start[v]);
    const std::vector<Vec3> arcs = arm.positions(t);
    straight_outside += outside(body.cover(), moving, t, straight);
    arcs_outside += outside(body.cover(), widened, t, arcs);
    arcs_outside_plain += outside(body.cover(), moving, t, arcs);
    for (std::size_t v = 0; v < arcs.size(); ++v) {
      farthest = std::max(farthest, length(arcs[v] - straight[v]));
      box_outside += squared_distance(swept, arcs[v]) > 0;
      exact.add(arcs[v]);
    }
  }
  std::printf("%zu vertices, %zu spheres, shutter open from time 0 to 1, %d sampled times\n", start.size(),
              moving.size(), samples + 1);
  std::printf("straight lines: %zu corners outside\n", straight_outside);
  std::printf("slerp: %zu corners outside, %zu without widening; vertices leave straight lines by %.4f, bound %.4f\n",
              arcs_outside, arcs_outside_plain, farthest, deviation);
  std::printf("box of the interval: diagonal %.3f; of all sampled vertices %.3f; %zu vertices outside\n",
              swept.diagonal(), exact.diagonal(), box_outside);
  return moving.covers() && straight_outside + arcs_outside + box_outside == 0 && arcs_outside_plain > 0 &&
                 farthest <= deviation
             ? 0
             : 1;
}
