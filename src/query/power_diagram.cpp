// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/query/power_diagram.hpp>
#include <numeric>
#include <vector>

#include "query/power_cell_of.hpp"
#include "query/stack_memory.hpp"

namespace morula {
namespace {

struct Corner {
  Barycentric barycentric;
  Vec3 point;
};

// Powers nearer to each other than this share of the squared distances involved count as equal: below it the sign
// depends on rounding, and a cut there would only make slivers.
// mutant power-ties: `0x1p-50` -> `0`
constexpr double relative_tie = 0x1p-50;

struct Power {
  double value;
  double rounding;  // bound of the rounding error of the value
};
Power power_with_rounding(const Sphere& s, const Vec3& x) {
  const double squared = squared_distance(s.center, x), squared_radius = s.radius * s.radius;
  return {squared - squared_radius, relative_tie * (squared + squared_radius)};
}

// Difference of powers of spheres a and b; zero when it is only rounding. Antisymmetric in a and b, bit for bit.
double power_difference(const Sphere& a, const Sphere& b, const Vec3& x) {
  const Power pa = power_with_rounding(a, x), pb = power_with_rounding(b, x);
  const double difference = pa.value - pb.value;
  return std::abs(difference) <= pa.rounding + pb.rounding ? 0.0 : difference;
}

// A lower bound of the power at this distance from the center: it is lowered by more than the largest rounding error.
double least_power(double distance, double radius) {
  // mutant power-least: `radius - 0x1p-40 * (distance * distance + radius * radius)` -> `radius`
  return distance * distance - radius * radius - 0x1p-40 * (distance * distance + radius * radius);
}

// Splits one polygon by bisectors of pairs that both own one of its corners. After a split by (a, b) neither half needs
// both, so the recursion ends; every cut point is made once and belongs to both halves, so the parts tile the polygon
// for any rounding.
class Cutter {
 public:
  Cutter(const FacetGeometry& facet, std::span<const Sphere> spheres, CutFacet& result)
      : facet_(facet), spheres_(spheres), result_(result) {}

  void cut(std::span<const Corner> polygon, std::span<const std::uint32_t> candidates) {
    // If all corners have one owner, it owns the whole polygon, because differences of powers are affine. Most polygons
    // end here.
    const std::uint32_t first = owner_at(polygon[0].point, candidates);
    std::uint32_t rival = first;
    for (std::size_t k = 1; k < polygon.size() && rival == first; ++k) {
      const std::uint32_t other = owner_at(polygon[k].point, candidates);
      if (other != first && power_difference(spheres_[first], spheres_[other], polygon[k].point) > 0) rival = other;
    }
    if (rival == first) return emit(polygon, first);

    Numbers remaining = still_possible(polygon, candidates);
    Corners side_of_first = room_for_side(polygon), side_of_rival = room_for_side(polygon);
    if (split(polygon, first, rival, side_of_first, side_of_rival)) {
      Numbers without_rival(remaining, &scratch_);
      std::erase(without_rival, rival);
      cut(side_of_first, without_rival);
      std::erase(remaining, first);
      cut(side_of_rival, remaining);
    } else {
      // At no corner is `first` better than its rival by more than rounding.
      std::erase(remaining, first);
      cut(polygon, remaining);
    }
  }

 private:
  // Most facets that are cut have a few parts of a few corners, which need no heap.
  static constexpr std::size_t scratch_bytes = 8192;
  template <class Item>
  using Items = std::vector<Item, detail::StackAllocator<Item, scratch_bytes>>;
  using Corners = Items<Corner>;
  using Numbers = Items<std::uint32_t>;

  Corners room_for_side(std::span<const Corner> polygon) {
    Corners side(&scratch_);
    side.reserve(polygon.size() + 2);
    return side;
  }

  std::uint32_t owner_at(const Vec3& x, std::span<const std::uint32_t> candidates) const {
    return detail::power_cell_of(x, spheres_, candidates);
  }

