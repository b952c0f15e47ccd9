// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/triangle.hpp>
#include <set>
#include <support/meshes.hpp>

namespace morula {
namespace {

using test::NamedMesh;

// The report's counts by their definitions, as slowly as they say.
MeshReport brute_force(const Mesh& mesh) {
  MeshReport report;
  const auto repeats = [](const Facet& f) { return std::set<std::uint32_t>(f.begin(), f.end()).size() < 3; };
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::map<Edge, std::pair<int, int>> edges;  // how many facets traverse it upwards and downwards
  for (const Facet& f : mesh.facets)
    for (int k = 0; k < 3 && !repeats(f); ++k) {
      const std::uint32_t from = f[k], to = f[(k + 1) % 3];
      if (from < to)
        ++edges[{from, to}].first;
      else
        ++edges[{to, from}].second;
    }
  report.closed = !edges.empty();
  report.oriented = true;
  for (const auto& [edge, ways] : edges) {
    const int count = ways.first + ways.second;
    report.boundary_edges += count == 1;
    report.nonmanifold_edges += count > 2;
    report.misoriented_edges += count == 2 && ways.first != 1;
    if (count % 2 != 0) report.closed = false;
    if (std::abs(ways.first - ways.second) > 1 || (count % 2 == 0 && ways.first != ways.second))
      report.oriented = false;
  }
  // Pieces of a set of facets, two being neighbors when they share at least `shared` vertices besides `apart_from`.
  const auto pieces = [&](const std::vector<Facet>& facets, int shared, std::uint32_t apart_from) {
    std::vector<bool> reached(facets.size(), false);
    std::size_t count = 0;
    for (std::size_t start = 0; start < facets.size(); ++start) {
      if (reached[start]) continue;
      ++count;
      std::vector<std::size_t> open{start};
      reached[start] = true;
      while (!open.empty()) {
        const Facet from = facets[open.back()];
        open.pop_back();
        for (std::size_t to = 0; to < facets.size(); ++to) {
          int common = 0;
          for (const std::uint32_t v : std::set<std::uint32_t>(from.begin(), from.end()))
            common += v != apart_from && std::count(facets[to].begin(), facets[to].end(), v) > 0;
          if (common >= shared && !reached[to]) reached[to] = true, open.push_back(to);
        }
      }
    }
    return count;
  };
  const std::uint32_t no_vertex = 0xffffffff;
  report.component_count = pieces(mesh.facets, 1, no_vertex);
  for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
    std::vector<Facet> around;
    bool used = false;
    for (const Facet& f : mesh.facets)
      if (std::count(f.begin(), f.end(), v) > 0) {
        used = true;
        if (!repeats(f)) around.push_back(f);
      }
    report.unused_vertices += !used;
    report.nonmanifold_vertices += pieces(around, 1, v) > 1;
    for (std::uint32_t u = 0; u < v; ++u)
      if (mesh.positions[u] == mesh.positions[v]) {
        ++report.duplicate_vertices;
        break;
      }
  }
  report.manifold = report.nonmanifold_edges == 0 && report.nonmanifold_vertices == 0;
  const double diagonal = bounding_box(mesh).diagonal();
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    report.degenerate_facets += repeats(mesh.facets[f]) || area(mesh.corners(f)) < 1e-12 * diagonal * diagonal;
    for (std::size_t g = 0; g < f; ++g)
      if (std::is_permutation(mesh.facets[f].begin(), mesh.facets[f].end(), mesh.facets[g].begin())) {
        ++report.duplicate_facets;
        break;
      }
  }
  return report;
}

void expect_matches_brute_force(const Mesh& mesh, const std::string& name) {
  SCOPED_TRACE(name);
  const MeshReport fast = inspect(mesh), slow = brute_force(mesh);
  EXPECT_EQ(fast.vertex_count, mesh.vertex_count());
  EXPECT_EQ(fast.facet_count, mesh.facet_count());
  EXPECT_EQ(fast.component_count, slow.component_count);
  EXPECT_EQ(fast.boundary_edges, slow.boundary_edges);
  EXPECT_EQ(fast.nonmanifold_edges, slow.nonmanifold_edges);
  EXPECT_EQ(fast.misoriented_edges, slow.misoriented_edges);
  EXPECT_EQ(fast.nonmanifold_vertices, slow.nonmanifold_vertices);
  EXPECT_EQ(fast.degenerate_facets, slow.degenerate_facets);
  EXPECT_EQ(fast.duplicate_facets, slow.duplicate_facets);
  EXPECT_EQ(fast.duplicate_vertices, slow.duplicate_vertices);
  EXPECT_EQ(fast.unused_vertices, slow.unused_vertices);
  EXPECT_EQ(fast.closed, slow.closed);
  EXPECT_EQ(fast.oriented, slow.oriented);
  EXPECT_EQ(fast.manifold, slow.manifold);
}

