// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "reference.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/triangle.hpp>
#include <stdexcept>
#include <string>

namespace morula::test {
namespace {

class PlainRules {
 public:
  PlainRules(const RestFacts& facts, const RuleOptions& options)
      : facts_(facts), mesh_(facts.mesh), tree_(facts.model.tree), options_(options) {}

  Sphere traditional(std::uint32_t node, bool by_area, const std::vector<Vec3>& now) const {
    const Sphere& rest = tree_.spheres[node];
    const bool is_void = facts_.enclosed[node].empty();
    std::uint32_t carrier = node;
    while (facts_.enclosed[carrier].empty() && !facts_.touches[carrier] && tree_.parent[carrier] != no_node)
      carrier = tree_.parent[carrier];
    const auto& vertices = facts_.enclosed[carrier].empty() ? facts_.of_nearest[carrier] : facts_.enclosed[carrier];
    const Vec3 center = rest.center + mean_displacement(vertices, now, [&](std::uint32_t v) {
                          return by_area ? facts_.vertex_area[v] : 1.0;
                        });
    if (is_void) return {center, rest.radius};
    double radius = 0;
    for (const std::uint32_t v : vertices) radius = std::max(radius, distance(center, now[v]));
    return {center, radius};
  }

  Sphere wrapped(std::uint32_t node, const std::vector<Sphere>& rest_spheres,
                 const std::vector<Sphere>& spheres) const {
    Vec3 center = tree_.spheres[node].center;
    for (const std::uint32_t c : facts_.children[node])
      center += (spheres[c].center - rest_spheres[c].center) / tree_.child_count[node];
    double radius = 0;
    for (const std::uint32_t c : facts_.children[node])
      radius = std::max(radius, distance(center, spheres[c].center) + spheres[c].radius);
    return {center, radius};
  }

  Sphere approach1(std::uint32_t node, const std::vector<Vec3>& now, const std::vector<Sphere>& rest_spheres,
                   const std::vector<Sphere>& spheres) const {
    const Sphere& rest = tree_.spheres[node];
    const bool is_leaf = tree_.is_leaf(node);
    const std::set<std::uint32_t>& vertices = facts_.linked[node];
    Vec3 center = rest.center;
    if (is_leaf || options_.approach1_inner_center == RuleOptions::InnerCenter::linked_vertices) {
      center += mean_displacement(vertices, now, [&](std::uint32_t v) {
        switch (options_.approach1_weights) {
          case RuleOptions::Weights::uniform:
            return 1.0;
          case RuleOptions::Weights::area:
            return facts_.vertex_area[v];
          case RuleOptions::Weights::inverse_distance:
            return 1 / std::max(distance(rest.center, mesh_.positions[v]), 1e-3 * rest.radius);
        }
        return 0.0;
      });
    } else {
      for (const std::uint32_t c : facts_.children[node])
        center += (spheres[c].center - rest_spheres[c].center) / tree_.child_count[node];
    }
    double largest_ratio = 0, largest_reach = 0;
    const auto add = [&](double before, double after) {
      const double raise = std::max(0.0, options_.distance_floor * rest.radius - before);
      if (before + raise > 1e-9 * rest.radius)
        largest_ratio = std::max(largest_ratio, (after + raise) / (before + raise));
      largest_reach = std::max(largest_reach, after);
    };
    if (is_leaf)
      for (const std::uint32_t v : vertices) add(distance(mesh_.positions[v], rest.center), distance(now[v], center));
    for (const std::uint32_t c : facts_.children[node])
      add(distance(rest.center, rest_spheres[c].center) + rest_spheres[c].radius,
          distance(center, spheres[c].center) + spheres[c].radius);
    return {center, largest_ratio > 0 ? rest.radius * largest_ratio : rest.radius + largest_reach};
  }

  Sphere approach2(std::uint32_t node, const std::vector<Vec3>& now, const std::vector<Sphere>& rest_spheres,
                   const std::vector<Sphere>& spheres) const {
    const Sphere& rest = tree_.spheres[node];
    Box before, after;
    if (tree_.is_leaf(node))
      for (const std::uint32_t v : facts_.linked[node]) before.add(mesh_.positions[v]), after.add(now[v]);
    for (const std::uint32_t c : facts_.children[node]) add(before, rest_spheres[c]), add(after, spheres[c]);
    const Vec3 center = rest.center + (after.center() - before.center());
    const double d = farthest_corner(before, rest.center), d_now = farthest_corner(after, center);
    return {center, d > 1e-9 * rest.radius ? rest.radius * d_now / d : rest.radius + d_now};
  }

