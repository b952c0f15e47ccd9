// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "motions.hpp"

#include <morula/geometry/rigid_transform.hpp>
#include <numbers>

#include "shapes.hpp"

namespace morula::properties {
namespace {

Box box_of(const Positions& positions, const std::vector<bool>& used) {
  Box box;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (used[i]) box.add(positions[i]);
  return box;
}

Vec3 any_direction(Dice& dice) {
  if (dice.chance(0.5)) return dice.pick<Vec3>({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  return normalized(Vec3{dice.uniform(-1, 1), dice.uniform(-1, 1), dice.uniform(-1, 1)});
}

std::size_t any_used(const std::vector<bool>& used, Dice& dice) {
  for (;;)
    if (const std::size_t i = dice.below(used.size()); used[i]) return i;
}

struct Turn {
  double cosine, sine;
  explicit Turn(double angle) : cosine(std::cos(angle)), sine(std::sin(angle)) {}
};

// Motions in the body's own box: `at` is 0…1 along the axis.
template <class Move>
void along(Positions& positions, const Box& box, int axis, const Move& move) {
  const double extent = box.extent()[axis];
  for (Vec3& p : positions) {
    const double t = extent > 0 ? (p[axis] - box.lower[axis]) / extent : 0;
    move(p, t);
  }
}

void stretch(Positions& positions, const Box& box, Dice& dice) {
  const int axis = dice.between(0, 2);
  const double factor = dice.pick({2.0, 2.0, 4.0, 0.5, 0.25, 1.5});
  const bool keeps_volume = dice.chance(0.5);
  const Vec3 middle = box.center();
  for (Vec3& p : positions)
    for (int k = 0; k < 3; ++k)
      p[k] = middle[k] + (p[k] - middle[k]) * (k == axis ? factor : keeps_volume ? 1 / std::sqrt(factor) : 1);
}

void twist(Positions& positions, const Box& box, Dice& dice) {
  const int axis = dice.between(0, 2), u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double degrees = dice.pick({90.0, 180.0, 360.0, 720.0, 37.0});
  const Vec3 middle = box.center();
  along(positions, box, axis, [&](Vec3& p, double t) {
    const Turn turn(t * degrees * std::numbers::pi / 180);
    const double x = p[u] - middle[u], y = p[v] - middle[v];
    p[u] = middle[u] + turn.cosine * x - turn.sine * y;
    p[v] = middle[v] + turn.sine * x + turn.cosine * y;
  });
}

void bend(Positions& positions, const Box& box, Dice& dice) {
  const int axis = dice.between(0, 2), u = (axis + 1) % 3;
  const double angle = dice.pick({45.0, 90.0, 180.0, 300.0}) * std::numbers::pi / 180;
  const double radius = std::max(box.extent()[axis], box.diagonal() * 1e-3) / angle;
  along(positions, box, axis, [&](Vec3& p, double t) {
    const Turn turn((t - 0.5) * angle);
    const double from_axis = radius + box.center()[u] - p[u];
    p[u] = box.center()[u] + radius - turn.cosine * from_axis;
    p[axis] = box.center()[axis] + turn.sine * from_axis;
  });
}

void shear(Positions& positions, const Box& box, Dice& dice) {
  const int axis = dice.between(0, 2), u = (axis + dice.between(1, 2)) % 3;
  const double amount = dice.pick({0.5, 1.0, -1.0, 10.0});
  for (Vec3& p : positions) p[u] += amount * (p[axis] - box.center()[axis]);
}

void relocate_vertex(Positions& positions, const Box& box, const std::vector<bool>& used, Dice& dice) {
  const double far = box.diagonal() * dice.pick({1.0, 10.0, 1e3, 1e6});
  const std::size_t vertex = any_used(used, dice);
  if (dice.chance(0.3))
    positions[vertex] = positions[any_used(used, dice)];
  else {
    const Vec3 direction = any_direction(dice);
    positions[vertex] += direction * (dice.sign() * far);
  }
}

void exchange(Positions& positions, const std::vector<bool>& used, Dice& dice) {
  for (int i = dice.between(1, 5); i > 0; --i)
    std::swap(positions[any_used(used, dice)], positions[any_used(used, dice)]);
}

void mirror(Positions& positions, const Box& box, Dice& dice) {
  const int axis = dice.between(0, 2);
  const double plane = dice.chance(0.5) ? box.center()[axis] : box.lower[axis];
  const bool fold = dice.chance(0.5);  // one half onto the other
  for (Vec3& p : positions)
    if (!fold || p[axis] > plane) p[axis] = 2 * plane - p[axis];
}

const char* move(Positions& positions, const std::vector<bool>& used, Dice& dice) {
  const Box box = box_of(positions, used);
  switch (dice.below(17)) {
    case 0:
      return "at rest";
    case 1:
      stretch(positions, box, dice);
      return "stretched";
    case 2:
      stretch(positions, box, dice);
      return "stretched";
    case 3:
      twist(positions, box, dice);
      return "twisted";
    case 4:
      bend(positions, box, dice);
      return "bent";
    case 5:
      shear(positions, box, dice);
      return "sheared";
    case 6:
      jitter(positions, used, dice, dice.logarithmic(1e-8, 1));
      return "noise";
    case 7:
      collapse(positions, used, dice);
      return "collapsed";
    case 8:
      relocate_vertex(positions, box, used, dice);
      return "a vertex teleported";
    case 9:
      relocate_vertex(positions, box, used, dice);
      return "a vertex teleported";
    case 10:
      scale(positions, dice.pick({1e3, 1e-3, 2.0, 0.5}));
      return "scaled";
    case 11: {
      const Vec3 direction = any_direction(dice);
      shift(positions, direction * dice.pick({1e9, 1e9, 1e4, 1.0}));
      return "shifted";
    }
    case 12:
      turn(positions, dice);
      return "turned";
    case 13:
      turn_part(positions, used, dice);
      return "a part turned";
    case 14:
      exchange(positions, used, dice);
      return "vertices exchanged";
    case 15:
      mirror(positions, box, dice);
      return "mirrored";
    default:
      snap(positions, used, dice);
      return "on a lattice";
  }
}

void keep_unused(const Mesh& rest, const std::vector<bool>& used, Positions& positions) {
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!used[i]) positions[i] = rest.positions[i];
}

}  // namespace

void collapse(Positions& positions, const std::vector<bool>& used, Dice& dice) {
  const Vec3 through = positions[any_used(used, dice)];
  const Vec3 n = any_direction(dice);
  const std::size_t kind = dice.below(4);
  for (Vec3& p : positions) {
    const Vec3 d = p - through;
    if (kind == 0)
      p = through;
    else if (kind == 1)
      p = through + dot(d, n) * n;
    else
      p = through + (d - dot(d, n) * n);
  }
}

void scale(Positions& positions, double factor) {
  for (Vec3& p : positions) p *= factor;
}

void shift(Positions& positions, const Vec3& by) {
  for (Vec3& p : positions) p += by;
}

void turn(Positions& positions, Dice& dice) {
  const double angle = dice.chance(0.3) ? std::numbers::pi / 2 : dice.uniform(-3.2, 3.2);
  const RigidTransform t = RigidTransform::from_axis(any_direction(dice), angle);
  for (Vec3& p : positions) p = t(p);
}

void turn_part(Positions& positions, const std::vector<bool>& used, Dice& dice) {
  const Box box = box_of(positions, used);
  const Vec3 n = any_direction(dice);
  const double plane = dot(n, box.center());
  const RigidTransform t = RigidTransform::from_axis(any_direction(dice), dice.uniform(-3.2, 3.2));
  for (Vec3& p : positions)
    if (dot(n, p) > plane) p = box.center() + t(p - box.center());
}

void jitter(Positions& positions, const std::vector<bool>& used, Dice& dice, double share) {
  const double amplitude = share * box_of(positions, used).diagonal();
  for (Vec3& p : positions)
    p += Vec3{dice.uniform(-amplitude, amplitude), dice.uniform(-amplitude, amplitude),
              dice.uniform(-amplitude, amplitude)};
}

void snap(Positions& positions, const std::vector<bool>& used, Dice& dice) {
  const double size = box_of(positions, used).diagonal();
  if (!(size > 0)) return;
  const double step = std::exp2(std::floor(std::log2(size)) - dice.pick({2.0, 3.0, 4.0, 8.0}));
  for (Vec3& p : positions)
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] / step) * step;
}

