// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/weld.hpp>

namespace morula {
namespace {

// Against all pairs of vertices.
TEST(WeldVertices, merges_equal_positions_of_one_label_into_the_first) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    Mesh mesh;
    std::vector<std::uint32_t> labels;
    for (int v = 0; v < 200; ++v) {
      const auto number = [&] { return std::floor(random.uniform(0, 4)) - 1; };
      mesh.positions.push_back({number(), random.uniform() < 0.5 ? 0.0 : -0.0, number()});
      labels.push_back(static_cast<std::uint32_t>(random.uniform(0, 3)));
    }
    mesh.positions[7] = mesh.positions[9] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
    for (const bool with_labels : {false, true}) {
      const MeshWeld weld =
          weld_vertices(mesh, with_labels ? std::span<const std::uint32_t>(labels) : std::span<const std::uint32_t>());
      std::vector<std::uint32_t> old_vertex;
      std::size_t apart = 0;
      for (std::uint32_t v = 0; v < 200; ++v) {
        std::uint32_t first = v;
        bool is_alone = true;
        for (std::uint32_t w = v; w-- > 0;) {
          if (mesh.positions[w] != mesh.positions[v]) continue;
          is_alone = false;
          if (!with_labels || labels[w] == labels[v]) first = w;
        }
        if (first == v) {
          apart += is_alone ? 0 : 1;
          old_vertex.push_back(v);
        }
        ASSERT_EQ(weld.old_vertex[weld.new_vertex[v]], first);
      }
      EXPECT_EQ(weld.old_vertex, old_vertex);
      EXPECT_EQ(weld.kept_apart, apart);
      EXPECT_EQ(weld.merged_count(), 200 - old_vertex.size());
    }
  }
}

TEST(WeldVertices, of_a_mesh_keep_its_facets_in_order) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                  {{0, 1, 2}, {4, 3, 5}, {1, 3, 5}}};
  const MeshWeld weld = weld_vertices(mesh);
  const Mesh whole = welded(mesh, weld);
  EXPECT_EQ(whole.facets, (std::vector<Facet>{{0, 1, 2}, {2, 1, 3}, {1, 1, 3}}));
  EXPECT_THROW(welded_positions(whole.positions, weld), std::invalid_argument);
  const Mesh wild{mesh.positions, {{0, 1, 70}}};
  EXPECT_THROW(welded(wild, weld), std::invalid_argument);
  EXPECT_THROW(weld_vertices(mesh, std::vector<std::uint32_t>(5)), std::invalid_argument);
}

TEST(Repair, merges_only_vertices_of_one_label) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {4, 3, 5}}};
  const std::vector<std::uint32_t> labels{0, 0, 0, 0, 1, 0};
  const RepairedMesh repaired = repair(mesh, {.labels = labels});
  EXPECT_EQ(repaired.report.new_vertex, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 4}));
  EXPECT_EQ(repaired.report.old_vertex, (std::vector<std::uint32_t>{0, 1, 2, 4, 5}));
  EXPECT_THROW(repair(mesh, {.labels = std::span(labels).first(3)}), std::invalid_argument);
}

}  // namespace
}  // namespace morula
