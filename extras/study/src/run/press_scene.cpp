// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Press scene: the places of two bodies pressed together, and the true values by triangles there.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <morula/collide/collider.hpp>
#include <morula/collide/distance.hpp>
#include <morula/geometry/inspect.hpp>
#include <numbers>
#include <span>
#include <stdexcept>

#include "run/poses.hpp"
#include "run/press.hpp"

namespace morula::study {
namespace {

/// Lengths are known to this share of the diagonal.
constexpr double precision = 1e-6;

/// The axes, the shortest first; equal ones in order.
std::array<int, 3> axes_by_length(const Vec3& extent) {
  std::array order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return extent[i] < extent[j]; });
  return order;
}

constexpr std::array axes{Axis::x, Axis::y, Axis::z};

/// The body and its copy, which moves.
class Pair {
 public:
  Pair(const Mesh& mesh, const CoveredTree& model, const std::vector<Vec3>& positions)
      : body_(mesh, model, {.rules = {Rule::exact}, .details = {}, .modes = {}}), a_(mesh, body_), b_(mesh, body_) {
    if (!body_.update(positions)) throw std::logic_error("the study's own motion was rejected by update");
    a_.set_positions(positions);
    b_.set_positions(positions);
  }
  const Collider& a() const { return a_; }
  const Collider& b() const { return b_; }

  std::span<const Crossing> crossings(const RigidTransform& transform) {
    b_.set_transform(transform);
    if (const Status status = found_.run(a_, b_); !status) throw std::invalid_argument(message(status));
    return found_.pairs();
  }
  double distance_above(const RigidTransform& transform) {
    b_.set_transform(transform);
    return query_.run(a_, b_).lower;
  }

 private:
  Body body_;
  Collider a_, b_;
  CrossingQuery found_;
  DistanceQuery query_;
};

RigidTransform moved(RigidTransform transform, const Vec3& by) {
  transform.translation += by;
  return transform;
}

/// Moves from `far` along the axis inwards until the bodies touch: never farther than they are proved to be apart, so
/// that no contact is skipped. None when they pass each other, or pass so near that the steps become too small.
std::optional<double> touching_offset(Pair& pair, const RigidTransform& turned, const Vec3& axis, double far,
                                      double diagonal) {
  constexpr int most_steps = 2000;
  double offset = far;
  for (int step = 0; offset > -far && step < most_steps; ++step) {
    const double free = pair.distance_above(moved(turned, offset * axis));
    if (free > 0.1 * precision * diagonal) {
      offset -= free;
      continue;
    }
    const double next = offset - precision * diagonal;
    if (!pair.crossings(moved(turned, next * axis)).empty()) return offset;
    offset = next;
  }
  return std::nullopt;
}

Vec3 facet_normal(const Triangle& t) {
  return normalized(cross(t[1] - t[0], t[2] - t[0]), {0, 0, 0});
}

/// The surface of a inside b has the curve where the surfaces cross as its rim, so its vector area is half the sum of
/// from × to along that curve: exact for any facets.
Vec3 push_direction(const Collider& a, const Collider& b, std::span<const Crossing> crossings, const Vec3& fallback) {
  Vec3 area{};
  const Vec3 origin = crossings.front().segment.from;
  for (const Crossing& c : crossings) {
    const Vec3 along = cross(facet_normal(a.triangle(c.facet_a)), facet_normal(b.triangle(c.facet_b)));
    const Vec3 from = c.segment.from - origin;
    const Vec3 to = c.segment.to - origin;
    const double sense = dot(along, to - from);
    if (sense != 0) area += cross(from, to) * (sense > 0 ? 0.5 : -0.5);
  }
  return normalized(-area, fallback);
}

/// The distance that b has to move along `away` until no facets cross, by bisection; at most `most`.
double way_out(Pair& pair, const RigidTransform& transform, const Vec3& away, double most, double diagonal) {
  double crossing = 0;
  double free = most;
  while (free - crossing > precision * diagonal) {
    const double middle = 0.5 * (crossing + free);
    (pair.crossings(moved(transform, middle * away)).empty() ? free : crossing) = middle;
  }
  return free;
}

/// Empty when the bodies pass each other, or are through each other before the last amount.
std::vector<PressTruth> press_along(const Plan& plan, Pair& pair, const Box& box, int side, double diagonal) {
  Vec3 axis{0, 0, 0};
  axis[side] = 1;
  RigidTransform turned = RigidTransform::from_axis(axis, std::numbers::pi / 2);
  turned.translation = box.center() - turned.rotate(box.center());
  const std::optional<double> touch =
      touching_offset(pair, turned, axis, 1.01 * std::abs(dot(box.extent(), axis)), diagonal);
  if (!touch) return {};
  std::vector<PressTruth> truths;
  for (const double amount : plan.press_amounts) {
    PressTruth truth;
    truth.axis = axes[static_cast<std::size_t>(side)];
    truth.amount = amount;
    truth.transform = moved(turned, (*touch - amount * diagonal) * axis);
    const std::span<const Crossing> found = pair.crossings(truth.transform);
    truth.crossings.assign(found.begin(), found.end());
    if (truth.crossings.empty()) return {};
    truth.normal = push_direction(pair.a(), pair.b(), truth.crossings, -axis);
    truth.depth = way_out(pair, truth.transform, -truth.normal, amount * diagonal, diagonal);
    truths.push_back(std::move(truth));
  }
  return truths;
}

}  // namespace

std::optional<PressScene> make_press(const Plan& plan, std::size_t body, const CoveredTree& model,
                                     std::vector<Skipped>& skipped) {
  const auto& [name_of_body, mesh] = plan.bodies[body];
  if (!inspect(mesh).has_volume()) {
    skipped.push_back({body, fmt::format("{} is not pressed: it has no inside", name_of_body)});
    return std::nullopt;
  }
  const std::vector<Deformations> motions{plan.press_pose};
  const std::vector<double> end{1.0};
  const std::vector<MovedFrames> frames = move_frames(plan, body, motions, end, &skipped);
  if (frames.empty()) return std::nullopt;
  PressScene scene{body, frames.front().frames.front(), bounding_box(mesh).diagonal(), {}};
  Pair pair(mesh, model, scene.positions);

  const Box box = bounding_box({scene.positions, mesh.facets});
  for (const int side : axes_by_length(box.extent())) {
    std::vector<PressTruth> truths = press_along(plan, pair, box, side, scene.diagonal);
    if (truths.empty()) {
      const Axis axis = axes[static_cast<std::size_t>(side)];
      skipped.push_back({body, fmt::format("{} is not pressed along {}", name_of_body, name(axis))});
    }
    std::move(truths.begin(), truths.end(), std::back_inserter(scene.truths));
  }
  if (scene.truths.empty()) return std::nullopt;
  return scene;
}

}  // namespace morula::study
