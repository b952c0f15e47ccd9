// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/weld.hpp>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

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

// A host may treat denormal numbers as 0, in which two different positions are equal.
TEST(WeldVertices, tells_denormal_positions_apart_in_every_environment) {
  const Mesh mesh{{{0x1p-1070, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-0x1p-1070, 0, 0}}, {{0, 1, 2}}};
#if defined(__SSE2__)
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040);
#endif
  const MeshWeld weld = weld_vertices(mesh);
#if defined(__SSE2__)
  _mm_setcsr(before);
#endif
  EXPECT_EQ(weld.merged_count(), 0u);
}

// Against all pairs of vertices, with far more labels at one position than cells around it.
TEST(Repair, merges_within_labels_however_many_are_at_one_position) {
  Random random(12);
  for (const double distance : {0.0, 0.25}) {
    Mesh mesh;
    std::vector<std::uint32_t> labels;
    for (std::uint32_t v = 0; v < 600; ++v) {
      mesh.positions.push_back({std::floor(random.uniform(0, 3)) * 0.2, 0, 0});
      labels.push_back(static_cast<std::uint32_t>(random.uniform(0, 90)));
      if (v % 3 == 2) mesh.facets.push_back({v - 2, v - 1, v});
    }
    const RepairedMesh repaired = repair(mesh, {.merge_distance = distance, .orient = false, .labels = labels});
    std::vector<std::uint32_t> target(600);
    std::size_t merged = 0;
    for (std::uint32_t v = 0; v < 600; ++v) {
      target[v] = v;
      for (std::uint32_t w = 0; w < v && target[v] == v; ++w)
        if (target[w] == w && labels[w] == labels[v] && std::abs(mesh.positions[w].x - mesh.positions[v].x) <= distance)
          target[v] = w;
      merged += target[v] != v ? 1 : 0;
      ASSERT_EQ(repaired.report.new_vertex[v], repaired.report.new_vertex[target[v]]) << v;
      if (target[v] == v) {
        ASSERT_EQ(repaired.report.old_vertex[repaired.report.new_vertex[v]], v);
      }
    }
    EXPECT_EQ(repaired.report.merged_vertices, merged);
    EXPECT_GT(merged, 200u);
  }
}

}  // namespace
}  // namespace morula
