// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Updates that are told which vertices moved: the same bits as full ones, for less work.
#include <gtest/gtest.h>

#include <limits>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <support/aligned.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;

// Moves the vertices of some random ranges.
std::vector<VertexRange> move_some(std::vector<Vec3>& positions, Random& random) {
  std::vector<VertexRange> ranges;
  const auto count = static_cast<double>(positions.size());
  for (int i = 0; i < 1 + static_cast<int>(random.uniform(0, 3)); ++i) {
    const auto begin = static_cast<std::uint32_t>(random.uniform(0, count));
    const auto end = static_cast<std::uint32_t>(std::min(count, begin + random.uniform(0, 0.1 * count) + 1));
    for (std::uint32_t v = begin; v < end; ++v)
      positions[v] += Vec3{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)};
    ranges.push_back({begin, end});
  }
  return ranges;
}

TEST(ChangedRanges, give_the_same_bits_as_full_updates) {
  Workers three(3);
  for (const Specimen& b : specimens()) {
    for (const std::vector<Rule>& rules :
         {std::vector{Rule::exact}, std::vector{Rule::wrapped}, std::vector{Rule::wrapped, Rule::exact}}) {
      Random random(7);
      Body full(b.mesh, b.model, {.rules = rules}), partial(b.mesh, b.model, {.rules = rules});
      Body parallel(b.mesh, b.model, {.rules = rules});
      std::vector<Vec3> positions = b.mesh.positions;
      for (int frame = 0; frame < 40; ++frame) {
        const std::vector<VertexRange> ranges = move_some(positions, random);
        ASSERT_TRUE(full.update(positions));
        ASSERT_TRUE(partial.update(positions, ranges));
        ASSERT_TRUE(parallel.update(positions, ranges, three));
        ASSERT_EQ(partial.hash(), full.hash()) << b.name << ", frame " << frame;
        ASSERT_EQ(parallel.hash(), full.hash()) << b.name << ", frame " << frame;
      }
    }
  }
}

// Vertices are read in runs that facets use, of any length.
TEST(ChangedRanges, and_full_updates_give_the_same_bits_with_vertices_between_that_no_facet_uses) {
  const Mesh mesh = sample_body("limb", 40);
  Random random(21);
  Mesh loose;
  std::vector<std::uint32_t> place;  // in it, of each vertex
  const double nan = std::numeric_limits<double>::quiet_NaN();
  while (place.size() < mesh.vertex_count()) {
    const auto unused = static_cast<std::size_t>(random.uniform(0, 3));
    loose.positions.insert(loose.positions.end(), unused, {nan, nan, nan});
    const auto run = static_cast<std::size_t>(std::exp2(random.uniform(0, 10)));
    for (std::size_t k = 0; k < run && place.size() < mesh.vertex_count(); ++k) {
      place.push_back(static_cast<std::uint32_t>(loose.positions.size()));
      loose.positions.push_back(mesh.positions[place.size() - 1]);
    }
  }
  ASSERT_GT(loose.vertex_count(), mesh.vertex_count());
  for (Facet facet : mesh.facets) {
    for (std::uint32_t& v : facet) v = place[v];
    loose.facets.push_back(facet);
  }
  const BuildOptions options{.method = Method::octree, .depth = 2};
  Body expected(mesh, build(mesh, options)), full(loose, build(loose, options)), partial = full;
  std::vector<Vec3> positions = mesh.positions, loose_positions = loose.positions;
  ASSERT_TRUE(partial.update(loose_positions));
  for (int frame = 0; frame < 20; ++frame) {
    std::vector<VertexRange> ranges = move_some(positions, random);
    for (auto& [begin, end] : ranges) begin = place[begin], end = place[end - 1] + 1;
    for (std::size_t v = 0; v < place.size(); ++v) loose_positions[place[v]] = positions[v];
    ASSERT_TRUE(expected.update(positions));
    ASSERT_TRUE(full.update(loose_positions));
    ASSERT_EQ(full.hash(), expected.hash()) << "frame " << frame;
    ASSERT_TRUE(partial.update(loose_positions, ranges));
    ASSERT_EQ(partial.hash(), expected.hash()) << "frame " << frame;
    std::vector<Vec3f> floats;
    for (const Vec3& p : loose_positions) floats.emplace_back(p);
    std::vector<Vec3f> packed;
    for (const Vec3& p : positions) packed.emplace_back(p);
    ASSERT_TRUE(expected.update(packed));
    ASSERT_TRUE(full.update(floats));
    ASSERT_EQ(full.hash(), expected.hash()) << "frame " << frame << ", floats";
    floats[place[7]].y = std::numeric_limits<float>::infinity();
    const UpdateStatus bad = full.update(floats);
    ASSERT_FALSE(bad);
    ASSERT_EQ(bad.index, place[7]);
  }
}