  // Candidates that can own a part of the polygon: their least power over its bounding ball is not above the least
  // power that some sphere guarantees on all of it.
  Numbers still_possible(std::span<const Corner> polygon, std::span<const std::uint32_t> candidates) {
    Vec3 middle{};
    for (const Corner& c : polygon) middle += c.point;
    middle = middle / static_cast<double>(polygon.size());
    double squared_reach = 0;
    for (const Corner& c : polygon) squared_reach = std::max(squared_reach, squared_distance(c.point, middle));
    const double reach = std::sqrt(squared_reach);
    double guaranteed = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : candidates) {
      double worst = -std::numeric_limits<double>::infinity();
      for (const Corner& c : polygon) worst = std::max(worst, power(spheres_[i], c.point));
      guaranteed = std::min(guaranteed, worst);
    }
    Numbers kept(&scratch_);
    kept.reserve(candidates.size());
    for (const std::uint32_t i : candidates) {
      const double nearest = std::max(0.0, distance(spheres_[i].center, middle) - reach);
      if (least_power(nearest, spheres_[i].radius) <= guaranteed) kept.push_back(i);
    }
    return kept;
  }

  // Returns false when no corner lies strictly on the side of a, or a side is left without area.
  bool split(std::span<const Corner> polygon, std::uint32_t a, std::uint32_t b, Corners& side_a, Corners& side_b) {
    Items<double> difference(&scratch_);
    difference.reserve(polygon.size());
    for (const Corner& c : polygon) difference.push_back(power_difference(spheres_[a], spheres_[b], c.point));
    // mutant power-ties-on-both-sides: `make_two_sided(difference)` -> ``
    make_two_sided(difference);
    if (std::none_of(difference.begin(), difference.end(), [](double d) { return d < 0; })) return false;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const std::size_t next = (k + 1) % polygon.size();
      // mutant power-bisector-corners: `<= 0` -> `< 0`
      if (difference[k] <= 0) side_a.push_back(polygon[k]);
      if (difference[k] >= 0) side_b.push_back(polygon[k]);
      if ((difference[k] < 0 && difference[next] > 0) || (difference[k] > 0 && difference[next] < 0)) {
        const Corner made = cut_point(polygon[k], polygon[next], difference[k], difference[next], a, b);
        side_a.push_back(made);
        side_b.push_back(made);
      }
    }
    // If all its corners are on the bisector, that can leave a side without area: its points belong to the other side
    // as well.
    return side_a.size() >= 3 && side_b.size() >= 3;
  }

  // Differences of powers are affine, so around a convex polygon they are negative in one run and positive in another,
  // with at most one zero on each way between. Rounded differences need not be: ties are wider where a corner is
  // farther from the spheres, and thin polygons invert a rounded sign. Sides made of such signs would overlap. So the
  // smallest differences count as ties until there are two runs; a tie inside a run joins it, and among ties between
  // two runs the one next to the negative run is the corner that both sides share. Two convex polygons then share two
  // points and the segment between them: they tile the original polygon. The area that this moves between the sides is
  // as near to the bisector as the smallest differences are. Corners of a cut through equal signs keep their sign.
  static void make_two_sided(std::span<double> difference) {
    while (sign_changes(difference) > 2) {
      std::size_t least = difference.size();
      for (std::size_t k = 0; k < difference.size(); ++k)
        if (difference[k] != 0 && (least == difference.size() || std::abs(difference[k]) < std::abs(difference[least])))
          least = k;
      difference[least] = 0;
    }
    const std::size_t count = difference.size();
    const auto start = std::find_if(difference.begin(), difference.end(), [](double d) { return d < 0; });
    if (start == difference.end()) return;
    constexpr double joins_negative = -std::numeric_limits<double>::min();
    constexpr double joins_positive = std::numeric_limits<double>::min();
    // Goes round once from a negative corner to itself, run of ties by run of ties.
    const auto first = static_cast<std::size_t>(start - difference.begin());
    const auto at = [&](std::size_t i) -> double& { return difference[(first + i) % count]; };
    for (std::size_t i = 1; i < count;) {
      if (at(i) != 0) {
        ++i;
        continue;
      }
      std::size_t end = i;
      while (at(end) == 0) ++end;  // ends at `first` at the latest
      const bool negative_before = at(i - 1) < 0, negative_after = at(end) < 0;
      for (std::size_t k = i; k < end; ++k) at(k) = negative_before && negative_after ? joins_negative : joins_positive;
      if (negative_before != negative_after) at(negative_before ? i : end - 1) = 0;
      i = end;
    }
  }

