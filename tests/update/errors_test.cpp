// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bad input is named and changes nothing.
#include <gtest/gtest.h>

#include <limits>
#include <morula/update/body.hpp>
#include <stdexcept>
#include <support/numbers.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;

using test::infinity;
using test::nan;

TEST(UpdateErrors, a_wrong_count_is_reported_and_changes_nothing) {
  const Specimen& b = specimens()[0];
  Body body(b.mesh, b.model);
  ASSERT_TRUE(body.update(test::noisy(b.mesh.positions, 0.1, 1)));
  const std::uint64_t last_good = body.hash();
  std::vector<Vec3> positions = b.mesh.positions;
  positions.push_back({});
  EXPECT_EQ(body.update(positions).code, UpdateStatus::Code::wrong_vertex_count);
  positions.resize(positions.size() - 2);
  EXPECT_EQ(body.update(positions).code, UpdateStatus::Code::wrong_vertex_count);
  EXPECT_EQ(body.update(std::vector<Vec3f>{}).code, UpdateStatus::Code::wrong_vertex_count);
  EXPECT_FALSE(body.update(positions));
  EXPECT_EQ(body.hash(), last_good);
}

TEST(UpdateErrors, an_index_map_that_leaves_its_nodes_is_refused) {
  const std::vector<Vec3> nodes(5);
  const std::vector<std::uint32_t> good{4, 0, 4}, bad{0, 1, 5, 6};
  const PositionView view = PositionView::indexed(nodes, good);
  EXPECT_EQ(view.size(), 3u);
  EXPECT_THROW(PositionView::indexed(view, good), std::invalid_argument);
  try {
    PositionView::indexed(nodes, bad);
    FAIL() << "node 5 of 5";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "vertex 2 is node 5 of 5");
  }
}

// The caller's numbering of vertices counts, not that of the nodes.
TEST(UpdateErrors, the_bad_vertex_of_an_indexed_view_is_a_vertex) {
  const Specimen& b = specimens()[0];
  Body body(b.mesh, b.model);
  std::vector<Vec3> nodes(1000, Vec3{nan, nan, nan});
  std::vector<std::uint32_t> index;
  for (std::uint32_t i = 0; i < b.mesh.vertex_count(); ++i) {
    index.push_back(999 - i);
    nodes[999 - i] = b.mesh.positions[i];
  }
  ASSERT_TRUE(body.update(PositionView::indexed(nodes, index)));
  nodes[999 - 7].y = infinity;
  const UpdateStatus status = body.update(PositionView::indexed(nodes, index));
  EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position);
  EXPECT_EQ(status.index, 7u);
}

TEST(UpdateErrors, the_lowest_bad_vertex_is_reported_whatever_the_workers) {
  Workers three(3);
  for (const Specimen& b : specimens())
    for (const Rule rule : {Rule::exact, Rule::approach2}) {
      Body body(b.mesh, b.model, {.rules = {rule}, .details = {}});
      std::vector<Vec3> good = b.mesh.positions;
      for (Vec3& p : good) p = p * 1.25;
      ASSERT_TRUE(body.update(good));
      const std::uint64_t last_good = body.hash();
      const Facet& low = b.mesh.facets.front();
      const Facet& high = b.mesh.facets.back();
      for (const double bad : {nan, -nan, infinity, -infinity, 1e30})
        for (int axis = 0; axis < 3; ++axis)
          for (Workers* workers : {&serial_workers(), &three}) {
            std::vector<Vec3> positions = good;
            positions[low[1]][axis] = bad;
            positions[high[2]][axis] = bad;
            const UpdateStatus status = body.update(positions, *workers);
            EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position) << b.name;
            EXPECT_EQ(body.hash(), last_good) << b.name;
            // 1e30 is finite: when it moves the vertex that guides the origin, all others are too far away instead.
            if (bad != 1e30) {
              EXPECT_EQ(status.index, std::min(low[1], high[2])) << b.name;
            }
          }
      ASSERT_TRUE(body.update(good));
      EXPECT_EQ(body.hash(), last_good);
    }
}

TEST(UpdateErrors, float_positions_are_checked_as_well) {
  const Specimen& b = specimens()[2];
  Body body(b.mesh, b.model);
  std::vector<Vec3f> positions;
  for (const Vec3& p : b.mesh.positions) positions.emplace_back(p);
  ASSERT_TRUE(body.update(positions));
  const std::uint64_t last_good = body.hash();
  for (const std::uint32_t v : {0u, 1u, 57u, static_cast<std::uint32_t>(positions.size() - 1)}) {
    std::vector<Vec3f> bad = positions;
    bad[v].z = std::numeric_limits<float>::infinity();
    const UpdateStatus status = body.update(bad);
    EXPECT_EQ(status.code, UpdateStatus::Code::non_finite_position);
    EXPECT_EQ(status.index, v);
    EXPECT_EQ(body.hash(), last_good);
  }
}

