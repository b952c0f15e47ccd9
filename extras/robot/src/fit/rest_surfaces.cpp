// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/rest_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <optional>
#include <stdexcept>

namespace morula::robot {

/// A link's surface in its place at rest.
struct RestSurfaces::Placed {
  Mesh mesh;
  std::vector<Sphere> balls;
  std::optional<SurfaceTree> tree;
  std::optional<TriangleBvh> index;
  double size = 0;

  Placed(const LinkSurface& surface, const RigidTransform& at) : mesh(surface.mesh) {
    Box box;
    for (Vec3& p : mesh.positions) {
      p = at(p);
      box.add(p);
    }
    for (const Sphere& s : surface.spheres) {
      balls.push_back({at(s.center), s.radius});
      const Vec3 half{s.radius, s.radius, s.radius};
      box.add(balls.back().center - half);
      box.add(balls.back().center + half);
    }
    if (!mesh.facets.empty()) {
      tree.emplace(mesh);
      index.emplace(mesh);
    }
    size = box.diagonal();
  }
};

namespace {

bool is_round(const Shape& shape) {
  return shape.kind == Shape::Kind::cylinder || shape.kind == Shape::Kind::capsule ||
         shape.kind == Shape::Kind::ellipsoid;
}

/// The least distance of a's vertices from b, where it is below `most`: an upper bound of that of the surfaces.
double vertex_distance(const Mesh& a, const TriangleBvh& b, double most) {
  for (const Facet& facet : a.facets) {
    for (const std::uint32_t vertex : facet) {
      const auto nearest = b.closest_point(a.positions[vertex], most);
      if (nearest) most = std::min(most, std::sqrt(nearest->squared_distance));
    }
  }
  return most;
}

void require_good(const Status& status) {
  if (!status) throw std::invalid_argument(message(status));
}

double mesh_distance(const Mesh& mesh_a, const SurfaceTree& tree_a, const TriangleBvh& index_a, const Mesh& mesh_b,
                     const SurfaceTree& tree_b, const TriangleBvh& index_b) {
  SurfaceCrossingQuery crossings;
  require_good(crossings.run(tree_a, tree_b));
  if (!crossings.pairs().empty()) return 0;
  double least = vertex_distance(mesh_a, index_b, std::numeric_limits<double>::infinity());
  least = vertex_distance(mesh_b, index_a, least);
  // Edges may be nearer.
  ProximityQuery near({.distance = least, .nearest_features_once = true});
  require_good(near.run(tree_a, tree_b));
  // mutant robot-pairs-edges: `min(least, pair.distance)` -> `max(least, 0 * pair.distance)`
  for (const ProximityPair& pair : near.pairs()) least = std::min(least, pair.distance);
  return least;
}

}  // namespace

RestSurfaces::RestSurfaces(const Robot& robot, const RobotSpheres& spheres, std::span<const RigidTransform> poses,
                           std::span<const std::size_t> used, Workers& workers)
    : around_(spheres.links.size()), inside_(spheres.links.size()) {
  workers.run(used.size(), [&](std::size_t i) {
    const LinkSpheres& link = spheres.links[used[i]];
    const RigidTransform& at = poses[link.link];
    const bool is_known = !link.surface.empty();
    around_[used[i]] = std::make_unique<Placed>(is_known ? link.surface : LinkSurface{{}, link.spheres}, at);
    const Link& own = robot.links[link.link];
    const std::vector<Shape>& shapes = spheres.visual ? own.visual : own.collision;
    if (is_known && std::any_of(shapes.begin(), shapes.end(), is_round)) {
      inside_[used[i]] = std::make_unique<Placed>(surface_of(robot.file, shapes, RoundShapes::inside), at);
    }
  });
}

RestSurfaces::~RestSurfaces() = default;

double RestSurfaces::distance(std::size_t a, std::size_t b) const {
  const auto between = [](const Placed& p, const Placed& q) {
    double least = std::numeric_limits<double>::infinity();
    for (const Sphere& s : p.balls) {
      for (const Sphere& t : q.balls)
        least = std::min(least, morula::distance(s.center, t.center) - s.radius - t.radius);
    }
    for (const auto& [x, y] : {std::pair(&p, &q), std::pair(&q, &p)}) {
      for (const Sphere& s : x->balls) {
        if (!y->index) continue;
        const auto nearest = y->index->closest_point(s.center);
        if (nearest) least = std::min(least, std::sqrt(nearest->squared_distance) - s.radius);
      }
    }
    if (p.tree && q.tree && least > 0) {
      least = std::min(least, mesh_distance(p.mesh, *p.tree, *p.index, q.mesh, *q.tree, *q.index));
    }
    constexpr double touching = 1e-6;
    return least <= touching * std::max(p.size, q.size) ? 0 : least;
  };
  const double around = between(*around_[a], *around_[b]);
  // mutant robot-pairs-round: `> 0 || (!inside_[a] && !inside_[b])` -> `>= 0`
  if (around > 0 || (!inside_[a] && !inside_[b])) return around;
  return between(inside_[a] ? *inside_[a] : *around_[a], inside_[b] ? *inside_[b] : *around_[b]);
}

}  // namespace morula::robot