Pose random_pose(const Mesh& rest, Dice& dice) {
  const std::vector<bool> used = used_vertices(rest);
  Pose pose{"", rest.positions};
  pose.name = move(pose.positions, used, dice);
  if (dice.chance(0.25)) pose.name += std::string(" and ") + move(pose.positions, used, dice);
  keep_unused(rest, used, pose.positions);
  return pose;
}

Pose partial_pose(const Mesh& rest, const Positions& before, Dice& dice, std::vector<VertexRange>& moved) {
  const std::vector<bool> used = used_vertices(rest);
  // Something else there, or a little of the same.
  Pose whole{"noise", before};
  if (dice.chance(0.5))
    whole = random_pose(rest, dice);
  else
    jitter(whole.positions, used, dice, dice.logarithmic(1e-9, 0.5));
  keep_unused(rest, used, whole.positions);
  const auto count = static_cast<std::uint32_t>(rest.vertex_count());
  Pose pose{whole.name + " in part", before};
  moved.clear();
  for (int i = dice.between(0, 3); i >= 0; --i) {
    const auto begin = static_cast<std::uint32_t>(dice.below(count + 1));
    const auto most = std::min<std::uint32_t>(count - begin, dice.chance(0.5) ? 3 : count);
    const auto end = begin + static_cast<std::uint32_t>(dice.below(most + 1));
    moved.push_back({begin, end});
    for (std::uint32_t v = begin; v < end; ++v) pose.positions[v] = whole.positions[v];
  }
  return pose;
}

}  // namespace morula::properties
