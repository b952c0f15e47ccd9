// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "placed_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

namespace morula::test {
namespace {

double point_segment(const Vec3& x, const Vec3& p, const Vec3& q) {
  const Vec3 d = q - p;
  const double square = dot(d, d), s = square > 0 ? std::clamp(dot(x - p, d) / square, 0.0, 1.0) : 0.0;
  return distance(x, p + d * s);
}

// Ends against the other segment, and the common perpendicular where it meets both.
double segment_segment(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  double best =
      std::min({point_segment(p, r, s), point_segment(q, r, s), point_segment(r, p, q), point_segment(s, p, q)});
  // In more digits: between nearly parallel segments most of a double's are lost.
  using Wide = Vector3<long double>;
  const Wide d = Wide(q) - Wide(p), e = Wide(s) - Wide(r), w = Wide(r) - Wide(p), n = cross(d, e);
  const long double square = dot(n, n);
  if (square > 0) {
    const long double t = dot(cross(w, e), n) / square, u = dot(cross(w, d), n) / square;
    if (t >= 0 && t <= 1 && u >= 0 && u <= 1) best = std::min(best, static_cast<double>(length(w + e * u - d * t)));
  }
  return best;
}

bool goes_through(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 n = area_vector(t);
  const double hp = dot(n, p - t[0]), hq = dot(n, q - t[0]);
  if (!(hp * hq < 0)) return false;
  const Vec3 x = p + (q - p) * (hp / (hp - hq));
  for (int k = 0; k < 3; ++k)
    if (dot(n, cross(t[(k + 1) % 3] - t[k], x - t[k])) < 0) return false;
  return true;
}

}  // namespace

PlacedBody::PlacedBody(Mesh m, int depth)
    : mesh(std::move(m)),
      model(build(mesh, {.method = Method::octree, .branching = 8, .depth = depth})),
      body(mesh, model),
      positions(mesh.positions),
      collider(mesh, body) {}

void PlacedBody::deform(std::vector<Vec3> moved) {
  positions = std::move(moved);
  if (!body.update(positions)) throw std::logic_error("a test deforms beyond what bodies take");
  collider.set_positions(positions);
}

std::vector<std::unique_ptr<PlacedBody>>& placed_bodies() {
  static std::vector<std::unique_ptr<PlacedBody>> bodies = [] {
    std::vector<std::unique_ptr<PlacedBody>> made;
    const auto add = [&](const char* name, Mesh mesh) {
      made.push_back(std::make_unique<PlacedBody>(std::move(mesh)));
      made.back()->name = name;
    };
    add("limb", sample_body("limb", 14));
    add("torus", sample_body("torus", 14));
    add("box", box_mesh({-1, -0.7, -0.4}, {1, 0.7, 0.4}, 4));
    add("plate", grid_plate(9, 2.0, 1.5));
    add("soup", scaled(facet_soup(120, 3), 2.0));
    return made;
  }();
  return bodies;
}

std::vector<Vec3> rippled(const std::vector<Vec3>& positions, double amount, std::uint64_t seed) {
  Random random(seed);
  const Vec3 wave = random_point(random, 2.0), phase = random_point(random, 3.0), tilt = random_point(random, amount);
  std::vector<Vec3> moved = positions;
  for (Vec3& p : moved) {
    const double angle = dot(wave, p);
    p += amount * Vec3{std::sin(angle + phase.x), std::sin(angle + phase.y), std::sin(angle + phase.z)} + tilt * p.x;
  }
  return moved;
}

double slow_segment_distance(const Vec3& p, const Vec3& q, const Triangle& t) {
  if (goes_through(p, q, t)) return 0;
  double best = std::sqrt(std::min(closest_point(t, p).squared_distance, closest_point(t, q).squared_distance));
  for (int k = 0; k < 3; ++k) best = std::min(best, segment_segment(p, q, t[k], t[(k + 1) % 3]));
  return best;
}

double slow_distance(const Triangle& a, const Triangle& b) {
  double best = infinity;
  for (int k = 0; k < 3; ++k) {
    best = std::min(best, slow_segment_distance(a[k], a[(k + 1) % 3], b));
    best = std::min(best, slow_segment_distance(b[k], b[(k + 1) % 3], a));
  }
  return best;
}

double slow_distance(const Collider& a, const Collider& b) {
  double best = infinity;
  const auto count_a = static_cast<std::uint32_t>(a.mesh_facets().size());
  const auto count_b = static_cast<std::uint32_t>(b.mesh_facets().size());
  std::vector<Triangle> others;
  for (std::uint32_t f = 0; f < count_b; ++f) others.push_back(b.triangle(f));
  for (std::uint32_t f = 0; f < count_a && best > 0; ++f) {
    const Triangle t = a.triangle(f);
    // Far pairs are left out by their boxes alone.
    const Vec3 lower = min(min(t[0], t[1]), t[2]), upper = max(max(t[0], t[1]), t[2]);
    for (const Triangle& u : others) {
      const Vec3 gap = max(max(min(min(u[0], u[1]), u[2]) - upper, lower - max(max(u[0], u[1]), u[2])), Vec3{0, 0, 0});
      if (length(gap) <= best) best = std::min(best, slow_distance(t, u));
    }
  }
  return best;
}

double slow_winding(const Collider& body, const Vec3& p) {
  double sum = 0;
  for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f) sum += solid_angle(body.triangle(f), p);
  return sum / (4 * std::numbers::pi);
}

double largest_coordinate(const Collider& body) {
  double largest = 0;
  for (const Facet& f : body.mesh_facets())
    for (const std::uint32_t v : f) largest = std::max(largest, max_norm(body.vertex(v)));
  return largest;
}

}  // namespace morula::test