TEST(Inspect, matches_brute_force_on_every_kind_of_mesh) {
  for (const NamedMesh& named : test::all_meshes())
    if (named.mesh.facet_count() <= 600) expect_matches_brute_force(named.mesh, named.name);
}

// Few vertices, many facets: every kind of defect, in every combination.
TEST(Inspect, matches_brute_force_on_random_facets) {
  Random random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const std::size_t vertices = 3 + random.next() % 7, facets = 1 + random.next() % 20;
    Mesh mesh;
    for (std::size_t v = 0; v < vertices; ++v) {
      // A coarse lattice, so that positions coincide and facets have no area.
      const double x = static_cast<double>(random.next() % 3), y = static_cast<double>(random.next() % 3);
      mesh.positions.push_back({x, y, static_cast<double>(random.next() % 2)});
    }
    for (std::size_t f = 0; f < facets; ++f) {
      Facet facet;
      for (std::uint32_t& v : facet) v = static_cast<std::uint32_t>(random.next() % vertices);
      mesh.facets.push_back(facet);
    }
    expect_matches_brute_force(mesh, "trial " + std::to_string(trial));
  }
}

TEST(Inspect, agrees_with_what_meshes_were_made_to_be) {
  for (const NamedMesh& named : test::all_meshes()) {
    SCOPED_TRACE(named.name);
    const MeshReport report = inspect(named.mesh);
    EXPECT_EQ(report.closed, named.closed);
    EXPECT_EQ(report.oriented, named.oriented);
    EXPECT_EQ(report.manifold, named.manifold);
    EXPECT_EQ(report.has_volume(), named.has_volume());
    if (named.has_volume()) {
      EXPECT_NEAR(report.volume, named.volume, 1e-9 * std::abs(named.volume));
    }
  }
}

TEST(Inspect, knows_a_cube) {
  const MeshReport report = inspect(test::box_mesh({0, 0, 0}, {1, 2, 3}, 2));
  EXPECT_EQ(report.vertex_count, 26u);
  EXPECT_EQ(report.facet_count, 48u);
  EXPECT_EQ(report.component_count, 1u);
  EXPECT_EQ(report.boundary_edges + report.nonmanifold_edges + report.misoriented_edges, 0u);
  EXPECT_EQ(report.degenerate_facets + report.duplicate_facets, 0u);
  EXPECT_EQ(report.duplicate_vertices + report.unused_vertices + report.nonmanifold_vertices, 0u);
  EXPECT_TRUE(report.closed && report.oriented && report.manifold && report.has_volume());
  EXPECT_EQ(report.box.lower, (Vec3{0, 0, 0}));
  EXPECT_EQ(report.box.upper, (Vec3{1, 2, 3}));
  EXPECT_DOUBLE_EQ(report.area, 22);
  EXPECT_DOUBLE_EQ(report.volume, 6);
}

