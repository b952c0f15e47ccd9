// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far a set's spheres stick out, found through the parts of the surface that they own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <generators/divide/largest_protrusion.hpp>
#include <generators/fit/partition.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <scenes/brute_force.hpp>
#include <support/meshes.hpp>
#include <tree/region.hpp>

namespace morula {
using namespace detail;
namespace {

// The surface shared out among spheres about these centers, each just as large as its part needs.
std::vector<BuildNode> leaves_about(const Mesh& mesh, const std::vector<Vec3>& centers) {
  std::vector<Sphere> seeds;
  for (const Vec3& c : centers) seeds.push_back({c, 0});
  const Partition parts = partition(mesh, whole_surface(mesh), seeds);
  std::vector<BuildNode> leaves;
  std::vector<Vec3> corners;
  for (std::size_t i = 0; i < centers.size(); ++i) {
    if (parts.regions[i].empty()) continue;
    corner_positions(mesh, parts.regions[i], corners);
    BuildNode leaf;
    leaf.region = parts.regions[i];
    leaf.sphere = {centers[i], rounded_up_radius(farthest_distance(centers[i], corners), max_norm(centers[i]))};
    leaves.push_back(std::move(leaf));
  }
  return leaves;
}

// By all facets. A whole number of turns other than 0 and 1 is where layers overlap.
double protrusion_by_all_facets(const Mesh& mesh, double orientation, const Sphere& s) {
  const double away = std::sqrt(brute_force::closest_point(mesh, s.center).squared_distance);
  const bool inside = orientation * brute_force::winding_number(mesh, s.center) > 0.5;
  return std::max(0.0, s.radius + (inside ? -away : away));
}

std::vector<std::vector<Vec3>> sets_of_centers(const Mesh& mesh, std::uint64_t seed) {
  const Box box = bounding_box(mesh);
  const Vec3 extent = box.extent();
  Random random(seed);
  std::vector<std::vector<Vec3>> sets;
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{30}}) {
    sets.emplace_back();
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = box.lower[k] + extent[k] * random.uniform(-0.1, 1.1);
      sets.back().push_back(p);
    }
  }
  // Below and above corners, middles of edges and of facets: the way up from there passes exactly through these.
  sets.emplace_back();
  const std::size_t step = std::max<std::size_t>(1, mesh.facet_count() / 12);
  for (std::size_t f = 0; f < mesh.facet_count(); f += step) {
    const Triangle t = mesh.corners(f);
    const double up = extent.z * (f % 2 == 0 ? -0.25 : 0.125);
    sets.back().push_back(t[0] + Vec3{0, 0, up});
    sets.back().push_back((t[1] + t[2]) * 0.5 + Vec3{0, 0, up});
    sets.back().push_back((t[0] + t[1] + t[2]) * (1.0 / 3) + Vec3{0, 0, up});
  }
  // A lattice that the corners of axis-aligned bodies are on.
  sets.emplace_back();
  for (int i = 0; i < 27; ++i)
    sets.back().push_back(box.lower + Vec3{extent.x * (i % 3), extent.y * (i / 3 % 3), extent.z * (i / 9)} * 0.5);
  return sets;
}

TEST(LargestProtrusion, is_that_of_all_facets) {
  std::size_t without_index = 0;
  for (const test::NamedMesh& body : test::all_meshes()) {
    if (body.mesh.facets.empty()) continue;
    for (const std::uint64_t seed : {1u, 2u})
      for (const std::vector<Vec3>& centers : sets_of_centers(body.mesh, seed)) {
        const std::vector<BuildNode> leaves = leaves_about(body.mesh, centers);
        const ObjectShape shape(body.mesh);
        const double found = largest_protrusion(body.mesh, shape, leaves);
        if (!shape.has_volume()) {
          double by_index = 0;
          for (const BuildNode& leaf : leaves)
            by_index = std::max(by_index, shape.distance().protrusion_bound(leaf.sphere));
          EXPECT_EQ(found, by_index) << body.name;
          continue;
        }
        double expected = 0;
        for (const BuildNode& leaf : leaves)
          expected = std::max(expected, protrusion_by_all_facets(body.mesh, shape.orientation(), leaf.sphere));
        EXPECT_EQ(found, expected) << body.name << ", " << centers.size() << " centers";
        without_index += !shape.has_index();
        // Every sphere in turn so large that it is the one that counts.
        const double much = 4 * bounding_box(body.mesh).diagonal();
        std::vector<BuildNode> with_large = leaves;
        for (std::size_t i = 0; i < leaves.size(); ++i) {
          with_large[i].sphere.radius += much;
          EXPECT_EQ(largest_protrusion(body.mesh, ObjectShape(body.mesh), with_large),
                    protrusion_by_all_facets(body.mesh, shape.orientation(), with_large[i].sphere))
              << body.name << ", " << centers.size() << " centers, " << i;
          with_large[i].sphere = leaves[i].sphere;
        }
      }
  }
  EXPECT_GT(without_index, 100u);
}

// A body far from the origin, where rounding is large beside it, and a minute one.
TEST(LargestProtrusion, holds_at_any_place_and_size) {
  for (const double size : {1e-12, 1.0, 1e12})
    for (const double away : {0.0, 1e6}) {
      Mesh mesh = sample_body("limb", 12);
      for (Vec3& p : mesh.positions) p = (p + Vec3{away, -away, 2 * away}) * size;
      for (const std::vector<Vec3>& centers : sets_of_centers(mesh, 3)) {
        const std::vector<BuildNode> leaves = leaves_about(mesh, centers);
        const ObjectShape shape(mesh);
        double expected = 0;
        for (const BuildNode& leaf : leaves)
          expected = std::max(expected, protrusion_by_all_facets(mesh, 1, leaf.sphere));
        EXPECT_EQ(largest_protrusion(mesh, shape, leaves), expected) << size << ", " << away;
      }
    }
}

// In the middle of a shell that lies on a larger one's inside, turned or not; where solids overlap.
TEST(LargestProtrusion, counts_layers) {
  for (const bool hollow : {true, false})
    for (const double shift : {0.0, 1.2}) {
      Mesh mesh = test::icosphere(2, 2);
      const Mesh other = test::icosphere(2, 1, {shift, 0, 0});
      const auto first = static_cast<std::uint32_t>(mesh.vertex_count());
      mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
      for (Facet f : other.facets) {
        for (std::uint32_t& v : f) v += first;
        if (hollow) std::swap(f[0], f[1]);
        mesh.facets.push_back(f);
      }
      const ObjectShape shape(mesh);
      ASSERT_TRUE(shape.has_volume());
      const std::vector<BuildNode> leaves =
          leaves_about(mesh, {{0.01, 0.02, 0}, {1.5, 0, 0.03}, {-1.5, 0.1, 0}, {2.5, 0, 0}});
      double expected = 0;
      for (const BuildNode& leaf : leaves)
        expected = std::max(expected, protrusion_by_all_facets(mesh, 1, leaf.sphere));
      EXPECT_EQ(largest_protrusion(mesh, shape, leaves), expected) << hollow << ' ' << shift;
      EXPECT_FALSE(shape.has_index());
    }
}

}  // namespace
}  // namespace morula
