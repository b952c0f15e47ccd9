// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "posed_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <stdexcept>
#include <utility>

namespace morula::test {

Skin skin_along_x(const Mesh& mesh, std::size_t bone_count) {
  double lower = mesh.positions[0].x, upper = lower;
  for (const Vec3& p : mesh.positions) lower = std::min(lower, p.x), upper = std::max(upper, p.x);
  Skin skin{.bone_count = bone_count, .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    const double at = (p.x - lower) / (upper - lower) * static_cast<double>(bone_count - 1);
    std::vector<std::pair<double, std::uint32_t>> nearest;
    for (std::uint32_t b = 0; b < bone_count; ++b) nearest.emplace_back(std::abs(at - b), b);
    std::sort(nearest.begin(), nearest.end());
    nearest.resize(std::min<std::size_t>(4, bone_count));
    double sum = 0;
    for (const auto& [away, bone] : nearest) sum += std::exp(-away * away);
    for (const auto& [away, bone] : nearest) {
      skin.bones.push_back(bone);
      skin.weights.push_back(std::exp(-away * away) / sum);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

Transforms random_pose(Random& random, std::size_t bone_count, double amount) {
  Transforms transforms(bone_count);
  for (AffineTransform& t : transforms) {
    const RigidTransform rigid =
        RigidTransform::from_axis(random_point(random, 1), amount * random.uniform(0, 1), random_point(random, amount));
    t.translation = rigid.translation;
    for (int column = 0; column < 3; ++column) {
      const double scale = 1 + amount / 4 * random.uniform(-1, 1);
      for (int row = 0; row < 3; ++row)
        t.columns[static_cast<std::size_t>(column)][row] = scale * rigid.rows[static_cast<std::size_t>(row)][column];
    }
  }
  return transforms;
}

std::vector<Vec3> defined_positions(const Skin& skin, const std::vector<Vec3>& rest, const Transforms& transforms) {
  std::vector<Vec3> moved(rest.size());
  for (std::size_t v = 0; v < rest.size(); ++v)
    for (int axis = 0; axis < 3; ++axis) {
      long double sum = 0, weights = 0;
      for (std::uint32_t k = skin.begin[v + 1]; k-- > skin.begin[v];) {
        const AffineTransform& t = transforms[skin.bones[k]];
        long double image = t.translation[axis];
        for (int column = 0; column < 3; ++column)
          image += static_cast<long double>(t.columns[static_cast<std::size_t>(column)][axis]) * rest[v][column];
        sum += static_cast<long double>(skin.weights[k]) * image;
        weights += skin.weights[k];
      }
      moved[v][axis] = static_cast<double>(sum + (1 - weights) * rest[v][axis]);
    }
  return moved;
}

PosedBody::PosedBody(Mesh m, std::size_t bone_count, int depth)
    : mesh(std::move(m)),
      skin(skin_along_x(mesh, bone_count)),
      model(build(mesh, {.method = Method::octree, .branching = 8, .depth = depth})),
      body(mesh, model, {.rules = {Rule::skinned}, .skin = skin}),
      positions(mesh.positions),
      collider(mesh, body),
      given(mesh, body) {}

void PosedBody::pose(const Transforms& pose) {
  if (!body.update_skinned(pose)) throw std::logic_error("a test poses beyond what bodies take");
  transforms = pose;
  move_by_skin(skin, mesh.positions, transforms, positions);
  given.set_positions(positions);
}

PosedBody& posed_limb() {
  static PosedBody body(sample_body("limb", 14), 24);
  return body;
}

bool same_bits(const PositionView& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t v = 0; v < b.size(); ++v)
    if (const Vec3 p = a[v]; std::memcmp(&p, &b[v], sizeof p) != 0) return false;
  return true;
}

bool same(const SurfacePoint& a, const SurfacePoint& b) {
  return a.facet == b.facet && a.barycentric == b.barycentric && a.point == b.point;
}

bool same(const std::optional<RayPoint>& a, const std::optional<RayPoint>& b) {
  return a.has_value() == b.has_value() && (!a || (a->t == b->t && same(a->point, b->point) && a->normal == b->normal));
}

}  // namespace morula::test
