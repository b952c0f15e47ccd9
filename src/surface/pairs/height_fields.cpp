// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/height_fields.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <morula/geometry/box.hpp>

#include "geometry/exact_predicates.hpp"
#include "parallel/float_environment.hpp"
#include "surface/boxes/vertex_reader.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t blocks_at_once = 512, regions_at_once = 32;

/// HeightFields::Directions of one facet. If a sign is in doubt, neither bit is set: a nearly upright facet is in no
/// height field.
unsigned directions_of(const Vec3& p, const Vec3& q, const Vec3& r) {
  unsigned directions = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int sign = certain_orient2d(p, q, r, projections[axis]);
    directions |= (sign > 0 ? 1u : 0u) << axis | (sign < 0 ? 8u : 0u) << axis;
  }
  return directions;
}

bool is_lower(const Vec3& p, const Vec3& q, Projection projection) {
  const auto [i, j] = projection;
  return p[i] != q[i] ? p[i] < q[i] : p[j] < q[j];
}

/// Whether segments pq and rs touch, or may touch within rounding.
bool may_touch(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s, Projection projection) {
  if (orient2d(p, q, r, projection) * orient2d(p, q, s, projection) > 0) return false;
  // mutant height-field-touches: `<= 0` -> `< 0`
  return orient2d(r, s, p, projection) * orient2d(r, s, q, projection) <= 0;
}

/// Whether segments pq and qr have more in common than q. Neither is a point. If p is on qr, or r on pq, the edges
/// beyond also touch; but in a loop of three there are none, and a facet may have a corner on its neighbor's edge.
bool folds_back(const Vec3& p, const Vec3& q, const Vec3& r, Projection projection) {
  // mutant height-field-folds-back: `orient2d(p, q, r, projection) == 0` -> `false`
  return is_lower(p, q, projection) == is_lower(r, q, projection) && orient2d(p, q, r, projection) == 0;
}

/// The directions from v, counter-clockwise from the direction of `from` to that of `to`, both included; the two
/// differ.
struct Sector {
  const Vec3 &v, &from, &to;

  bool has(const Vec3& p, Projection projection) const {
    if (orient2d(v, from, to, projection) > 0)
      return orient2d(v, from, p, projection) >= 0 && orient2d(v, p, to, projection) >= 0;
    // mutant height-field-sector-wide: `orient2d(v, to ... ) <= 0 || orient2d(v, p, from, projection) <= 0` -> `false`
    return orient2d(v, to, p, projection) <= 0 || orient2d(v, p, from, projection) <= 0;
  }
};
/// Whether two sectors at one point have no direction in common. Two arcs with a common direction have in common the
/// direction at which one of them begins.
bool are_disjoint(const Sector& a, const Sector& b, Projection projection) {
  return !a.has(b.from, projection) && !b.has(a.from, projection);
}

}  // namespace

/// The border that is tested. Edge e goes from point e to point next_[e].
class HeightFields::Border {
 public:
  void start() {
    points_.clear();
    slots_.clear();
    boxes_.clear();
    next_.clear();
    before_.clear();
    loops_.assign(1, 0);
  }
  void add(const SurfaceTreeState& s, const SurfaceBoxes& boxes, std::span<const std::uint32_t> loop) {
    const auto first = static_cast<std::uint32_t>(points_.size());
    for (const std::uint32_t slot : loop) {
      points_.push_back(s.from_of(s.blocks.vertex_of_slot[slot]));
      boxes_.push_back(boxes.vertices[slot]);
      slots_.push_back(slot);
      before_.push_back(static_cast<std::uint32_t>(points_.size()) - 2);
      next_.push_back(static_cast<std::uint32_t>(points_.size()));
    }
    next_.back() = first;
    before_[first] = edge_count() - 1;
    loops_.push_back(static_cast<std::uint32_t>(points_.size()));
  }
  /// Whether no edges touch except at a vertex that they share, the fans at a vertex are in disjoint sectors, and no
  /// counter-clockwise loop is within another. Mirrored: clockwise. False if one of these is in doubt.
  bool is_simple(Projection projection, bool is_mirrored) {
    group_edges(projection);
    // mutant height-field-border: `return no_edges_touch(projection, is_mirrored) &&` -> `return`
    return no_edges_touch(projection, is_mirrored) &&
           // mutant height-field-nested: `(loops_.size ... || no_loops_are_nested(projection, is_mirrored))` -> `true`
           (loops_.size() == 2 || no_loops_are_nested(projection, is_mirrored));
  }

