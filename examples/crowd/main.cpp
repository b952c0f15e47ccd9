// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A crowd of skinned characters is culled against the frustum of a camera by bounds from bones alone. Brute force clips
// every posed facet to the frustum: a visible character must be drawn. Three usual bounds do the same: a sphere at
// rest, a box per joint, and a sphere of the posed vertices, which needs all of them.
#include <cstdio>
#include <morula/update/skin_bounds.hpp>

#include "walker.hpp"

namespace crowd {
namespace {

constexpr std::size_t walkers = 200, frames = 24, facets_of_cluster = 48;

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

/// A walker of the crowd in a frame: where it is, and its bones relative to rest.
struct Member {
  RigidTransform to_world;
  std::vector<AffineTransform> bones;
};

Member member(const Walker& walker, std::size_t number, std::size_t frame) {
  Random random(number);
  const Vec3 place{random.uniform(-30, 30), 0, random.uniform(-30, 30)};
  Member m{RigidTransform::from_axis({0, 1, 0}, random.uniform(0, 2 * std::numbers::pi), place), {}};
  walker.pose(random.uniform(0, 6) + 0.5 * static_cast<double>(frame), random.uniform(), m.bones);
  return m;
}

/// What others do: each answers whether a walker may be visible.
class UsualBounds {
 public:
  explicit UsualBounds(const Walker& walker) : joint_boxes_(walker.skin.bone_count) {
    const Box box = bounding_box(walker.mesh);
    rest_ = {box.center(), box.diagonal() / 2};
    for (std::size_t v = 0; v < walker.mesh.vertex_count(); ++v)
      for (std::uint32_t k = walker.skin.begin[v]; k < walker.skin.begin[v + 1]; ++k)
        joint_boxes_[walker.skin.bones[k]].add(walker.mesh.positions[v]);
  }
  bool at_rest(const Member& m, const Frustum& view) const {
    return !is_outside(view, Sphere{m.to_world(rest_.center), rest_.radius});
  }
  bool by_joints(const Member& m, const Frustum& view) const {
    Box moved;
    for (std::size_t b = 0; b < joint_boxes_.size(); ++b)
      for (const Vec3& corner : corners_of(joint_boxes_[b])) moved.add(m.bones[b](corner));
    std::array<Vec3, 8> corners = corners_of(moved);
    for (Vec3& corner : corners) corner = m.to_world(corner);
    return !is_outside(view, corners);
  }
  /// posed: all vertices, in the world.
  static bool by_vertices(std::span<const Vec3> posed, const Frustum& view) {
    Box box;
    for (const Vec3& p : posed) box.add(p);
    double radius = 0;
    for (const Vec3& p : posed) radius = std::max(radius, length(p - box.center()));
    return !is_outside(view, Sphere{box.center(), radius});
  }

 private:
  Sphere rest_;
  std::vector<Box> joint_boxes_;
};

int run() {
  const Walker walker;
  const std::size_t facet_count = walker.mesh.facets.size();
  const UsualBounds usual(walker);
  Body body(walker.mesh, build(walker.mesh), {.rules = {Rule::skinned}, .skin = walker.skin});
  // [clusters]
  std::vector<std::uint32_t> cluster_of_facet;
  for (std::uint32_t f = 0; f < facet_count; ++f) cluster_of_facet.push_back(f / facets_of_cluster);
  SkinBounds bounds(walker.mesh, walker.skin, cluster_of_facet);
  const std::size_t clusters = bounds.cluster_count();
  std::vector<Spheref> spheres(walkers * clusters);
  // [end]

  Score by_tree{"tree of spheres"}, by_clusters{"spheres of clusters"}, by_rest{"sphere at rest"},
      by_joints{"box per joint"}, by_vertices{"sphere of posed vertices"};
  std::size_t visible_count = 0, clusters_drawn = 0, clusters_visible = 0, clusters_lost = 0;
  std::vector<Vec3> posed(walker.mesh.vertex_count()), polygon;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    const auto turn = sin_cos(2 * std::numbers::pi * static_cast<double>(frame) / frames);
    const Frustum view = frustum({0, 1.7, 0}, normalized(Vec3{turn.cos, -0.1, turn.sin}), 0.6, 0.4, 0.1, 25);
    std::vector<Member> crowd;
    for (std::size_t w = 0; w < walkers; ++w) crowd.push_back(member(walker, w, frame));
    // All clusters of all walkers in one call.
    std::vector<AffineTransform> bones;
    for (const Member& m : crowd) bones.insert(bones.end(), m.bones.begin(), m.bones.end());
    if (!bounds.bounds(bones, {.spheres = spheres})) return 1;

    for (std::size_t w = 0; w < walkers; ++w) {
      const Member& m = crowd[w];
      if (!body.update_skinned(m.bones)) return 1;
      const bool tree_draws = may_be_visible(body, m.to_world, view);
      std::vector<bool> draws(clusters), shows(clusters);
      for (std::size_t k = 0; k < clusters; ++k) {
        const Spheref& s = spheres[w * clusters + k];
        draws[k] = !is_outside(view, Sphere{m.to_world(Vec3(s.center)), static_cast<double>(s.radius)});
      }

      move_by_skin(walker.skin, walker.mesh.positions, m.bones, posed);
      for (Vec3& p : posed) p = m.to_world(p);
      for (std::size_t f = 0; f < facet_count; ++f) {
        const Facet& facet = walker.mesh.facets[f];
        polygon = {posed[facet[0]], posed[facet[1]], posed[facet[2]]};
        if (is_visible(view, polygon)) shows[cluster_of_facet[f]] = true;
      }
      const auto any = [](const std::vector<bool>& of) { return std::find(of.begin(), of.end(), true) != of.end(); };
      const bool visible = any(shows);
      visible_count += visible;
      for (std::size_t k = 0; k < clusters; ++k) {
        clusters_drawn += draws[k], clusters_visible += shows[k];
        clusters_lost += shows[k] && !draws[k];
      }
      by_tree.count(tree_draws, visible);
      by_clusters.count(any(draws), visible);
      by_rest.count(usual.at_rest(m, view), visible);
      by_joints.count(usual.by_joints(m, view), visible);
      by_vertices.count(UsualBounds::by_vertices(posed, view), visible);
    }
  }

  std::printf("%zu walkers of %zu facets, %zu frames: %zu visible\n", walkers, facet_count, frames, visible_count);
  for (const Score* s : {&by_tree, &by_clusters, &by_rest, &by_joints, &by_vertices})
    std::printf("%-25s %5zu drawn, %4zu needlessly, %3zu visible ones lost\n", s->name, s->drawn, s->needless, s->lost);
  std::printf("clusters: %zu drawn, %zu visible, %zu visible ones lost\n", clusters_drawn, clusters_visible,
              clusters_lost);
  const std::size_t lost = by_tree.lost + by_clusters.lost + by_joints.lost + by_vertices.lost + clusters_lost;
  return visible_count > 0 && lost == 0 && by_tree.needless < by_vertices.needless ? 0 : 1;
}

}  // namespace
}  // namespace crowd

int main() {
  return crowd::run();
}
