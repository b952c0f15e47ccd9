// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes and k-DOPs contain what their nodes own, and hardly more.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/update/kdop_tree.hpp>
#include <numeric>
#include <stdexcept>

#include "bodies.hpp"
#include "update/kdop/slab_extents.hpp"

namespace morula {
using namespace detail;
namespace {

using test::motions;
using test::Specimen;
using test::specimens;

constexpr std::array all_k{6, 14, 18, 26};

// Least and largest projection of a node's region, over all its corners, in double.
std::pair<double, double> extent(const CoveredTree& model, std::uint32_t node, const Vec3& direction,
                                 const Vec3& origin, const std::vector<Vec3>& positions) {
  double lower = std::numeric_limits<double>::infinity(), upper = -lower;
  for (const std::uint32_t c : model.cover.region_corners(node)) {
    const double on = dot(direction, corner_position(model.cover, c, positions) - origin);
    lower = std::min(lower, on), upper = std::max(upper, on);
  }
  return {lower, upper};
}

void expect_tight_cover(const KDopTree& dops, const Specimen& b, const std::vector<Vec3>& positions,
                        const std::string& what) {
  double largest = 0;
  for (const Facet& f : b.mesh.facets)
    for (const std::uint32_t v : f)
      largest = std::max({largest, max_norm(positions[v] - dops.origin()), max_norm(positions[v])});
  for (std::uint32_t node = 0; node < dops.node_count(); ++node)
    for (std::size_t i = 0; i < dops.directions().size(); ++i) {
      const auto [lower, upper] = extent(b.model, node, dops.directions()[i], dops.origin(), positions);
      const double low = static_cast<double>(dops.lower(node)[i]), high = static_cast<double>(dops.upper(node)[i]);
      // No tolerance: rounding cannot lose a corner.
      ASSERT_LE(low, lower) << b.name << ", " << what << ", k " << dops.k() << ", node " << node << ", slab " << i;
      ASSERT_GE(high, upper) << b.name << ", " << what << ", k " << dops.k() << ", node " << node << ", slab " << i;
      ASSERT_GE(low, lower - 1e-5 * largest) << b.name << ", " << what << ", k " << dops.k() << ", node " << node;
      ASSERT_LE(high, upper + 1e-5 * largest) << b.name << ", " << what << ", k " << dops.k() << ", node " << node;
    }
}

TEST(KDopTree, every_node_contains_what_it_owns_and_hardly_more) {
  for (const Specimen& b : specimens())
    for (const int k : all_k) {
      KDopTree dops(b.mesh, b.model, k);
      expect_tight_cover(dops, b, b.mesh.positions, "rest");
      for (const test::Motion& motion : motions()) {
        const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
        ASSERT_TRUE(dops.update(positions));
        expect_tight_cover(dops, b, positions, motion.name);
      }
    }
}

TEST(KDopTree, being_far_away_small_or_large_loses_no_corner) {
  const Specimen& b = specimens()[2];
  for (const double scale : {1e-6, 1.0, 1e6})
    for (const double away : {0.0, 1e5, 1e9}) {
      Specimen moved = b;
      moved.mesh.positions = test::translated(test::scaled(b.mesh.positions, scale), {away * scale, -away * scale, 0});
      KDopTree dops(moved.mesh, moved.model, 26);
      ASSERT_TRUE(dops.update(test::noisy(moved.mesh.positions, 0.1 * scale, 3)));
      expect_tight_cover(dops, moved, test::noisy(moved.mesh.positions, 0.1 * scale, 3), "far away");
    }
}

TEST(KDopTree, inner_nodes_are_the_unions_of_their_children) {
  for (const Specimen& b : specimens()) {
    KDopTree dops(b.mesh, b.model, 26);
    ASSERT_TRUE(dops.update(test::noisy(b.mesh.positions, 0.2, 1)));
    const SphereTree& tree = b.model.tree;
    for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
      if (tree.is_leaf(node)) continue;
      for (std::size_t i = 0; i < 13; ++i) {
        float lower = dops.lower(tree.first_child[node])[i], upper = dops.upper(tree.first_child[node])[i];
        for (std::uint32_t c = 1; c < tree.child_count[node]; ++c) {
          lower = std::min(lower, dops.lower(tree.first_child[node] + c)[i]);
          upper = std::max(upper, dops.upper(tree.first_child[node] + c)[i]);
        }
        EXPECT_EQ(dops.lower(node)[i], lower);
        EXPECT_EQ(dops.upper(node)[i], upper);
      }
    }
  }
}

TEST(KDopTree, more_slabs_cut_off_more_and_share_the_bounds_of_fewer) {
  const Specimen& b = specimens()[2];
  KDopTree all(b.mesh, b.model, 26);
  for (const int k : {6, 14, 18}) {
    KDopTree some(b.mesh, b.model, k);
    for (std::uint32_t node = 0; node < some.node_count(); ++node)
      for (std::size_t i = 0; i < some.directions().size(); ++i) {
        const auto same = std::find(all.directions().begin(), all.directions().end(), some.directions()[i]);
        ASSERT_NE(same, all.directions().end());
        EXPECT_EQ(some.lower(node)[i], all.lower(node)[static_cast<std::size_t>(same - all.directions().begin())]);
      }
  }
}

TEST(KDopTree, bits_depend_on_positions_alone) {
  Workers three(3);
  for (const Specimen& b : specimens())
    for (const int k : all_k) {
      KDopTree dops(b.mesh, b.model, k);
      const std::uint64_t rest = dops.hash();
      const std::vector<Vec3> moved = test::noisy(b.mesh.positions, 0.3, 2);
      ASSERT_TRUE(dops.update(moved));
      const std::uint64_t now = dops.hash();
      EXPECT_NE(now, rest);
      ASSERT_TRUE(dops.update(b.mesh.positions));
      EXPECT_EQ(dops.hash(), rest);
      ASSERT_TRUE(dops.update(moved, three));
      EXPECT_EQ(dops.hash(), now);
    }
}

TEST(KDopTree, bad_input_is_named_and_changes_nothing) {
  const Specimen& b = specimens()[0];
  for (const int k : {0, 4, 8, 24, 27}) EXPECT_THROW(KDopTree(b.mesh, b.model, k), std::invalid_argument);
  EXPECT_THROW(KDopTree(specimens()[1].mesh, b.model, 6), std::invalid_argument);
  KDopTree dops(b.mesh, b.model, 14);
  ASSERT_TRUE(dops.update(test::noisy(b.mesh.positions, 0.1, 1)));
  const std::uint64_t last_good = dops.hash();
  std::vector<Vec3> positions = b.mesh.positions;
  positions[7].z = std::numeric_limits<double>::quiet_NaN();
  const UpdateStatus status = dops.update(positions);
  EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position);
  EXPECT_EQ(status.index, 7u);
  positions.pop_back();
  EXPECT_EQ(dops.update(positions).code, UpdateStatus::Code::wrong_vertex_count);
  EXPECT_EQ(dops.hash(), last_good);
}

