// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Connectivity against searches over all pairs of facets.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <set>
#include <support/meshes.hpp>

namespace morula {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

bool has_sides(const Facet& f) {
  return f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
}
bool is_in(const Facet& f, std::uint32_t v) {
  return std::count(f.begin(), f.end(), v) > 0;
}
std::set<Pair> edges_of(const Facet& f) {
  std::set<Pair> edges;
  if (has_sides(f))
    for (const std::uint32_t a : f)
      for (const std::uint32_t b : f)
        if (a < b) edges.insert({a, b});
  return edges;
}
bool share_an_edge(const Facet& f, const Facet& g) {
  for (const Pair& e : edges_of(f))
    if (edges_of(g).count(e) > 0) return true;
  return false;
}

// Pieces of the facets 0 … count - 1 under a relation, numbered by their lowest member.
template <class Related>
std::vector<std::uint32_t> pieces(std::uint32_t count, const Related& related) {
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> piece(count, none);
  std::uint32_t next = 0;
  for (std::uint32_t first = 0; first < count; ++first) {
    if (piece[first] != none) continue;
    std::vector<std::uint32_t> open{first};
    piece[first] = next;
    while (!open.empty()) {
      const std::uint32_t f = open.back();
      open.pop_back();
      for (std::uint32_t g = 0; g < count; ++g)
        if (piece[g] == none && related(f, g)) piece[g] = next, open.push_back(g);
    }
    ++next;
  }
  return piece;
}

// A soup of facets on few vertices: edges of many facets, duplicates, either way round, repeated indices, unused
// vertices.
Mesh soup(std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  const std::uint64_t vertices = 3 + random.next() % 30, facets = random.next() % 60;
  mesh.positions.resize(vertices);
  for (std::uint64_t f = 0; f < facets; ++f) {
    if (!mesh.facets.empty() && random.next() % 8 == 0) {
      Facet again = mesh.facets[random.next() % mesh.facets.size()];
      if (random.next() % 2 == 0) std::swap(again[0], again[1]);
      mesh.facets.push_back(again);
      continue;
    }
    Facet facet;
    for (std::uint32_t& v : facet) v = static_cast<std::uint32_t>(random.next() % vertices);
    mesh.facets.push_back(facet);
  }
  return mesh;
}

// A surface with holes: facets taken out of a closed one at random.
Mesh riddled(std::uint64_t seed) {
  Random random(seed);
  Mesh mesh = test::icosphere(2);
  std::erase_if(mesh.facets, [&](const Facet&) { return random.next() % 5 == 0; });
  return mesh;
}

std::vector<Mesh> specimens() {
  std::vector<Mesh> all{{}, sample_body("two", 6), sample_body("torus", 8)};
  for (std::uint64_t seed = 0; seed < 300; ++seed) all.push_back(soup(seed));
  for (std::uint64_t seed = 0; seed < 20; ++seed) all.push_back(riddled(seed));
  return all;
}

TEST(Connectivity, edges_and_their_sides_are_those_of_a_search) {
  for (const Mesh& mesh : specimens()) {
    const Connectivity c = connectivity(mesh);
    std::map<Pair, std::vector<std::uint32_t>> expected;
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
      if (has_sides(mesh.facets[f]))
        for (std::uint32_t k = 0; k < 3; ++k)
          expected[std::minmax(std::uint32_t{mesh.facets[f][k]}, std::uint32_t{mesh.facets[f][(k + 1) % 3]})].push_back(
              3 * f + k);
    ASSERT_EQ(c.edge_count(), expected.size());
    std::uint32_t e = 0;
    std::vector<std::uint32_t> border, several;
    for (const auto& [edge, sides] : expected) {
      EXPECT_EQ((Pair{c.edges[e][0], c.edges[e][1]}), edge);
      const auto found = c.edge_sides(e);
      EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), sides);
      for (const std::uint32_t side : sides) EXPECT_EQ(c.facet_edges[side / 3][side % 3], e);
      if (sides.size() == 1) border.push_back(e);
      if (sides.size() > 2) several.push_back(e);
      ++e;
    }
    EXPECT_EQ(border_edges(c), border);
    EXPECT_EQ(nonmanifold_edges(c), several);
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
      if (!has_sides(mesh.facets[f])) {
        EXPECT_EQ(c.facet_edges[f], (std::array{no_edge, no_edge, no_edge}));
      }
  }
}

