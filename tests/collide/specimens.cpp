// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "specimens.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/sample_bodies.hpp>

namespace morula::test {
namespace {

Mesh moved_mesh(std::string_view sample, int resolution, double scale, const Vec3& offset) {
  Mesh mesh = sample_body(sample, resolution);
  for (Vec3& p : mesh.positions) p = scale * p + offset;
  return mesh;
}

// Where the segment meets the triangle, if it goes from one side to the other.
bool goes_through(const Vec3& from, const Vec3& to, const Triangle& t, Vec3& point) {
  const Vec3 normal = area_vector(t);
  const double start = dot(normal, from - t[0]), end = dot(normal, to - t[0]);
  if ((start > 0) == (end > 0) || start == end) return false;
  point = from + (to - from) * (start / (start - end));
  for (std::size_t k = 0; k < 3; ++k)
    if (dot(normal, cross(t[(k + 1) % 3] - t[k], point - t[k])) < 0) return false;
  return true;
}

Box box_of(const Triangle& t) {
  Box box;
  for (const Vec3& p : t) box.lower = min(box.lower, p), box.upper = max(box.upper, p);
  return box;
}

}  // namespace

Specimen::Specimen(std::string_view sample, int resolution, const BuildOptions& options, double scale,
                   const Vec3& offset)
    : mesh(moved_mesh(sample, resolution, scale, offset)),
      model(build(mesh, options)),
      body(std::make_unique<Body>(mesh, model)),
      collider(std::make_unique<Collider>(mesh, *body)),
      positions(mesh.positions),
      size(bounding_box(mesh).diagonal()) {}

void Specimen::deform(Random& random, double amplitude) {
  const Vec3 middle = 0.5 * (bounding_box(mesh).lower + bounding_box(mesh).upper);
  Vec3 stretch;
  for (int axis = 0; axis < 3; ++axis) stretch[axis] = 1 + random.uniform(-4, 4) * amplitude;
  for (std::size_t i = 0; i < positions.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      positions[i][axis] = middle[axis] + stretch[axis] * (mesh.positions[i][axis] - middle[axis]) +
                           random.uniform(-1, 1) * amplitude * 0.2 * size;
  EXPECT_TRUE(body->update(positions));
  collider->set_positions(positions);
}

std::vector<Crossing> crossings_by_brute_force(const Collider& a, const Collider& b) {
  const auto triangles = [](const Collider& c) {
    std::vector<Triangle> list;
    for (std::uint32_t f = 0; f < c.mesh_facets().size(); ++f) list.push_back(c.triangle(f));
    return list;
  };
  const std::vector<Triangle> all_a = triangles(a), all_b = triangles(b);
  std::vector<Box> boxes_b;
  for (const Triangle& t : all_b) boxes_b.push_back(box_of(t));
  std::vector<Crossing> found;
  for (std::uint32_t i = 0; i < all_a.size(); ++i) {
    const Box box = box_of(all_a[i]);
    for (std::uint32_t j = 0; j < all_b.size(); ++j) {
      const Box& other = boxes_b[j];
      if (box.lower.x > other.upper.x || other.lower.x > box.upper.x || box.lower.y > other.upper.y ||
          other.lower.y > box.upper.y || box.lower.z > other.upper.z || other.lower.z > box.upper.z)
        continue;
      Vec3 point;
      for (std::size_t k = 0; k < 3; ++k) {
        if (goes_through(all_a[i][k], all_a[i][(k + 1) % 3], all_b[j], point)) found.push_back({i, j, point});
        if (goes_through(all_b[j][k], all_b[j][(k + 1) % 3], all_a[i], point)) found.push_back({i, j, point});
      }
    }
  }
  return found;
}

std::size_t crossings_missed(const std::vector<Crossing>& crossings, const Collider& a, const Collider& b,
                             const std::vector<Contact>& contacts) {
  const auto has = [](const Collider& c, std::uint32_t node, std::uint32_t facet) {
    const auto list = c.facets(node);  // ascending for leaves only
    return std::find(list.begin(), list.end(), facet) != list.end();
  };
  return static_cast<std::size_t>(std::count_if(crossings.begin(), crossings.end(), [&](const Crossing& x) {
    const double coordinate = max_norm(x.point);
    return std::none_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
      return distance(x.point, c.point) <= c.error_bound * (1 + 1e-9) + 1e-14 * coordinate &&
             has(a, c.node_a, x.facet_a) && has(b, c.node_b, x.facet_b);
    });
  }));
}

}  // namespace morula::test