  static int sign_changes(std::span<const double> difference) {
    int changes = 0;
    double last = 0;
    for (std::size_t round = 0; round < 2; ++round)
      for (const double d : difference) {
        if (d == 0) continue;
        changes += round == 1 && (d < 0) != (last < 0) ? 1 : 0;
        last = d;
      }
    return changes;
  }

  Corner cut_point(const Corner& p, const Corner& q, double at_p, double at_q, std::uint32_t a, std::uint32_t b) const {
    Barycentric made{};
    if (!cut_on_mesh_edge(p, q, a, b, made)) {
      const double t = at_p / (at_p - at_q);
      for (int k = 0; k < 3; ++k) made[k] = p.barycentric[k] + t * (q.barycentric[k] - p.barycentric[k]);
    }
    return {made, at_barycentric(facet_.corners, made)};
  }

  // On a mesh edge the cut is computed from its two vertices, lower index first, lower sphere first: the facet on the
  // other side then computes the same bits, and the two share one cut point.
  bool cut_on_mesh_edge(const Corner& p, const Corner& q, std::uint32_t a, std::uint32_t b, Barycentric& made) const {
    for (int opposite = 0; opposite < 3; ++opposite) {
      if (p.barycentric[opposite] != 0 || q.barycentric[opposite] != 0) continue;
      int from = (opposite + 1) % 3, to = (opposite + 2) % 3;
      // mutant power-edge-without-direction: `if (facet_.vertices ... > facet_.vertices[to]) std::swap(from, to)` -> ``
      if (facet_.vertices[from] > facet_.vertices[to]) std::swap(from, to);
      const Sphere& lower = spheres_[std::min(a, b)];
      const Sphere& higher = spheres_[std::max(a, b)];
      const double at_from = power(lower, facet_.corners[from]) - power(higher, facet_.corners[from]);
      const double at_to = power(lower, facet_.corners[to]) - power(higher, facet_.corners[to]);
      const double t = at_from / (at_from - at_to);
      const double one = p.barycentric[to], other = q.barycentric[to];
      if (!(std::min(one, other) < t && t < std::max(one, other))) return false;
      made[opposite] = 0;
      made[to] = t;
      made[from] = 1 - t;
      return made[from] > 0;
    }
    return false;
  }

  void emit(std::span<const Corner> polygon, std::uint32_t owner) {
    for (const Corner& c : polygon) result_.corners.push_back(c.barycentric);
    result_.corner_begin.push_back(static_cast<std::uint32_t>(result_.corners.size()));
    result_.owner.push_back(owner);
  }

  const FacetGeometry& facet_;
  std::span<const Sphere> spheres_;
  CutFacet& result_;
  detail::StackMemory<scratch_bytes> scratch_;
};

}  // namespace

