// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/paper_rules.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <morula/query/triangle_bvh.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <vector>

#include "parallel/interruption.hpp"
#include "update/points/kernels.hpp"
#include "update/rules/engine_table.hpp"

namespace morula::detail {
namespace {

// The paper's links: the vertices that a sphere follows [garcia2005, sec. 3.1].
struct Links {
  std::vector<std::uint32_t> vertices;  // mesh vertices, ascending, each once; never empty
  bool fallback = false;                // true: the regular place has no vertices
};

std::vector<std::uint32_t> vertices_of(const MeshView& mesh, const std::vector<std::uint32_t>& facets) {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(3 * facets.size());
  for (const std::uint32_t f : facets) vertices.insert(vertices.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// The three vertices of every facet that meets the closed ball, inside or outside of it; of the nearest facet if none
// does (fallback).
Links linked_vertices(const MeshView& mesh, const TriangleBvh& bvh, const Sphere& ball) {
  std::vector<std::uint32_t> facets;
  bvh.facets_touching(ball, facets);
  if (!facets.empty()) return {vertices_of(mesh, facets), false};
  return {vertices_of(mesh, {bvh.closest_point(ball.center)->facet}), true};
}

// The vertices inside the closed ball of a node. If there are none (fallback, a void sphere), those of the nearest
// facet that meets the ball; if there is none either, the links of the node's parent; at the root, the nearest facet's.
Links enclosed_vertices(const MeshView& mesh, const TriangleBvh& bvh, const SphereTree& tree, std::uint32_t node) {
  bool fallback = false;
  std::vector<std::uint32_t> facets;
  for (;;) {
    const Sphere& ball = tree.spheres[node];
    // A vertex inside the ball is part of a facet that meets it.
    bvh.facets_touching(ball, facets);
    std::vector<std::uint32_t> vertices = vertices_of(mesh, facets);
    std::erase_if(vertices,
                  [&](std::uint32_t v) { return !(distance(mesh.positions[v], ball.center) <= ball.radius); });
    if (!vertices.empty()) return {std::move(vertices), fallback};
    fallback = true;
    if (!facets.empty() || tree.parent[node] == no_node)
      return {vertices_of(mesh, {bvh.closest_point(ball.center)->facet}), fallback};
    node = tree.parent[node];
  }
}

// A third of each facet's area to each of its vertices, at rest.
std::vector<double> vertex_areas(const MeshView& mesh) {
  std::vector<double> areas(mesh.vertex_count());
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const double third = area(mesh.corners(f)) / 3;
    for (const std::uint32_t v : mesh.facets[f]) areas[v] += third;
  }
  return areas;
}

struct FourPoints {
  Float4 x, y, z;
};
// Four points by index, coordinate by coordinate.
FourPoints gather(const LocalPoint* points, const std::uint32_t* index) {
  FourPoints p{Float4::load(points[index[0]]), Float4::load(points[index[1]]), Float4::load(points[index[2]])};
  Float4::transpose_points(p.x, p.y, p.z, Float4::load(points[index[3]]));
  return p;
}

constexpr std::size_t nodes_per_chunk = 16;
// Distances below this share of the radius are no divisors.
constexpr float least_divisor = 1e-9f;
constexpr float infinity = std::numeric_limits<float>::infinity();

bool is_paper_rule(Rule rule) {
  const auto row = std::find_if(engine_table.begin(), engine_table.end(),
                                [&](const EngineRow& candidate) { return candidate.rule == rule; });
  return row->bind == bind_paper_rules;
}

// NaN becomes the bound as well.
float bounded(float radius) {
  return radius < largest_radius ? radius : largest_radius;
}

// Equations 3 and 4: reach of a child sphere from its parent's center.
float reach_of_child(const Vec3f& center, const Spheref& child) {
  return distance(center, child.center) + child.radius;
}

// Distance from c to the farthest corner of a box.
float reach_of_box(const Vec3f& lower, const Vec3f& upper, const Vec3f& c) {
  const auto farther = [](float a, float b, float x) { return std::max(std::abs(a - x), std::abs(b - x)); };
  return length(Vec3f{farther(lower.x, upper.x, c.x), farther(lower.y, upper.y, c.y), farther(lower.z, upper.z, c.z)});
}

// Distances from c to four points of a list.
Float4 four_distances(const LocalPoint* points, const std::uint32_t* index, const Vec3f& c) {
  const FourPoints p = gather(points, index);
  const Float4 dx = p.x - Float4(c.x), dy = p.y - Float4(c.y), dz = p.z - Float4(c.z);
  return sqrt(dx * dx + dy * dy + dz * dz);
}

// Equation 5 and similar ones: a radius grown by the ratio of two reaches; by the reach itself if there is nothing to
// divide by. At rest both reaches are the same number, so the ratio is exactly 1.
float grown(float radius, float reach, float rest_reach) {
  return bounded(rest_reach > least_divisor * radius ? radius * (reach / rest_reach) : radius + reach);
}

// Moves the center towards the child that it has to reach farthest for, by less each time; returns the best place on
// the way. That converges to the smallest sphere; after 16 steps, with about 8 children, it is 1 % larger on average
// and 3 % at worst.
Vec3f pulled_to_farthest(const Vec3f& start, std::span<const Spheref> children) {
  constexpr int steps = 16, first_share = 8;
  Vec3 center(start), best = center;
  double least_reach = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= steps; ++step) {
    double reach = 0, apart = 0;
    Vec3 towards{};
    for (const Spheref& child : children) {
      const Vec3 offset = Vec3(child.center) - center;
      const double distance = length(offset), r = distance + static_cast<double>(child.radius);
      if (r > reach) reach = r, apart = distance, towards = offset;
    }
    if (reach < least_reach) least_reach = reach, best = center;
    if (!(apart > 0)) break;
    center += towards * (reach / (apart * (first_share + step)));
  }
  return Vec3f(best);
}

// Weights that add up to 1.
std::vector<double> link_weights(const MeshView& mesh, const Sphere& ball, const std::vector<std::uint32_t>& vertices,
                                 RuleOptions::Weights kind, const std::vector<double>& areas) {
  // A vertex at the very center must not outweigh all others.
  constexpr double nearest = 1e-3;
  std::vector<double> weights;
  double sum = 0;
  for (const std::uint32_t v : vertices) {
    double weight = 1;
    if (kind == RuleOptions::Weights::area) weight = areas[v];
    if (kind == RuleOptions::Weights::inverse_distance)
      weight = 1 / std::max(distance(mesh.positions[v], ball.center), nearest * ball.radius);
    weights.push_back(weight);
    sum += weight;
  }
  const bool usable = sum > 0 && std::isfinite(sum);  // not so for facets without area, or a point sphere on a vertex
  for (double& weight : weights) weight = usable ? weight / sum : 1 / static_cast<double>(weights.size());
  return weights;
}

}  // namespace

PaperRules::PaperRules(const Binding& binding)
    : boxes_of_centers_(binding.options.details.approach2_inner_boxes == RuleOptions::InnerBoxes::child_centers),
      wraps_smallest_(binding.options.details.wrapped_center == RuleOptions::WrappedCenter::smallest),
      distance_floor_(binding.options.details.distance_floor) {
  const SphereTree& tree = binding.model.tree;
  level_begin_.push_back(0);
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      if (!is_paper_rule(binding.rules.of_node[node])) continue;
      Node n{.node = node, .rule = binding.rules.of_node[node]};
      n.first_child = tree.first_child[node];
      n.child_count = tree.child_count[node];
      n.rest = binding.tree_spheres[node];
      nodes_.push_back(n);
      only_wraps_ = only_wraps_ && n.rule == Rule::wrapped;
    }
    level_begin_.push_back(static_cast<std::uint32_t>(nodes_.size()));
  }
  bind_links(binding);

  // A parent divides by its children's spheres at rest, whatever rule makes them: ratios at rest are then exactly 1 in
  // every mixture. So rest spheres are computed from the leaves up.
  rest_spheres_.assign(binding.spheres.begin(), binding.spheres.end());
  for (auto n = nodes_.rbegin(); n != nodes_.rend(); ++n) {
    n->rest_sum = weighted_sum(*n, binding.local.points());
    if (n->rule == Rule::approach1 || n->rule == Rule::approach2) continue;
    rest_spheres_[n->node] = n->rule == Rule::wrapped ? wrapped(*n, binding.rest.rounding, rest_spheres_)
                                                      : traditional(*n, binding.local.points(), binding.rest.rounding);
  }
  for (Node& n : nodes_) bind_rest(binding, n);
  std::copy(rest_spheres_.begin(), rest_spheres_.end(), binding.spheres.begin());
}

