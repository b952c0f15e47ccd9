// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/scale.hpp>
#include <morula/medial/medial_balls.hpp>
#include <stdexcept>

#include "medial/ball_neighbors.hpp"
#include "medial/shrunken_balls.hpp"
#include "medial/voronoi_balls.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t neighbor_count = 8;

}  // namespace

MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            WorkersOrAll given) {
  Workers& workers = given;
  MedialBalls medial;
  medial.balls = shrunken_balls(shape, points, normals, BallSharing::none, workers);
  connect_overlapping(medial, neighbor_count, workers);
  return medial;
}

MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples) {
  const StandardFloats standard;
  Box box;
  for (const Vec3& sample : samples) {
    if (is_finite(sample)) box.add(sample);
  }
  if (!box.is_empty() && !(has_usable_scale({box.lower, 0}) && has_usable_scale({box.upper, 0})))
    throw std::invalid_argument("voronoi_balls: a sample has a number beyond 1e30");
  MedialBalls medial;
  if (box.is_empty()) return medial;
  VoronoiBalls voronoi(box, shape);
  voronoi.insert(samples);

  const std::vector<VoronoiBall>& all = voronoi.balls();
  const auto is_medial = [&](std::uint32_t slot) { return all[slot].alive && voronoi.side(slot) < 0; };
  std::vector<std::uint32_t> number(all.size(), no_ball);
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (!is_medial(slot)) continue;
    number[slot] = static_cast<std::uint32_t>(medial.balls.size());
    medial.balls.push_back(all[slot].ball);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (number[slot] == no_ball) continue;
    for (const std::uint32_t neighbor : all[slot].neighbors) {
      if (neighbor != no_ball && number[neighbor] != no_ball) pairs.emplace_back(number[slot], number[neighbor]);
    }
  }
  set_neighbors(medial, std::move(pairs));
  return medial;
}

}  // namespace morula
