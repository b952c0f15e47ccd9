// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/kernels.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "geometry/rounded_up.hpp"
#include "simd/processors.hpp"
#include "update/points/turned_axes.hpp"

namespace morula::detail {
namespace {

/// The reference that the other kernels reproduce, in plain loops; also for compilers without vector types.
namespace plain {

void farthest(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
              std::span<const Vec3f> centers, float* squared) {
  for (std::size_t k = 0; k < centers.size(); ++k) {
    float most = 0;
    const auto measure = [&](const LocalPoint& p) {
      most = std::max(most, squared_length(Vec3f{p.x, p.y, p.z} - centers[k]));
    };
    for (const PointRun& run : runs) std::for_each(points + run.begin, points + run.end, measure);
    for (const std::uint32_t i : index) measure(points[i]);
    squared[k] = most;
  }
}

// Calls visit(run, list) for each group; it is one of the two.
template <class Visit>
void each_group(std::span<const PointRun> runs, std::span<const std::uint32_t> index, const Visit& visit) {
  for (const PointRun& run : runs)
    for (std::uint32_t p = run.begin; p != run.end; p += points_per_group) {
      const PointRun group{p, p + static_cast<std::uint32_t>(points_per_group)};
      visit(std::span(&group, 1), std::span<const std::uint32_t>());
    }
  for (std::size_t p = 0; p != index.size(); p += points_per_group)
    visit(std::span<const PointRun>(), index.subspan(p, points_per_group));
}

void farthest_of_groups(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                        const Vec3f& center, float* groups) {
  each_group(runs, index, [&](std::span<const PointRun> run, std::span<const std::uint32_t> list) {
    farthest(points, run, list, {&center, 1}, groups++);
  });
}

float farthest_of_some(const LocalPoint* points, std::span<const PointRun> runs, std::span<const std::uint32_t> index,
                       const Vec3f& center, const float* groups, float least) {
  float most = 0;
  each_group(runs, index, [&](std::span<const PointRun> run, std::span<const std::uint32_t> list) {
    float squared = 0;
    if (*groups++ >= least) farthest(points, run, list, {&center, 1}, &squared);
    most = std::max(most, squared);
  });
  return most;
}

Vec3f pull(const LocalPoint* points, const Pull& pull, const Vec3f& center) {
  Vec3f now = center, best = center;
  float least = 0;
  for (int step = 0;; ++step) {
    float squared = -1;
    Vec3f far;
    for (std::size_t i = 0; i < core_size; ++i) {
      const LocalPoint& p = points[pull.core[i]];
      const float s = squared_length(Vec3f{p.x, p.y, p.z} - now);
      if (s > squared) squared = s, far = {p.x, p.y, p.z};
    }
    if (step == 0 || squared < least) least = squared, best = now;
    if (squared <= pull.enough || step == pull_steps) return best;
    const float distance = std::sqrt(squared);
    const float along = 0.15f * distance / static_cast<float>(step + 1);
    const float excess = 0.8f * (std::sqrt(least) - pull.rest_radius);
    const float share = std::min(along, excess) / distance;
    now += (far - now) * share;
  }
}

void pull_many(const LocalPoint* points, const std::uint32_t* cores, std::size_t core_count, const float* rest_radii,
               LocalPoint* centers) {
  for (std::size_t k = 0; k < nodes_at_once; ++k) {
    const float enough = most_growth * rest_radii[k];
    std::array<std::uint32_t, core_size> core;
    for (std::size_t i = 0; i < core_size; ++i) core[i] = cores[nodes_at_once * (i < core_count ? i : 0) + k];
    const Pull one{core.data(), enough * enough, rest_radii[k]};
    const Vec3f center = pull(points, one, {centers[k].x, centers[k].y, centers[k].z});
    centers[k] = {center.x, center.y, center.z, 0};
  }
}

void fit_many(const LocalPoint* points, const Fits& fits, LocalPoint* centers) {
  for (std::size_t k = 0; k < nodes_at_once; ++k) {
    Vec3f now{centers[k].x, centers[k].y, centers[k].z}, best = now;
    float least = 0, limit = 0;
    for (int step = 0;; ++step) {
      float most = -1, nearest = std::numeric_limits<float>::infinity();
      Vec3f to, from;
      for (std::size_t i = 0; i < core_size; ++i) {
        const LocalPoint& p = points[fits.cores[nodes_at_once * i + k]];
        const float s = squared_length(Vec3f{p.x, p.y, p.z} - now);
        if (s > most) most = s, to = {p.x, p.y, p.z};
      }
      for (std::size_t i = 0; i < near_size; ++i) {
        const LocalPoint& p = points[fits.near[nodes_at_once * i + k]];
        const float s = squared_length(Vec3f{p.x, p.y, p.z} - now);
        if (s < nearest) nearest = s, from = {p.x, p.y, p.z};
      }
      const float cost = most - nearest;
      if (step == 0 && cost <= fits.enough[k]) break;
      if (step == 0) least = cost, limit = most_squared_growth * most;
      if (most <= limit && cost < least) least = cost, best = now;
      if (step == fit_steps) break;
      const float reach = std::sqrt(most), protrusion = std::max(0.0f, reach - std::sqrt(nearest));
      now += (to - from) * (reach > 0 ? fit_lengths[step] * protrusion / reach : 0.0f);
    }
    centers[k] = {best.x, best.y, best.z, 0};
  }
}

void weighted_sums(const LocalPoint* points, const std::uint32_t* index, const float* weight,
                   std::span<const std::uint32_t> group_begin, LocalPoint* sums) {
  for (std::size_t g = 0; g + 1 < group_begin.size(); ++g)
    for (std::size_t node = 0; node < nodes_per_group; ++node) {
      Vec3f even{}, odd{};
      for (std::size_t i = group_begin[g] + node; i < group_begin[g + 1]; i += 2 * nodes_per_group) {
        const LocalPoint &p = points[index[i]], &q = points[index[i + nodes_per_group]];
        even += Vec3f{p.x, p.y, p.z} * weight[i];
        odd += Vec3f{q.x, q.y, q.z} * weight[i + nodes_per_group];
      }
      const Vec3f sum = even + odd;
      sums[nodes_per_group * g + node] = {sum.x, sum.y, sum.z, 0};
    }
}

void carry(const LocalPoint* points, const Remainders& remainders, std::size_t begin, std::size_t end,
           LocalPoint* moves) {
  for (std::size_t i = begin; i < end; ++i) {
    const auto point = [&](int k) {
      const LocalPoint& p = points[remainders.points[k][i]];
      return Vec3f{p.x, p.y, p.z};
    };
    const auto vector = [&](const float* const(&columns)[3]) {
      return Vec3f{columns[0][i], columns[1][i], columns[2][i]};
    };
    const Vec3f move =
        TurnedAxes(point(0), point(1), point(2)).place(vector(remainders.in_axes)) - vector(remainders.at_rest);
    moves[i - begin] = {move.x, move.y, move.z, 0};
  }
}

void farthest_of_leaves(const LocalPoint* points, const LeafLists& lists, std::size_t begin, std::size_t end,
                        std::size_t count, const Spheref* spheres, float* squared) {
  for (std::size_t leaf = begin; leaf < end; ++leaf)
    for (std::uint32_t e = lists.chain_begin[leaf]; e < lists.chain_begin[leaf + 1]; ++e)
      if (lists.chain[e] < count)
        farthest(points, {lists.runs + lists.run_begin[leaf], lists.runs + lists.run_begin[leaf + 1]},
                 {lists.points + lists.point_begin[leaf], lists.points + lists.point_end[e]},
                 {&spheres[lists.nodes[lists.chain[e]]].center, 1}, squared + e);
}

void covering_radii(const float* squared, const float* norms, std::size_t count, const RadiusAllowances& allowances,
                    float* radii) {
  for (std::size_t i = 0; i < count; ++i) {
    const double farthest = std::sqrt(static_cast<double>(squared[i]));
    const double mesh_coordinate = allowances.coordinate + static_cast<double>(norms[i]);
    const double pad = allowances.least + allowances.per_coordinate * mesh_coordinate + 0x1p-62;
    radii[i] = rounded_up(farthest * (1 + 0x1p-22) + pad);
  }
}

void move_edge_cuts(const LocalPoint* points, const EdgeCut* cuts, std::size_t count, LocalPoint* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const LocalPoint &p = points[cuts[i].point[0]], &q = points[cuts[i].point[1]];
    const Vec3f a{p.x, p.y, p.z}, b{q.x, q.y, q.z}, at = a + (b - a) * cuts[i].weight;
    out[i] = {at.x, at.y, at.z, 0};
  }
}

void move_inner_cuts(const LocalPoint* points, const InnerCut* cuts, std::size_t count, LocalPoint* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const LocalPoint &p = points[cuts[i].point[0]], &q = points[cuts[i].point[1]], &r = points[cuts[i].point[2]];
    const Vec3f a{p.x, p.y, p.z}, b{q.x, q.y, q.z}, c{r.x, r.y, r.z};
    const Vec3f at = a + (b - a) * cuts[i].weight1 + (c - a) * cuts[i].weight2;
    out[i] = {at.x, at.y, at.z, 0};
  }
}

// place(i): index of the i-th point in the output.
template <class Place>
std::uint32_t narrow_packed(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out,
                            const Place& place) {
  std::uint32_t largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p = Vec3f{packed[3 * i], packed[3 * i + 1], packed[3 * i + 2]} - origin;
    out[place(i)] = {p.x, p.y, p.z, 0};
    for (const float coordinate : {p.x, p.y, p.z})
      largest = std::max(largest, std::bit_cast<std::uint32_t>(coordinate) & 0x7fffffffu);
  }
  return largest;
}

std::uint32_t narrow_floats(const float* packed, std::size_t count, const Vec3f& origin, LocalPoint* out) {
  return narrow_packed(packed, count, origin, out, [](std::size_t i) { return i; });
}

std::uint32_t narrow_scattered(const float* packed, std::size_t count, const Vec3f& origin, const std::uint32_t* to,
                               LocalPoint* out) {
  return narrow_packed(packed, count, origin, out, [&](std::size_t i) { return to[i]; });
}

constexpr Kernels kernels{
    farthest, farthest_of_groups, farthest_of_some, pull,           pull_many,       fit_many,      weighted_sums,
    carry,    farthest_of_leaves, covering_radii,   move_edge_cuts, move_inner_cuts, narrow_floats, narrow_scattered};

}  // namespace plain

#define MORULA_KERNELS "update/points/kernels.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<Kernels> table{MORULA_EVERY_KIND(kernels)};

}  // namespace

std::span<const Kernels> all_kernels() {
  return table.runnable();
}

const Kernels& kernels() {
  return table.widest();
}

}  // namespace morula::detail
