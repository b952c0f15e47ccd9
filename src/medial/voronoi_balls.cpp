// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/voronoi_balls.hpp"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "medial/delaunay.hpp"

namespace morula::detail {

struct VoronoiBalls::Data {
  Data(const Box& box_, const SignedDistance& shape_)
      : box(box_), shape(shape_), cell(max_norm(box_.extent()) / Delaunay::lattice_size) {
    assert(!box_.is_empty() && is_finite(box_.extent()));
    if (!(cell > 0)) cell = 1;  // one point has any lattice
  }

  bool add(const Vec3& sample);
  void finish();
  void fill(std::uint32_t slot);

  Box box;
  const SignedDistance& shape;
  double cell;
  Delaunay delaunay;
  std::vector<Vec3> samples;
  std::vector<VoronoiBall> balls;
  std::vector<std::uint32_t> removed, created;
  bool changed = false;  // by the call that is under way
};

/// Frees balls; `created` collects slots, to be looked at when all samples are in.
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
    // A ball that stays can only get neighbours that are new, so this keeps both sides up to date.
    const std::array<std::uint32_t, 4>& back = delaunay.slots()[neighbor].neighbors;
    const auto side = static_cast<std::size_t>(std::find(back.begin(), back.end(), slot) - back.begin());
    balls[neighbor].neighbors[side] = slot;
  }
  // Everything from the lattice points, not from the samples: four samples of a plane can be off it by rounding on the
  // lattice, and then have a sphere there, but none of their own.
  const Vec3 offset = delaunay.circumcenter_offset(slot) * cell;
  const LatticePoint& corner = delaunay.points()[t.vertices[0]];
  const Vec3 first = box.lower + cell * Vec3(corner[0], corner[1], corner[2]);
  ball.ball = {first + offset, length(offset)};
  const double reach = box.diagonal();
  ball.distance = squared_distance(box, ball.ball.center) <= reach * reach ? shape(ball.ball.center)
                                                                           : std::numeric_limits<double>::infinity();
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
