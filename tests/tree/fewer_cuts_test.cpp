// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Covers with fewer cuts, judged in extended precision from the public arrays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/query/power_diagram.hpp>
#include <morula/tree/cover.hpp>
#include <set>
#include <support/aligned.hpp>
#include <support/meshes.hpp>

namespace morula {
namespace {

using Real = long double;

// The power partition by the leaves of a tree, nothing of it given away: a facet's pieces by the owner of their middle.
// Made of the public diagram alone.
CoveredTree as_partitioned(const Mesh& mesh, const SphereTree& tree) {
  std::vector<std::uint32_t> leaves;
  std::vector<Sphere> spheres;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    if (tree.is_leaf(node)) leaves.push_back(node), spheres.push_back(tree.spheres[node]);
  const PowerDiagram diagram(spheres);
  struct Piece {
    std::uint32_t facet;
    std::vector<Barycentric> corners;
  };
  std::vector<std::vector<Piece>> pieces(tree.node_count());
  CutFacet cut;
  std::vector<std::uint32_t> scratch;
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
    cut.clear();
    diagram.cut({mesh.corners(f), mesh.facets[f]}, scratch, cut);
    for (std::size_t k = 0; k < cut.size(); ++k)
      pieces[leaves[cut.owner[k]]].push_back({f, {cut.polygon(k).begin(), cut.polygon(k).end()}});
  }
  // Leaves of no power get something all the same.
  for (const std::uint32_t leaf : leaves) {
    if (!pieces[leaf].empty()) continue;
    auto& most = *std::max_element(pieces.begin(), pieces.end(),
                                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
    pieces[leaf].push_back(most.back());
    most.pop_back();
  }
  CoveredTree model{tree, {}, {}};
  Cover& cover = model.cover;
  cover.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count());
  cover.facet_count = static_cast<std::uint32_t>(mesh.facet_count());
  cover.corner_begin = {0};
  cover.region_begin.resize(tree.node_count());
  cover.region_end.resize(tree.node_count());
  std::map<std::pair<std::array<std::uint32_t, 3>, std::array<double, 3>>, std::uint32_t> numbers;
  const auto visit = [&](const auto& self, std::uint32_t node) -> void {
    cover.region_begin[node] = static_cast<std::uint32_t>(cover.patch_count());
    for (const Piece& piece : pieces[node]) {
      cover.patch_facet.push_back(piece.facet);
      for (const Barycentric& b : piece.corners) {
        const Facet& facet = mesh.facets[piece.facet];
        const auto whole = std::find(b.begin(), b.end(), 1.0);
        if (whole != b.end()) {
          cover.corners.push_back(facet[static_cast<std::size_t>(whole - b.begin())]);
          continue;
        }
        const auto next = static_cast<std::uint32_t>(cover.vertex_count + cover.cut_points.size());
        const auto [entry, is_new] = numbers.try_emplace({facet, {b[0], b[1], b[2]}}, next);
        if (is_new) cover.cut_points.push_back({facet, {b[0], b[1], b[2]}});
        cover.corners.push_back(entry->second);
      }
      cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    }
    for (std::uint32_t c = 0; c < tree.child_count[node]; ++c) self(self, tree.first_child[node] + c);
    cover.region_end[node] = static_cast<std::uint32_t>(cover.patch_count());
  };
  visit(visit, 0);
  // Spheres that a partition by power alone does not fill are made to hold their regions.
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    double farthest = 0;
    for (const std::uint32_t c : cover.region_corners(node))
      farthest = std::max(farthest, distance(corner_position(cover, c, mesh.positions), tree.spheres[node].center));
    model.tree.spheres[node].radius =
        std::max(tree.spheres[node].radius,
                 rounded_up_radius(farthest, std::max(max_norm(tree.spheres[node].center), largest_coordinate(mesh))));
  }
  return model;
}

Real distance_of(const Cover& cover, std::uint32_t corner, const Mesh& mesh, const Vec3& center) {
  std::array<Real, 3> at{};
  const auto add = [&](const Vec3& p, Real weight) {
    at[0] += weight * p.x, at[1] += weight * p.y, at[2] += weight * p.z;
  };
  if (corner < cover.vertex_count) {
    add(mesh.positions[corner], 1);
  } else {
    const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
    for (std::size_t k = 0; k < 3; ++k) add(mesh.positions[cut.vertex[k]], cut.weight[k]);
  }
  return std::hypot(at[0] - center.x, at[1] - center.y, at[2] - center.z);
}

