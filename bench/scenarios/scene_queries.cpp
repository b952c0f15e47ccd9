// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario scene_queries: rays with all hits, filters and moving shapes in a scene of 200 bodies, beside the same
// queries of each body; and the first frames of a scene with and without reserved memory.
#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <morula/collide/sweep.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/scene/scene.hpp>
#include <morula/update/body.hpp>
#include <utility>

#include "frames.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

constexpr std::size_t body_count = 200, query_count = 100;

/// Bodies at random places in a cube, a quarter of them in another group.
struct Room {
  Room(const Mesh& given, const Settings& settings)
      : mesh(given), body(mesh, std::make_shared<const CoveredTree>(build(mesh, {}, *settings.workers))) {
    const double diagonal = bounding_box(mesh).diagonal();
    size = diagonal * std::cbrt(static_cast<double>(body_count));
    for (std::size_t i = 0; i < body_count; ++i) {
      colliders.emplace_back(mesh, body);
      colliders.back().set_transform(RigidTransform::from_axis(point(1), random.uniform(0, 6), point(0.5 * size)));
    }
  }
  Vec3 point(double reach) {
    return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  }
  void fill(Scene& scene) {
    ids.clear();
    for (std::size_t i = 0; i < body_count; ++i)
      ids.push_back(scene.add(colliders[i], {.category = i % 4 == 0 ? 2u : 1u}));
  }

  Random random{5};
  const Mesh& mesh;
  Body body;
  double size;
  std::vector<Collider> colliders;
  std::vector<BodyId> ids;
};

using Hit = std::pair<BodyId, double>;

/// Times a query of the scene and the same of all bodies by themselves, one after the other, and compares the results.
Result compared(const Input& input, const Settings& settings, const std::string& item,
                const std::function<std::vector<Hit>(std::size_t)>& of_scene,
                const std::function<std::vector<Hit>(std::size_t)>& of_bodies) {
  Result result{.scenario = "scene-queries", .item = item, .mesh = input.name};
  std::vector<double> alone;
  std::size_t hits = 0, wrong = 0;
  timed(settings, [&] {
    std::vector<std::vector<Hit>> found(query_count), expected(query_count);
    result.seconds.push_back(processor_seconds_of([&] {
      for (std::size_t i = 0; i < query_count; ++i) found[i] = of_scene(i);
    }));
    alone.push_back(processor_seconds_of([&] {
      for (std::size_t i = 0; i < query_count; ++i) expected[i] = of_bodies(i);
    }));
    hits = 0;
    for (std::size_t i = 0; i < query_count; ++i) {
      std::sort(found[i].begin(), found[i].end()), std::sort(expected[i].begin(), expected[i].end());
      wrong += found[i] != expected[i], hits += found[i].size();
    }
  });
  result.expect(wrong == 0, "the scene finds something else than its bodies do");
  result.expect(hits > 0, "nothing is hit");
  result.figures = {{"hits a query", static_cast<double>(hits) / query_count},
                    {"times faster than each body", median(alone) / median(result.seconds)}};
  return result;
}

/// The longest of the first frames, in which all bodies meet, with and without reserved memory.
Result reserved(const Input& input, const Settings& settings, Room& room) {
  Result result{.scenario = "scene-queries", .item = "first frames, reserved", .mesh = input.name};
  std::vector<double> plain;
  std::size_t pairs = 0, pairs_reserved = 0;
  timed(settings, [&] {
    for (const bool is_reserved : {false, true}) {
      Scene scene;
      room.fill(scene);
      if (is_reserved) scene.reserve({.bodies = body_count, .near_pairs = 20 * body_count, .contacts = 64});
      (is_reserved ? result.seconds : plain).push_back(seconds_of([&] { require(scene.update(*settings.workers)); }));
      (is_reserved ? pairs_reserved : pairs) = scene.pairs().size();
    }
  });
  result.expect(pairs == pairs_reserved && pairs > 0, "reserved memory changes the pairs");
  result.figures = {{"pairs", static_cast<double>(pairs)},
                    {"times unreserved", median(plain) / median(result.seconds)}};
  return result;
}

}  // namespace

std::vector<Result> run_scene_queries(const Input& input, const Settings& settings) {
  Room room(input.mesh, settings);
  Scene scene;
  room.fill(scene);
  require(scene.update(*settings.workers));
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < query_count; ++i) rays.push_back({room.point(room.size), room.point(1)});
  const auto rays_with = [&](const SceneFilter& filter, std::uint32_t mask) {
    return std::pair<std::function<std::vector<Hit>(std::size_t)>, std::function<std::vector<Hit>(std::size_t)>>{
        [&scene, &rays, filter](std::size_t i) {
          std::vector<Hit> found;
          const SceneRayHits all = scene.all_hits(rays[i], filter);
          require(all.status);
          for (const SceneHit& hit : all.hits) found.emplace_back(hit.body, hit.hit.t);
          return found;
        },
        [&room, &rays, mask](std::size_t i) {
          std::vector<Hit> found;
          for (std::size_t k = 0; k < body_count; ++k)
            if (((k % 4 == 0 ? 2u : 1u) & mask) != 0)
              for (const RayPoint& point : all_hits(room.colliders[k], rays[i]))
                found.emplace_back(room.ids[k], point.t);
          return found;
        }};
  };
  std::vector<Result> results;
  const auto [all_of_scene, all_of_bodies] = rays_with({}, ~0u);
  results.push_back(compared(input, settings, "all hits of a ray", all_of_scene, all_of_bodies));
  const auto [some_of_scene, some_of_bodies] = rays_with({.mask = 2}, 2);
  results.push_back(compared(input, settings, "all hits, a quarter by mask", some_of_scene, some_of_bodies));
  const double radius = 0.02 * room.size;
  const auto shape_of = [&](std::size_t i) {
    return Capsule{rays[i].origin, rays[i].origin + Vec3{radius, radius, 0}, radius};
  };
  results.push_back(compared(
      input, settings, "capsule in motion",
      [&](std::size_t i) {
        std::vector<Hit> found;
        const SceneSweepHits all = scene.sweep_all(shape_of(i), rays[i].direction * room.size);
        require(all.status);
        for (const SceneSweep& hit : all.hits) found.emplace_back(hit.body, hit.first.t);
        return found;
      },
      [&](std::size_t i) {
        std::vector<Hit> found;
        for (std::size_t k = 0; k < body_count; ++k)
          if (const SweepHit hit = sweep(room.colliders[k], shape_of(i), rays[i].direction * room.size); hit.first)
            found.emplace_back(room.ids[k], hit.first->t);
        return found;
      }));
  results.push_back(reserved(input, settings, room));
  return results;
}

}  // namespace morula::bench