void cut_by_power(const FacetGeometry& facet, std::span<const Barycentric> polygon, std::span<const Sphere> spheres,
                  std::span<const std::uint32_t> candidates, CutFacet& cut) {
  assert(polygon.size() >= 3 && !candidates.empty());
  // Corners of uncut facets and of polygons cut a few times fit without allocation.
  std::array<Corner, 16> few;
  std::vector<Corner> many;
  std::span<Corner> corners(few.data(), std::min(few.size(), polygon.size()));
  if (polygon.size() > few.size()) {
    many.resize(polygon.size());
    corners = many;
  }
  for (std::size_t k = 0; k < polygon.size(); ++k) corners[k] = {polygon[k], at_barycentric(facet.corners, polygon[k])};

  const auto& v = facet.vertices;
  if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) {
    // Barycentric coordinates are ambiguous here; the facet is a segment or a point and stays whole, with the sphere
    // that needs to grow least.
    std::uint32_t best = candidates[0];
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : candidates) {
      double excess = -std::numeric_limits<double>::infinity();
      for (const Corner& c : corners)
        excess = std::max(excess, distance(c.point, spheres[i].center) - spheres[i].radius);
      if (excess < least) least = excess, best = i;
    }
    candidates = std::span(&best, 1);
    Cutter(facet, spheres, cut).cut(corners, candidates);
    return;
  }
  Cutter(facet, spheres, cut).cut(corners, candidates);
}

PowerDiagram::PowerDiagram(std::span<const Sphere> spheres) : spheres_(spheres), order_(spheres.size()) {
  assert(!spheres.empty());
  std::iota(order_.begin(), order_.end(), 0u);
  nodes_.reserve(2 * spheres.size());
  nodes_.push_back({{}, {}, 0, 0, static_cast<std::uint32_t>(spheres.size()), 0});
  split(0);
}

void PowerDiagram::split(std::uint32_t index) {
  constexpr std::uint32_t leaf_size = 4;
  const std::uint32_t begin = nodes_[index].begin, end = nodes_[index].end;
  Box box;
  double largest_radius = 0;
  for (std::uint32_t k = begin; k < end; ++k) {
    box.add(spheres_[order_[k]].center);
    largest_radius = std::max(largest_radius, spheres_[order_[k]].radius);
  }
  nodes_[index].lower = box.lower;
  nodes_[index].upper = box.upper;
  nodes_[index].largest_radius = largest_radius;
  if (end - begin <= leaf_size) return;
  const int axis = box.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double ca = spheres_[a].center[axis], cb = spheres_[b].center[axis];
                     return ca != cb ? ca < cb : a < b;
                   });
  const auto left = static_cast<std::uint32_t>(nodes_.size());
  nodes_[index].left = left;
  nodes_.push_back({{}, {}, 0, begin, middle, 0});
  nodes_.push_back({{}, {}, 0, middle, end, 0});
  split(left);
  split(left + 1);
}

namespace {

// Depth first, nearer child first; the tree is balanced, so a small fixed stack is enough.
constexpr int stack_size = 128;

// Calls visit(node) for the leaves whose bounds, and those of all nodes above, are not above limit().
template <class Nodes, class Bound, class Limit, class Visit>
void visit_nearest_first(const Nodes& nodes, const Bound& bound, const Limit& limit, const Visit& visit) {
  std::array<std::uint32_t, stack_size> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const auto& node = nodes[stack[--top]];
    if (bound(node) > limit()) continue;
    if (node.left == 0) {
      visit(node);
    } else {
      const bool left_first = bound(nodes[node.left]) <= bound(nodes[node.left + 1]);
      stack[top++] = node.left + (left_first ? 1 : 0);
      stack[top++] = node.left + (left_first ? 0 : 1);
    }
  }
}

double squared_distance_to_farthest(const Box& box, std::span<const Vec3> points) {
  double farthest = 0;
  for (const Vec3& p : points) farthest = std::max(farthest, squared_distance(box, p));
  return farthest;
}

}  // namespace

