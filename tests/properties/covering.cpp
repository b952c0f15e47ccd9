// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "covering.hpp"

#include <cstdio>

namespace morula::properties {
namespace {

using oracle::Ball;
using oracle::Point;
using oracle::Real;

std::string text(Real x) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.3Lg", x);
  return buffer;
}

bool is_finite_ball(const Ball& ball) {
  return std::isfinite(ball.radius) && std::isfinite(ball.center.x) && std::isfinite(ball.center.y) &&
         std::isfinite(ball.center.z);
}

// Every corner of every patch of a node inside the node's own sphere. The patch is the hull of its corners, so that is
// the library's proof, gone through again in the judge's arithmetic.
//
// Rounding: a corner is a sum of three products, in which weights are taken as they are; with the distance below 20
// epsilon A, within what find_uncovered() allows. Weights that do not add up to 1 make a corner that is off its facet;
// the cover is about that very corner, so nothing is allowed for it.
void judge_regions(const Moment& m, Record& record, const std::string& suffix) {
  const Cover& cover = m.cover;
  const std::size_t vertices = m.positions.size();
  std::vector<Point> corner(vertices + cover.cut_points.size());
  std::copy(m.positions.begin(), m.positions.end(), corner.begin());
  for (std::size_t i = 0; i < cover.cut_points.size(); ++i) {
    const CutPoint& cut = cover.cut_points[i];
    Point p;
    for (std::size_t k = 0; k < 3; ++k)
      // A vertex of no weight may be one that is not used.
      if (cut.weight[k] != 0) p = p + static_cast<Real>(cut.weight[k]) * m.positions[cut.vertex[k]];
    corner[vertices + i] = p;
  }
  Real worst = 0;
  std::uint32_t worst_node = no_node;
  std::vector<std::uint32_t> distinct;
  for (std::uint32_t node = 0; node < m.tree.node_count(); ++node) {
    if (!m.promised[node]) continue;
    const Ball& ball = m.balls[node];
    for (std::uint32_t p = cover.region_begin[node]; p < cover.region_end[node]; ++p)
      for (std::uint32_t c = cover.corner_begin[p]; c < cover.corner_begin[p + 1]; ++c) {
        const Point& q = corner[cover.corners[c]];
        ++record.counts.corners;
        const Point d = q - ball.center;
        const Real reach =
            ball.radius +
            oracle::allowance(std::max(largest_coordinate(q), largest_coordinate(ball.center)), ball.radius);
        if (reach >= 0 && dot(d, d) <= reach * reach) continue;
        if (const Real excess = distance(q, ball.center) - ball.radius; excess > worst)
          worst = excess, worst_node = node;
      }
  }
  if (worst_node != no_node)
    record.fail("uncovered-region" + suffix, "node " + std::to_string(worst_node) + " of radius " +
                                                 text(m.balls[worst_node].radius) + " by " + text(worst));
}

// A corner of some patches, or a point of the patch close to it: there a node that forgot something leaves surface
// uncovered. Where they are is taken from the cover, that they are on their facet is not: weights are made to add up
// to 1.
std::vector<oracle::Hint> corners_of_patches(const Mesh& mesh, const Cover& cover, Dice& dice) {
  std::vector<oracle::Hint> hints;
  for (std::size_t p = 0; p < cover.patch_count(); ++p) {
    if (dice.chance(0.6)) continue;
    const std::uint32_t f = cover.patch_facet[p];
    const Facet& facet = mesh.facets[f];
    const auto corners = cover.patch(p);
    const auto weights = [&](std::uint32_t corner) {
      std::array<Real, 3> w{};
      const auto add = [&](std::uint32_t vertex, double weight) {
        for (std::size_t k = 0; k < 3; ++k)
          if (facet[k] == vertex) {
            w[k] += static_cast<Real>(weight);
            return;
          }
      };
      if (corner < cover.vertex_count) {
        add(corner, 1);
      } else {
        const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
        for (std::size_t k = 0; k < 3; ++k) add(cut.vertex[k], cut.weight[k]);
      }
      return w;
    };
    std::array<Real, 3> middle{};
    for (const std::uint32_t corner : corners) {
      const auto w = weights(corner);
      for (std::size_t k = 0; k < 3; ++k) middle[k] += w[k] / static_cast<Real>(corners.size());
    }
    auto at = weights(corners[dice.below(corners.size())]);
    const Real towards = dice.pick({0.0, 1e-4, 0.01, 0.1});
    for (std::size_t k = 0; k < 3; ++k) at[k] += towards * (middle[k] - at[k]);
    const Real v = std::clamp(at[1], Real(0), Real(1));
    hints.push_back({f, v, std::clamp(at[2], Real(0), 1 - v)});
  }
  std::stable_sort(hints.begin(), hints.end(), [](const auto& a, const auto& b) { return a.facet < b.facet; });
  return hints;
}

}  // namespace

std::vector<Point> points_of(std::span<const Vec3> positions) {
  std::vector<Point> points;
  points.reserve(positions.size());
  for (const Vec3& p : positions) points.push_back({p.x, p.y, p.z});
  return points;
}

std::vector<Ball> balls_of(std::span<const Sphere> spheres) {
  std::vector<Ball> balls;
  balls.reserve(spheres.size());
  for (const Sphere& s : spheres) balls.push_back({{s.center.x, s.center.y, s.center.z}, s.radius});
  return balls;
}

std::vector<std::vector<std::uint32_t>> level_sets(const SphereTree& tree) {
  std::vector<std::size_t> level(tree.node_count());
  std::size_t levels = 1;
  for (std::uint32_t node = 1; node < tree.node_count(); ++node) {
    level[node] = level[tree.parent[node]] + 1;
    levels = std::max(levels, level[node] + 1);
  }
  std::vector<std::vector<std::uint32_t>> sets(levels);
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    sets[level[node]].push_back(node);
    if (tree.child_count[node] == 0)
      for (std::size_t below = level[node] + 1; below < levels; ++below) sets[below].push_back(node);
  }
  return sets;
}

void judge(const Moment& m, Dice& dice, Record& record, const oracle::Effort& effort, const std::string& suffix) {
  ++record.counts.frames;
  for (std::size_t node = 0; node < m.balls.size(); ++node)
    if (m.promised[node] && !is_finite_ball(m.balls[node])) {
      record.fail("not-finite" + suffix, "the sphere of node " + std::to_string(node));
      return;
    }
  judge_regions(m, record, suffix);
  std::vector<oracle::Triangle> facets;
  for (const Facet& f : m.mesh.facets) facets.push_back({m.positions[f[0]], m.positions[f[1]], m.positions[f[2]]});
  const auto sets = level_sets(m.tree);
  for (std::size_t j = 0; j < sets.size(); ++j) {
    std::vector<Ball> balls;
    bool promised = true;
    for (const std::uint32_t node : sets[j]) balls.push_back(m.balls[node]), promised = promised && m.promised[node];
    if (!promised) continue;
    ++record.counts.levels;
    const auto hints = corners_of_patches(m.mesh, m.cover, dice);
    if (const auto uncovered = oracle::find_uncovered(facets, balls, dice, record.counts.cover, effort, hints))
      record.fail("uncovered" + suffix, "level " + std::to_string(j) + " facet " + std::to_string(uncovered->facet) +
                                            " by " + text(uncovered->gap));
  }
}

}  // namespace morula::properties
