// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <morula/geometry/scale.hpp>
#include <morula/update/kdop_tree.hpp>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "update/kdop/slab_extents.hpp"
#include "update/points/facet_hull.hpp"
#include "update/points/local_points.hpp"
#include "update/points/ownership.hpp"
#include "update/points/ownership_check.hpp"
#include "update/points/point_runs.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t kdop_leaves_per_chunk = 16;
constexpr std::size_t kdop_nodes_per_chunk = 256;

// Directions in the order of the kernel's slabs.
std::vector<Vec3> slab_directions(int k) {
  std::vector<Vec3> directions{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  if (has_corner_slabs(k)) directions.insert(directions.end(), {{1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, -1, -1}});
  if (has_edge_slabs(k))
    directions.insert(directions.end(), {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}});
  return directions;
}

int require_known(int k) {
  if (k != 6 && k != 14 && k != 18 && k != 26)
    throw std::invalid_argument("a k-DOP of k = " + std::to_string(k) + " is not one of 6, 14, 18 and 26");
  return k;
}

/// Length by which a bound is moved out, per slab. With e and M as in rounding.hpp and w the number of coordinates that
/// are added up: points w × 7 e M, corners left out w × 0.04 e M, the w − 1 sums below 5 e M in all; together below w ×
/// 10 e M, allowed w × 16 e M. Reading in double requires the allowance of a sphere's radius, once per coordinate: for
/// weights that do not add up to 1 that is s A, and 2 s M for corners left out.
double allowance(const Rounding& rounding, const Vec3& direction) {
  const double coordinates = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
  const double mesh_coordinate = rounding.largest_origin_coordinate + rounding.largest_coordinate;
  return coordinates *
         // mutant kdop-pad: `(0x1p-20 ... rounding.weight_slack) * mesh_coordinate + 0x1p-62)` -> `0 * mesh_coordinate`
         (0x1p-20 * rounding.largest_coordinate + (0x1p-48 + 4 * rounding.weight_slack) * mesh_coordinate + 0x1p-62);
}

}  // namespace

struct KDopTree::State {
  SphereTree tree;
  std::size_t mesh_vertex_count;
  int k;
  std::vector<Vec3> directions;
  LocalPoints local;
  std::vector<std::uint32_t> leaves;  // leaves in the order of the ownership
  // Points leaf after leaf: consecutive ones as runs, others in a list, padded to whole groups.
  std::vector<std::uint32_t> run_begin{0}, point_begin{0}, points{};
  std::vector<PointRun> runs{};
  std::vector<float> bounds{};    // bounds per node: lower, then upper
  std::vector<Spheref> around{};  // scratch of pose()
  Vec3 origin{};
  UpdateStatus work{};  // work of a good update: the same every time

  std::size_t slab_count() const { return directions.size(); }
  float* lower(std::uint32_t node) { return &bounds[2 * slab_count() * node]; }
  float* upper(std::uint32_t node) { return lower(node) + slab_count(); }

  void list_points(std::span<const std::uint32_t> owned) {
    append_in_runs(owned, runs, points);
    run_begin.push_back(static_cast<std::uint32_t>(runs.size()));
    point_begin.push_back(static_cast<std::uint32_t>(points.size()));
    work.points_tested += owned.size();
  }

  void bind(const Ownership& ownership) {
    for (std::size_t leaf = 0; leaf < leaves.size(); ++leaf) list_points(ownership.of_leaf(leaf));
    work.nodes_updated = tree.node_count();
    work.vertices_read = local.vertex_count();
    work.cut_points_moved = local.cut_point_count();
    bounds.resize(tree.node_count() * static_cast<std::size_t>(k));
    around.resize(tree.node_count());
  }