 private:
  template <class Weight>
  Vec3 mean_displacement(const std::set<std::uint32_t>& vertices, const std::vector<Vec3>& now,
                         const Weight& weight) const {
    Vec3 sum{}, plain{};
    double total = 0;
    for (const std::uint32_t v : vertices) {
      const Vec3 moved = now[v] - mesh_.positions[v];
      sum += moved * weight(v);
      plain += moved;
      total += weight(v);
    }
    return total > 0 ? sum / total : plain / static_cast<double>(vertices.size());
  }
  void add(Box& box, const Sphere& child) const {
    const double r = options_.approach2_inner_boxes == RuleOptions::InnerBoxes::child_spheres ? child.radius : 0.0;
    box.add(child.center - Vec3{r, r, r});
    box.add(child.center + Vec3{r, r, r});
  }
  static double farthest_corner(const Box& box, const Vec3& c) {
    double farthest = 0;
    for (int corner = 0; corner < 8; ++corner)
      farthest = std::max(
          farthest, distance(c, Vec3{corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                     corner & 4 ? box.upper.z : box.lower.z}));
    return farthest;
  }

  const RestFacts& facts_;
  const Mesh& mesh_;
  const SphereTree& tree_;
  const RuleOptions& options_;
};

}  // namespace

RestFacts::RestFacts(const Mesh& rest_mesh, const CoveredTree& rest_built)
    : mesh(rest_mesh), model(rest_built), vertex_area(mesh.vertex_count()) {
  const SphereTree& tree = model.tree;
  children.resize(tree.node_count());
  for (std::uint32_t i = 1; i < tree.node_count(); ++i) children[tree.parent[i]].push_back(i);
  for (const Sphere& ball : tree.spheres) {
    std::set<std::uint32_t> touched, inside, nearest;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
      const Facet& facet = mesh.facets[f];
      const double d = std::sqrt(closest_point(mesh.corners(f), ball.center).squared_distance);
      if (d <= ball.radius) touched.insert(facet.begin(), facet.end());
      if (d < least) least = d, nearest = {facet.begin(), facet.end()};
      for (const std::uint32_t v : facet)
        if (distance(mesh.positions[v], ball.center) <= ball.radius) inside.insert(v);
    }
    touches.push_back(!touched.empty());
    linked.push_back(touched.empty() ? nearest : touched);
    enclosed.push_back(inside);
    of_nearest.push_back(nearest);
  }
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (const std::uint32_t v : mesh.facets[f]) vertex_area[v] += area(mesh.corners(f));
}

Reference reference_update(const RestFacts& facts, const UpdateOptions& options, const std::vector<Vec3>& positions,
                           std::span<const Sphere> body_rest, std::span<const Sphere> body_now) {
  const Mesh& mesh = facts.mesh;
  const SphereTree& tree = facts.model.tree;
  const PlainRules plain(facts, options.details);
  Reference result{{tree.spheres.begin(), tree.spheres.end()}, tree.spheres};
  for (auto node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
    const std::size_t level = tree.level_of(node);
    const Rule rule = options.rules[std::min(level, options.rules.size() - 1)];
    switch (rule == Rule::wrapped && tree.is_leaf(node) ? Rule::exact : rule) {
      case Rule::wrapped:
        result.rest[node] = plain.wrapped(node, result.rest, result.rest);
        result.now[node] = plain.wrapped(node, result.rest, result.now);
        break;
      case Rule::exact:
      case Rule::modal:
        result.rest[node] = body_rest[node];
        result.now[node] = body_now[node];
        break;
      case Rule::traditional:
      case Rule::weighted: {
        const bool by_area = rule == Rule::weighted;
        result.rest[node] = plain.traditional(node, by_area, mesh.positions);
        result.now[node] = plain.traditional(node, by_area, positions);
        break;
      }
      case Rule::approach1:
        result.now[node] = plain.approach1(node, positions, result.rest, result.now);
        break;
      case Rule::approach2:
        result.now[node] = plain.approach2(node, positions, result.rest, result.now);
        break;
      default:
        throw std::invalid_argument("the reference does not know the rule " + std::string(name(rule)));
    }
  }
  return result;
}

double owned_reach(const CoveredTree& model, std::uint32_t node, const Vec3& center,
                   const std::vector<Vec3>& positions) {
  double reach = 0;
  for (const std::uint32_t c : model.cover.region_corners(node))
    reach = std::max(reach, distance(center, corner_position(model.cover, c, positions)));
  return reach;
}

}  // namespace morula::test
