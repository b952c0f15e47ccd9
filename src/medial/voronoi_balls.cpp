// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/voronoi_balls.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <morula/geometry/mesh_view.hpp>
#include <utility>

#include "medial/delaunay.hpp"

namespace morula::detail {

namespace {

/// Balls without surface in their inside, which therefore lies on one side of the surface: closed surfaces wind round
/// all of its points equally often. The allowance is for rounding.
class EmptyBalls {
 public:
  explicit EmptyBalls(double largest_coordinate) : rounding_(1e-12 * largest_coordinate) {}

  void add(const Vec3& center, double distance) {
    const double radius = std::abs(distance) * (1 - 1e-9) - rounding_;
    if (!(radius > 0)) return;
    x_.push_back(center.x), y_.push_back(center.y), z_.push_back(center.z);
    square_.push_back(radius * radius);
    side_.push_back(distance < 0 ? -1 : 1);
  }
  /// −1: in a ball inside; 1: in one outside; 0: in none.
  int side(const Vec3& p) const {
    constexpr std::size_t some = 32;
    for (std::size_t begin = 0; begin < x_.size(); begin += some) {
      const std::size_t end = std::min(begin + some, x_.size());
      bool any = false;
      for (std::size_t i = begin; i < end; ++i) any |= is_in(i, p);
      for (std::size_t i = begin; any; ++i)
        if (is_in(i, p)) return side_[i];
    }
    return 0;
  }

 private:
  bool is_in(std::size_t i, const Vec3& p) const {
    const double x = x_[i] - p.x, y = y_[i] - p.y, z = z_[i] - p.z;
    return x * x + y * y + z * z < square_[i];
  }

  double rounding_;
  std::vector<double> x_, y_, z_, square_;
  std::vector<std::int8_t> side_;
};

}  // namespace

struct VoronoiBalls::Data {
  Data(const Box& box_, const SignedDistance& shape_)
      : box(box_),
        shape(shape_),
        cell(max_norm(box_.extent()) / Delaunay::lattice_size),
        empty(std::max(largest_coordinate(box_), largest_coordinate(shape_.bvh().bounding_box()))) {
    assert(!box_.is_empty() && is_finite(box_.extent()));
    if (!(cell > 0)) cell = 1;  // any lattice suits a single point
  }

  bool add(const Vec3& sample);
  void finish();
  void fill(std::uint32_t slot);

  // Cached properties of a ball's center.
  struct Known {
    static constexpr std::int8_t unknown = 2;
    std::int8_t side = unknown;
    bool computed = false;  // `closest` is computed
    Closest closest;
  };
  bool is_far(std::uint32_t slot) const {
    const double reach = box.diagonal();
    return !(squared_distance(box, balls[slot].ball.center) <= reach * reach);
  }
  // within: a distance from the center within which surface is proven to be.
  const Closest& compute_closest(std::uint32_t slot, double within = std::numeric_limits<double>::infinity());
  int side(std::uint32_t slot);

  Box box;
  const SignedDistance& shape;
  double cell;
  Delaunay delaunay;
  std::vector<Vec3> samples;
  std::vector<VoronoiBall> balls;
  std::vector<Known> known;  // properties of the balls' centers
  EmptyBalls empty;
  std::vector<std::uint32_t> removed, created;
  bool changed = false;  // changed by the current call
};

/// Frees balls; `created` collects slots, which are read when all samples are in.
bool VoronoiBalls::Data::add(const Vec3& sample) {
  if (!is_finite(sample)) return false;
  LatticePoint point;
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = std::round((sample[axis] - box.lower[axis]) / cell);
    assert(cells >= -1 && cells <= Delaunay::lattice_size + 1.0);
    point[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::clamp(cells, 0.0, double{Delaunay::lattice_size}));
  }
  if (!delaunay.insert(point)) return false;
  if (!std::exchange(changed, true)) {
    removed.clear();
    created.clear();
  }
  samples.push_back(sample);
  balls.resize(delaunay.slots().size());
  known.resize(delaunay.slots().size());
  for (const std::uint32_t slot : delaunay.removed()) {
    if (!balls[slot].alive) continue;
    balls[slot].alive = false;
    removed.push_back(slot);
  }
  created.insert(created.end(), delaunay.created().begin(), delaunay.created().end());
  return true;
}

void VoronoiBalls::Data::finish() {
  if (!std::exchange(changed, false)) return;
  std::erase_if(created, [&](std::uint32_t slot) {
    if (balls[slot].alive || !delaunay.is_alive(slot) || delaunay.is_ghost(slot)) return true;
    balls[slot].alive = true;  // so that a slot filled twice is taken once
    return false;
  });
  for (const std::uint32_t slot : created) fill(slot);
}

