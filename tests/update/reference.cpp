// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "reference.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/triangle.hpp>
#include <set>

namespace morula::test {
namespace {

class PlainRules {
 public:
  PlainRules(const Mesh& mesh, const SphereTree& tree, const RuleOptions& options)
      : mesh_(mesh), tree_(tree), options_(options) {}

  Sphere traditional(std::uint32_t node, bool by_area, const std::vector<Vec3>& now) const {
    const Sphere& rest = tree_.spheres[node];
    std::set<std::uint32_t> vertices = enclosed(rest);
    const bool is_void = vertices.empty();
    for (std::uint32_t at = node; vertices.empty(); at = tree_.parent[at]) {
      vertices = enclosed(tree_.spheres[at]);
      if (vertices.empty() && (tree_.parent[at] == no_node || !touching(tree_.spheres[at]).empty()))
        vertices = of_facet(nearest_facet(tree_.spheres[at].center));
    }
    const Vec3 center =
        rest.center + mean_displacement(vertices, now, [&](std::uint32_t v) { return by_area ? area_about(v) : 1.0; });
    if (is_void) return {center, rest.radius};
    double radius = 0;
    for (const std::uint32_t v : vertices) radius = std::max(radius, distance(center, now[v]));
    return {center, radius};
  }

  Sphere approach1(std::uint32_t node, const std::vector<Vec3>& now, const std::vector<Sphere>& rest_spheres,
                   const std::vector<Sphere>& spheres) const {
    const Sphere& rest = tree_.spheres[node];
    const bool is_leaf = tree_.is_leaf(node);
    const std::set<std::uint32_t> vertices = linked(rest);
    Vec3 center = rest.center;
    if (is_leaf || options_.approach1_inner_center == RuleOptions::InnerCenter::linked_vertices) {
      center += mean_displacement(vertices, now, [&](std::uint32_t v) {
        switch (options_.approach1_weights) {
          case RuleOptions::Weights::uniform:
            return 1.0;
          case RuleOptions::Weights::area:
            return area_about(v);
          case RuleOptions::Weights::inverse_distance:
            return 1 / std::max(distance(rest.center, mesh_.positions[v]), 1e-3 * rest.radius);
        }
        return 0.0;
      });
    } else {
      for (const std::uint32_t c : children(node))
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
    for (const std::uint32_t c : children(node))
      add(distance(rest.center, rest_spheres[c].center) + rest_spheres[c].radius,
          distance(center, spheres[c].center) + spheres[c].radius);
    return {center, largest_ratio > 0 ? rest.radius * largest_ratio : rest.radius + largest_reach};
  }

  Sphere approach2(std::uint32_t node, const std::vector<Vec3>& now, const std::vector<Sphere>& rest_spheres,
                   const std::vector<Sphere>& spheres) const {
    const Sphere& rest = tree_.spheres[node];
    Box before, after;
    if (tree_.is_leaf(node))
      for (const std::uint32_t v : linked(rest)) before.add(mesh_.positions[v]), after.add(now[v]);
    for (const std::uint32_t c : children(node)) add(before, rest_spheres[c]), add(after, spheres[c]);
    const Vec3 center = rest.center + (after.center() - before.center());
    const double d = farthest_corner(before, rest.center), d_now = farthest_corner(after, center);
    return {center, d > 1e-9 * rest.radius ? rest.radius * d_now / d : rest.radius + d_now};
  }

 private:
  std::vector<std::uint32_t> children(std::uint32_t node) const {
    std::vector<std::uint32_t> found;
    for (std::uint32_t i = 0; i < tree_.node_count(); ++i)
      if (tree_.parent[i] == node) found.push_back(i);
    return found;
  }
  double distance_to_facet(std::size_t f, const Vec3& p) const {
    return std::sqrt(closest_point(mesh_.corners(f), p).squared_distance);
  }
  std::vector<std::size_t> touching(const Sphere& ball) const {
    std::vector<std::size_t> found;
    for (std::size_t f = 0; f < mesh_.facet_count(); ++f)
      if (distance_to_facet(f, ball.center) <= ball.radius) found.push_back(f);
    return found;
  }
  std::size_t nearest_facet(const Vec3& p) const {
    std::size_t nearest = 0;
    for (std::size_t f = 0; f < mesh_.facet_count(); ++f)
      if (distance_to_facet(f, p) < distance_to_facet(nearest, p)) nearest = f;
    return nearest;
  }
  std::set<std::uint32_t> of_facet(std::size_t f) const { return {mesh_.facets[f].begin(), mesh_.facets[f].end()}; }
  std::set<std::uint32_t> linked(const Sphere& ball) const {
    std::set<std::uint32_t> vertices;
    for (const std::size_t f : touching(ball)) vertices.merge(of_facet(f));
    return vertices.empty() ? of_facet(nearest_facet(ball.center)) : vertices;
  }
  std::set<std::uint32_t> enclosed(const Sphere& ball) const {
    std::set<std::uint32_t> vertices;
    for (const Facet& f : mesh_.facets)
      for (const std::uint32_t v : f)
        if (distance(mesh_.positions[v], ball.center) <= ball.radius) vertices.insert(v);
    return vertices;
  }
  double area_about(std::uint32_t v) const {
    double sum = 0;
    for (std::size_t f = 0; f < mesh_.facet_count(); ++f)
      sum +=
          area(mesh_.corners(f)) * static_cast<double>(std::count(mesh_.facets[f].begin(), mesh_.facets[f].end(), v));
    return sum;
  }
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

  const Mesh& mesh_;
  const SphereTree& tree_;
  const RuleOptions& options_;
};

}  // namespace

Reference reference_update(const Mesh& mesh, const Built& built, const UpdateOptions& options,
                           const std::vector<Vec3>& positions, std::span<const Sphere> body_rest,
                           std::span<const Sphere> body_now) {
  const SphereTree& tree = built.tree;
  const PlainRules plain(mesh, tree, options.details);
  Reference result{{tree.spheres.begin(), tree.spheres.end()}, tree.spheres};
  for (auto node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
    const std::size_t level = tree.level_of(node);
    switch (options.rules[std::min(level, options.rules.size() - 1)]) {
      case Rule::exact:
        result.rest[node] = body_rest[node];
        result.now[node] = body_now[node];
        break;
      case Rule::traditional:
      case Rule::weighted: {
        const bool by_area = options.rules[std::min(level, options.rules.size() - 1)] == Rule::weighted;
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
    }
  }
  return result;
}

double owned_reach(const Built& built, std::uint32_t node, const Vec3& center, const std::vector<Vec3>& positions) {
  double reach = 0;
  for (const std::uint32_t c : built.cover.region_corners(node))
    reach = std::max(reach, distance(center, corner_position(built.cover, c, positions)));
  return reach;
}

}  // namespace morula::test
