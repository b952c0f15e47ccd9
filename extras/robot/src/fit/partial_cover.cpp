// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/partial_cover.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/reproducible.hpp>

namespace morula::robot {

namespace {

constexpr std::size_t surface_samples = 3000, bins = 256;
constexpr int cells_along = 34, moves = 16, jumps = 8;
constexpr double margin_share = 0.25;

/// Squared distances of the points from a center.
void squared_distances(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
                       const Vec3& center, std::vector<float>& squares) {
  const auto cx = static_cast<float>(center.x), cy = static_cast<float>(center.y), cz = static_cast<float>(center.z);
  squares.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float a = x[i] - cx, b = y[i] - cy, c = z[i] - cz;
    squares[i] = a * a + b * b + c * c;
  }
}

}  // namespace

void PartialCover::Points::add(const Vec3& p, double amount_of) {
  x.push_back(static_cast<float>(p.x));
  y.push_back(static_cast<float>(p.y));
  z.push_back(static_cast<float>(p.z));
  amount.push_back(static_cast<float>(amount_of));
}

void PartialCover::Points::copy(const Points& from, std::size_t i) {
  x.push_back(from.x[i]);
  y.push_back(from.y[i]);
  z.push_back(from.z[i]);
  amount.push_back(from.amount[i]);
}

void PartialCover::Points::clear() {
  for (std::vector<float>* list : {&x, &y, &z, &amount}) list->clear();
}

PartialCover::PartialCover(const Mesh& mesh, const SignedDistance& object, std::span<const Sphere> start,
                           double tolerance, double most_radius, std::uint64_t seed)
    : spheres_(start.begin(), start.end()), tolerance_(tolerance), most_radius_(most_radius), seed_(seed) {
  sample_surface(mesh);
  sample_space(mesh, object);
  count_all();
}

void PartialCover::sample_surface(const Mesh& mesh) {
  Random random(seed_);
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  middle_ = box.center();
  std::vector<double> areas(mesh.facet_count());
  for (std::size_t f = 0; f < areas.size(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    areas[f] = 0.5 * length(cross(b - a, c - a));
    area_ += areas[f];
  }
  const double step = area_ / surface_samples;
  double end = 0, next = 0.5 * step;
  for (std::size_t f = 0; f < areas.size() && step > 0; ++f) {
    const auto [a, b, c] = mesh.corners(f);
    for (end += areas[f]; next < end; next += step) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      surface_.add(a + u * (b - a) + v * (c - a) - middle_, step);
    }
  }
  // Vertices are the farthest points of many surfaces.
  const std::size_t stride = mesh.positions.size() / surface_samples + 1;
  for (std::size_t i = 0; i < mesh.positions.size(); i += stride) surface_.add(mesh.positions[i] - middle_, 0);
}

/// Cells of a lattice, of which those near the surface are divided into eight; one point at random in each.
void PartialCover::sample_space(const Mesh& mesh, const SignedDistance& object) {
  Random random(seed_ + 1);
  Box box;
  for (const Vec3& p : mesh.positions) box.add(p);
  const Vec3 extent = box.upper - box.lower;
  const double longest = std::max({extent.x, extent.y, extent.z}), margin = margin_share * longest;
  if (!(longest > 0)) return;
  reach_ = 0.5 * box.diagonal() + margin;
  const double cell = (longest + 2 * margin) / cells_along;
  const Vec3 low = box.lower - Vec3{margin, margin, margin};
  const auto add = [&](const Vec3& corner, double side) {
    const Vec3 p = corner + side * Vec3{random.uniform(), random.uniform(), random.uniform()};
    if (object(p) > 0) {
      space_.add(p - middle_, side * side * side);
    } else {
      seats_.push_back(p);
    }
  };
  const auto count = [&](double side) { return static_cast<int>(std::ceil((side + 2 * margin) / cell)); };
  const int nx = count(extent.x), ny = count(extent.y), nz = count(extent.z);
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j)
      for (int k = 0; k < nz; ++k) {
        const Vec3 corner = low + cell * Vec3{1.0 * i, 1.0 * j, 1.0 * k};
        if (std::abs(object(corner + 0.5 * cell * Vec3{1, 1, 1})) > 1.5 * cell) {
          add(corner, cell);
        } else {
          for (int part = 0; part < 8; ++part)
            add(corner + 0.5 * cell * Vec3{1.0 * (part & 1), 1.0 * (part >> 1 & 1), 1.0 * (part >> 2)}, 0.5 * cell);
        }
      }
}

void PartialCover::set_spheres(std::span<const Sphere> spheres) {
  spheres_.assign(spheres.begin(), spheres.end());
  count_all();
}

void PartialCover::set_tolerance(double tolerance) {
  tolerance_ = tolerance;
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    const Vec3 p = Vec3{surface_.x[i], surface_.y[i], surface_.z[i]} + middle_;
    const auto gap = [&](const Sphere& s) { return distance(p, s.center) - s.radius; };
    Sphere& nearest = *std::min_element(spheres_.begin(), spheres_.end(),
                                        [&](const Sphere& a, const Sphere& b) { return gap(a) < gap(b); });
    // mutant robot-uncovered-radius: `most_radius_` -> `1e300`
    const double most = std::max(nearest.radius, most_radius_);
    nearest.radius = std::clamp(nearest.radius + gap(nearest) - tolerance, nearest.radius, most);
  }
  count_all();
}