void VoronoiBalls::Data::fill(std::uint32_t slot) {
  const Delaunay::Tetrahedron& t = delaunay.slots()[slot];
  VoronoiBall& ball = balls[slot];
  ball.samples = t.vertices;
  for (std::size_t k = 0; k < 4; ++k) {
    const std::uint32_t neighbor = t.neighbors[k];
    ball.neighbors[k] = no_ball;
    if (delaunay.is_ghost(neighbor)) continue;
    ball.neighbors[k] = neighbor;
    // A ball that stays can only get new neighbors, so this keeps both sides up to date.
    const std::array<std::uint32_t, 4>& back = delaunay.slots()[neighbor].neighbors;
    const auto side = static_cast<std::size_t>(std::find(back.begin(), back.end(), slot) - back.begin());
    balls[neighbor].neighbors[side] = slot;
  }
  // All values come from the lattice points, not from the samples: four samples of a plane can be off it by rounding on
  // the lattice, and then have a sphere there, but none of their own.
  const Vec3 offset = delaunay.circumcenter_offset(slot) * cell;
  const LatticePoint& corner = delaunay.points()[t.vertices[0]];
  const Vec3 first = box.lower + cell * Vec3(corner[0], corner[1], corner[2]);
  ball.ball = {first + offset, length(offset)};
  known[slot] = {};
}

const VoronoiBalls::Closest& VoronoiBalls::Data::compute_closest(std::uint32_t slot, double within) {
  assert(balls[slot].alive);
  Known& of = known[slot];
  if (std::exchange(of.computed, true)) return of.closest;
  if (is_far(slot)) {
    of.closest = {std::numeric_limits<double>::infinity(), {}};
  } else {
    const auto& [center, radius] = balls[slot].ball;
    const SignedDistance::Result at = shape.at(center, std::min(radius + cell, within));
    of.closest = {at.distance, at.closest.point};
    if (shape.has_volume()) empty.add(center, at.distance);
  }
  of.side = static_cast<std::int8_t>((of.closest.distance > 0) - (of.closest.distance < 0));
  return of.closest;
}

int VoronoiBalls::Data::side(std::uint32_t slot) {
  assert(balls[slot].alive);
  Known& of = known[slot];
  if (of.side == Known::unknown && !is_far(slot)) {
    if (const int side = empty.side(balls[slot].ball.center); side != 0) of.side = static_cast<std::int8_t>(side);
  }
  if (of.side == Known::unknown) compute_closest(slot);
  return of.side;
}

bool VoronoiBalls::is_far(std::uint32_t slot) const {
  return data_->is_far(slot);
}
const VoronoiBalls::Closest& VoronoiBalls::closest(std::uint32_t slot) const {
  return data_->compute_closest(slot);
}
int VoronoiBalls::side(std::uint32_t slot) const {
  return data_->side(slot);
}
std::optional<VoronoiBalls::Closest> VoronoiBalls::closest_within(std::uint32_t slot, double most) const {
  const Data::Known& of = data_->known[slot];
  if (!of.computed && (data_->is_far(slot) || !data_->shape.bvh().closest_point(data_->balls[slot].ball.center, most)))
    return {};
  const Closest& closest = data_->compute_closest(slot, most);
  return std::abs(closest.distance) <= most ? std::optional(closest) : std::nullopt;
}

VoronoiBalls::VoronoiBalls(const Box& box, const SignedDistance& shape) : data_(std::make_unique<Data>(box, shape)) {}
VoronoiBalls::~VoronoiBalls() = default;

bool VoronoiBalls::insert(const Vec3& sample) {
  return insert(std::span(&sample, 1)) == 1;
}

std::size_t VoronoiBalls::insert(std::span<const Vec3> samples) {
  const std::size_t before = data_->samples.size();
  for (const Vec3& sample : samples) data_->add(sample);
  data_->finish();
  return data_->samples.size() - before;
}

const std::vector<Vec3>& VoronoiBalls::samples() const {
  return data_->samples;
}
const std::vector<VoronoiBall>& VoronoiBalls::balls() const {
  return data_->balls;
}
const std::vector<std::uint32_t>& VoronoiBalls::removed() const {
  return data_->removed;
}
const std::vector<std::uint32_t>& VoronoiBalls::created() const {
  return data_->created;
}

}  // namespace morula::detail
