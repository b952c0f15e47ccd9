// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A crowd of skinned characters is culled against the frustum of a camera by bounds from bones alone. Brute force clips
// every posed facet to the frustum: a visible character must be drawn. Three usual bounds do the same: a sphere at
// rest, a box per joint, and a sphere of the posed vertices, which needs all of them.
#include <cstdio>

#include "walker.hpp"

namespace crowd {
namespace {

constexpr int walkers = 200, frames = 24;

/// A camera's frustum: points x with normal . x + offset >= 0 for all planes.
struct Plane {
  Vec3 normal;
  double offset;
  double of(const Vec3& p) const { return dot(normal, p) + offset; }
};
using Frustum = std::array<Plane, 6>;

Frustum frustum(const Vec3& eye, const Vec3& forward, double half_width, double half_height, double near, double far) {
  const Vec3 right = normalized(cross(forward, {0, 1, 0})), up = cross(right, forward);
  const auto through_eye = [&](const Vec3& normal) { return Plane{normalized(normal), -dot(normalized(normal), eye)}; };
  return {through_eye(forward * half_width + right), through_eye(forward * half_width - right),
          through_eye(forward * half_height + up),   through_eye(forward * half_height - up),
          Plane{forward, -dot(forward, eye) - near}, Plane{forward * -1.0, dot(forward, eye) + far}};
}

bool is_outside(const Frustum& frustum, const Sphere& sphere) {
  return std::any_of(frustum.begin(), frustum.end(),
                     [&](const Plane& p) { return p.of(sphere.center) < -sphere.radius; });
}

/// Whether a box, given by its corners, lies beyond one plane.
bool is_outside(const Frustum& frustum, std::span<const Vec3> corners) {
  return std::any_of(frustum.begin(), frustum.end(), [&](const Plane& p) {
    return std::all_of(corners.begin(), corners.end(), [&](const Vec3& c) { return p.of(c) < 0; });
  });
}

/// Whether a part of the facet is inside: it is clipped by one plane after the other.
bool is_visible(const Frustum& frustum, std::vector<Vec3>& polygon) {
  std::vector<Vec3> kept;
  for (const Plane& plane : frustum) {
    kept.clear();
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
      const double at_a = plane.of(a), at_b = plane.of(b);
      if (at_a >= 0) kept.push_back(a);
      if ((at_a < 0) != (at_b < 0)) kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
    }
    polygon.swap(kept);
    if (polygon.empty()) return false;
  }
  return true;
}

std::array<Vec3, 8> corners_of(const Box& box) {
  std::array<Vec3, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] = {(k & 1 ? box.upper : box.lower).x, (k & 2 ? box.upper : box.lower).y,
                  (k & 4 ? box.upper : box.lower).z};
  return corners;
}

/// Whether a sphere of the body may be visible, from the root down. to_world moves the body to its place.
// [culling]
bool may_be_visible(const Body& body, const RigidTransform& to_world, const Frustum& frustum) {
  const SphereTree& tree = body.rest_tree();
  std::vector<std::uint32_t> open{0};
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    const Sphere s = body.sphere(node);
    if (is_outside(frustum, Sphere{to_world(s.center), s.radius})) continue;
    if (tree.is_leaf(node)) return true;
    for (std::uint32_t c = 0; c < tree.child_count[node]; ++c) open.push_back(tree.first_child[node] + c);
  }
  return false;
}
// [end]

/// How a bound did against brute force.
struct Score {
  const char* name;
  std::size_t drawn = 0, needless = 0, lost = 0;
  void count(bool draws, bool is_visible) {
    drawn += draws;
    needless += draws && !is_visible;
    lost += !draws && is_visible;
  }
};

int run() {
  const Walker walker;
  Body body(walker.mesh, build(walker.mesh), {.rules = {Rule::skinned}, .skin = walker.skin});
  const Box at_rest = bounding_box(walker.mesh);
  const Sphere rest{at_rest.center(), at_rest.diagonal() / 2};
  std::vector<Box> joint_boxes(walker.skin.bone_count);
  for (std::size_t v = 0; v < walker.mesh.vertex_count(); ++v)
    for (std::uint32_t k = walker.skin.begin[v]; k < walker.skin.begin[v + 1]; ++k)
      joint_boxes[walker.skin.bones[k]].add(walker.mesh.positions[v]);

  Score by_bones{"spheres from bones"}, by_rest{"sphere at rest"}, by_joints{"box per joint"},
      by_vertices{"sphere of posed vertices"};
  std::size_t visible_count = 0;
  std::vector<AffineTransform> bones;
  std::vector<Vec3> posed(walker.mesh.vertex_count()), polygon;
  for (int frame = 0; frame < frames; ++frame) {
    const auto turn = sin_cos(2 * std::numbers::pi * frame / frames);
    const Frustum view = frustum({0, 1.7, 0}, normalized(Vec3{turn.cos, -0.1, turn.sin}), 0.6, 0.4, 0.1, 25);
    for (int w = 0; w < walkers; ++w) {
      Random random(static_cast<std::uint64_t>(w));
      const Vec3 place{random.uniform(-30, 30), 0, random.uniform(-30, 30)};
      const RigidTransform to_world =
          RigidTransform::from_axis({0, 1, 0}, random.uniform(0, 2 * std::numbers::pi), place);
      walker.pose(random.uniform(0, 6) + 0.5 * frame, random.uniform(), bones);

      if (!body.update_skinned(bones)) return 1;
      const bool drawn = may_be_visible(body, to_world, view);

      move_by_skin(walker.skin, walker.mesh.positions, bones, posed);
      Box all, moved_boxes;
      for (Vec3& p : posed) all.add(p), p = to_world(p);
      const bool visible = std::any_of(walker.mesh.facets.begin(), walker.mesh.facets.end(), [&](const Facet& f) {
        polygon = {posed[f[0]], posed[f[1]], posed[f[2]]};
        return is_visible(view, polygon);
      });
      for (std::size_t b = 0; b < bones.size(); ++b)
        for (const Vec3& corner : corners_of(joint_boxes[b])) moved_boxes.add(bones[b](corner));
      std::array<Vec3, 8> box = corners_of(moved_boxes);
      for (Vec3& corner : box) corner = to_world(corner);
      Sphere around{to_world(all.center()), 0};
      for (const Vec3& p : posed) around.radius = std::max(around.radius, length(p - around.center));

      visible_count += visible;
      by_bones.count(drawn, visible);
      by_rest.count(!is_outside(view, Sphere{to_world(rest.center), rest.radius}), visible);
      by_joints.count(!is_outside(view, box), visible);
      by_vertices.count(!is_outside(view, around), visible);
    }
  }

  std::printf("%d walkers of %zu facets, %d frames: %zu visible\n", walkers, walker.mesh.facets.size(), frames,
              visible_count);
  for (const Score* s : {&by_bones, &by_rest, &by_joints, &by_vertices})
    std::printf("%-25s %5zu drawn, %4zu needlessly, %3zu visible ones lost\n", s->name, s->drawn, s->needless, s->lost);
  return visible_count > 0 && by_bones.lost == 0 && by_joints.lost == 0 && by_vertices.lost == 0 &&
                 by_bones.needless < by_vertices.needless
             ? 0
             : 1;
}

}  // namespace
}  // namespace crowd

int main() {
  return crowd::run();
}