TEST(Connectivity, fans_and_facets_across_are_those_of_a_search) {
  for (const Mesh& mesh : specimens()) {
    const Connectivity c = connectivity(mesh);
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::vector<std::uint32_t> expected;
      for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
        if (has_sides(mesh.facets[f]) && is_in(mesh.facets[f], v)) expected.push_back(f);
      const auto found = c.vertex_facets(v);
      EXPECT_EQ(std::vector<std::uint32_t>(found.begin(), found.end()), expected);
    }
    for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t a = mesh.facets[f][k], b = mesh.facets[f][(k + 1) % 3];
        std::vector<std::uint32_t> others;
        for (std::uint32_t g = 0; g < mesh.facet_count(); ++g)
          if (g != f && has_sides(mesh.facets[f]) && has_sides(mesh.facets[g]) && is_in(mesh.facets[g], a) &&
              is_in(mesh.facets[g], b))
            others.push_back(g);
        EXPECT_EQ(c.facet_across(f, k), others.empty() ? no_facet : others.size() > 1 ? several_facets : others[0]);
      }
  }
}

TEST(Connectivity, pieces_are_those_of_a_search) {
  for (const Mesh& mesh : specimens()) {
    const auto count = static_cast<std::uint32_t>(mesh.facet_count());
    const auto most = [](const std::vector<std::uint32_t>& piece) {
      return piece.empty() ? 0 : *std::max_element(piece.begin(), piece.end()) + 1;
    };
    const auto touch = [&](std::uint32_t f, std::uint32_t g) {
      return std::any_of(mesh.facets[f].begin(), mesh.facets[f].end(),
                         [&](std::uint32_t v) { return is_in(mesh.facets[g], v); });
    };
    const std::vector<std::uint32_t> by_vertices = pieces(count, touch);
    EXPECT_EQ(components_by_vertices(mesh).of_facet, by_vertices);
    EXPECT_EQ(components_by_vertices(mesh).count, most(by_vertices));
    const auto join = [&](std::uint32_t f, std::uint32_t g) { return share_an_edge(mesh.facets[f], mesh.facets[g]); };
    const std::vector<std::uint32_t> by_edges = pieces(count, join);
    const Components found = components_by_edges(mesh, connectivity(mesh));
    EXPECT_EQ(found.of_facet, by_edges);
    EXPECT_EQ(found.count, most(by_edges));
  }
}

TEST(Connectivity, vertices_of_several_fans_are_those_of_a_search) {
  for (const Mesh& mesh : specimens()) {
    std::vector<std::uint32_t> expected;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      std::vector<Facet> around;
      for (const Facet& f : mesh.facets)
        if (has_sides(f) && is_in(f, v)) around.push_back(f);
      const std::vector<std::uint32_t> fans =
          pieces(static_cast<std::uint32_t>(around.size()), [&](std::uint32_t f, std::uint32_t g) {
            for (const Pair& e : edges_of(around[f]))
              if ((e.first == v || e.second == v) && edges_of(around[g]).count(e) > 0) return true;
            return false;
          });
      if (std::count(fans.begin(), fans.end(), 1u) > 0) expected.push_back(v);
    }
    EXPECT_EQ(nonmanifold_vertices(mesh, connectivity(mesh)), expected);
  }
}

