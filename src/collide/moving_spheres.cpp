// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <morula/collide/moving_spheres.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <stdexcept>

#include "collide/pairs/placed_spheres.hpp"
#include "collide/require.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

Status usable(const Collider& body) {
  if (const Status status = status_of(body, 0, {}); !status) return status;
  if (!(max_norm(body.transform().translation) < 0x1p200)) return {Status::Code::transform_too_far};
  return {};
}

void copy_placed(const Collider& body, std::vector<Sphere>& spheres) {
  const PlacedSpheres placed(body);
  spheres.resize(body.tree().node_count());
  for (std::uint32_t node = 0; node < spheres.size(); ++node) spheres[node] = placed(node);
}

// What the sphere between two ends is padded by.
//
// Let u = 2^-53, A a bound of the |coordinates| of both centers, R the larger radius. The center c0 + t (c1 - c0) is
// off by 2 u A for the difference, as much for the product, and by u A for the sum: below 5.1 u A per coordinate, as a
// length below 8.9 u A. Vertices that are computed in this way are off by as much: their coordinates are at most A + R.
// The radius is off by 3.1 u R. Together below 17.8 u A + 12 u R; allowed 2^-47 (A + R) = 64 u (A + R). Products that
// underflow are off by 2^-1074 each, for which 2^-1000 is allowed.
double pad_of(const Sphere& a, const Sphere& b) {
  const double largest = std::max(max_norm(a.center), max_norm(b.center)) + std::max(a.radius, b.radius);
  // mutant moving-rounding: `0x1p-47 *` -> `0 *`
  return 0x1p-47 * largest + 0x1p-1000;
}

}  // namespace

Status MovingSpheres::set_start(const Collider& body) {
  const StandardFloats standard;
  if (const Status status = usable(body); !status) return status;
  // Allocation may throw: the old spheres are still whole then.
  end_.reserve(body.tree().node_count());
  start_.reserve(body.tree().node_count());
  copy_placed(body, start_);
  end_ = start_;
  tree_ = &body.tree();
  kept_ = body.sphere_state().shared.lock();
  cover_id_ = body.sphere_state().cover_id;
  start_covers_ = end_covers_ = body.sphere_state().covers;
  wider_ = 0;
  return {};
}

Status MovingSpheres::set_end(const Collider& body) {
  const StandardFloats standard;
  if (const Status status = usable(body); !status) return status;
  if (start_.empty() || body.sphere_state().cover_id != cover_id_ || body.tree().node_count() != start_.size())
    return {Status::Code::other_bodies};
  copy_placed(body, end_);
  end_covers_ = body.sphere_state().covers;
  return {};
}

void MovingSpheres::advance() {
  start_ = end_;
  start_covers_ = end_covers_;
  wider_ = 0;
}

void MovingSpheres::widen(double length) {
  if (!(length >= 0 && std::isfinite(length)))
    throw std::invalid_argument("the length to widen spheres by is not a finite number of at least 0");
  wider_ += length;
}

Sphere MovingSpheres::sphere(std::uint32_t node, double t) const {
  const StandardFloats standard;
  const Sphere &a = start_[node], &b = end_[node];
  t = std::clamp(t, 0.0, 1.0);
  return {a.center + t * (b.center - a.center), a.radius + t * (b.radius - a.radius) + pad_of(a, b) + wider_};
}

// Both contain the spheres of both ends with twice the pad of sphere(), and so, being convex, those of all times: these
// are off by less than a pad. The other pad is for the rounding here.
Sphere MovingSpheres::swept_sphere(std::uint32_t node) const {
  const StandardFloats standard;
  const std::array<Sphere, 2> ends{start_[node], end_[node]};
  Sphere around = enclosing_sphere_of_spheres(ends);
  // mutant swept-rounding: `4 *` -> `0 *`
  around.radius += 4 * pad_of(ends[0], ends[1]) + wider_;
  return around;
}

Box MovingSpheres::swept_box(std::uint32_t node) const {
  const StandardFloats standard;
  const Sphere &a = start_[node], &b = end_[node];
  Box box;
  for (const Sphere& s : {a, b}) {
    const double r = s.radius + 4 * pad_of(a, b) + wider_;
    box.add(s.center - Vec3{r, r, r});
    box.add(s.center + Vec3{r, r, r});
  }
  return box;
}

double arc_deviation(std::span<const double> angles, std::span<const double> reaches) {
  const StandardFloats standard;
  if (angles.size() != reaches.size())
    throw std::invalid_argument(std::to_string(angles.size()) + " angles and " + std::to_string(reaches.size()) +
                                " reaches: there is one of each per joint");
  for (const std::span<const double> list : {angles, reaches})
    for (const double x : list)
      if (!(x >= 0 && std::isfinite(x)))
        throw std::invalid_argument("an angle or a reach is not a finite number of at least 0");
  // Entry j: the sum over pairs of joints of which j is the deeper one.
  double above = 0, sum = 0;
  for (std::size_t j = 0; j < angles.size(); ++j) {
    sum += angles[j] * (2 * above + angles[j]) * reaches[j];
    above += angles[j];
  }
  // The distance of a function from its chord is at most max |x''| t (1 - t) / 2.
  return sum / 8 * (1 + 0x1p-40);
}

}  // namespace morula
