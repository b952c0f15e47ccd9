// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "quadruped.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <morula/geometry/rigid_transform.hpp>
#include <support/numbers.hpp>
#include <utility>

namespace morula::test {
namespace {

struct Bone {
  Vec3 from, to;
  std::size_t parent;
  double radius;
};

// Chains of bones: torso, neck and head, tail, legs; x is forward, z up.
std::vector<std::vector<Bone>> chains() {
  std::vector<std::vector<Bone>> result;
  std::size_t count = 0;
  const auto add = [&](std::size_t parent, const std::vector<Vec3>& joints, double thick, double thin) {
    std::vector<Bone>& chain = result.emplace_back();
    for (std::size_t i = 0; i + 1 < joints.size(); ++i) {
      const double along = static_cast<double>(i) / static_cast<double>(joints.size() - 1);
      chain.push_back({joints[i], joints[i + 1], i == 0 ? parent : count - 1, thick + (thin - thick) * along});
      ++count;
    }
  };
  add(0, {{-0.8, 0, 1}, {-0.4, 0, 1.02}, {0, 0, 1.04}, {0.4, 0, 1.02}, {0.8, 0, 1}}, 0.28, 0.26);  // bones 0 … 3
  add(3, {{0.8, 0, 1.1}, {1.0, 0, 1.3}, {1.2, 0, 1.5}, {1.55, 0, 1.45}}, 0.16, 0.14);              // 4 … 6
  add(0, {{-0.8, 0, 1.1}, {-1.05, 0, 1.1}, {-1.3, 0, 1.05}, {-1.55, 0, 0.95}, {-1.8, 0, 0.8}, {-2, 0, 0.6}}, 0.08,
      0.04);  // 7 … 11
  for (const double x : {-0.65, 0.65})
    for (const double y : {-0.2, 0.2})
      add(x < 0 ? 0 : 3, {{x, y, 0.95}, {x + 0.08, y, 0.55}, {x - 0.05, y, 0.2}, {x + 0.1, y, 0.05}}, 0.13, 0.07);
  return result;
}

// A tube around a chain, closed by a vertex at each end.
void add_tube(const std::vector<Bone>& chain, int around, Mesh& mesh) {
  std::vector<Vec3> middles;
  std::vector<double> radii;
  for (std::size_t b = 0; b < chain.size(); ++b) {
    const double step = 2 * pi * chain[b].radius / around;
    const int rings = std::max(2, static_cast<int>(length(chain[b].to - chain[b].from) / step));
    const double next = b + 1 < chain.size() ? chain[b + 1].radius : 0.8 * chain[b].radius;
    for (int k = b == 0 ? 0 : 1; k <= rings; ++k) {
      const double along = static_cast<double>(k) / rings;
      middles.push_back(chain[b].from + (chain[b].to - chain[b].from) * along);
      radii.push_back(chain[b].radius + (next - chain[b].radius) * along);
    }
  }
  const auto first = static_cast<std::uint32_t>(mesh.positions.size()), n = static_cast<std::uint32_t>(around);
  const auto rings = static_cast<std::uint32_t>(middles.size());
  for (std::uint32_t r = 0; r < rings; ++r) {
    const Vec3 ahead = normalized(middles[std::min(r + 1, rings - 1)] - middles[r == 0 ? 0 : r - 1]);
    const Vec3 side = normalized(cross(ahead, Vec3{0.1, 1, 0.2})), up = cross(side, ahead);
    for (std::uint32_t k = 0; k < n; ++k) {
      const double angle = 2 * pi * k / around;
      mesh.positions.push_back(middles[r] + (side * std::cos(angle) + up * std::sin(angle)) * radii[r]);
    }
  }
  for (std::uint32_t r = 0; r + 1 < rings; ++r)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = first + r * n + k, b = first + r * n + (k + 1) % n;
      mesh.facets.push_back({a, b, b + n});
      mesh.facets.push_back({a, b + n, a + n});
    }
  const std::uint32_t last = first + (rings - 1) * n, start = first + rings * n;
  mesh.positions.push_back(middles.front());
  mesh.positions.push_back(middles.back());
  for (std::uint32_t k = 0; k < n; ++k) {
    mesh.facets.push_back({start, first + (k + 1) % n, first + k});
    mesh.facets.push_back({start + 1, last + k, last + (k + 1) % n});
  }
}

double distance_to(const Bone& bone, const Vec3& p) {
  const Vec3 along = bone.to - bone.from;
  const double t = std::clamp(dot(p - bone.from, along) / squared_length(along), 0.0, 1.0);
  return distance(p, bone.from + along * t);
}

// The four bones nearest to each vertex, which blend smoothly.
Skin skin_of(const Mesh& mesh, const std::vector<Bone>& bones) {
  Skin skin{.bone_count = bones.size(), .begin = {0}};
  for (const Vec3& p : mesh.positions) {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (std::uint32_t b = 0; b < bones.size(); ++b)
      near.emplace_back(std::max(0.02, distance_to(bones[b], p) - 0.5 * bones[b].radius), b);
    std::sort(near.begin(), near.end());
    double sum = 0;
    for (std::size_t k = 0; k < 4; ++k) sum += std::pow(near[k].first, -4);
    for (std::size_t k = 0; k < 4; ++k) {
      skin.bones.push_back(near[k].second);
      skin.weights.push_back(std::pow(near[k].first, -4) / sum);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

AffineTransform turn_about(const Vec3& pivot, const Vec3& axis, double angle) {
  const RigidTransform turn = RigidTransform::from_axis(axis, angle, {});
  AffineTransform result;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      result.columns[static_cast<std::size_t>(column)][row] = turn.rows[row][column];
  result.translation = pivot - result.linear(pivot);
  return result;
}

}  // namespace

Quadruped quadruped(int around) {
  Quadruped result;
  std::vector<Bone> bones;
  for (const std::vector<Bone>& chain : chains()) {
    add_tube(chain, around, result.mesh);
    bones.insert(bones.end(), chain.begin(), chain.end());
  }
  for (const Bone& bone : bones) result.pivots.push_back(bone.from), result.parents.push_back(bone.parent);
  result.skin = skin_of(result.mesh, bones);
  return result;
}

std::vector<AffineTransform> Quadruped::gait(double phase, double swing) const {
  std::vector<AffineTransform> transforms(pivots.size());
  for (std::size_t b = 0; b < pivots.size(); ++b) {
    const bool is_leg = b >= 12;
    const double at =
        2 * pi * (phase + 0.31 * static_cast<double>(is_leg ? b / 3 : b)) + 1.3 * static_cast<double>(b % 3);
    const Vec3 axis = is_leg || b % 2 == 0 ? Vec3{0.1, 1, 0} : Vec3{0, 0.2, 1};
    const double angle = (is_leg ? 1.0 : b < 4 ? 0.25 : 0.6) * swing * std::sin(at);
    const AffineTransform turn = turn_about(pivots[b], axis, angle);
    transforms[b] = b == 0 ? turn : transforms[parents[b]] * turn;
  }
  return transforms;
}

}  // namespace morula::test