Real reach_of(const CoveredTree& model, const Cover& cover, std::uint32_t node, const Mesh& mesh) {
  Real farthest = 0;
  for (const std::uint32_t c : cover.region_corners(node))
    farthest = std::max(farthest, distance_of(cover, c, mesh, model.tree.spheres[node].center));
  return farthest;
}

std::set<std::uint32_t> owners_of(const CoveredTree& model, const Cover& cover, std::uint32_t facet) {
  std::set<std::uint32_t> owners;
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    for (std::uint32_t p = cover.region_begin[node]; model.tree.is_leaf(node) && p < cover.region_end[node]; ++p)
      if (cover.patch_facet[p] == facet) owners.insert(node);
  return owners;
}

// Of each node, the facets that it owns some of; nothing of nodes that are no leaves.
std::vector<std::set<std::uint32_t>> owned_by_leaves(const SphereTree& tree, const Cover& cover) {
  std::vector<std::set<std::uint32_t>> facets(tree.node_count());
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    for (std::uint32_t p = cover.region_begin[node]; tree.is_leaf(node) && p < cover.region_end[node]; ++p)
      facets[node].insert(cover.patch_facet[p]);
  return facets;
}

std::size_t corners_that_are_cut(const Cover& cover) {
  return static_cast<std::size_t>(std::count_if(cover.corners.begin(), cover.corners.end(),
                                                [&](std::uint32_t c) { return c >= cover.vertex_count; }));
}

// What the promise of with_fewer_cuts says, on whatever tree. Returns how many patches there are fewer.
std::size_t expect_fewer_cuts(const Mesh& mesh, const CoveredTree& model, const std::string& name) {
  const auto faults_before = validate(mesh, model);
  EXPECT_TRUE(faults_before.empty()) << name << ": " << (faults_before.empty() ? "" : faults_before.front());
  CoveredTree freed{model.tree, with_fewer_cuts(mesh, model), {}};
  const auto faults = validate(mesh, freed);
  EXPECT_TRUE(faults.empty()) << name << ": " << (faults.empty() ? "" : faults.front());
  EXPECT_LE(corners_that_are_cut(freed.cover), corners_that_are_cut(model.cover)) << name;
  EXPECT_LE(freed.cover.patch_count(), model.cover.patch_count()) << name;

  std::vector<Real> reach;
  const Real rounding = 0x1p-48L * static_cast<Real>(largest_coordinate(mesh));
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node) {
    reach.push_back(reach_of(model, model.cover, node, mesh));
    EXPECT_LE(reach_of(model, freed.cover, node, mesh), reach.back() * (1 + 0x1p-50L) + rounding)
        << name << ", node " << node;
    EXPECT_LT(freed.cover.region_begin[node], freed.cover.region_end[node]) << name << ", node " << node;
  }
  std::vector<std::uint8_t> used(freed.cover.cut_points.size());
  for (const std::uint32_t c : freed.cover.corners)
    if (c >= freed.cover.vertex_count) used[c - freed.cover.vertex_count] = 1;
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << name << ": cut points that nobody owns";

  // What is still shared could go to none of those who share it, or would have taken somebody's last patch.
  const auto last_patch_of = [&](std::uint32_t leaf) {
    std::set<std::uint32_t> facets;
    for (std::uint32_t p = freed.cover.region_begin[leaf]; p < freed.cover.region_end[leaf]; ++p)
      facets.insert(freed.cover.patch_facet[p]);
    return facets.size() == 1;
  };
  for (std::uint32_t f = 0; f < mesh.facet_count(); f += 1 + static_cast<std::uint32_t>(mesh.facet_count() / 64)) {
    const std::set<std::uint32_t> owners = owners_of(model, freed.cover, f);
    if (owners.size() < 2 || std::any_of(owners.begin(), owners.end(), last_patch_of)) continue;
    for (const std::uint32_t owner : owners) {
      bool holds = true;
      for (std::uint32_t node = owner; node != no_node; node = model.tree.parent[node])
        for (const std::uint32_t v : mesh.facets[f])
          holds = holds && distance_of(model.cover, v, mesh, model.tree.spheres[node].center) <
                               reach[node] * (1 - 0x1p-40L) - rounding;
      EXPECT_FALSE(holds) << name << ": facet " << f << " could belong to leaf " << owner << " alone";
    }
  }
  return model.cover.patch_count() - freed.cover.patch_count();
}