// On lattices many corners are the farthest at once. One goes out, so that all above hang on it, and comes back, or in.
TEST(ChangedRanges, give_the_same_bits_where_the_farthest_comes_back_among_equals) {
  for (const test::NamedMesh& aligned : test::aligned_bodies()) {
    const Mesh& mesh = aligned.mesh;
    const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
    Body full(mesh, model), partial(mesh, model);
    std::vector<Vec3> positions = mesh.positions;
    Random random(11);
    for (int frame = 0; frame < 60; ++frame) {
      const auto v = static_cast<std::uint32_t>(random.uniform(0, static_cast<double>(positions.size())));
      for (const double factor : {1.5, 1.0, 0.5, 1.0}) {
        positions[v] = mesh.positions[v] * factor;
        const VertexRange range{v, v + 1};
        ASSERT_TRUE(full.update(positions));
        ASSERT_TRUE(partial.update(positions, std::span(&range, 1)));
        ASSERT_EQ(partial.hash(), full.hash()) << aligned.name << ", frame " << frame << ", factor " << factor;
      }
    }
  }
}

// Leaves of many points, where groups of them are left out; now and then everything moves, in an update of all.
TEST(ChangedRanges, give_the_same_bits_where_leaves_own_much) {
  const Mesh as_made = sample_body("limb", 80);
  const CoveredTree built_as_made = build(as_made, {.method = Method::octree, .depth = 1});
  const std::vector<std::uint32_t> order = leaf_order(built_as_made);
  const Mesh mesh = renumbered(as_made, order);
  const CoveredTree model = renumbered(built_as_made, mesh, order);
  Body full(mesh, model), partial(mesh, model);
  std::vector<Vec3> positions = mesh.positions;
  const auto count = static_cast<std::uint32_t>(positions.size());
  Random random(12);
  std::size_t tested = 0, whole = 0;
  for (int frame = 0; frame < 400; ++frame) {
    const auto begin = 1 + static_cast<std::uint32_t>(random.uniform(0, 0.99 * count - 1));
    const VertexRange range{begin, begin + count / 100};
    const double way = frame % 2 == 0 ? 0.01 : 0.1;
    for (std::uint32_t v = range.begin; v < range.end; ++v)
      positions[v] += Vec3{random.uniform(-way, way), random.uniform(-way, way), random.uniform(-way, way)};
    if (frame % 50 == 49)
      for (Vec3& p : positions) p.y *= 1.02;
    ASSERT_TRUE(full.update(positions));
    const UpdateStatus status =
        frame % 50 == 49 ? partial.update(positions) : partial.update(positions, std::span(&range, 1));
    ASSERT_TRUE(status);
    ASSERT_EQ(partial.hash(), full.hash()) << "frame " << frame;
    if (frame % 50 == 49) whole = status.points_tested;
    tested += status.points_tested;
  }
  EXPECT_LT(tested, 400 * whole / 2);
}