// Projections of one point, in float, with the sums in the kernel's order.
std::vector<float> projections(const LocalPoint& p, int k) {
  std::vector<float> on{p.x, p.y, p.z};
  const float sum = p.x + p.y, difference = p.x - p.y;
  if (has_corner_slabs(k)) on.insert(on.end(), {sum + p.z, sum - p.z, difference + p.z, difference - p.z});
  if (has_edge_slabs(k)) on.insert(on.end(), {sum, difference, p.x + p.z, p.x - p.z, p.y + p.z, p.y - p.z});
  return on;
}

TEST(SlabKernels, all_that_this_processor_runs_agree_bit_for_bit) {
  Random random(3);
  for (int trial = 0; trial < 60; ++trial) {
    const double magnitude = std::exp2(random.uniform(-100, 57));
    std::vector<LocalPoint> points(200);
    // Zeros of both signs are among them.
    const auto coordinate = [&] {
      const double u = random.uniform(-1, 1);
      return trial % 3 == 0 && std::abs(u) < 0.3 ? std::copysign(0.0f, static_cast<float>(u))
                                                 : static_cast<float>(magnitude * u);
    };
    for (LocalPoint& p : points) p = {coordinate(), coordinate(), coordinate(), 0};
    if (trial % 4 == 0)
      for (LocalPoint& p : points) p.y = -0.0f, p.x = std::abs(p.x);
    std::vector<std::uint32_t> index(trial % 3 * points_per_group);
    for (std::uint32_t& i : index) i = static_cast<std::uint32_t>(random.uniform(0, 200));
    std::vector<PointRun> runs{{3, 19}, {50, 98}};
    if (!index.empty()) runs.resize(static_cast<std::size_t>(trial % 2) * 2);
    std::vector<std::uint32_t> all = index;
    for (const PointRun& run : runs)
      for (std::uint32_t i = run.begin; i < run.end; ++i) all.push_back(i);

    for (const int k : all_k) {
      const auto slab_count = static_cast<std::size_t>(k / 2);
      std::vector<float> lower(slab_count, std::numeric_limits<float>::infinity()), upper;
      for (const float bound : lower) upper.push_back(-bound);
      for (const std::uint32_t i : all)
        for (std::size_t s = 0; s < slab_count; ++s) {
          lower[s] = std::min(lower[s], projections(points[i], k)[s] + 0.0f);
          upper[s] = std::max(upper[s], projections(points[i], k)[s] + 0.0f);
        }
      ASSERT_EQ(slab_kernels(k).size(), all_kernels().size());
      for (const SlabKernel kernel : slab_kernels(k)) {
        std::vector<float> low(slab_count), high(slab_count);
        kernel(points.data(), runs, index, low.data(), high.data());
        for (std::size_t s = 0; s < slab_count; ++s) {
          EXPECT_EQ(std::bit_cast<std::uint32_t>(low[s]), std::bit_cast<std::uint32_t>(lower[s])) << "k " << k;
          EXPECT_EQ(std::bit_cast<std::uint32_t>(high[s]), std::bit_cast<std::uint32_t>(upper[s])) << "k " << k;
        }
      }
    }
  }
}

// The farthest point may sit in any lane of any group.
TEST(SlabKernels, every_place_counts) {
  std::vector<LocalPoint> points(64);
  std::vector<std::uint32_t> index(32);
  std::iota(index.begin(), index.end(), 32u);
  const PointRun run{0, 32};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const int k : all_k)
      for (const SlabKernel kernel : slab_kernels(k)) {
        points[i] = {-1, 2, -4, 0};
        std::array<float, 13> lower{}, upper{};
        kernel(points.data(), std::span(&run, 1), index, lower.data(), upper.data());
        const std::vector<float> on = projections(points[i], k);
        for (std::size_t s = 0; s < on.size(); ++s) {
          EXPECT_EQ(lower[s], std::min(on[s], 0.0f)) << "point " << i << ", k " << k;
          EXPECT_EQ(upper[s], std::max(on[s], 0.0f)) << "point " << i << ", k " << k;
        }
        points[i] = {};
      }
}

}  // namespace
}  // namespace morula