 private:
  std::uint32_t edge_count() const { return static_cast<std::uint32_t>(points_.size()); }
  void group_edges(Projection projection);
  bool no_edges_touch(Projection projection, bool is_mirrored) const;
  bool no_loops_are_nested(Projection projection, bool is_mirrored);
  bool may_be_within(std::size_t inner, std::size_t outer, Projection projection) const;
  bool are_apart(std::uint32_t e, std::uint32_t f, Projection projection, bool is_mirrored) const;
  bool have_disjoint_fans(std::uint32_t e, std::uint32_t f, Projection projection, bool is_mirrored) const;
  int turn(std::size_t loop, Projection projection) const;

  std::vector<Vec3> points_;
  std::vector<MinBox> boxes_;  // boxes of the points, rounded outwards
  std::vector<std::uint32_t> slots_, next_, before_, loops_;
  std::vector<BoxGroup> edges_, runs_;  // boxes of edges in the plane, and of runs of eight of them
  struct Loop {
    std::size_t number;
    Box box;
  };
  std::vector<Loop> ccw_loops_;
};

void HeightFields::Border::group_edges(Projection projection) {
  const std::size_t runs = (edge_count() + 7) / 8;
  edges_.resize(std::max(edges_.size(), runs));
  runs_.resize(std::max(runs_.size(), (runs + 7) / 8));
  const auto flat = [&](const MinBox& box) {
    MinBox of_plane;
    of_plane.bound[0] = box.bound[projection.first], of_plane.bound[4] = box.bound[projection.first + 4];
    of_plane.bound[1] = box.bound[projection.second], of_plane.bound[5] = box.bound[projection.second + 4];
    of_plane.bound[2] = of_plane.bound[6] = 0;
    return of_plane;
  };
  for (std::size_t run = 0; run < runs; ++run) {
    if (run % 8 == 0) runs_[run / 8].clear();
    edges_[run].clear();
    MinBox all;
    for (std::size_t e = 8 * run; e < std::min<std::size_t>(edge_count(), 8 * run + 8); ++e) {
      MinBox box = boxes_[e];
      box.add(boxes_[next_[e]]);
      put(edges_[run], e % 8, flat(box));
      all.add(box);
    }
    put(runs_[run / 8], run % 8, flat(all));
  }
}

bool HeightFields::Border::no_edges_touch(Projection projection, bool is_mirrored) const {
  const MeetGroups meet = meet_groups();
  const std::uint32_t runs = (edge_count() + 7) / 8, groups = (runs + 7) / 8;
  const BoxReach none{};
  constexpr std::uint64_t above_diagonal = 0x0080c0e0f0f8fcfe, diagonal = 0x8040201008040201;
  for (std::uint32_t g = 0; g < groups; ++g)
    for (std::uint32_t h = g; h < groups; ++h) {
      std::uint64_t of_runs = meet(runs_[g], runs_[h], none);
      if (g == h) of_runs &= above_diagonal | diagonal;
      for (; of_runs != 0; of_runs &= of_runs - 1) {
        const auto bit = static_cast<std::uint32_t>(std::countr_zero(of_runs));
        const std::uint32_t i = 8 * g + bit / 8, j = 8 * h + bit % 8;
        std::uint64_t of_edges = meet(edges_[i], edges_[j], none);
        if (i == j) of_edges &= above_diagonal;
        for (; of_edges != 0; of_edges &= of_edges - 1) {
          const auto place = static_cast<std::uint32_t>(std::countr_zero(of_edges));
          if (!are_apart(8 * i + place / 8, 8 * j + place % 8, projection, is_mirrored)) return false;
        }
      }
    }
  return true;
}

/// Whether two edges are apart, except for a vertex that they share.
bool HeightFields::Border::are_apart(std::uint32_t e, std::uint32_t f, Projection projection, bool is_mirrored) const {
  const std::uint32_t e_end = next_[e], f_end = next_[f];
  const Vec3 &p = points_[e], &q = points_[e_end], &r = points_[f], &s = points_[f_end];
  if (e_end == f) return !folds_back(p, q, s, projection);
  if (f_end == e) return !folds_back(r, p, q, projection);
  // mutant height-field-pinched: `have_disjoint_fans(e, f, projection, is_mirrored)` -> `true`
  if (slots_[e] == slots_[f]) return have_disjoint_fans(e, f, projection, is_mirrored);
  // Sides of two fans are in disjoint sectors when the sides that leave the vertex are.
  if (slots_[e_end] == slots_[f] || slots_[f_end] == slots_[e] || slots_[e_end] == slots_[f_end]) return true;
  return !may_touch(p, q, r, s, projection);
}

