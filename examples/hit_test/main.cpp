// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A hit test of a skinned character of 20,000 facets: rays through the pixels of a camera find the facet that they hit
// first, and the bone that moves it most, such as that of the head. Only vertices of facets in leaves that a ray
// reaches are posed. Brute force poses all vertices and tests all facets: it must find the same hits.
#include <cstdio>
#include <limits>

#include "../crowd/walker.hpp"

namespace hit_test {
namespace {

using namespace morula;

constexpr std::size_t frames = 8, columns = 16, rows = 24;

/// A camera with an image of columns × rows pixels.
struct Camera {
  Vec3 eye, forward;
  double half_width, half_height;  // of the image at distance 1
  Ray ray(std::size_t column, std::size_t row) const {
    const Vec3 right = normalized(cross(forward, {0, 1, 0})), up = cross(right, forward);
    const double x = (2 * static_cast<double>(column) + 1) / columns - 1;
    const double y = 1 - (2 * static_cast<double>(row) + 1) / rows;
    return {eye, forward + right * (x * half_width) + up * (y * half_height)};
  }
};

/// The bone with the largest weight at a point of the surface.
std::uint32_t bone_at(const Mesh& mesh, const Skin& skin, const SurfacePoint& point) {
  std::vector<double> weights(skin.bone_count);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t v = mesh.facets[point.facet][k];
    for (std::uint32_t i = skin.begin[v]; i < skin.begin[v + 1]; ++i)
      weights[skin.bones[i]] += point.barycentric[k] * skin.weights[i];
  }
  return static_cast<std::uint32_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
}

struct SlowHit {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t facet = 0;
  bool is_close = false;  ///< the ray passes so near to an edge that rounding may decide
};
/// The first hit by a test of all facets.
SlowHit slow_first_hit(const std::vector<Facet>& facets, const std::vector<Vec3>& positions, const Ray& ray) {
  SlowHit hit;
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const Vec3 a = positions[facets[f][0]] - ray.origin, b = positions[facets[f][1]] - ray.origin,
               c = positions[facets[f][2]] - ray.origin;
    // Where the ray meets the plane, the barycentric coordinates are these numbers over their sum.
    const double of_a = dot(ray.direction, cross(b, c)), of_b = dot(ray.direction, cross(c, a)),
                 of_c = dot(ray.direction, cross(a, b)), sum = of_a + of_b + of_c;
    if (sum == 0) continue;
    const double least = std::min({of_a / sum, of_b / sum, of_c / sum}), t = dot(a, cross(b, c)) / sum;
    if (t < 0) continue;
    hit.is_close = hit.is_close || std::abs(least) < 1e-6;
    if (least >= 0 && t < hit.t) hit.t = t, hit.facet = f;
  }
  return hit;
}

/// Compares hits with those of brute force over all posed vertices.
class Check {
 public:
  explicit Check(const crowd::Walker& walker) : walker_(walker), posed_(walker.mesh.vertex_count()) {}

  void pose(std::span<const AffineTransform> bones, const RigidTransform& to_world) {
    move_by_skin(walker_.skin, walker_.mesh.positions, bones, posed_);
    for (Vec3& p : posed_) p = to_world(p);
  }
  void compare(const RayHit& hit, const Ray& ray) {
    ++rays, hits += hit.first ? 1 : 0, facet_tests += hit.facet_tests;
    const SlowHit expected = slow_first_hit(walker_.mesh.facets, posed_, ray);
    const bool same = hit.first ? hit.first->point.facet == expected.facet && std::abs(hit.first->t - expected.t) < 1e-9
                                : !std::isfinite(expected.t);
    ++(expected.is_close ? close : same && hit.certified ? equal : different);
  }

  std::size_t rays = 0, hits = 0, facet_tests = 0, equal = 0, different = 0, close = 0;

 private:
  const crowd::Walker& walker_;
  std::vector<Vec3> posed_;
};

int run() {
  const crowd::Walker hero(40, 42);
  const Camera camera{{0, 1.3, 6}, {0, 0, -1}, 0.2, 0.24};
  const RigidTransform to_world = RigidTransform::from_axis({0, 1, 0}, 0.7, {0.2, 0, 0.1});
  std::vector<std::size_t> hits_of_bone(hero.skin.bone_count);
  std::vector<AffineTransform> bones;
  Check check(hero);
  // [picking]
  const BuildOptions small_leaves{.method = Method::octree, .branching = 12, .depth = 3};
  Body body(hero.mesh, build(hero.mesh, small_leaves), {.rules = {Rule::skinned}, .skin = hero.skin});
  Collider character(hero.mesh, body);  // made once
  for (std::size_t frame = 0; frame < frames; ++frame) {
    hero.pose(0.8 * static_cast<double>(frame), 0.6, bones);
    if (!body.update_skinned(bones)) return 1;  // moves spheres, but no vertex
    character.set_transform(to_world);
    check.pose(bones, to_world);  // not shown
    for (std::size_t pixel = 0; pixel < columns * rows; ++pixel) {
      const Ray ray = camera.ray(pixel % columns, pixel / columns);
      const RayHit hit = first_hit(character, ray);
      if (hit.first) ++hits_of_bone[bone_at(hero.mesh, hero.skin, hit.first->point)];
      check.compare(hit, ray);  // not shown
    }
  }
  // [end]

  const auto of_bones = [&](std::size_t first, std::size_t last) {
    std::size_t sum = 0;
    for (std::size_t b = first; b <= last; ++b) sum += hits_of_bone[b];
    return sum;
  };
  std::printf("%zu facets, %zu bones, %zu frames: %zu rays, %zu hits\n", hero.mesh.facet_count(), hero.skin.bone_count,
              frames, check.rays, check.hits);
  std::printf("head %zu, trunk %zu, arms %zu, legs %zu\n", of_bones(2, 2), of_bones(0, 1), of_bones(3, 6),
              of_bones(7, 10));
  std::printf("facets tested per ray: %.1f\n",
              static_cast<double>(check.facet_tests) / static_cast<double>(check.rays));
  std::printf("brute force: %zu rays equal, %zu differ, %zu pass too near to an edge to compare\n", check.equal,
              check.different, check.close);
  const bool is_local = 50 * check.facet_tests < check.rays * hero.mesh.facet_count();
  const bool is_telling = check.hits > 0 && check.hits < check.rays && 100 * check.close < check.rays;
  return check.different == 0 && is_local && is_telling ? 0 : 1;
}

}  // namespace
}  // namespace hit_test

int main() {
  return hit_test::run();
}
