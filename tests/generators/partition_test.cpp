// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Regions of whole and cut facets, and how they are divided: shortcuts for whole facets and for shared vertices change
// nothing.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/fit/partition.hpp>
#include <map>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/power_diagram.hpp>
#include <support/meshes.hpp>
#include <tree/vertex_memo.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

std::vector<Barycentric> polygon_of(const Region& region, std::size_t k) {
  const auto polygon = region.polygon(k);
  return {polygon.begin(), polygon.end()};
}

// Spheres about the mesh, some of the same size at mirrored places, so that powers tie on aligned meshes.
std::vector<Sphere> spheres_about(const Mesh& mesh, Random& random) {
  const Box box = bounding_box(mesh);
  const double size = max_norm(box.extent());
  std::vector<Sphere> spheres;
  const int count = 1 + static_cast<int>(random.uniform(0, 8));
  for (int i = 0; i < count; ++i) {
    Vec3 at = box.center();
    for (int axis = 0; axis < 3; ++axis)
      at[axis] += size * (random.uniform() < 0.5 ? std::floor(random.uniform(-2, 3)) / 4 : random.uniform(-0.5, 0.5));
    spheres.push_back({at, size * (random.uniform() < 0.5 ? 0.5 : random.uniform(0.1, 0.9))});
  }
  return spheres;
}

// Every polygon through cut_by_power, one after the other; without leftovers, which go by growth.
std::vector<std::vector<std::pair<std::uint32_t, std::vector<Barycentric>>>> divided_one_by_one(
    const Mesh& mesh, const Region& region, std::span<const Sphere> spheres, std::size_t& leftovers) {
  std::vector<std::vector<std::pair<std::uint32_t, std::vector<Barycentric>>>> parts(spheres.size());
  std::vector<std::uint32_t> all(spheres.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  leftovers = 0;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const std::uint32_t facet = region.facet[k];
    const FacetGeometry geometry = facet_geometry(mesh, facet);
    CutFacet cut;
    cut_by_power(geometry, region.polygon(k), spheres, all, cut);
    for (std::size_t piece = 0; piece < cut.size(); ++piece) {
      const auto polygon = cut.polygon(piece);
      std::vector<Vec3> corners;
      for (const Barycentric& b : polygon) corners.push_back(at_barycentric(geometry.corners, b));
      const Sphere& own = spheres[cut.owner[piece]];
      const double square = own.radius * own.radius;
      if (std::any_of(corners.begin(), corners.end(),
                      [&](const Vec3& p) { return squared_distance(own.center, p) > square; }))
        ++leftovers;
      else
        parts[cut.owner[piece]].push_back({facet, {polygon.begin(), polygon.end()}});
    }
  }
  return parts;
}

void expect_divided_as_one_by_one(const Mesh& mesh, const Region& region, std::span<const Sphere> spheres) {
  const Partition divided = partition(mesh, region, spheres);
  std::size_t leftovers = 0;
  const auto expected = divided_one_by_one(mesh, region, spheres, leftovers);
  EXPECT_EQ(divided.leftover_patches, leftovers);
  std::size_t pieces = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    pieces += divided.regions[i].size();
    ASSERT_GE(divided.regions[i].size(), expected[i].size());
    for (std::size_t k = 0; k < expected[i].size(); ++k) {
      ASSERT_EQ(divided.regions[i].facet[k], expected[i][k].first);
      ASSERT_EQ(polygon_of(divided.regions[i], k), expected[i][k].second);
    }
  }
  std::size_t expected_pieces = leftovers;
  for (const auto& part : expected) expected_pieces += part.size();
  EXPECT_EQ(pieces, expected_pieces);
}