/// Whether edges that leave the same vertex have disjoint fans. The fan of an edge is on its left, up to the preceding
/// edge.
bool HeightFields::Border::have_disjoint_fans(std::uint32_t e, std::uint32_t f, Projection projection,
                                              bool is_mirrored) const {
  const auto fan = [&](std::uint32_t edge) {
    const Vec3 &before = points_[before_[edge]], &after = points_[next_[edge]];
    // mutant height-field-pinched-mirrored: `is_mirrored ? Sector{points_[edge], before, after} : Sector` -> `Sector`
    return is_mirrored ? Sector{points_[edge], before, after} : Sector{points_[edge], after, before};
  };
  return are_disjoint(fan(e), fan(f), projection);
}

/// The direction of a loop; 1: counter-clockwise. Its first point in the order of coordinates is a corner of its convex
/// hull. If the loop passes that point more than once, a clockwise loop may count as counter-clockwise, but not the
/// reverse: all sectors of a counter-clockwise loop are less than half a turn there, since a larger sector has
/// directions out of the hull, which are not on its left.
int HeightFields::Border::turn(std::size_t loop, Projection projection) const {
  std::uint32_t first = loops_[loop];
  for (std::uint32_t e = loops_[loop] + 1; e < loops_[loop + 1]; ++e)
    if (is_lower(points_[e], points_[first], projection)) first = e;
  return orient2d(points_[before_[first]], points_[first], points_[next_[first]], projection);
}

bool HeightFields::Border::no_loops_are_nested(Projection projection, bool is_mirrored) {
  ccw_loops_.clear();
  // mutant height-field-nested-mirrored: `is_mirrored ? -1 : 1` -> `1`
  const int counter_clockwise = is_mirrored ? -1 : 1;
  for (std::size_t loop = 0; loop + 1 < loops_.size(); ++loop) {
    if (turn(loop, projection) != counter_clockwise) continue;
    Box box;
    for (std::uint32_t e = loops_[loop]; e < loops_[loop + 1]; ++e)
      box.add({points_[e][projection.first], points_[e][projection.second], 0});
    ccw_loops_.push_back({loop, box});
  }
  // A loop that lies within another has a box within the other's box.
  for (const auto& [inner, box] : ccw_loops_)
    for (const auto& [outer, around] : ccw_loops_)
      if (inner != outer && min(box.lower, around.lower) == around.lower &&
          max(box.upper, around.upper) == around.upper && may_be_within(inner, outer, projection))
        return false;
  return true;
}

/// The two loops touch at vertices only, so a point of the inner loop that is no vertex of the outer loop is not on the
/// outer loop. A ray from there along which the second coordinate is constant and the first grows crosses the outer
/// loop an odd number of times when the point is within. The answer is in doubt if all vertices are on both loops.
bool HeightFields::Border::may_be_within(std::size_t inner, std::size_t outer, Projection projection) const {
  const std::span<const std::uint32_t> of_outer(slots_.data() + loops_[outer], loops_[outer + 1] - loops_[outer]);
  for (std::uint32_t i = loops_[inner]; i < loops_[inner + 1]; ++i) {
    if (std::find(of_outer.begin(), of_outer.end(), slots_[i]) != of_outer.end()) continue;
    const Vec3& p = points_[i];
    const int k = projection.second;
    bool is_within = false;
    for (std::uint32_t e = loops_[outer]; e < loops_[outer + 1]; ++e) {
      const Vec3 &from = points_[e], &to = points_[next_[e]];
      if ((from[k] > p[k]) == (to[k] > p[k])) continue;
      // mutant height-field-within: `> p` -> `< p`
      if ((orient2d(from, to, p, projection) > 0) == (to[k] > p[k])) is_within = !is_within;
    }
    return is_within;
  }
  return true;
}

HeightFields::HeightFields() = default;
HeightFields::~HeightFields() = default;
HeightFields::HeightFields(HeightFields&&) noexcept = default;
HeightFields& HeightFields::operator=(HeightFields&&) noexcept = default;