void PaperRules::bind_links(const Binding& binding) {
  const MeshView& mesh = binding.mesh;
  const SphereTree& tree = binding.model.tree;
  const RuleOptions& options = binding.options.details;
  BindReport& report = binding.report;
  const auto is_traditional = [](const Node& n) { return n.rule == Rule::traditional || n.rule == Rule::weighted; };
  std::vector<Links> found(nodes_.size());
  parallel_for(binding.workers, nodes_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Node& n = nodes_[k];
      if (is_traditional(n))
        found[k] = enclosed_vertices(mesh, *binding.bvh, tree, n.node);
      else if (n.child_count == 0 || (n.rule == Rule::approach1 &&
                                      options.approach1_inner_center == RuleOptions::InnerCenter::linked_vertices))
        found[k] = linked_vertices(mesh, *binding.bvh, tree.spheres[n.node]);
    }
  });

  const std::vector<double> areas = vertex_areas(mesh);
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    Node& n = nodes_[k];
    const std::vector<std::uint32_t>& vertices = found[k].vertices;
    n.link_begin = n.link_end = static_cast<std::uint32_t>(points_.size());
    if (vertices.empty()) continue;
    n.keeps_radius = is_traditional(n) && found[k].fallback;
    report.void_spheres += n.keeps_radius;
    report.unlinked_spheres += !is_traditional(n) && n.child_count == 0 && found[k].fallback;
    if (is_traditional(n) ? !n.keeps_radius : n.child_count == 0) tested_points_ += vertices.size();

    const auto kind = n.rule == Rule::weighted    ? RuleOptions::Weights::area
                      : n.rule == Rule::approach1 ? options.approach1_weights
                                                  : RuleOptions::Weights::uniform;
    const std::vector<double> weights = link_weights(mesh, tree.spheres[n.node], vertices, kind, areas);
    // Sorted by point: neighbors in the tree are then neighbors in memory.
    std::vector<std::pair<std::uint32_t, float>> links;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      links.emplace_back(binding.local.point_of(vertices[i]), static_cast<float>(weights[i]));
    std::sort(links.begin(), links.end());
    for (const auto& [point, weight] : links) points_.push_back(point), weights_.push_back(weight);
    while (points_.size() % points_per_group != 0) {
      points_.push_back(points_.back());
      weights_.push_back(0.0f);
    }
    n.link_end = static_cast<std::uint32_t>(points_.size());
  }
}

