// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/tree/cover.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "tree/region.hpp"

namespace morula {
using namespace detail;
namespace {

struct Patch {
  std::uint32_t facet;
  std::uint32_t leaf;  // index into the leaves
  bool leftover;
};

// The patches of a run of facets, in facet order.
struct AssignedPatches {
  std::vector<Patch> patches;
  std::vector<std::uint32_t> corner_begin{0};
  std::vector<Barycentric> corners;
};

// Cuts facets by the power diagram of all leaves; a patch that sticks out of its owner goes undivided to the leaf that
// contains it after the least growth.
AssignedPatches assign_facets(const MeshView& mesh, const PowerDiagram& diagram, std::span<const Sphere> leaves,
                              std::size_t begin, std::size_t end) {
  AssignedPatches result;
  CutFacet cut;
  std::vector<std::uint32_t> scratch;
  std::vector<Vec3> points;
  for (std::size_t f = begin; f < end; ++f) {
    const FacetGeometry facet = facet_geometry(mesh, static_cast<std::uint32_t>(f));
    cut.clear();
    diagram.cut(facet, scratch, cut);
    for (std::size_t k = 0; k < cut.size(); ++k) {
      points.clear();
      for (const Barycentric& b : cut.polygon(k)) points.push_back(at_barycentric(facet.corners, b));
      Patch patch{static_cast<std::uint32_t>(f), cut.owner[k], false};
      // mutant cover-leftovers: `farthest_distance(leaves ... ].center, points) > leaves[patch.leaf].radius` -> `false`
      if (farthest_distance(leaves[patch.leaf].center, points) > leaves[patch.leaf].radius) {
        patch.leaf = diagram.least_growth(points).sphere;
        patch.leftover = true;
      }
      result.patches.push_back(patch);
      result.corners.insert(result.corners.end(), cut.polygon(k).begin(), cut.polygon(k).end());
      result.corner_begin.push_back(static_cast<std::uint32_t>(result.corners.size()));
    }
  }
  return result;
}

// The tree without leaves that own nothing and without inner nodes that lost all their leaves. kept: old number of each
// new node.
SphereTree without_empty(const SphereTree& tree, std::span<const Region> regions, std::vector<std::uint32_t>& kept) {
  std::vector<char> owns(tree.node_count());
  for (std::size_t i = tree.node_count(); i-- > 0;) {
    if (tree.is_leaf(static_cast<std::uint32_t>(i))) owns[i] = !regions[i].empty();
    if (owns[i] && tree.parent[i] != no_node) owns[tree.parent[i]] = 1;
  }
  SphereTree result;
  result.branching = tree.branching;
  std::vector<std::uint32_t> child_counts;
  std::vector<Sphere> spheres;
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    child_counts.clear();
    spheres.clear();
    if (level > 0)
      for (std::uint32_t p = tree.level_begin[level - 1]; p < tree.level_begin[level]; ++p) {
        if (!owns[p]) continue;
        std::uint32_t count = 0;
        for (std::uint32_t c = 0; c < tree.child_count[p]; ++c) count += owns[tree.first_child[p] + c] ? 1u : 0u;
        child_counts.push_back(count);
      }
    for (std::uint32_t i = tree.level_begin[level]; i < tree.level_begin[level + 1]; ++i)
      if (owns[i]) {
        spheres.push_back(tree.spheres[i]);
        kept.push_back(i);
      }
    if (spheres.empty()) break;
    result.append_level(child_counts, spheres);
  }
  return result;
}

// The smaller of {same center, larger radius} and {smallest sphere of the points}, padded against rounding.
Sphere grown_to_contain(const Sphere& sphere, std::span<const Vec3> points, double pad_coordinate) {
  const auto padded = [&](const Vec3& center, double farthest) {
    // mutant cover-growth-not-padded: `rounded_up_radius ... std::max(pad_coordinate, max_norm(center)))` -> `farthest`
    return Sphere{center, rounded_up_radius(farthest, std::max(pad_coordinate, max_norm(center)))};
  };
  const Sphere same_center = padded(sphere.center, farthest_distance(sphere.center, points));
  const Sphere smallest = enclosing_sphere(points);
  const Sphere moved = padded(smallest.center, smallest.radius);
  return moved.radius < same_center.radius ? moved : same_center;
}

// The region of each leaf, and an empty region for inner nodes. All leaves share the surface in one power partition.
// leftover: the number of patches that had to go to another leaf is added to it.
std::vector<Region> regions_by_power(const MeshView& mesh, const SphereTree& tree, std::size_t& leftover,
                                     Workers& workers) {
  std::vector<std::uint32_t> leaf_nodes;
  std::vector<Sphere> leaves;
  for (std::uint32_t i = 0; i < tree.node_count(); ++i)
    if (tree.is_leaf(i)) {
      leaf_nodes.push_back(i);
      leaves.push_back(tree.spheres[i]);
    }
  const PowerDiagram diagram(leaves);

  constexpr std::size_t facets_per_chunk = 1024;
  std::vector<AssignedPatches> chunks((mesh.facet_count() + facets_per_chunk - 1) / facets_per_chunk);
  parallel_for(workers, mesh.facet_count(), facets_per_chunk, [&](std::size_t begin, std::size_t end) {
    chunks[begin / facets_per_chunk] = assign_facets(mesh, diagram, leaves, begin, end);
  });

  std::vector<Region> regions(tree.node_count());
  for (const AssignedPatches& chunk : chunks)
    for (std::size_t k = 0; k < chunk.patches.size(); ++k) {
      const Patch& patch = chunk.patches[k];
      leftover += patch.leftover;
      const std::uint32_t begin = chunk.corner_begin[k];
      regions[leaf_nodes[patch.leaf]].add(patch.facet,
                                          std::span(chunk.corners).subspan(begin, chunk.corner_begin[k + 1] - begin));
    }
  return regions;
}

// Grows spheres that do not contain their regions.
void grow_spheres(const MeshView& mesh, CoveredTree& model, Workers& workers) {
  const double pad_coordinate = largest_coordinate(mesh);
  parallel_for(workers, model.tree.node_count(), 1, [&](std::size_t i, std::size_t) {
    std::vector<Vec3> points;
    for (const std::uint32_t c : model.cover.region_corners(static_cast<std::uint32_t>(i)))
      points.push_back(corner_position(model.cover, c, mesh.positions));
    Sphere& sphere = model.tree.spheres[i];
    // mutant cover-does-not-grow: `farthest_distance(sphere.center, points) > sphere.radius` -> `false`
    if (farthest_distance(sphere.center, points) > sphere.radius)
      sphere = grown_to_contain(sphere, points, pad_coordinate);
  });
}

// tree: the given one; kept: its number of each remaining node.
void complete_report(const MeshView& mesh, const SphereTree& tree, std::span<const std::uint32_t> kept,
                     CoveredTree& model) {
  BuildReport& report = model.report;
  report.method = "imported";
  report.branching = tree.branching;
  report.depth = static_cast<std::uint32_t>(tree.level_count() - 1);
  report.mesh_hash = mesh_hash(mesh);
  report.most_patches_of_a_facet = model.cover.most_patches_of_a_facet();
  report.dropped_spheres = tree.node_count() - model.tree.node_count();
  report.growth.resize(model.tree.level_count());
  for (std::size_t level = 0; level < model.tree.level_count(); ++level)
    for (std::uint32_t i = model.tree.level_begin[level]; i < model.tree.level_begin[level + 1]; ++i) {
      const double before = tree.spheres[kept[i]].radius, after = model.tree.spheres[i].radius;
      if (tree.spheres[kept[i]] == model.tree.spheres[i]) continue;
      LevelGrowth& growth = report.growth[level];
      ++growth.grown;
      growth.largest_growth = std::max(growth.largest_growth, after - before);
      growth.largest_factor = std::max(growth.largest_factor, before > 0 ? after / before : 1.0);
    }
  for (std::uint32_t i = 0; i + 1 < model.tree.level_begin.back(); ++i)
    report.early_leaves += model.tree.is_leaf(i) && i < model.tree.level_begin[model.tree.level_count() - 1];
}

// |p − c| − r for squares that vanish or overflow: in units of the largest number involved, which changes no digit.
// Values that are not comparable are far outside.
double excess_at_any_scale(const Sphere& sphere, const Vec3& p) {
  Vec3 difference = p - sphere.center;
  double radius = sphere.radius;
  int halvings = 0;
  if (!is_finite(difference)) {
    // Halves prevent overflow of a difference of finite numbers; the digit that a denormal loses is negligible compared
    // with the other.
    difference = p * 0.5 - sphere.center * 0.5;
    radius *= 0.5;
    halvings = 1;
  }
  if (!is_finite(difference) || std::isnan(radius)) return std::numeric_limits<double>::infinity();
  if (std::isinf(radius)) return -radius;
  const double largest = std::max(max_norm(difference), std::abs(radius));
  if (largest == 0) return 0;
  const int exponent = std::ilogb(largest);
  const auto scaled = [&](double x) { return std::ldexp(x, -exponent); };
  const double excess = length(Vec3{scaled(difference.x), scaled(difference.y), scaled(difference.z)}) - scaled(radius);
  const double unscaled = std::ldexp(excess, exponent + halvings);
  // A point outside stays outside, by however little.
  return excess > 0 && unscaled == 0 ? std::numeric_limits<double>::denorm_min() : unscaled;
}

// Largest distance by which underflow can have moved a corner: each product of a cut point by half of the least double
// per coordinate, at most 3/2 √3 of it in all. Vertices are exact.
double underflow_of(const Cover& cover, std::uint32_t corner, const PositionView& positions) {
  if (corner < cover.vertex_count) return 0;
  double largest = 0;
  for (const std::uint32_t v : cover.cut_points[corner - cover.vertex_count].vertex)
    largest = std::max(largest, max_norm(positions[v]));
  // Larger coordinates have products that are normal numbers, or too small relative to them to matter.
  return largest > 0 && largest < 0x1p-960 ? 3 * std::numeric_limits<double>::denorm_min() : 0;
}

}  // namespace

