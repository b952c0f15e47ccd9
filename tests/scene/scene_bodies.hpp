// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies of a scene, whatever becomes of them, and their crossings by brute force.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/scene/scene.hpp>
#include <optional>
#include <stdexcept>
#include <support/meshes.hpp>
#include <support/transforms.hpp>
#include <vector>

namespace morula::test {

/// A body with all that a collider borrows, at an address that stays.
struct Thing {
  explicit Thing(Mesh m)
      : mesh(std::move(m)),
        model(build(mesh, {.method = Method::octree, .branching = 8, .depth = 2})),
        body(mesh, model),
        positions(mesh.positions),
        collider(mesh, body) {}
  void deform(Random& random, double amount) {
    const Vec3 stretch{random.uniform(0.8, 1.3), random.uniform(0.8, 1.3), random.uniform(0.8, 1.3)};
    for (std::size_t v = 0; v < positions.size(); ++v) {
      const Vec3 p = mesh.positions[v];
      positions[v] = Vec3{p.x * stretch.x, p.y * stretch.y, p.z * stretch.z} + random_point(random, amount);
    }
    ASSERT_TRUE(body.update(positions));
  }

  Mesh mesh;
  CoveredTree model;
  Body body;
  std::vector<Vec3> positions;
  Collider collider;
  SceneBodyOptions options{};
  BodyId id{};
};

/// A ball, a box or a plate, by turns.
inline Mesh thing_mesh(std::size_t i) {
  if (i % 3 == 0) return icosphere(1, 0.6);
  if (i % 3 == 1) return box_mesh({-0.7, -0.4, -0.3}, {0.7, 0.4, 0.3}, 2);
  return grid_plate(4, 1.4, 1.0);
}

inline std::unique_ptr<Thing> make_thing(std::size_t i) {
  return std::make_unique<Thing>(thing_mesh(i));
}

/// The middle of all vertices, and the farthest from it, where they are now.
inline Sphere around(const Collider& body) {
  const auto count = static_cast<std::uint32_t>(body.vertex_count());
  Vec3 sum{};
  for (std::uint32_t v = 0; v < count; ++v) sum = sum + body.vertex(v);
  Sphere sphere{sum / static_cast<double>(count), 0};
  for (std::uint32_t v = 0; v < count; ++v)
    sphere.radius = std::max(sphere.radius, distance(sphere.center, body.vertex(v)));
  return sphere;
}

/// Where the edge from p to q goes through t.
inline std::optional<Vec3> pierced(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double hp = dot(n, p - t[0]), hq = dot(n, q - t[0]);
  if (!(hp * hq < 0)) return {};
  const Vec3 x = p + (q - p) * (hp / (hp - hq));
  for (std::size_t k = 0; k < 3; ++k)
    if (dot(n, cross(t[(k + 1) % 3] - t[k], x - t[k])) < 0) return {};
  return x;
}

struct Crossed {
  std::uint32_t facet_a, facet_b;
  Vec3 point;
};
inline std::vector<Crossed> crossings_by_force(const Collider& a, const Collider& b) {
  std::vector<Crossed> found;
  const Sphere sphere_a = around(a), sphere_b = around(b);
  if (distance(sphere_a.center, sphere_b.center) > sphere_a.radius + sphere_b.radius + 1e-9) return found;
  struct Boxed {
    Triangle triangle;
    Box box;
  };
  const auto boxed = [](const Collider& body) {
    std::vector<Boxed> all(body.mesh_facets().size());
    for (std::uint32_t f = 0; f < all.size(); ++f) {
      all[f].triangle = body.triangle(f);
      for (const Vec3& p : all[f].triangle) all[f].box.add(p);
    }
    return all;
  };
  const auto apart = [](const Box& s, const Box& t) {
    return s.lower.x > t.upper.x || t.lower.x > s.upper.x || s.lower.y > t.upper.y || t.lower.y > s.upper.y ||
           s.lower.z > t.upper.z || t.lower.z > s.upper.z;
  };
  const std::vector<Boxed> all_a = boxed(a), all_b = boxed(b);
  for (std::uint32_t f = 0; f < all_a.size(); ++f)
    for (std::uint32_t g = 0; g < all_b.size(); ++g) {
      if (apart(all_a[f].box, all_b[g].box)) continue;
      const Triangle &t = all_a[f].triangle, &u = all_b[g].triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        if (const auto x = pierced(t[k], t[(k + 1) % 3], u)) found.push_back({f, g, *x});
        if (const auto x = pierced(u[k], u[(k + 1) % 3], t)) found.push_back({f, g, *x});
      }
    }
  return found;
}