void PartialCover::count_all() {
  surface_in_.assign(surface_.size(), 0);
  space_in_.assign(space_.size(), 0);
  near_.assign(surface_.size(), 0);
  for (const Sphere& s : spheres_) count(s, 1);
}

void PartialCover::count(const Sphere& s, int change) {
  const auto change_where = [&](std::vector<std::uint32_t>& counts, double radius) {
    const auto square = static_cast<float>(radius * radius);
    for (std::size_t i = 0; i < counts.size(); ++i)
      if (squares_[i] <= square) counts[i] = static_cast<std::uint32_t>(counts[i] + change);
  };
  squared_distances(surface_.x, surface_.y, surface_.z, s.center - middle_, squares_);
  change_where(surface_in_, s.radius);
  change_where(near_, s.radius + tolerance_);
  squared_distances(space_.x, space_.y, space_.z, s.center - middle_, squares_);
  change_where(space_in_, s.radius);
}

/// Sorts out the points that no counted sphere has.
void PartialCover::gather() {
  bare_.clear();
  free_.clear();
  far_.clear();
  for (std::size_t i = 0; i < surface_.size(); ++i) {
    if (surface_in_[i] == 0) bare_.copy(surface_, i);
    if (near_[i] == 0) far_.copy(surface_, i);
  }
  for (std::size_t i = 0; i < space_.size(); ++i)
    if (space_in_[i] == 0) free_.copy(space_, i);
}

/// The radius with the largest gain, of multiples of a part of the reach and the least radius that the tolerance
/// requires. The gain is −∞ if that exceeds the largest radius.
PartialCover::Choice PartialCover::best_at(const Vec3& center, double worth, double reach, double most_radius) {
  squared_distances(far_.x, far_.y, far_.z, center - middle_, squares_);
  const double farthest = squares_.empty() ? 0 : std::sqrt(*std::max_element(squares_.begin(), squares_.end()));
  const double least = std::max(0.0, farthest * (1 + 1e-6) - tolerance_);
  if (least > most_radius) return {{center, least}, -std::numeric_limits<double>::infinity()};
  reach = std::max(reach, 1.25 * least);

  std::array<double, bins> gains{};
  const auto add = [&](const Points& points, double worth_of_amount) {
    const auto square = static_cast<float>(reach * reach), per_bin = static_cast<float>(bins / reach);
    squared_distances(points.x, points.y, points.z, center - middle_, squares_);
    for (std::size_t i = 0; i < squares_.size(); ++i) {
      if (squares_[i] >= square) continue;
      const auto bin = std::min(bins - 1, static_cast<std::size_t>(std::sqrt(squares_[i]) * per_bin));
      gains[bin] += worth_of_amount * points.amount[i];
    }
  };
  add(bare_, worth);
  add(free_, -1);
  const double width = reach / bins;
  Choice best{{center, least}, -std::numeric_limits<double>::infinity()};
  double sum = 0;
  for (std::size_t k = 0; k < bins; ++k) {
    // The sum is that of all bins below this radius; the least radius has the rest of its own bin also.
    const double radius = std::max(least, static_cast<double>(k) * width);
    if (static_cast<double>(k + 1) * width > least && radius <= most_radius && sum > best.gain)
      best = {{center, radius}, sum};
    sum += gains[k];
  }
  return best;
}

Sphere PartialCover::best_place(const Sphere& s, double worth) {
  Random random(seed_ + ++turns_);
  const auto centered = [&] { return random.uniform(-1, 1) + random.uniform(-1, 1); };
  Choice best = best_at(s.center, worth, reach_, std::max(s.radius, most_radius_));
  const double near = std::min(reach_, 2 * best.sphere.radius + 0.1 * reach_);
  double step = 0.3 * std::max(best.sphere.radius, 0.1 * reach_);
  for (int k = 0; k < moves; ++k) {
    const Vec3 center = best.sphere.center + step * Vec3{centered(), centered(), centered()};
    if (const Choice other = best_at(center, worth, near, most_radius_); other.gain > best.gain) {
      best = other;
    } else {
      step *= 0.85;
    }
  }
  for (int k = 0; k < jumps && !seats_.empty(); ++k) {
    const Choice other = best_at(seats_[random.next() % seats_.size()], worth, reach_, most_radius_);
    if (other.gain > best.gain) best = other;
  }
  return best.gain > -std::numeric_limits<double>::infinity() ? best.sphere : s;
}

void PartialCover::improve(double worth, int rounds, const StopToken& stop) {
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < spheres_.size() && !stop.stop_requested(); ++i) {
      count(spheres_[i], -1);
      gather();
      spheres_[i] = best_place(spheres_[i], worth);
      count(spheres_[i], 1);
    }
  }
}

double PartialCover::uncovered_area() const {
  double sum = 0;
  for (std::size_t i = 0; i < surface_.size(); ++i)
    if (surface_in_[i] == 0) sum += surface_.amount[i];
  return sum;
}

double PartialCover::outside_volume() const {
  double sum = 0;
  for (std::size_t i = 0; i < space_.size(); ++i)
    if (space_in_[i] != 0) sum += space_.amount[i];
  return sum;
}

}  // namespace morula::robot