Vec3 corner_position(const Cover& cover, std::uint32_t corner, const PositionView& positions) {
  if (corner < cover.vertex_count) return positions[corner];
  const CutPoint& c = cover.cut_points[corner - cover.vertex_count];
  return positions[c.vertex[0]] * c.weight[0] + positions[c.vertex[1]] * c.weight[1] +
         positions[c.vertex[2]] * c.weight[2];
}

std::size_t Cover::most_patches_of_a_facet() const {
  std::vector<std::uint32_t> patches(facet_count);
  std::uint32_t most = 0;
  for (const std::uint32_t f : patch_facet) most = std::max(most, ++patches[f]);
  return most;
}

CoveredTree cover(const MeshView& mesh, const SphereTree& tree, const CoverOptions& options, WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  require_usable(mesh);
  require_usable_scale(mesh);
  if (const auto faults = validate(tree); !faults.empty())
    throw std::invalid_argument("the sphere tree is not usable: " + faults.front());
  for (std::uint32_t i = 0; i < tree.node_count(); ++i)
    if (!has_usable_scale(tree.spheres[i]))
      throw std::invalid_argument("node " + std::to_string(i) +
                                  " of the sphere tree has a number beyond 1e30: scale mesh and tree down");

  CoveredTree model;
  std::vector<Region> regions = regions_by_power(mesh, tree, model.report.leftover_patches, workers);
  std::vector<std::uint32_t> kept;
  model.tree = without_empty(tree, regions, kept);
  std::vector<Region> kept_regions(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) kept_regions[i] = std::move(regions[kept[i]]);
  model.cover = assemble_cover(mesh, model.tree, std::move(kept_regions));
  grow_spheres(mesh, model, workers);
  model.cover = with_fewer_cuts(mesh, model, workers);
  // mutant cover-keeps-nested: `options.nested || tree.nested` -> `options.nested`
  if (options.nested || tree.nested) make_nested(model.tree);
  complete_report(mesh, tree, kept, model);
  return model;
}