TEST(ChangedRanges, cost_what_moved) {
  const Mesh as_made = sample_body("limb", 64);
  const CoveredTree built_as_made = build(as_made, {.method = Method::octree, .depth = 3});
  const std::vector<std::uint32_t> order = leaf_order(built_as_made);
  const Mesh mesh = renumbered(as_made, order);
  Body body(mesh, renumbered(built_as_made, mesh, order));
  std::vector<Vec3> positions = mesh.positions;
  const UpdateStatus whole = body.update(positions);
  const auto count = static_cast<std::uint32_t>(positions.size());
  std::size_t tested = 0, read = 0;
  constexpr int trials = 50;
  for (int i = 0; i < trials; ++i) {
    const std::uint32_t begin = 1 + static_cast<std::uint32_t>(i) * (count - 1 - count / 100) / trials;
    const VertexRange range{begin, begin + count / 100};
    for (std::uint32_t v = range.begin; v < range.end; ++v) positions[v].x += 1e-3;
    const UpdateStatus part = body.update(positions, std::span(&range, 1));
    ASSERT_TRUE(part);
    tested += part.points_tested;
    read += part.vertices_read;
  }
  EXPECT_LT(read, whole.vertices_read * trials / 10);
  EXPECT_LT(tested, whole.points_tested * trials / 5);
  EXPECT_GT(tested, 0u);
  const UpdateStatus nothing = body.update(positions, std::span<const VertexRange>());
  EXPECT_EQ(nothing.points_tested + nothing.vertices_read + nothing.cut_points_moved, 0u);
}

TEST(ChangedRanges, that_move_the_origins_vertex_update_everything) {
  const Specimen& b = specimens()[2];
  Body full(b.mesh, b.model), partial(b.mesh, b.model);
  std::vector<Vec3> positions = b.mesh.positions;
  positions[0] += Vec3{0.3, 0, 0};
  const VertexRange range{0, 1};
  const UpdateStatus status = partial.update(positions, std::span(&range, 1));
  ASSERT_TRUE(status);
  ASSERT_TRUE(full.update(positions));
  EXPECT_EQ(partial.hash(), full.hash());
  EXPECT_EQ(status.vertices_read, b.mesh.vertex_count());
}

TEST(ChangedRanges, of_rules_that_read_their_children_update_everything) {
  for (const Rule rule : {Rule::traditional, Rule::weighted, Rule::approach1, Rule::approach2}) {
    const Specimen& b = specimens()[2];
    Body full(b.mesh, b.model, {.rules = {rule, Rule::exact}}),
        partial(b.mesh, b.model, {.rules = {rule, Rule::exact}});
    Random random(3);
    std::vector<Vec3> positions = b.mesh.positions;
    const std::vector<VertexRange> ranges = move_some(positions, random);
    ASSERT_TRUE(full.update(positions));
    ASSERT_TRUE(partial.update(positions, ranges));
    EXPECT_EQ(partial.hash(), full.hash());
  }
}

TEST(ChangedRanges, with_a_bad_vertex_keep_the_last_good_spheres_and_recover) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model), full(b.mesh, b.model);
  const std::uint64_t rest = body.hash();
  std::vector<Vec3> positions = b.mesh.positions;
  const auto bad = static_cast<std::uint32_t>(positions.size() - 2);
  positions[bad].y = std::numeric_limits<double>::quiet_NaN();
  const VertexRange first{bad, bad + 1};
  const UpdateStatus status = body.update(positions, std::span(&first, 1));
  EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position);
  EXPECT_EQ(status.index, bad);
  EXPECT_EQ(body.hash(), rest);
  // The next one names other vertices only; the mended one is seen all the same.
  positions[bad] = b.mesh.positions[bad] + Vec3{0.1, 0, 0};
  positions[1] += Vec3{0, 0.1, 0};
  const VertexRange second{1, 2};
  ASSERT_TRUE(body.update(positions, std::span(&second, 1)));
  ASSERT_TRUE(full.update(positions));
  EXPECT_EQ(body.hash(), full.hash());
}

TEST(ChangedRanges, outside_the_mesh_are_refused) {
  const Specimen& b = specimens()[0];
  Body body(b.mesh, b.model);
  const std::uint64_t before = body.hash();
  const auto count = static_cast<std::uint32_t>(b.mesh.vertex_count());
  for (const VertexRange range : {VertexRange{0, count + 1}, VertexRange{5, 4}, VertexRange{count, 0xffffffffu}})
    EXPECT_EQ(body.update(b.mesh.positions, std::span(&range, 1)).code, UpdateStatus::Code::bad_range);
  EXPECT_EQ(body.hash(), before);
}

}  // namespace
}  // namespace morula