void HeightFields::start(const SurfaceTreeState& s, const SurfaceBoxes& boxes) {
  state_ = &s;
  boxes_ = &boxes;
  levels_.resize(s.borders.size());
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const std::size_t size = std::size_t{8} << (3 * level);
    levels_[level].assign((s.blocks.order.size() + size - 1) / size, {});
  }
  if (borders_.empty()) borders_.resize(1);
}

void HeightFields::find_directions(std::uint32_t first_block, std::uint32_t last_block) {
  const SurfaceTreeState& s = *state_;
  const bool is_placed = s.pose.followed && s.pose.followed->is_placed;
  with_reader(s.pose.from, s.mesh.rest, [&](const auto& read) {
    // mutant height-field-placed: `s.pose.followed->spheres.transform()(read(v))` -> `read(v)`
    const auto corner = [&](std::uint32_t v) {
      return is_placed ? s.pose.followed->spheres.transform()(read(v)) : read(v);
    };
    for (std::uint32_t block = first_block; block < last_block; ++block) {
      const std::size_t begin = 8 * std::size_t{block}, end = std::min(s.blocks.order.size(), begin + 8);
      unsigned directions = 63;
      for (std::size_t i = begin; i < end && directions != 0; ++i) {
        const Facet& f = s.blocks.facets_in_order[i];
        directions &= directions_of(corner(f[0]), corner(f[1]), corner(f[2]));
      }
      levels_[0][block].directions = static_cast<Directions>(directions);
    }
  });
}

HeightFields::Directions HeightFields::common_directions(std::size_t level, std::uint32_t region) const {
  const std::vector<Region>& below = levels_[level - 1];
  const std::size_t begin = 8 * std::size_t{region}, end = std::min(below.size(), begin + 8);
  Directions directions = 63;
  // mutant height-field-one-block: `&= below` -> `|= below`
  for (std::size_t i = begin; i < end; ++i) directions &= below[i].directions;
  return directions;
}

void HeightFields::find_all(Workers& workers) {
  parallel_for(workers, levels_[0].size(), blocks_at_once, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    find_directions(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end));
  });
  for (std::size_t level = 1; level < levels_.size(); ++level)
    for (std::uint32_t region = 0; region < levels_[level].size(); ++region)
      levels_[level][region].directions = common_directions(level, region);
  // Regions are tested from the largest on: a region within a height field is one, and is not tested.
  for (std::size_t level = levels_.size() - 1; level > 0; --level) {
    std::vector<Region>& regions = levels_[level];
    borders_.resize(std::max(borders_.size(), (regions.size() + regions_at_once - 1) / regions_at_once));
    parallel_for(workers, regions.size(), regions_at_once, [&](std::size_t begin, std::size_t end) {
      const StandardFloats standard;
      for (std::size_t i = begin; i < end; ++i) {
        const auto region = static_cast<std::uint32_t>(i);
        Region& r = regions[i];
        r.is_field =
            is_one(level + 1, region / 8) ||
            (r.directions != 0 && has_simple_border(level, region, r.directions, borders_[begin / regions_at_once]));
      }
    });
  }
}

void HeightFields::find(std::size_t level, std::uint32_t region) {
  const std::uint32_t first = region << (3 * level);
  const auto last = static_cast<std::uint32_t>(
      std::min<std::size_t>(levels_[0].size(), std::size_t{first} + (std::size_t{1} << (3 * level))));
  find_directions(first, last);
  Directions directions = 63;
  for (std::uint32_t block = first; block < last; ++block) directions &= levels_[0][block].directions;
  levels_[level][region].is_field = directions != 0 && has_simple_border(level, region, directions, borders_[0]);
}

bool HeightFields::has_simple_border(std::size_t level, std::uint32_t region, Directions directions,
                                     Border& border) const {
  const SurfaceTreeState& s = *state_;
  const RegionBorders& of_level = s.borders[level];
  const std::uint32_t first_loop = of_level.loops_begin[region], last_loop = of_level.loops_begin[region + 1];
  if (first_loop == last_loop) return false;
  border.start();
  for (std::uint32_t k = first_loop; k < last_loop; ++k) border.add(s, *boxes_, of_level.loop(k));
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_seen = (directions >> axis & 1) != 0, is_mirrored = (directions >> axis & 8) != 0;
    if ((is_seen || is_mirrored) && border.is_simple(projections[axis], is_mirrored)) return true;
  }
  return false;
}

}  // namespace morula::detail
