// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rules of variants: Approach 1 and 2 once more, node by node, without the library's engines.
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/query/triangle_bvh.hpp>
#include <morula/study/variants.hpp>
#include <morula/tree/sphere_state.hpp>
#include <morula/version.hpp>

namespace morula::study {
namespace {

using Links = std::vector<std::uint32_t>;

constexpr float infinity = std::numeric_limits<float>::infinity();
// As in the library: a smaller share of the radius is no divisor.
constexpr float least_divisor = 1e-9f;
constexpr double nearest_weight = 1e-3;
constexpr std::size_t nearest_count = 8;

void make_set(Links& vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
}

Links vertices_of(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  Links vertices;
  for (const std::uint32_t f : facets) vertices.insert(vertices.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  make_set(vertices);
  return vertices;
}

/// The vertices of one sphere, by each kind of link.
class Linker {
 public:
  Linker(const Mesh& mesh, const CoveredTree& model) : mesh_(mesh), model_(model), bvh_(mesh) {
    std::vector<std::uint32_t> all(mesh.facet_count());
    for (std::uint32_t f = 0; f < all.size(); ++f) all[f] = f;
    used_ = vertices_of(mesh, all);
  }

  Links links(Variant::Links kind, std::uint32_t node) const {
    Links found = regular(kind, node);
    const Vec3& center = model_.tree.spheres[node].center;
    return found.empty() ? vertices_of(mesh_, {bvh_.closest_point(center)->facet}) : found;
  }
  std::uint32_t first_used() const { return used_.front(); }

 private:
  Links regular(Variant::Links kind, std::uint32_t node) const {
    const Sphere& ball = model_.tree.spheres[node];
    std::vector<std::uint32_t> facets;
    switch (kind) {
      case Variant::Links::facets:
        bvh_.facets_touching(ball, facets);
        return vertices_of(mesh_, facets);
      case Variant::Links::region:
        for (std::uint32_t p = model_.cover.region_begin[node]; p < model_.cover.region_end[node]; ++p)
          facets.push_back(model_.cover.patch_facet[p]);
        return vertices_of(mesh_, facets);
      case Variant::Links::enclosed: {
        Links inside;
        for (const std::uint32_t v : used_)
          if (distance(mesh_.positions[v], ball.center) <= ball.radius) inside.push_back(v);
        return inside;
      }
      case Variant::Links::nearest:
        break;
    }
    Links nearest = used_;
    const auto count = static_cast<std::ptrdiff_t>(std::min(nearest_count, nearest.size()));
    std::partial_sort(nearest.begin(), nearest.begin() + count, nearest.end(), [&](std::uint32_t a, std::uint32_t b) {
      const double to_a = squared_distance(mesh_.positions[a], ball.center);
      const double to_b = squared_distance(mesh_.positions[b], ball.center);
      return to_a != to_b ? to_a < to_b : a < b;
    });
    nearest.resize(static_cast<std::size_t>(count));
    return nearest;
  }

  const Mesh& mesh_;
  const CoveredTree& model_;
  TriangleBvh bvh_;
  Links used_;
};

std::vector<double> vertex_areas(const Mesh& mesh) {
  std::vector<double> areas(mesh.vertex_count());
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const double third = area(MeshView(mesh).corners(f)) / 3;
    for (const std::uint32_t v : mesh.facets[f]) areas[v] += third;
  }
  return areas;
}

/// Weights that add up to 1; equal ones if these do not.
void normalize(std::vector<double>& weights) {
  double sum = 0;
  for (const double weight : weights) sum += weight;
  const bool usable = sum > 0 && std::isfinite(sum);
  for (double& weight : weights) weight = usable ? weight / sum : 1 / static_cast<double>(weights.size());
}

struct Boxf {
  Vec3f lower{infinity, infinity, infinity}, upper{-infinity, -infinity, -infinity};
  void add(const Vec3f& a, const Vec3f& b) { lower = min(lower, a), upper = max(upper, b); }
  Vec3f center() const { return (lower + upper) * 0.5f; }
  /// Distance from c to the farthest corner.
  float reach(const Vec3f& c) const {
    const auto farther = [](float a, float b, float x) { return std::max(std::abs(a - x), std::abs(b - x)); };
    return length(
        Vec3f{farther(lower.x, upper.x, c.x), farther(lower.y, upper.y, c.y), farther(lower.z, upper.z, c.z)});
  }
};

float distance_between(const Vec3f& a, const Vec3f& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// One variant on one tree.
class VariantRule {
 public:
  VariantRule(const Variant& variant, const Mesh& mesh, const CoveredTree& model)
      : variant_(variant), mesh_(mesh), tree_(model.tree), nodes_(tree_.node_count()), spheres_(tree_.node_count()) {
    const Linker linker(mesh, model);
    guide_ = linker.first_used();
    place(mesh.positions);
    narrow_spheres(tree_.spheres, origin_, rest_);
    const std::vector<double> areas = vertex_areas(mesh);
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) bind(linker, areas, node);
  }

  SphereTree follow(const std::vector<Vec3>& positions) {
    place(positions);
    for (auto node = static_cast<std::uint32_t>(nodes_.size()); node-- > 0;)
      spheres_[node] = variant_.approach == Variant::Approach::first ? first(node) : second(node);
    SphereTree tree = tree_;
    tree.nested = false;
    for (std::size_t i = 0; i < spheres_.size(); ++i)
      tree.spheres[i] = {origin_ + Vec3(spheres_[i].center), static_cast<double>(spheres_[i].radius)};
    return tree;
  }

 private:
  struct Node {
    Links links;  // empty where the children take their place
    std::vector<float> weights;
    std::vector<double> child_weights;  // empty: equal
    Vec3 rest_sum{};
    std::vector<float> divisors, raises;  // of links or children
    bool has_ratio = false;
    Vec3f rest_box_center{};
    float rest_reach = 0;
  };

  /// Points about an origin that moves with a vertex, in float.
  void place(const std::vector<Vec3>& positions) {
    const Vec3 at = bounding_box(mesh_).center() + (positions[guide_] - mesh_.positions[guide_]);
    origin_ = Vec3(Vec3f(at));
    points_.clear();
    for (const Vec3& p : positions) points_.push_back(Vec3f(p - origin_));
  }

  void bind(const Linker& linker, const std::vector<double>& areas, std::uint32_t node) {
    Node& n = nodes_[node];
    const Sphere& ball = tree_.spheres[node];
    if (tree_.is_leaf(node) || variant_.inner_vertices) {
      n.links = linker.links(variant_.links, node);
      std::vector<double> weights;
      for (const std::uint32_t v : n.links) {
        weights.push_back(1);
        if (variant_.weights == Variant::Weights::area) weights.back() = areas[v];
        if (variant_.weights == Variant::Weights::inverse_distance)
          weights.back() = 1 / std::max(distance(mesh_.positions[v], ball.center), nearest_weight * ball.radius);
      }
      normalize(weights);
      for (const double weight : weights) n.weights.push_back(static_cast<float>(weight));
      n.rest_sum = weighted_sum(n);
    }
    const std::uint32_t child = tree_.first_child[node];
    if (variant_.weighs_children) {
      for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c)
        n.child_weights.push_back(
            1 / std::max(distance(tree_.spheres[child + c].center, ball.center), nearest_weight * ball.radius));
      normalize(n.child_weights);
    }
    for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c)
      add_ratio(node, reach(rest_[node].center, rest_[child + c]));
    if (tree_.is_leaf(node))
      for (const std::uint32_t v : n.links) add_ratio(node, distance_between(points_[v], rest_[node].center));
    const Boxf box = box_of(node, rest_);
    n.rest_box_center = box.center();
    n.rest_reach = box.reach(rest_[node].center);
  }