void PaperRules::bind_rest(const Binding& binding, Node& n) {
  const std::span<const LocalPoint> points = binding.local.points();
  if (n.rule == Rule::approach1) {
    n.ratio_begin = static_cast<std::uint32_t>(divisors_.size());
    if (n.child_count > 0)
      for (std::uint32_t c = 0; c < n.child_count; ++c)
        add_ratio(n, reach_of_child(n.rest.center, rest_spheres_[n.first_child + c]));
    else
      for (std::uint32_t i = n.link_begin; i < n.link_end; i += 4)
        for (const float d : four_distances(points.data(), &points_[i], n.rest.center).lanes()) add_ratio(n, d);
  }
  if (n.rule == Rule::approach2) {
    const Boxf box = box_of(n, points, rest_spheres_);
    n.rest_box_center = box.center();
    n.rest_reach = reach_of_box(box.lower, box.upper, n.rest.center);
  }
}

// Adds (d' + k) / (d + k) with k = (floor r - d)+ to the ratios of a node: 1 at rest, and never so
// large for a near vertex as d' / d. With floor 0 it is the paper's. Distances too small to divide by never count.
void PaperRules::add_ratio(Node& n, float rest_distance) {
  const float raise = std::max(0.0f, static_cast<float>(distance_floor_) * n.rest.radius - rest_distance);
  const float divisor = rest_distance + raise;
  const bool counts = divisor > least_divisor * n.rest.radius;
  n.has_ratio = n.has_ratio || counts;
  divisors_.push_back(counts ? divisor : infinity);
  raises_.push_back(raise);
}

void PaperRules::update_level(std::size_t level, const RuleFrame& frame, std::span<Spheref> spheres,
                              Workers& workers) noexcept {
  const Uninterrupted whole;
  const std::span<const LocalPoint> points = frame.points;
  const std::size_t first = level_begin_[level];
  parallel_for(workers, level_begin_[level + 1] - first, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = first + begin; k < first + end; ++k) {
      const Node& n = nodes_[k];
      switch (n.rule) {
        case Rule::traditional:
        case Rule::weighted:
          spheres[n.node] = traditional(n, points, frame.rounding);
          break;
        case Rule::approach1:
          spheres[n.node] = approach1(n, points, spheres);
          break;
        case Rule::approach2:
          spheres[n.node] = approach2(n, points, spheres);
          break;
        case Rule::wrapped:
          spheres[n.node] = wrapped(n, frame.rounding, spheres);
          break;
        default:
          assert(!"a rule of another engine");
      }
    }
  });
}

// The sum is in double: a root may sum up a hundred thousand vertices.
Vec3 PaperRules::weighted_sum(const Node& n, std::span<const LocalPoint> points) const noexcept {
  Vec3 sums[2]{};  // two, so that an addition need not wait for the last one
  for (std::uint32_t i = n.link_begin; i < n.link_end; i += 2)
    for (std::uint32_t k = 0; k < 2; ++k) {
      const LocalPoint& p = points[points_[i + k]];
      sums[k] += Vec3(Vec3f{p.x, p.y, p.z}) * static_cast<double>(weights_[i + k]);
    }
  return sums[0] + sums[1];
}

Vec3f PaperRules::moved_by_links(const Node& n, std::span<const LocalPoint> points) const noexcept {
  return n.rest.center + Vec3f(weighted_sum(n, points) - n.rest_sum);
}

