// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Repairs, judged by counting: directed edges one by one, and tetrahedra about the origin.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>

namespace morula::test {
namespace {

/// How often each directed edge is gone.
std::map<std::pair<std::uint32_t, std::uint32_t>, int> directed_edges(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> count;
  for (const Facet& f : mesh.facets)
    for (std::size_t k = 0; k < 3; ++k) ++count[{f[k], f[(k + 1) % 3]}];
  return count;
}

/// Each edge once in each direction: closed, manifold and oriented.
bool is_sound(const Mesh& mesh) {
  const auto edges = directed_edges(mesh);
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return true;
}

double plain_volume(const Mesh& mesh) {
  double sum = 0;
  for (const Facet& f : mesh.facets) {
    const Vec3 &a = mesh.positions[f[0]], &b = mesh.positions[f[1]], &c = mesh.positions[f[2]];
    sum += a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) + a.z * (b.x * c.y - b.y * c.x);
  }
  return sum / 6;
}

Mesh scaled(Mesh mesh, double factor) {
  for (Vec3& p : mesh.positions) p = p * factor;
  return mesh;
}

Mesh inverted(Mesh mesh) {
  for (Facet& f : mesh.facets) std::swap(f[1], f[2]);
  return mesh;
}

TEST(Repair, leaves_a_sound_mesh_alone) {
  for (const char* name : {"limb", "torus", "two", "blob"}) {
    const Mesh mesh = sample_body(name, 12);
    const RepairedMesh r = repair(mesh, {.remove_degenerate = true, .cap_edges = 20});
    EXPECT_FALSE(r.report.changed()) << name;
    EXPECT_EQ(r.mesh.positions, mesh.positions) << name;
    EXPECT_EQ(r.mesh.facets, mesh.facets) << name;
    EXPECT_EQ(r.report.open_holes, 0u) << name;
  }
}

TEST(Repair, merges_a_soup_into_the_body_it_came_from) {
  const Mesh mesh = sample_body("limb", 12);
  const RepairedMesh r = repair(soup_of(mesh));
  EXPECT_EQ(r.mesh.vertex_count(), mesh.vertex_count());
  EXPECT_EQ(r.report.merged_vertices, 3 * mesh.facet_count() - mesh.vertex_count());
  EXPECT_TRUE(is_sound(r.mesh));
  EXPECT_NEAR(plain_volume(r.mesh), plain_volume(mesh), 1e-12 * plain_volume(mesh));
  // New numbers lead to equal positions.
  const Mesh soup = soup_of(mesh);
  for (std::size_t v = 0; v < soup.vertex_count(); ++v)
    EXPECT_EQ(r.mesh.positions[r.report.new_vertex[v]], soup.positions[v]);
}

TEST(Repair, merges_within_the_distance_and_not_beyond) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.004, 0, 0}, {1.02, 0, 0}, {0, -1, 0}, {0.008, 0, 0}}, {}};
  mesh.facets = {{0, 1, 2}, {3, 5, 4}, {6, 5, 4}};
  const RepairedMesh exact = repair(mesh);
  EXPECT_EQ(exact.report.merged_vertices, 0u);
  const RepairedMesh near = repair(mesh, {.merge_distance = 0.005});
  // 3 goes to 0; 6 is within reach of 3, which is gone, but not of 0: no chains.
  EXPECT_EQ(near.report.merged_vertices, 1u);
  EXPECT_EQ(near.report.new_vertex[3], 0u);
  EXPECT_NE(near.report.new_vertex[6], 0u);
  const RepairedMesh far = repair(mesh, {.merge_distance = 0.03});
  EXPECT_EQ(far.report.merged_vertices, 3u);
  const RepairedMesh none =
      repair(Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{0, 1, 2}}}, {.merge_distance = {}});
  EXPECT_EQ(none.report.merged_vertices, 0u);
  EXPECT_THROW(repair(mesh, {.merge_distance = -1}), std::invalid_argument);
  EXPECT_THROW(repair(mesh, {.merge_distance = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(repair(mesh, {.cap_edges = 501}), std::invalid_argument);
}

TEST(Repair, turns_as_few_facets_as_make_neighbors_agree) {
  const Mesh mesh = sample_body("torus", 16);
  Mesh mixed = mesh;
  std::size_t turned = 0;
  for (std::size_t f = 0; f < mixed.facet_count(); f += 7, ++turned) std::swap(mixed.facets[f][1], mixed.facets[f][2]);
  const RepairedMesh r = repair(mixed);
  EXPECT_EQ(r.report.turned_facets, turned);
  EXPECT_TRUE(is_sound(r.mesh));
  EXPECT_NEAR(plain_volume(r.mesh), plain_volume(mesh), 1e-12);
}

TEST(Repair, closed_pieces_face_outwards_and_cavities_stay_cavities) {
  const Mesh ball = sample_body("blob", 12);
  const double volume = plain_volume(ball);
  ASSERT_GT(volume, 0);
  EXPECT_NEAR(plain_volume(repair(inverted(ball)).mesh), volume, 1e-9 * volume);
  // A shell with a cavity, as it should be and inside out.
  Mesh shell = ball;
  shell = joined(shell, inverted(scaled(ball, 0.5)));
  const double hollow = 0.875 * volume;
  EXPECT_NEAR(plain_volume(repair(shell).mesh), hollow, 1e-9 * volume);
  EXPECT_FALSE(repair(shell).report.changed());
  EXPECT_NEAR(plain_volume(repair(inverted(shell)).mesh), hollow, 1e-9 * volume);
  EXPECT_EQ(repair(inverted(shell)).report.turned_facets, shell.facet_count());
}

TEST(Repair, a_strip_with_one_side_is_said_to_be_one) {
  Mesh strip;
  constexpr std::uint32_t n = 12;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double turn = 6.283185307179586 * i / n, half = turn / 2;
    for (const double side : {-0.3, 0.3})
      strip.positions.push_back({(1 + side * std::cos(half)) * std::cos(turn),
                                 (1 + side * std::cos(half)) * std::sin(turn), side * std::sin(half)});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    std::uint32_t a = 2 * i, b = a + 1, c = (2 * i + 2) % (2 * n), d = c + 1;
    if (i + 1 == n) std::swap(c, d);
    strip.facets.push_back({a, c, b});
    strip.facets.push_back({b, c, d});
  }
  const RepairedMesh r = repair(strip, {.cap_edges = 5});
  EXPECT_EQ(r.report.unorientable_pieces, 1u);
  EXPECT_EQ(r.report.turned_facets, 0u);
}

TEST(Repair, caps_holes_of_so_many_edges_and_no_more) {
  const Mesh mesh = sample_body("limb", 16);
  Mesh holed = mesh;
  // All facets about one vertex: a hole of as many edges as it has facets; and a facet elsewhere: three edges.
  std::size_t valence = 0;
  std::erase_if(holed.facets, [&](const Facet& f) {
    const bool touches = f[0] == 40 || f[1] == 40 || f[2] == 40;
    valence += touches;
    return touches;
  });
  holed.facets.erase(holed.facets.end() - 20);
  ASSERT_FALSE(is_sound(holed));
  const RepairedMesh none = repair(holed);
  EXPECT_EQ(none.report.open_holes, 2u);
  EXPECT_EQ(none.report.capped_holes, 0u);
  const RepairedMesh small = repair(holed, {.cap_edges = 3});
  EXPECT_EQ(small.report.capped_holes, 1u);
  EXPECT_EQ(small.report.cap_facets, 1u);
  EXPECT_EQ(small.report.open_holes, 1u);
  const RepairedMesh all = repair(holed, {.cap_edges = valence});
  EXPECT_EQ(all.report.capped_holes, 2u);
  EXPECT_EQ(all.report.cap_facets, valence - 2 + 1);
  EXPECT_TRUE(is_sound(all.mesh));
  EXPECT_EQ(all.mesh.positions, holed.positions);
  // Only the tip over the hole is lost.
  EXPECT_NEAR(plain_volume(all.mesh), plain_volume(mesh), 0.01 * plain_volume(mesh));
  // The same of one that is inside out: the cap tells which way is out.
  EXPECT_GT(plain_volume(repair(inverted(holed), {.cap_edges = valence}).mesh), 0);
}

TEST(Repair, a_cap_takes_no_edge_that_is_there_already) {
  // A bent hole, whose shorter diagonal, of the smaller cap, is an edge of a facet already.
  Mesh mesh{{{0.3, 0.3, 0}, {1, 0, 0.5}, {0.7, 0.7, 0}, {0, 1, 0.5}, {0.5, 0.5, -1}, {0.5, 0.5, 1}}, {}};
  for (std::uint32_t k = 0; k < 4; ++k) mesh.facets.push_back({(k + 1) % 4, k, 4});
  mesh.facets.push_back({0, 2, 5});
  const RepairedMesh r = repair(mesh, {.cap_edges = 4});
  for (const auto& [edge, count] : directed_edges(r.mesh)) EXPECT_EQ(count, 1) << edge.first << ' ' << edge.second;
  // Without that facet the shorter one is taken.
  mesh.facets.pop_back();
  EXPECT_EQ(directed_edges(repair(mesh, {.cap_edges = 4}).mesh).count({0, 2}), 1u);
}

TEST(Repair, removes_facets_without_area_on_request) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 1, 2}}};
  EXPECT_EQ(repair(mesh).mesh.facet_count(), 3u);
  const RepairedMesh r = repair(mesh, {.remove_degenerate = true});
  EXPECT_EQ(r.report.degenerate_facets, 2u);
  EXPECT_EQ(r.mesh.facets, (std::vector<Facet>{{0, 1, 2}}));
  EXPECT_EQ(r.mesh.vertex_count(), 4u) << "vertices of no facet stay";
}

}  // namespace
}  // namespace morula::test