TEST(FewerCuts, reach_no_farther_own_all_and_leave_nothing_that_could_be_whole) {
  std::size_t fewer = 0;
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (named.mesh.facet_count() > 1500) continue;
    const CoveredTree octree = build(named.mesh, {.method = Method::octree, .depth = 2});
    fewer += expect_fewer_cuts(named.mesh, as_partitioned(named.mesh, octree.tree), named.name);
    EXPECT_EQ(expect_fewer_cuts(named.mesh, octree, named.name), 0u) << named.name << ": build has done that";
  }
  // Bodies whose octrees stay divided: those of balls do not.
  for (const char* const sample : {"limb", "torus", "bar", "plate"}) {
    const Mesh mesh = sample_body(sample, 20);
    const CoveredTree octree = build(mesh, {.method = Method::octree, .depth = 2});
    fewer += expect_fewer_cuts(mesh, as_partitioned(mesh, octree.tree), sample);
  }
  EXPECT_GT(fewer, 1000u);
}

TEST(FewerCuts, hold_where_cuts_align_with_facets) {
  std::size_t fewer = 0;
  for (const test::NamedMesh& body : test::aligned_bodies())
    for (const int branching : {2, 8}) {
      const CoveredTree octree = build(body.mesh, {.method = Method::octree, .branching = branching, .depth = 2});
      fewer += expect_fewer_cuts(body.mesh, as_partitioned(body.mesh, octree.tree), body.name);
    }
  EXPECT_GT(fewer, 100u);
}

// More leaves than facets: most own parts of a single one, and nobody may lose his last.
TEST(FewerCuts, leave_every_leaf_a_patch_on_coarse_bodies) {
  for (const int resolution : {3, 4, 6})
    for (const char* name : {"limb", "torus", "plate"}) {
      const Mesh mesh = sample_body(name, resolution);
      const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 4});
      expect_fewer_cuts(mesh, as_partitioned(mesh, model.tree), name);
    }
}

// A facet cut into hundreds of pieces becomes one: pieces were counted in a byte, and each 256th was the facet again.
TEST(FewerCuts, make_one_of_a_facet_in_however_many_pieces) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  for (const std::uint32_t pieces : {2u, 255u, 256u, 257u, 600u}) {
    CoveredTree model;
    model.tree.append_level({}, std::array{Sphere{{1, 1, 0}, 4}});
    Cover& cover = model.cover;
    cover.vertex_count = 3;
    cover.facet_count = 1;
    cover.corner_begin = {0};
    // A fan about vertex 0, between points on the edge from 1 to 2.
    const auto on_edge = [&](std::uint32_t k) -> std::uint32_t { return k == 0 ? 1 : k == pieces ? 2 : 2 + k; };
    for (std::uint32_t k = 1; k < pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      cover.cut_points.push_back({{1, 2, 2}, {1 - share, share, 0}});
    }
    for (std::uint32_t k = 0; k < pieces; ++k) {
      cover.patch_facet.push_back(0);
      cover.corners.insert(cover.corners.end(), {0, on_edge(k), on_edge(k + 1)});
      cover.corner_begin.push_back(static_cast<std::uint32_t>(cover.corners.size()));
    }
    cover.region_begin = {0};
    cover.region_end = {pieces};
    model.report.mesh_hash = mesh_hash(mesh);
    ASSERT_TRUE(validate(mesh, model).empty()) << pieces << ": " << validate(mesh, model).front();
    const Cover freed = with_fewer_cuts(mesh, model);
    EXPECT_EQ(freed.corners, (std::vector<std::uint32_t>{0, 1, 2})) << pieces;
    EXPECT_TRUE(freed.cut_points.empty()) << pieces;
  }
}

// Squares below all normal numbers compare as equal: such nodes take nothing.
TEST(FewerCuts, take_nothing_where_squares_vanish) {
  Mesh mesh = sample_body("bar", 20);
  const CoveredTree large = as_partitioned(mesh, build(mesh, {.method = Method::octree, .depth = 2}).tree);
  ASSERT_NE(owned_by_leaves(large.tree, with_fewer_cuts(mesh, large)), owned_by_leaves(large.tree, large.cover))
      << "there is nothing to take";
  CoveredTree tiny = large;
  for (Vec3& p : mesh.positions) p = p * 0x1p-540;
  for (Sphere& s : tiny.tree.spheres) s = {s.center * 0x1p-540, s.radius * 0x1p-540};
  const Cover freed = with_fewer_cuts(mesh, tiny);
  EXPECT_EQ(owned_by_leaves(tiny.tree, freed), owned_by_leaves(tiny.tree, tiny.cover));
}

}  // namespace
}  // namespace morula