TEST(UpdateErrors, vertices_without_a_facet_are_not_read) {
  const Specimen& soup = specimens()[4];
  ASSERT_TRUE(std::isnan(soup.mesh.positions[0].x)) << "every other vertex of this body is unused";
  for (const Rule rule : position_rules()) {
    Body body(soup.mesh, soup.model, {.rules = {rule}, .details = {}});
    std::vector<Vec3> positions = soup.mesh.positions;
    const UpdateStatus status = body.update(positions);
    ASSERT_TRUE(status);
    EXPECT_LE(status.vertices_read, soup.mesh.vertex_count() / 2);
    const std::uint64_t before = body.hash();
    for (std::size_t i = 0; i < positions.size(); i += 2) positions[i] = {1, 2, infinity};
    ASSERT_TRUE(body.update(positions));
    EXPECT_EQ(body.hash(), before);
    for (const Spheref& s : body.spheres()) EXPECT_TRUE(is_finite(s.center) && std::isfinite(s.radius));
  }
}

TEST(UpdateErrors, what_does_not_belong_together_is_refused) {
  const Specimen& b = specimens()[2];
  const auto refuse = [&](const auto& spoil, const char* what) {
    Mesh mesh = b.mesh;
    CoveredTree model = b.model;
    UpdateOptions options;
    spoil(mesh, model, options);
    EXPECT_THROW(Body(mesh, model, options), std::invalid_argument) << what;
  };
  refuse([](Mesh&, CoveredTree&, UpdateOptions& o) { o.rules.clear(); }, "no rules");
  refuse([](Mesh&, CoveredTree&, UpdateOptions& o) { o.details.distance_floor = -0.1; }, "negative floor");
  refuse([](Mesh&, CoveredTree&, UpdateOptions& o) { o.details.distance_floor = nan; }, "floor not a number");
  refuse([](Mesh& m, CoveredTree&, UpdateOptions&) { m.positions.push_back({}); }, "one vertex more");
  refuse([](Mesh& m, CoveredTree&, UpdateOptions&) { m.facets.pop_back(); }, "one facet less");
  refuse([](Mesh& m, CoveredTree&, UpdateOptions&) { m.facets.clear(); }, "no facets");
  refuse([](Mesh& m, CoveredTree&, UpdateOptions&) { m.positions[3].x = nan; }, "bad rest position");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.report.mesh_hash = 12345; }, "another mesh's tree");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.tree = {}; }, "no tree");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.tree.spheres[4].radius = nan; }, "bad sphere");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.tree.spheres[4].radius = 1e20; }, "huge sphere");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.region_begin.pop_back(); }, "a region less");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.region_end.back() = t.cover.region_begin.back(); },
         "no patch");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.corners[5] = 0x7fffffff; }, "corner out of range");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.corner_begin.back() += 1; }, "corners past the end");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.corner_begin.clear(); }, "no corner offsets");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.patch_facet[3] = 0x7fffffff; }, "patch on no facet");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.corner_begin[1] = 2; }, "patch of two corners");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.region_end[1] = 0x7fffffff; },
         "region beyond the patches");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.cut_points[2].weight[0] += 1e-11; }, "weights nearly 1");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.cut_points[2].vertex[1] = 0x7fffffff; },
         "cut point off the mesh");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.cut_points[2].weight[0] += 0.5; }, "weights not 1");
  refuse([](Mesh&, CoveredTree& t, UpdateOptions&) { t.cover.cut_points[2].weight[0] = nan; }, "weight not a number");
  EXPECT_NO_THROW(Body(b.mesh, b.model));
}

TEST(UpdateErrors, more_rules_than_levels_and_the_right_hash_are_fine) {
  Specimen b = specimens()[0];
  b.model.report.mesh_hash = mesh_hash(b.mesh);
  const Body body(b.mesh, b.model, {.rules = std::vector<Rule>(20, Rule::exact), .details = {}});
  EXPECT_EQ(body.options().rules.size(), 20u);
  EXPECT_EQ(body.hash(), Body(b.mesh, b.model).hash());
}

}  // namespace
}  // namespace morula