std::uint32_t PowerDiagram::owner(const Vec3& x) const {
  std::uint32_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  visit_nearest_first(
      nodes_,
      [&](const Node& n) {
        return squared_distance(Box{n.lower, n.upper}, x) - n.largest_radius * n.largest_radius;
      },
      [&] { return least; },
      [&](const Node& leaf) {
        for (std::uint32_t k = leaf.begin; k < leaf.end; ++k) {
          const std::uint32_t i = order_[k];
          const double p = power(spheres_[i], x);
          // mutant power-owner-of-equals: `< least || (p == least && i < best)` -> `<= least`
          if (p < least || (p == least && i < best)) least = p, best = i;
        }
      });
  return best;
}

PowerDiagram::Growth PowerDiagram::least_growth(std::span<const Vec3> points) const {
  assert(!points.empty());
  Growth best{0, std::numeric_limits<double>::infinity()};
  visit_nearest_first(
      nodes_,
      [&](const Node& n) {
        return std::sqrt(squared_distance_to_farthest({n.lower, n.upper}, points)) - n.largest_radius;
      },
      [&] { return best.amount; },
      [&](const Node& leaf) {
        for (std::uint32_t k = leaf.begin; k < leaf.end; ++k) {
          const std::uint32_t i = order_[k];
          const double amount = farthest_distance(spheres_[i].center, points) - spheres_[i].radius;
          // mutant power-growth-of-equals: `< best.amount ... == best.amount && i < best.sphere)` -> `<= best.amount`
          if (amount < best.amount || (amount == best.amount && i < best.sphere)) best = {i, amount};
        }
      });
  return best;
}

PowerDiagram::Growth least_growth(std::span<const Sphere> spheres, std::span<const Vec3> points) {
  PowerDiagram::Growth best{0, std::numeric_limits<double>::infinity()};
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const double amount = farthest_distance(spheres[i].center, points) - spheres[i].radius;
    if (amount < best.amount) best = {i, amount};
  }
  return best;
}

void PowerDiagram::candidates(const Triangle& triangle, std::vector<std::uint32_t>& found) const {
  found.clear();
  const Vec3 middle = (triangle[0] + triangle[1] + triangle[2]) / 3.0;
  double reach = 0;
  for (const Vec3& p : triangle) reach = std::max(reach, distance(p, middle));

  // The power that some sphere guarantees on the whole triangle: the maximum over its corners, because powers are
  // convex.
  double guaranteed = std::numeric_limits<double>::infinity();
  visit_nearest_first(
      nodes_,
      [&](const Node& n) {
        return squared_distance_to_farthest({n.lower, n.upper}, triangle) - n.largest_radius * n.largest_radius;
      },
      [&] { return guaranteed; },
      [&](const Node& leaf) {
        for (std::uint32_t k = leaf.begin; k < leaf.end; ++k) {
          const Sphere& s = spheres_[order_[k]];
          guaranteed =
              std::min(guaranteed, std::max({power(s, triangle[0]), power(s, triangle[1]), power(s, triangle[2])}));
        }
      });
  std::array<std::uint32_t, stack_size> stack;
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const Node& node = nodes_[stack[--top]];
    const double to_box = std::sqrt(squared_distance(Box{node.lower, node.upper}, middle));
    const double nearest_in_node = std::max(0.0, to_box - reach);
    if (least_power(nearest_in_node, node.largest_radius) > guaranteed) continue;
    if (node.left != 0) {
      stack[top++] = node.left;
      stack[top++] = node.left + 1;
      continue;
    }
    for (std::uint32_t k = node.begin; k < node.end; ++k) {
      const Sphere& s = spheres_[order_[k]];
      const double nearest = std::max(0.0, distance(s.center, middle) - reach);
      if (least_power(nearest, s.radius) <= guaranteed) found.push_back(order_[k]);
    }
  }
  std::sort(found.begin(), found.end());
}

void PowerDiagram::cut(const FacetGeometry& facet, std::vector<std::uint32_t>& scratch, CutFacet& cut) const {
  candidates(facet.corners, scratch);
  cut_by_power(facet, whole_facet, spheres_, scratch, cut);
}

}  // namespace morula