bool has_repeated_vertex(const Mesh& mesh) {
  return std::any_of(mesh.facets.begin(), mesh.facets.end(),
                     [](const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
}

TEST(Partition, divides_whole_and_cut_facets_as_one_by_one) {
  Random random(5);
  for (const test::NamedMesh& named : test::all_meshes()) {
    if (has_repeated_vertex(named.mesh)) continue;  // those go by growth, not by power
    SCOPED_TRACE(named.name);
    for (int trial = 0; trial < 4; ++trial) {
      const Region whole = whole_surface(named.mesh);
      const std::vector<Sphere> spheres = spheres_about(named.mesh, random);
      expect_divided_as_one_by_one(named.mesh, whole, spheres);
      // Once more what is cut already.
      const std::vector<Sphere> finer = spheres_about(named.mesh, random);
      for (const Region& part : partition(named.mesh, whole, spheres).regions)
        expect_divided_as_one_by_one(named.mesh, part, finer);
    }
  }
}

// Segments and points are in one part, whole, and no sphere grows for one that another reaches already.
TEST(Partition, keeps_facets_with_a_repeated_vertex_whole) {
  Random random(6);
  std::size_t reached = 0, not_reached = 0;
  for (const test::NamedMesh& named : test::all_meshes()) {
    SCOPED_TRACE(named.name);
    Mesh mesh{named.mesh.positions, {}};
    for (const Facet& f : named.mesh.facets)
      mesh.facets.insert(mesh.facets.end(), {f, {f[0], f[1], f[1]}, {f[2], f[2], f[2]}});
    for (int trial = 0; trial < 4; ++trial) {
      const std::vector<Sphere> spheres = spheres_about(mesh, random);
      const Partition divided = partition(mesh, whole_surface(mesh), spheres);
      std::vector<int> times(mesh.facet_count(), 0);
      for (std::size_t i = 0; i < spheres.size(); ++i)
        for (std::size_t k = 0; k < divided.regions[i].size(); ++k) {
          const std::uint32_t f = divided.regions[i].facet[k];
          if (f % 3 == 0) continue;
          ++times[f];
          ASSERT_TRUE(divided.regions[i].is_whole(k));
          const double almost = 1 - 1e-12, hardly = 1 + 1e-12;
          const auto reach = [&](const Sphere& s) { return farthest_distance(s.center, mesh.corners(f)) / s.radius; };
          if (std::none_of(spheres.begin(), spheres.end(), [&](const Sphere& s) { return reach(s) <= almost; })) {
            ++not_reached;
            continue;
          }
          ++reached;
          ASSERT_LE(reach(spheres[i]), hardly);
        }
      for (std::size_t f = 0; f < mesh.facet_count(); ++f) ASSERT_EQ(times[f], f % 3 == 0 ? 0 : 1) << f;
    }
  }
  EXPECT_GT(reached, 10000u);
  EXPECT_GT(not_reached, 1000u);
}

TEST(Region, gives_back_what_was_added) {
  Random random(1);
  Region region;
  std::vector<std::pair<std::uint32_t, std::vector<Barycentric>>> added;
  std::size_t corners = 0;
  for (std::uint32_t k = 0; k < 500; ++k) {
    std::vector<Barycentric> polygon(whole_facet.begin(), whole_facet.end());
    if (random.uniform() < 0.3) polygon = {{1, 0, 0}, {0.5, 0.5, 0}, {0, random.uniform(), 1}, {0.5, 0, 0.5}};
    if (random.uniform() < 0.1) std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
    region.add(k % 7, polygon);
    corners += polygon.size();
    added.push_back({k % 7, polygon});
  }
  ASSERT_EQ(region.size(), added.size());
  EXPECT_EQ(region.corner_count(), corners);
  std::size_t whole = 0;
  for (std::size_t k = 0; k < added.size(); ++k) {
    EXPECT_EQ(region.facet[k], added[k].first);
    EXPECT_EQ(polygon_of(region, k), added[k].second);
    EXPECT_EQ(region.is_whole(k),
              std::equal(added[k].second.begin(), added[k].second.end(), whole_facet.begin(), whole_facet.end()));
    whole += region.is_whole(k);
  }
  EXPECT_GT(whole, 200u);
  EXPECT_LT(whole, 450u);
}

TEST(Region, hands_out_the_positions_of_its_corners) {
  Random random(2);
  for (const test::NamedMesh& named : test::all_meshes()) {
    SCOPED_TRACE(named.name);
    const std::vector<Sphere> spheres = spheres_about(named.mesh, random);
    for (const Region& region : partition(named.mesh, whole_surface(named.mesh), spheres).regions) {
      std::vector<Vec3> all;
      for (std::size_t k = 0; k < region.size(); ++k)
        for (const Barycentric& b : region.polygon(k))
          all.push_back(at_barycentric(named.mesh.corners(region.facet[k]), b));
      for (const std::size_t most : {1u, 7u, 100u, 100000u}) {
        std::vector<Vec3> expected;
        for (std::size_t i = 0; i < all.size(); i += 1 + all.size() / most) expected.push_back(all[i]);
        EXPECT_EQ(some_corner_positions(named.mesh, region, most), expected) << most;
      }
      // Each once at least, in the order in which they come first.
      std::vector<Vec3> found;
      corner_positions(named.mesh, region, found);
      EXPECT_LE(found.size(), all.size());
      std::size_t at = 0;
      for (const Vec3& p : all) {
        if (at < found.size() && found[at] == p) {
          ++at;
          continue;
        }
        ASSERT_NE(std::find(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(at), p),
                  found.begin() + static_cast<std::ptrdiff_t>(at));
      }
      EXPECT_EQ(at, found.size());
    }
  }
}

TEST(VertexMemo, never_takes_one_vertex_for_another) {
  for (const std::size_t facets : {0u, 100u, 1000000u}) {
    VertexMemo<std::uint64_t> memo(facets);
    Random random(3);
    std::map<std::uint32_t, int> made;
    std::size_t asked = 0;
    for (int i = 0; i < 20000; ++i) {
      // Near each other for a while, and some that fall together.
      const auto vertex = static_cast<std::uint32_t>(i / 10 + random.uniform(0, 20)) + (i % 40 == 0 ? 65536u : 0u);
      const std::uint64_t value = memo.of(vertex, [&] { return ++made[vertex], 7 * std::uint64_t{vertex}; });
      ASSERT_EQ(value, 7 * std::uint64_t{vertex});
      ++asked;
    }
    std::size_t makings = 0;
    for (const auto& [vertex, times] : made) makings += static_cast<std::size_t>(times);
    EXPECT_LT(2 * makings, asked) << "next to nothing is remembered";
  }
}

}  // namespace
}  // namespace morula