TEST(Connectivity, border_runs_have_every_border_side_once_and_pass_no_vertex_twice) {
  for (const Mesh& mesh : specimens()) {
    const Connectivity c = connectivity(mesh);
    const BorderLoops loops = border_loops(mesh, c);
    std::vector<std::uint32_t> border, sides = loops.sides;
    std::map<std::uint32_t, int> surplus;  // of a vertex: sides that leave minus those that arrive
    for (const std::uint32_t e : border_edges(c)) {
      const std::uint32_t side = c.edge_sides(e)[0];
      border.push_back(side);
      ++surplus[mesh.facets[side / 3][side % 3]], --surplus[mesh.facets[side / 3][(side + 1) % 3]];
    }
    std::sort(border.begin(), border.end());
    std::sort(sides.begin(), sides.end());
    ASSERT_EQ(sides, border);
    int open_ends = 0;
    for (const auto& [vertex, more] : surplus) open_ends += std::max(0, more);
    std::size_t at = 0;
    for (std::size_t i = 0; i < loops.count(); ++i) {
      EXPECT_EQ(loops.begin[i], at);
      at += loops.run(i).size();
      std::set<std::uint32_t> passed;
      std::uint32_t last = 0;
      for (const std::uint32_t side : loops.run(i)) {
        const std::uint32_t from = mesh.facets[side / 3][side % 3];
        if (!passed.empty()) {
          EXPECT_EQ(from, last);
        }
        EXPECT_TRUE(passed.insert(from).second) << "vertex " << from;
        last = mesh.facets[side / 3][(side + 1) % 3];
      }
      const std::uint32_t first = loops.run(i)[0];
      EXPECT_EQ(loops.is_loop[i] != 0, last == mesh.facets[first / 3][first % 3]);
      if (loops.is_loop[i] == 0) {
        EXPECT_TRUE(passed.insert(last).second);
        --open_ends;
      }
    }
    EXPECT_EQ(at, loops.sides.size());
    EXPECT_EQ(open_ends, 0) << "no more open runs than there have to be";
  }
}

TEST(Connectivity, a_tube_has_two_loops_a_pinched_sheet_one_for_each_side_of_the_pinch) {
  Mesh tube;
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t j = (i + 1) % 6;
    tube.facets.push_back({i, j, i + 6});
    tube.facets.push_back({j, j + 6, i + 6});
  }
  tube.positions.resize(12);
  const BorderLoops ends = border_loops(tube, connectivity(tube));
  ASSERT_EQ(ends.count(), 2u);
  EXPECT_EQ(ends.run(0).size(), 6u);
  EXPECT_EQ(ends.is_loop, (std::vector<std::uint8_t>{1, 1}));

  const Mesh pinched{std::vector<Vec3>(5), {{0, 1, 2}, {2, 3, 4}}};
  const BorderLoops both = border_loops(pinched, connectivity(pinched));
  ASSERT_EQ(both.count(), 2u);
  EXPECT_EQ(both.run(0).size(), 3u);
  EXPECT_EQ(both.run(1).size(), 3u);

  // Two facets that do not agree about which side is out.
  const Mesh turned{std::vector<Vec3>(4), {{0, 1, 2}, {3, 1, 2}}};
  const BorderLoops open = border_loops(turned, connectivity(turned));
  EXPECT_EQ(open.is_loop, (std::vector<std::uint8_t>{0, 0}));
}

TEST(Connectivity, a_report_is_the_same_with_a_connectivity_that_is_there) {
  for (const Mesh& mesh : {sample_body("two", 6), riddled(3), soup(7)}) {
    const MeshReport a = inspect(mesh), b = inspect(mesh, connectivity(mesh));
    EXPECT_EQ(a.component_count, b.component_count);
    EXPECT_EQ(a.boundary_edges, b.boundary_edges);
    EXPECT_EQ(a.nonmanifold_vertices, b.nonmanifold_vertices);
    EXPECT_EQ(a.closed, b.closed);
    EXPECT_EQ(a.oriented, b.oriented);
  }
}

}  // namespace
}  // namespace morula
