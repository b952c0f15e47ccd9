// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <numbers>
#include <numeric>
#include <type_traits>

#include "parallel/float_environment.hpp"
#include "query/wide_tree.hpp"

namespace morula {
using namespace detail;

struct TriangleBvh::Data {
  wide::Tree tree;
};

namespace {

using wide::Clusters;
using wide::Node;

// From this distance on the whole mesh, whose coordinates are below 2^100, counts as one point up to rounding; squares
// stay finite up to this distance.
constexpr double too_far = 0x1p200;

// A child waiting to be visited: a node, or the slots of a leaf. Its squared distance is in the tree's Units.
template <class Scalar>
struct Waiting {
  Scalar squared_distance;
  std::uint32_t first;
  std::uint32_t node;  // the parent, and the place of the child in it
  std::uint8_t k, count;
};

// On large meshes queries mostly wait for nodes in memory: nodes that will be visited are prefetched.
void fetch_early([[maybe_unused]] const Node& node) {
#ifdef __GNUC__
  constexpr std::size_t line = 64;
  for (std::size_t at = 0; at < sizeof(Node); at += line)
    __builtin_prefetch(reinterpret_cast<const std::byte*>(&node) + at);
#endif
}

// The nearest child is pushed last, so that it is popped first. Children at the same distance keep their order.
template <class Scalar>
void push_by_distance(const wide::Tree& tree, std::uint32_t index, const Scalar* distances, Scalar limit,
                      Waiting<Scalar>* stack, int& top) {
  const Node& node = tree.nodes[index];
  const int bottom = top;
  for (int k = node.size; k-- > 0;) {
    if (!(distances[k] <= limit)) continue;
    if (node.count[k] == 0) fetch_early(tree.nodes[node.first[k]]);
    int at = top++;
    for (; at > bottom && stack[at - 1].squared_distance < distances[k]; --at) stack[at] = stack[at - 1];
    stack[at] = {distances[k], node.first[k], index, static_cast<std::uint8_t>(k),
                 static_cast<std::uint8_t>(node.count[k])};
  }
}

struct Nearest {
  static constexpr std::uint32_t none = 0xffffffffu;
  TrianglePoint point{};
  std::uint32_t facet = none;
};

// A child exactly as far as the best is still visited: it may hold a facet of lower index.
template <class Distances>
Nearest nearest(const wide::Tree& tree, const Vec3& p, double limit, const Distances& to) {
  using Scalar = typename Distances::Scalar;
  const double square = tree.units.scale * tree.units.scale;
  Nearest best;
  Scalar limit_in_units = to.limit(limit * square), distances[wide::width];
  Waiting<Scalar> stack[wide::stack_size];
  int top = 0;
  stack[top++] = {};
  while (top > 0) {
    const Waiting<Scalar> next = stack[--top];
    if (!(next.squared_distance <= limit_in_units)) continue;
    if (next.count == 0) {
      to(tree.nodes[next.first].boxes, distances);
      push_by_distance(tree, next.first, distances, limit_in_units, stack, top);
      continue;
    }
    // A point in the leaf's box is also in most boxes of its facets, so reading these boxes is not worthwhile.
    const bool is_apart = next.squared_distance > 0 && next.count > 1;
    if (is_apart) {
      const Node& parent = tree.nodes[next.node];
      to(parent.boxes, next.k, tree.boxes[parent.leaf[next.k]], distances);
    }
    for (std::uint32_t k = 0; k < next.count; ++k) {
      if (is_apart && !(distances[k] <= limit_in_units)) continue;
      const std::uint32_t facet = tree.facets[next.first + k];
      const TrianglePoint found = morula::closest_point(tree.triangle(facet), p);
      const bool nearer = found.squared_distance < limit;
      // mutant bvh-lowest-of-equals: `facet < best.facet` -> `false`
      const bool as_near = found.squared_distance == limit && facet < best.facet;
      if (!nearer && !as_near) continue;
      limit = found.squared_distance;
      limit_in_units = to.limit(limit * square);
      best = {found, facet};
    }
  }
  return best;
}

// Computes ∫ (x − p)·n / |x − p|³ over each cluster, expanded about its centroid to first order: with R = centroid − p,
// area vector N and moment M, R·N / R³ + tr(M) / R³ − 3 Rᵀ M R / R⁵.
void far_fields(const Clusters& c, const Vec3& p, double* squared_distances, double* fields) {
  for (int k = 0; k < wide::width; ++k) {
    const double x = c.centroid[0][k] - p.x, y = c.centroid[1][k] - p.y, z = c.centroid[2][k] - p.z;
    const double squared = x * x + y * y + z * z;
    const double flux = x * c.area_vector[0][k] + y * c.area_vector[1][k] + z * c.area_vector[2][k];
    const double trace = c.moment[0][k] + c.moment[1][k] + c.moment[2][k];
    const double form = x * x * c.moment[0][k] + y * y * c.moment[1][k] + z * z * c.moment[2][k] +
                        x * y * c.moment[3][k] + x * z * c.moment[4][k] + y * z * c.moment[5][k];
    squared_distances[k] = squared;
    fields[k] = (flux + trace - 3 * form / squared) / (squared * std::sqrt(squared));
  }
}

}  // namespace

TriangleBvh::TriangleBvh(const MeshView& mesh, Workers& workers)
    : data_([&] {
        const StandardFloats standard;
        return std::make_unique<const Data>(Data{wide::build(mesh, workers)});
      }()) {}
TriangleBvh::~TriangleBvh() = default;
TriangleBvh::TriangleBvh(TriangleBvh&&) noexcept = default;
TriangleBvh& TriangleBvh::operator=(TriangleBvh&&) noexcept = default;

std::size_t TriangleBvh::facet_count() const {
  return data_->tree.facets.size();
}

const Box& TriangleBvh::bounding_box() const {
  return data_->tree.box;
}

Triangle TriangleBvh::triangle(std::uint32_t facet) const {
  return data_->tree.triangle(facet);
}

const Facet& TriangleBvh::corners(std::uint32_t facet) const {
  return data_->tree.corners[facet];
}

std::optional<ClosestFacetPoint> TriangleBvh::closest_point(const Vec3& p, double max_distance) const {
  const StandardFloats standard;
  if (!(max_distance >= 0) || !(max_norm(p) < too_far)) return std::nullopt;
  const wide::Tree& tree = data_->tree;
  const Nearest best =
      with_distances(tree.units, p, [&](const auto& to) { return nearest(tree, p, max_distance * max_distance, to); });
  if (best.facet == Nearest::none) return std::nullopt;
  return ClosestFacetPoint{{best.facet, best.point.barycentric, best.point.point}, best.point.squared_distance};
}

void TriangleBvh::facets_touching(const Sphere& ball, std::vector<std::uint32_t>& facets) const {
  const StandardFloats standard;
  facets.clear();
  if (!(ball.radius >= 0)) return;
  const wide::Tree& tree = data_->tree;
  if (!(std::max(max_norm(ball.center), ball.radius) < too_far)) {
    if (!(scaled_length(ball.center) <= ball.radius)) return;
    facets.resize(tree.facets.size());
    std::iota(facets.begin(), facets.end(), 0u);
    return;
  }
  const double limit = ball.radius * ball.radius;
  with_distances(tree.units, ball.center, [&](const auto& to) {
    using Scalar = typename std::decay_t<decltype(to)>::Scalar;
    const Scalar limit_in_units = to.limit(limit * tree.units.scale * tree.units.scale);
    Scalar distances[wide::width];
    std::uint32_t stack[wide::stack_size];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
      const Node& node = tree.nodes[stack[--top]];
      to(node.boxes, distances);
      for (int k = 0; k < node.size; ++k) {
        if (!(distances[k] <= limit_in_units)) continue;
        if (node.count[k] == 0) stack[top++] = node.first[k];
        for (std::uint32_t slot = node.first[k]; slot < node.first[k] + node.count[k]; ++slot)
          if (morula::closest_point(tree.triangle(tree.facets[slot]), ball.center).squared_distance <= limit)
            facets.push_back(tree.facets[slot]);
      }
    }
  });
  std::sort(facets.begin(), facets.end());
}

double TriangleBvh::winding_number(const Vec3& p, double accuracy) const {
  const StandardFloats standard;
  if (is_finite(p) && !(max_norm(p) < too_far)) return 0;
  const wide::Tree& tree = data_->tree;
  const double squared_accuracy = accuracy * accuracy;
  double sum = 0;
  std::uint32_t stack[wide::stack_size];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const Node& node = tree.nodes[index];
    const Clusters& clusters = tree.clusters[index];
    double squared[wide::width], fields[wide::width];
    far_fields(clusters, p, squared, fields);
    for (int k = 0; k < node.size; ++k) {
      // An infinite accuracy makes the right side infinite or, for a cluster of radius zero, NaN: never far.
      if (squared[k] > squared_accuracy * (clusters.radius[k] * clusters.radius[k])) {
        sum += fields[k];
        continue;
      }
      if (node.count[k] == 0) stack[top++] = node.first[k];
      for (std::uint32_t slot = node.first[k]; slot < node.first[k] + node.count[k]; ++slot)
        sum += solid_angle(tree.triangle(tree.facets[slot]), p);
    }
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace morula