  void measure_leaves(const Rounding& rounding, Workers& workers) noexcept {
    const SlabKernel extents_of = slab_kernels(k).back();
    parallel_for(workers, leaves.size(), kdop_leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t leaf = begin; leaf < end; ++leaf) {
        float *const low = lower(leaves[leaf]), *const high = upper(leaves[leaf]);
        const auto in_runs = std::span(runs).subspan(run_begin[leaf], run_begin[leaf + 1] - run_begin[leaf]);
        const auto listed = std::span(points).subspan(point_begin[leaf], point_begin[leaf + 1] - point_begin[leaf]);
        extents_of(local.points().data(), in_runs, listed, low, high);
        for (std::size_t i = 0; i < slab_count(); ++i) {
          const double pad = allowance(rounding, directions[i]);
          low[i] = -rounded_up(pad - static_cast<double>(low[i]));
          high[i] = rounded_up(static_cast<double>(high[i]) + pad);
        }
      }
    });
  }

  void unite(std::uint32_t node) noexcept {
    float *const low = lower(node), *const high = upper(node);
    const std::uint32_t first = tree.first_child[node];
    std::copy_n(lower(first), 2 * slab_count(), low);
    for (std::uint32_t child = first + 1; child < first + tree.child_count[node]; ++child)
      for (std::size_t i = 0; i < slab_count(); ++i) {
        low[i] = std::min(low[i], lower(child)[i]);
        high[i] = std::max(high[i], upper(child)[i]);
      }
  }

  void write_bounds(const LocalPoints::Frame& frame, Workers& workers) noexcept {
    const Uninterrupted whole;
    measure_leaves(frame.rounding, workers);
    for (std::size_t level = tree.level_count(); level-- > 0;) {
      const std::uint32_t first = tree.level_begin[level];
      parallel_for(workers, tree.level_begin[level + 1] - first, kdop_nodes_per_chunk,
                   [&](std::size_t begin, std::size_t end) {
                     for (auto node = static_cast<std::uint32_t>(first + begin); node < first + end; ++node)
                       if (!tree.is_leaf(node)) unite(node);
                   });
    }
    origin = frame.origin;
  }
};

KDopTree::KDopTree(const MeshView& mesh, const CoveredTree& model, int k, Workers& workers) {
  const StandardFloats standard;
  require_known(k);
  require_belonging(mesh, model);
  LeafOrder order = depth_first_leaves(model.tree);
  const std::vector<std::uint8_t> every_leaf(order.leaves.size(), 1);
  const Ownership ownership = share_points(mesh, model.cover, order, every_leaf, hull_tolerance);
  assert(ownership_faults(mesh, model.tree, model.cover, order, ownership, every_leaf, hull_tolerance).empty());
  state_ = std::make_unique<State>(State{model.tree, mesh.vertex_count(), k, slab_directions(k),
                                         LocalPoints(mesh, model.cover, ownership), std::move(order.leaves)});
  state_->bind(ownership);
  const LocalPoints::Frame rest = state_->local.move(mesh.positions, workers);
  if (!rest.finite)
    throw std::invalid_argument("vertex " + std::to_string(rest.first_bad_vertex) +
                                " is too far from the center for an update");
  state_->write_bounds(rest, workers);
}

KDopTree::~KDopTree() = default;
KDopTree::KDopTree(KDopTree&&) noexcept = default;
KDopTree& KDopTree::operator=(KDopTree&&) noexcept = default;

UpdateStatus KDopTree::update(const PositionView& positions, Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  if (positions.size() != s.mesh_vertex_count) return refused(Status::Code::wrong_vertex_count);
  const LocalPoints::Frame frame = s.local.move(positions, workers);
  if (!frame.finite) return refused(Status::Code::non_finite_position, frame.first_bad_vertex);
  s.write_bounds(frame, workers);
  return s.work;
}

int KDopTree::k() const {
  return state_->k;
}

std::size_t KDopTree::node_count() const {
  return state_->tree.node_count();
}

std::span<const Vec3> KDopTree::directions() const {
  return state_->directions;
}

std::span<const float> KDopTree::lower(std::uint32_t node) const {
  return {state_->lower(node), state_->slab_count()};
}

std::span<const float> KDopTree::upper(std::uint32_t node) const {
  return {state_->upper(node), state_->slab_count()};
}

Vec3 KDopTree::origin() const {
  return state_->origin;
}

PosedSpheres KDopTree::posed() const {
  PosedSpheres spheres(state_->tree, true);
  pose(spheres);
  return spheres;
}

void KDopTree::pose(PosedSpheres& spheres) const {
  const StandardFloats standard;
  State& s = *state_;
  for (std::uint32_t node = 0; node < s.tree.node_count(); ++node) {
    const float *const low = s.lower(node), *const high = s.upper(node);
    const auto middle = [&](int i) { return 0.5f * low[i] + 0.5f * high[i]; };
    const Vec3f center{middle(0), middle(1), middle(2)};
    // Reach from the rounded center to the farthest corner, in double: below 2^-50 off.
    const auto reach = [&](int i, float c) {
      return std::max(static_cast<double>(high[i]) - static_cast<double>(c),
                      static_cast<double>(c) - static_cast<double>(low[i]));
    };
    const Vec3 farthest{reach(0, center.x), reach(1, center.y), reach(2, center.z)};
    s.around[node] = {center, rounded_up(scaled_length(farthest) * (1 + 0x1p-48))};
  }
  spheres.set(s.around, s.origin);
}

std::uint64_t KDopTree::hash() const {
  Hasher hash;
  hash.add(state_->origin);
  for (const float bound : state_->bounds) hash.add(bound);
  return hash.value();
}

}  // namespace morula