  void add_ratio(std::uint32_t node, float distance_at_rest) {
    Node& n = nodes_[node];
    const float radius = rest_[node].radius;
    const float raise = std::max(0.0f, static_cast<float>(variant_.distance_floor) * radius - distance_at_rest);
    const bool counts = distance_at_rest + raise > least_divisor * radius;
    n.has_ratio = n.has_ratio || counts;
    n.divisors.push_back(counts ? distance_at_rest + raise : infinity);
    n.raises.push_back(raise);
  }

  /// Equations 3 and 4.
  static float reach(const Vec3f& center, const Spheref& child) {
    return distance(center, child.center) + child.radius;
  }

  Vec3 weighted_sum(const Node& n) const {
    Vec3 sum{};
    for (std::size_t i = 0; i < n.links.size(); ++i)
      sum += Vec3(points_[n.links[i]]) * static_cast<double>(n.weights[i]);
    return sum;
  }

  Vec3f moved_center(std::uint32_t node) const {
    const Node& n = nodes_[node];
    if (!n.links.empty()) return rest_[node].center + Vec3f(weighted_sum(n) - n.rest_sum);
    Vec3 sum{};
    for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c) {
      const std::uint32_t child = tree_.first_child[node] + c;
      const Vec3 moved = Vec3(spheres_[child].center) - Vec3(rest_[child].center);
      sum += n.child_weights.empty() ? moved : moved * n.child_weights[c];
    }
    const double divisor = n.child_weights.empty() ? static_cast<double>(tree_.child_count[node]) : 1.0;
    return rest_[node].center + Vec3f(sum / divisor);
  }

  /// Equations 2 to 4.
  Spheref first(std::uint32_t node) const {
    const Node& n = nodes_[node];
    const Vec3f center = moved_center(node);
    float largest_ratio = 0, largest_reach = 0;
    const auto add = [&](float reach_now, std::size_t i) {
      largest_reach = std::max(largest_reach, reach_now);
      largest_ratio = std::max(largest_ratio, (reach_now + n.raises[i]) / n.divisors[i]);
    };
    for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c)
      add(reach(center, spheres_[tree_.first_child[node] + c]), c);
    if (tree_.is_leaf(node))
      for (std::size_t i = 0; i < n.links.size(); ++i) add(distance_between(points_[n.links[i]], center), i);
    const float radius = rest_[node].radius;
    return {center, n.has_ratio ? radius * largest_ratio : radius + largest_reach};
  }

  /// Equations 1 and 5.
  Spheref second(std::uint32_t node) const {
    const Node& n = nodes_[node];
    const Boxf box = box_of(node, spheres_);
    const Vec3f center = rest_[node].center + (box.center() - n.rest_box_center);
    const float radius = rest_[node].radius, reach_now = box.reach(center);
    return {center, n.rest_reach > least_divisor * radius ? radius * (reach_now / n.rest_reach) : radius + reach_now};
  }

  Boxf box_of(std::uint32_t node, const std::vector<Spheref>& spheres) const {
    Boxf box;
    for (const std::uint32_t v : nodes_[node].links) box.add(points_[v], points_[v]);
    if (!nodes_[node].links.empty()) return box;
    for (std::uint32_t c = 0; c < tree_.child_count[node]; ++c) {
      const Spheref& child = spheres[tree_.first_child[node] + c];
      const float r = variant_.boxes_of_centers ? 0.0f : child.radius;
      box.add(child.center - Vec3f{r, r, r}, child.center + Vec3f{r, r, r});
    }
    return box;
  }

  Variant variant_;
  const Mesh& mesh_;
  const SphereTree& tree_;
  std::vector<Node> nodes_;
  std::vector<Spheref> rest_, spheres_;
  std::vector<Vec3f> points_;
  Vec3 origin_{};
  std::uint32_t guide_ = 0;
};