Sphere reduced(const Sphere& sphere, double length) {
  if (!(length >= 0)) throw std::invalid_argument("the length to reduce a sphere by is not a number of at least 0");
  if (length == 0) return sphere;
  const double radius = sphere.radius - length;
  // The difference is rounded to nearest; the next number up is above the exact one.
  // mutant reduced-not-rounded: `std::nextafter(radius, std::numeric_limits<double>::infinity())` -> `radius`
  return {sphere.center, std::max(0.0, std::nextafter(radius, std::numeric_limits<double>::infinity()))};
}

SphereTree reduced(const SphereTree& tree, double length) {
  SphereTree result = tree;
  for (Sphere& s : result.spheres) s = reduced(s, length);
  if (length > 0) result.nested = false;
  return result;
}

Certificate certify(const Cover& cover, const PositionView& positions, std::span<const Sphere> spheres,
                    Workers& workers) {
  const StandardFloats standard;
  if (positions.size() != cover.vertex_count)
    throw std::invalid_argument("certify: " + std::to_string(positions.size()) + " positions for a cover of " +
                                std::to_string(cover.vertex_count) + " vertices");
  if (spheres.size() != cover.region_begin.size())
    throw std::invalid_argument("certify: " + std::to_string(spheres.size()) + " spheres for a cover of " +
                                std::to_string(cover.region_begin.size()) + " nodes");
  std::vector<Vec3> points(cover.vertex_count + cover.cut_points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = corner_position(cover, static_cast<std::uint32_t>(i), positions);

  // If the largest square is above this, vanished squares are no digits of it.
  constexpr double smallest_safe_square = 0x1p-900;
  std::vector<double> excess(spheres.size());
  parallel_for(workers, spheres.size(), 1, [&](std::size_t i, std::size_t) {
    double farthest = 0;
    // mutant certify-radius-not-a-number: `!std::isnan(spheres[i].radius)` -> `true`
    bool comparable = !std::isnan(spheres[i].radius);
    for (const std::uint32_t c : cover.region_corners(static_cast<std::uint32_t>(i))) {
      const double squared = squared_distance(spheres[i].center, points[c]);
      // mutant certify-corner-not-a-number: `comparable = comparable && !std::isnan(squared)` -> ``
      comparable = comparable && !std::isnan(squared);
      farthest = std::max(farthest, squared);
    }
    if (!comparable) {
      excess[i] = std::numeric_limits<double>::infinity();
    } else if (farthest > smallest_safe_square && farthest < std::numeric_limits<double>::infinity()) {
      excess[i] = std::sqrt(farthest) - spheres[i].radius;
    } else {
      excess[i] = -std::numeric_limits<double>::infinity();
      for (const std::uint32_t c : cover.region_corners(static_cast<std::uint32_t>(i)))
        excess[i] = std::max(excess[i], excess_at_any_scale(spheres[i], points[c]) + underflow_of(cover, c, positions));
    }
  });
  Certificate certificate;
  certificate.worst_excess = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < excess.size(); ++i)
    if (excess[i] > certificate.worst_excess) {
      certificate.worst_excess = excess[i];
      certificate.worst_node = static_cast<std::uint32_t>(i);
    }
  // mutant certify-nearly: `0` -> `1e-12`
  // mutant certify-strictly: `<= 0` -> `< 0`
  certificate.covered = certificate.worst_excess <= 0;
  return certificate;
}

}  // namespace morula