// D.1: c' = c + sum b (v' - v), r' = max |v' - c'| over the enclosed vertices; they stay enclosed.
Spheref PaperRules::traditional(const Node& n, std::span<const LocalPoint> points,
                                const Rounding& rounding) const noexcept {
  const Vec3f center = moved_by_links(n, points);
  if (n.keeps_radius) return {center, n.rest.radius};
  float squared = 0;
  kernels().farthest(points.data(), {}, links(n), std::span(&center, 1), &squared);
  return {center, rounding.covering_radius(squared, center)};
}

Vec3f PaperRules::moved_by_children(const Node& n, std::span<const Spheref> spheres) const noexcept {
  Vec3 sum{};
  for (std::uint32_t c = n.first_child; c < n.first_child + n.child_count; ++c)
    sum += Vec3(spheres[c].center) - Vec3(rest_spheres_[c].center);
  return n.rest.center + Vec3f(sum / static_cast<double>(n.child_count));
}

// Bottom up: around the children's spheres.
Spheref PaperRules::wrapped(const Node& n, const Rounding& rounding, std::span<const Spheref> spheres) const noexcept {
  const std::span<const Spheref> children = spheres.subspan(n.first_child, n.child_count);
  Vec3f center = moved_by_children(n, spheres);
  if (wraps_smallest_) center = pulled_to_farthest(center, children);
  // mutant wrapped-stops-with-its-children: `rounding ... center)` -> `bounded(rounding.wrapping_radius(children, center))`
  return {center, rounding.wrapping_radius(children, center)};
}

// Equations 2 to 4 [garcia2005].
Spheref PaperRules::approach1(const Node& n, std::span<const LocalPoint> points,
                              std::span<const Spheref> spheres) const noexcept {
  const Vec3f center = n.link_begin < n.link_end ? moved_by_links(n, points) : moved_by_children(n, spheres);
  float largest_ratio = 0, largest_reach = 0;
  if (n.child_count > 0) {
    for (std::uint32_t c = 0; c < n.child_count; ++c) {
      const float reach = reach_of_child(center, spheres[n.first_child + c]);
      largest_reach = std::max(largest_reach, reach);
      largest_ratio = std::max(largest_ratio, (reach + raises_[n.ratio_begin + c]) / divisors_[n.ratio_begin + c]);
    }
  } else {
    Float4 ratio(0.0f), reach(0.0f);
    const float* divisors = &divisors_[n.ratio_begin];
    const float* raises = &raises_[n.ratio_begin];
    for (std::uint32_t i = n.link_begin; i < n.link_end; i += 4) {
      const Float4 d = four_distances(points.data(), &points_[i], center);
      const std::size_t k = i - n.link_begin;
      ratio = max((d + Float4::load(raises + k)) / Float4::load(divisors + k), ratio);
      reach = max(d, reach);
    }
    largest_ratio = largest_lane(ratio);
    largest_reach = largest_lane(reach);
  }
  return {center, bounded(n.has_ratio ? n.rest.radius * largest_ratio : n.rest.radius + largest_reach)};
}

// Equations 1 and 5 [garcia2005].
Spheref PaperRules::approach2(const Node& n, std::span<const LocalPoint> points,
                              std::span<const Spheref> spheres) const noexcept {
  const Boxf box = box_of(n, points, spheres);
  const Vec3f center = n.rest.center + (box.center() - n.rest_box_center);
  return {center, grown(n.rest.radius, reach_of_box(box.lower, box.upper, center), n.rest_reach)};
}

PaperRules::Boxf PaperRules::box_of(const Node& n, std::span<const LocalPoint> points,
                                    std::span<const Spheref> spheres) const noexcept {
  if (n.child_count == 0) {
    Float4 lower(infinity), upper(-infinity);
    for (std::uint32_t i = n.link_begin; i < n.link_end; i += 2) {
      const Float4 p = Float4::load(points[points_[i]]), q = Float4::load(points[points_[i + 1]]);
      lower = min(min(p, q), lower);
      upper = max(max(p, q), upper);
    }
    const auto l = lower.lanes(), u = upper.lanes();
    return {{l[0], l[1], l[2]}, {u[0], u[1], u[2]}};
  }
  Boxf box{{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  for (std::uint32_t c = n.first_child; c < n.first_child + n.child_count; ++c) {
    const float r = boxes_of_centers_ ? 0.0f : spheres[c].radius;
    const Vec3f half{r, r, r};
    box.lower = min(box.lower, spheres[c].center - half);
    box.upper = max(box.upper, spheres[c].center + half);
  }
  return box;
}

std::unique_ptr<RuleEngine> bind_paper_rules(const Binding& binding) {
  return std::make_unique<PaperRules>(binding);
}

}  // namespace morula::detail