Variant variant_of(Variant::Approach approach, const char* name, const char* text) {
  Variant variant;
  variant.approach = approach;
  variant.name = name;
  variant.text = text;
  return variant;
}

void add_links(std::vector<Variant>& list, Variant::Approach approach, const std::string& name) {
  using Kind = Variant::Links;
  for (const auto& [kind, word, text] :
       {std::tuple{Kind::enclosed, "-enclosed", "linked to the vertices in the sphere"},
        std::tuple{Kind::region, "-region", "linked to the vertices of its patch"},
        std::tuple{Kind::nearest, "-nearest", "linked to the eight nearest vertices"}}) {
    Variant& variant = list.emplace_back(variant_of(approach, (name + word).c_str(), text));
    variant.links = kind;
  }
}

}  // namespace

std::vector<Variant> paper_variants() {
  constexpr auto one = Variant::Approach::first, two = Variant::Approach::second;
  std::vector<Variant> list;
  list.push_back(variant_of(one, "approach1-plain", "the library's: equal weights, inner nodes follow child centers"));
  list.push_back(variant_of(one, "approach1-area", "vertices weighted by their area"));
  list.back().weights = Variant::Weights::area;
  list.push_back(variant_of(one, "approach1-inverse", "vertices weighted by inverse distance"));
  list.back().weights = Variant::Weights::inverse_distance;
  list.push_back(variant_of(one, "approach1-inverse-all", "vertices and child centers weighted by inverse distance"));
  list.back().weights = Variant::Weights::inverse_distance;
  list.back().weighs_children = true;
  list.push_back(variant_of(one, "approach1-inner-vertices", "inner centers follow the vertices linked to them"));
  list.back().inner_vertices = true;
  list.push_back(variant_of(one, "approach1-floor", "distances below a quarter of the radius raised to it"));
  list.back().distance_floor = 0.25;
  add_links(list, one, "approach1");
  list.push_back(variant_of(two, "approach2-plain", "the library's: inner boxes hold child spheres"));
  list.push_back(variant_of(two, "approach2-centers", "inner boxes hold child centers"));
  list.back().boxes_of_centers = true;
  list.push_back(variant_of(two, "approach2-inner-vertices", "inner boxes hold the vertices linked to them"));
  list.back().inner_vertices = true;
  add_links(list, two, "approach2");
  return list;
}

std::shared_ptr<const OwnRule> rule_of(const Variant& variant) {
  return own_rule(
      variant.name, [variant](const Mesh& mesh, const CoveredTree& model) { return VariantRule(variant, mesh, model); },
      std::string("morula ") + version);
}

}  // namespace morula::study