inline bool is_within(const Crossed& crossed, const ScenePair& pair, const Collider& a, const Collider& b) {
  const auto has = [](std::span<const std::uint32_t> facets, std::uint32_t f) {
    return std::find(facets.begin(), facets.end(), f) != facets.end();
  };
  for (const Contact& c : pair.contacts)
    if (distance(c.point, crossed.point) <= c.error_bound + 1e-9 && has(a.facets(c.node_a), crossed.facet_a) &&
        has(b.facets(c.node_b), crossed.facet_b))
      return true;
  return false;
}

/// The least gap between spheres of final nodes, by all pairs in double; negative where they overlap.
inline double least_gap(const Collider& a, const Collider& b, std::optional<std::uint32_t> level) {
  const auto spheres_of = [&](const Collider& body) {
    const std::size_t last = body.tree().level_count() - 1;
    const std::size_t at = level ? std::min<std::size_t>(*level, last) : last;
    std::vector<Sphere> spheres;
    for (const std::uint32_t node : level_set(body.tree(), at)) {
      const Spheref& s = body.sphere_state().spheres[node];
      spheres.push_back({body.transform()(body.sphere_state().origin + Vec3(s.center)), s.radius});
    }
    return spheres;
  };
  // A level below both trees stands for the leaves.
  if (level && *level >= std::max(a.tree().level_count(), b.tree().level_count())) level.reset();
  double least = std::numeric_limits<double>::infinity();
  const std::vector<Sphere> all_a = spheres_of(a), all_b = spheres_of(b);
  for (const Sphere& s : all_a)
    for (const Sphere& t : all_b) least = std::min(least, distance(s.center, t.center) - s.radius - t.radius);
  return least;
}
/// More than tests of pairs allow for rounding, for bodies of this size at these places.
inline constexpr double gap_in_doubt = 1e-4;

/// Bodies that come, go, move, deform, sleep and wake.
class Crowd {
 public:
  explicit Crowd(std::uint64_t seed) : random(seed) {
    for (std::size_t i = 0; i < 14; ++i) spare_.push_back(make_thing(i));
  }
  void step(Scene& scene, bool with_sleep) {
    for (std::uint64_t k = random.next() % 4; k-- > 0 && !spare_.empty();) add(scene);
    if (random.next() % 4 == 0 && things.size() > 6) {
      const auto gone = things.begin() + static_cast<std::ptrdiff_t>(random.next() % things.size());
      scene.remove((*gone)->id);
      EXPECT_THROW(scene.remove((*gone)->id), std::invalid_argument);
      spare_.push_back(std::move(*gone));
      things.erase(gone);
      // Its place is not taken before the scene knows.
      if (random.next() % 2 == 0 && !spare_.empty()) add(scene);
    }
    for (const auto& thing : things) {
      const std::uint64_t what = random.next() % 6;
      if (with_sleep && what == 5) scene.sleep(thing->id);
      if (thing->options.is_static && what != 0) continue;
      if (scene.is_asleep(thing->id) || thing->options.is_static) {
        if (what > 1) continue;
        scene.wake(thing->id);
      }
      if (what == 0) thing->collider.set_transform(random_transform(random, 1.2));
      if (what == 1) thing->deform(random, 0.05);
      if (what == 2) {
        RigidTransform nudged = thing->collider.transform();
        nudged.translation = nudged.translation + random_point(random, 0.02);
        thing->collider.set_transform(nudged);
      }
    }
  }
  bool may_meet(const Thing& a, const Thing& b) const {
    return !(a.options.is_static && b.options.is_static) && (a.options.category & b.options.mask) != 0 &&
           (b.options.category & a.options.mask) != 0;
  }

  Random random;
  std::vector<std::unique_ptr<Thing>> things;

 private:
  void add(Scene& scene) {
    things.push_back(std::move(spare_.front()));
    spare_.erase(spare_.begin());
    Thing& thing = *things.back();
    thing.options = {.is_static = random.next() % 5 == 0,
                     .category = 1u << (random.next() % 3),
                     .mask = static_cast<std::uint32_t>(random.next() % 7 + 1) | 1u,
                     .weight = random.uniform(0, 3),
                     .user_data = random.next()};
    thing.collider.set_transform(random_transform(random, 1.2));
    thing.id = scene.add(thing.collider, thing.options);
    EXPECT_EQ(scene.user_data(thing.id), thing.options.user_data);
  }
  std::vector<std::unique_ptr<Thing>> spare_;
};

}  // namespace morula::test
