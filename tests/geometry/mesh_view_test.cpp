// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Whatever reads a mesh reads a view: of floats, of doubles with gaps, of nodes by index.
#include <gtest/gtest.h>

#include <bit>
#include <morula/accuracy/measure.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/tree/cover.hpp>
#include <numeric>

namespace morula {
namespace {

// The same body four times: as a mesh, with floats, with doubles and gaps, by index. Its coordinates are floats.
struct Views {
  Mesh mesh = sample_body("limb", 12);
  std::vector<Vec3f> floats;
  std::vector<double> gappy;
  std::vector<Vec3> nodes;
  std::vector<std::uint32_t> index;

  Views() {
    for (Vec3& p : mesh.positions) {
      p = Vec3(Vec3f(p));
      floats.emplace_back(p);
      gappy.insert(gappy.end(), {p.x, p.y, p.z, -1e300, 1e300});
    }
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      index.push_back(static_cast<std::uint32_t>(mesh.vertex_count()) - 1 - v);
      nodes.insert(nodes.begin(), mesh.positions[v]);
    }
  }
  std::vector<MeshView> all() const {
    return {mesh,
            {floats, mesh.facets},
            {PositionView::strided(gappy.data(), floats.size(), 5 * sizeof(double)), mesh.facets},
            {PositionView::indexed(nodes, index), mesh.facets}};
  }
};

TEST(MeshView, says_what_the_mesh_says) {
  const Views views;
  for (const MeshView& view : views.all()) {
    ASSERT_EQ(view.vertex_count(), views.mesh.vertex_count());
    ASSERT_EQ(view.facet_count(), views.mesh.facet_count());
    for (std::size_t f = 0; f < view.facet_count(); ++f) ASSERT_EQ(view.corners(f), views.mesh.corners(f));
  }
}

TEST(MeshView, gives_everything_that_reads_a_mesh_the_same_bits) {
  const Views views;
  const CoveredTree model = build(views.mesh, {.method = Method::octree, .depth = 2});
  const SignedDistance object(views.mesh);
  const MeshReport report = inspect(views.mesh);
  const std::vector<SurfacePoint> samples = sample_surface(views.mesh, 50);
  const std::vector<LevelMeasure> figures = measure(views.mesh, model.tree, {.grid = {.resolution = 32}});
  for (const MeshView& view : views.all()) {
    EXPECT_NO_THROW(require_usable(view));
    EXPECT_NO_THROW(require_usable_scale(view));
    EXPECT_EQ(mesh_hash(view), mesh_hash(views.mesh));
    EXPECT_EQ(bounding_box(view).lower, bounding_box(views.mesh).lower);
    EXPECT_EQ(largest_coordinate(view), largest_coordinate(views.mesh));
    EXPECT_EQ(surface_area(view), report.area);
    EXPECT_EQ(signed_volume(view), report.volume);
    EXPECT_EQ(inspect(view).nonmanifold_vertices, report.nonmanifold_vertices);
    EXPECT_TRUE(inspect(view).has_volume());
    EXPECT_TRUE(validate(view, model).empty());
    const std::vector<SurfacePoint> again = sample_surface(view, 50);
    const SignedDistance other(view);
    EXPECT_EQ(other.method(), object.method());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      EXPECT_EQ(again[i].point, samples[i].point);
      EXPECT_EQ(other(samples[i].point * 1.1), object(samples[i].point * 1.1));
    }
    const std::vector<LevelMeasure> found = measure(view, model.tree, {.grid = {.resolution = 32}});
    ASSERT_EQ(found.size(), figures.size());
    for (std::size_t level = 0; level < figures.size(); ++level) {
      EXPECT_EQ(found[level].looseness.looseness, figures[level].looseness.looseness);
      EXPECT_EQ(found[level].coverage.covered, figures[level].coverage.covered);
      EXPECT_EQ(found[level].protrusion->worst, figures[level].protrusion->worst);
    }
  }
}

TEST(MeshView, largest_coordinate_is_of_vertices_in_use) {
  const Mesh mesh{{{1, -7, 2}, {3, 0, 0}, {0, 5, 0}, {1e9, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(largest_coordinate(mesh), 7);
  EXPECT_EQ(largest_coordinate(bounding_box(mesh)), 7);
  EXPECT_EQ(largest_coordinate(Mesh{}), 0);
}

}  // namespace
}  // namespace morula