TEST(Inspect, counts_the_defects_of_known_meshes) {
  const auto report = [](const char* name) { return inspect(test::mesh_named(name).mesh); };
  EXPECT_EQ(report("two_components").component_count, 2u);
  EXPECT_EQ(report("nested_shells").component_count, 2u);
  EXPECT_EQ(report("facet_soup").component_count, 60u);
  EXPECT_EQ(report("flat_plate").boundary_edges, 40u);
  EXPECT_EQ(report("single_facet").boundary_edges, 3u);
  // However its facets are turned, a strip of this kind keeps one edge that they traverse in the same direction.
  EXPECT_EQ(report("moebius_strip").misoriented_edges, 1u);
  EXPECT_EQ(report("moebius_strip").boundary_edges, 48u);
  EXPECT_EQ(report("three_pages").nonmanifold_edges, 1u);
  EXPECT_EQ(report("three_pages").nonmanifold_vertices, 0u);
  EXPECT_EQ(report("cubes_at_one_edge").nonmanifold_edges, 1u);
  EXPECT_EQ(report("cones_at_one_vertex").nonmanifold_vertices, 1u);
  EXPECT_EQ(report("cones_at_one_vertex").nonmanifold_edges, 0u);
  EXPECT_EQ(report("duplicated_facet").duplicate_facets, 1u);
  EXPECT_EQ(report("duplicated_facet").nonmanifold_edges, 3u);
  EXPECT_EQ(report("repeated_indices").degenerate_facets, 3u);
  EXPECT_EQ(report("collinear_facet").degenerate_facets, 1u);
  EXPECT_EQ(report("sliver_facets").degenerate_facets, 0u);
  EXPECT_EQ(report("duplicate_vertices").duplicate_vertices, 28u);
  EXPECT_EQ(report("unused_vertices").unused_vertices, 2u);
}

TEST(Inspect, a_mesh_without_edges_has_no_inside) {
  Mesh mesh;
  EXPECT_FALSE(inspect(mesh).closed || inspect(mesh).has_volume());
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_FALSE(inspect(mesh).has_volume());
  mesh.facets = {{0, 1, 1}, {2, 2, 2}};
  const MeshReport report = inspect(mesh);
  EXPECT_FALSE(report.closed || report.has_volume());
  EXPECT_TRUE(report.oriented && report.manifold);
}

TEST(Inspect, facets_with_a_repeated_index_count_except_for_edges_and_fans) {
  Mesh mesh = test::icosphere(1);
  const MeshReport ball = inspect(mesh);
  const auto last = static_cast<std::uint32_t>(mesh.vertex_count());
  mesh.positions.push_back({9, 0, 0}), mesh.positions.push_back({9, 1, 0});
  mesh.facets.push_back({last, last, last + 1}), mesh.facets.push_back({last, last + 1, last});
  mesh.facets.push_back({0, 0, 1});
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.facet_count, ball.facet_count + 3);
  EXPECT_EQ(report.component_count, 2u);
  EXPECT_EQ(report.degenerate_facets, 3u);
  EXPECT_EQ(report.duplicate_facets, 1u);
  EXPECT_EQ(report.unused_vertices, 0u);
  EXPECT_EQ(report.boundary_edges + report.nonmanifold_edges + report.misoriented_edges, 0u);
  EXPECT_EQ(report.nonmanifold_vertices, 0u);
  EXPECT_TRUE(report.has_volume());
  EXPECT_DOUBLE_EQ(report.volume, ball.volume);
}

TEST(Inspect, a_facet_turned_over_misorients_its_three_edges) {
  Mesh mesh = test::icosphere(1);
  std::swap(mesh.facets[17][0], mesh.facets[17][1]);
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.misoriented_edges, 3u);
  EXPECT_TRUE(report.closed && report.manifold);
  EXPECT_FALSE(report.oriented || report.has_volume());
  // Open meshes can be misoriented as well.
  mesh.facets.pop_back();
  EXPECT_FALSE(inspect(mesh).oriented);
}

TEST(Inspect, does_not_depend_on_size_or_place) {
  const Mesh mesh = test::mesh_named("collinear_facet").mesh;
  for (const double factor : {1e-9, 1e9}) {
    const MeshReport report = inspect(test::scaled(mesh, factor));
    EXPECT_EQ(report.degenerate_facets, 1u);
    EXPECT_NEAR(report.volume / (factor * factor * factor), 1, 1e-12);
  }
  EXPECT_NEAR(inspect(test::translated(mesh, {1e6, 1e6, 1e6})).volume, 1, 1e-9);
}

TEST(Inspect, unused_vertices_may_hold_anything) {
  Mesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mesh.positions.insert(mesh.positions.end(), {{nan, 0, 0}, {nan, 0, 0}, {5, 5, 5}, {5, 5, 5}});
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.unused_vertices, 4u);
  EXPECT_EQ(report.duplicate_vertices, 1u);
  EXPECT_EQ(report.box.upper, (Vec3{1, 1, 1}));
  EXPECT_TRUE(report.has_volume());
}

}  // namespace
}  // namespace morula
