// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario skinned-pick: rays against a character of 24 bones that no one skins, and against one whose vertices are all
// skinned for `exact`. Answers are compared with brute force over the skinned positions.
#include <algorithm>
#include <cmath>
#include <morula/collide/primitives.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/body.hpp>
#include <utility>

#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr std::size_t bones = 24, influences = 4, pick_frames = 40, rays_per_frame = 64;

// Bones in a row along x, with the four nearest for each vertex.
Skin row_of_bones(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  Skin skin{.bone_count = bones, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    const double at = (p.x - box.lower.x) / (box.upper.x - box.lower.x) * (bones - 1);
    const auto first =
        static_cast<std::uint32_t>(std::clamp(std::floor(at) - 1, 0.0, static_cast<double>(bones - influences)));
    double sum = 0;
    for (std::uint32_t b = first; b < first + influences; ++b) sum += std::exp(-(at - b) * (at - b));
    for (std::uint32_t b = first; b < first + influences; ++b) {
      skin.bones.push_back(b);
      skin.weights.push_back(std::exp(-(at - b) * (at - b)) / sum);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

// Each bone turned against the one before it, about an axis across the row.
std::vector<AffineTransform> row_pose(const Mesh& mesh, Random& random) {
  const Box box = bounding_box(mesh);
  const double step = (box.upper.x - box.lower.x) / (bones - 1);
  std::vector<AffineTransform> pose(bones);
  for (std::size_t b = 1; b < bones; ++b) {
    const Vec3 joint{box.lower.x + step * (static_cast<double>(b) - 0.5), 0, 0};
    const double angle = random.uniform(-0.12, 0.12), c = std::cos(angle), s = std::sin(angle);
    AffineTransform turn;
    turn.columns = b % 2 == 0 ? std::array{Vec3{c, s, 0}, Vec3{-s, c, 0}, Vec3{0, 0, 1}}
                              : std::array{Vec3{c, 0, -s}, Vec3{0, 1, 0}, Vec3{s, 0, c}};
    turn.translation = joint - turn.linear(joint);
    pose[b] = pose[b - 1] * turn;
  }
  return pose;
}

// The least t at which the ray hits a facet, and the least distance of the ray from an edge.
std::pair<double, double> first_by_brute_force(const Mesh& mesh, const std::vector<Vec3>& p, const Ray& ray) {
  double first = std::numeric_limits<double>::infinity(), nearest_edge = first;
  for (const Facet& f : mesh.facets) {
    const Triangle t{p[f[0]], p[f[1]], p[f[2]]};
    const Vec3 n = area_vector(t);
    const double slope = dot(n, ray.direction);
    double inside = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 side = cross(ray.direction, t[(k + 1) % 3] - t[k]);
      const double offset = dot(side, t[k] - ray.origin) / std::max(length(side), 0x1p-500) * (slope > 0 ? -1 : 1);
      inside = std::min(inside, offset);
      nearest_edge = std::min(nearest_edge, std::abs(offset));
    }
    const double where = slope != 0 ? dot(n, t[0] - ray.origin) / slope : -1;
    if (inside >= 0 && where >= 0) first = std::min(first, where);
  }
  return {first, nearest_edge};
}

struct PickFrame {
  std::vector<AffineTransform> pose;
  std::vector<Ray> rays;
};

// Three of four rays aim at a vertex, as a click on the character does; the others anywhere.
std::vector<PickFrame> frames_of(const Mesh& mesh, const Skin& skin) {
  Random random(1);
  std::vector<PickFrame> frames(pick_frames);
  std::vector<Vec3> moved(mesh.vertex_count());
  const double size = bounding_box(mesh).diagonal();
  const auto anywhere = [&] {
    return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * size;
  };
  for (PickFrame& frame : frames) {
    frame.pose = row_pose(mesh, random);
    move_by_skin(skin, mesh.positions, frame.pose, moved);
    for (std::size_t i = 0; i < rays_per_frame; ++i) {
      Ray ray{anywhere() * 2.0, {}};
      const Vec3 target = i % 4 == 3 ? anywhere() : moved[static_cast<std::size_t>(random.next() % moved.size())];
      ray.direction = target + anywhere() * 1e-3 - ray.origin;
      frame.rays.push_back(ray);
    }
  }
  return frames;
}

struct PickTimes {
  std::vector<double> update, first_ray, update_and_first_ray, further_ray;
};

template <class Update>
PickTimes pick(const std::vector<PickFrame>& frames, const Collider& collider, const Settings& settings,
               const Update& update, std::vector<double>& hits) {
  PickTimes times;
  const RayQuery query;
  timed(settings, [&] {
    hits.clear();
    for (const PickFrame& frame : frames) {
      times.update.push_back(seconds_of([&] { update(frame.pose); }));
      RayHit hit;
      const auto take = [&] { hits.push_back(hit.first ? hit.first->t : std::numeric_limits<double>::infinity()); };
      times.first_ray.push_back(seconds_of([&] { hit = query.run(collider, frame.rays[0]); }));
      times.update_and_first_ray.push_back(times.update.back() + times.first_ray.back());
      take();
      for (std::size_t i = 1; i < frame.rays.size(); ++i) {
        times.further_ray.push_back(seconds_of([&] { hit = query.run(collider, frame.rays[i]); }));
        take();
      }
    }
  });
  return times;
}

Result pick_result(const std::string& item, const Input& input, const PickTimes& times, const SphereTree& tree) {
  Result result{.scenario = "skinned-pick", .item = item, .mesh = input.name};
  result.seconds = times.update_and_first_ray;
  result.figures = {{"us update", 1e6 * median(times.update)},
                    {"us first ray", 1e6 * median(times.first_ray)},
                    {"us further ray", 1e6 * median(times.further_ray)},
                    {"spheres", static_cast<double>(tree.node_count())}};
  return result;
}

}  // namespace

std::vector<Result> run_skinned_pick(const Input& input, const Settings& settings) {
  const Mesh& mesh = input.mesh;
  const Skin skin = row_of_bones(mesh);
  // Many compact leaves: a ray computes the vertices of all facets of those that it comes to.
  BuildOptions options = tree_options(settings);
  options.branching = 12;
  if (settings.methods.size() != 1) options.method = Method::octree;
  const CoveredTree model = build(mesh, options, *settings.workers);
  Body skinned(mesh, model, {.rules = {Rule::skinned}, .skin = skin}, *settings.workers);
  Body exact(mesh, model, {.rules = {Rule::exact}}, *settings.workers);
  const Collider of_skinned(mesh, skinned), of_exact(mesh, exact);
  const std::vector<PickFrame> frames = frames_of(mesh, skin);
  std::vector<Vec3> moved(mesh.vertex_count());

  std::vector<double> hits, hits_exact;
  const PickTimes lazy = pick(
      frames, of_skinned, settings, [&](const auto& pose) { require(skinned.update_skinned(pose)); }, hits);
  const PickTimes full = pick(
      frames, of_exact, settings,
      [&](const auto& pose) {
        move_by_skin(skin, mesh.positions, pose, moved);
        require(exact.update(moved));
      },
      hits_exact);

  Result result = pick_result("skinned, vertices on demand", input, lazy, model.tree);
  Result peer = pick_result("all vertices skinned, exact", input, full, model.tree);
  std::size_t wrong = 0, judged = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    move_by_skin(skin, mesh.positions, frames[f].pose, moved);
    for (std::size_t i = 0; i < rays_per_frame; i += 8) {
      const auto [first, nearest_edge] = first_by_brute_force(mesh, moved, frames[f].rays[i]);
      if (nearest_edge < 1e-9) continue;
      ++judged;
      const double found = hits[f * rays_per_frame + i];
      wrong += std::isfinite(first) ? !(std::abs(found - first) <= 1e-9) : std::isfinite(found);
    }
  }
  result.expect(wrong == 0 && judged > 0, "a first hit is not that of brute force");
  result.expect(hits == hits_exact, "other hits than over all skinned vertices");
  result.figures.push_back(
      {"full update and ray / first ray", median(full.update_and_first_ray) / median(lazy.first_ray)});
  result.figures.push_back({"full / on demand, update and first ray",
                            median(full.update_and_first_ray) / median(lazy.update_and_first_ray)});
  result.figures.push_back({"rays judged", static_cast<double>(judged)});
  return {result, peer};
}

}  // namespace morula::bench
