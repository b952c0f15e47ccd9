// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trees of tiny, aligned and degenerate meshes pass validate: their patches tile the facets, whatever falls on what.
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/power_diagram.hpp>
#include <support/aligned.hpp>
#include <support/methods.hpp>

namespace morula {
namespace {

std::string first_fault(const Mesh& mesh, const BuildOptions& options) {
  const auto faults = validate(mesh, build(mesh, options));
  return faults.empty() ? "" : faults.front();
}

// Few vertices on a coarse lattice, some a hair off; facets between any of them, repeated vertices included.
Mesh tiny_mesh(Random& random) {
  Mesh mesh;
  const int vertices = 3 + static_cast<int>(random.uniform(0, 5));
  const int facets = 1 + static_cast<int>(random.uniform(0, 7));
  const double hair = random.uniform() < 0.5 ? 0 : 0x1p-8;
  const double far = random.uniform() < 0.25 ? 1e6 : 0;
  for (int i = 0; i < vertices; ++i) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = far + std::floor(random.uniform(0, 3)) / 2 - (random.uniform() < 0.2 ? hair : 0);
    mesh.positions.push_back(p);
  }
  for (int i = 0; i < facets; ++i) {
    Facet f;
    for (std::uint32_t& v : f) v = static_cast<std::uint32_t>(random.uniform(0, vertices));
    mesh.facets.push_back(f);
  }
  return mesh;
}

void expect_tiling_of_tiny_meshes(std::uint64_t seed, int trials) {
  Random random(seed);
  for (int trial = 0; trial < trials; ++trial) {
    const Mesh mesh = tiny_mesh(random);
    const int branching = std::array{2, 3, 4, 8, 16}[static_cast<std::size_t>(random.uniform(0, 5))];
    const int depth = 1 + static_cast<int>(random.uniform(0, 3));
    if (bounding_box(mesh).diagonal() == 0) continue;
    EXPECT_EQ(first_fault(mesh, {.method = Method::octree, .branching = branching, .depth = depth}), "")
        << "trial " << trial << ", branching " << branching << ", depth " << depth;
  }
}

TEST(Tiling, holds_for_octrees_of_tiny_degenerate_meshes) {
  expect_tiling_of_tiny_meshes(17, 200);
}

TEST(NightlyTiling, holds_for_octrees_of_many_tiny_degenerate_meshes) {
  expect_tiling_of_tiny_meshes(17, 1500);
}

using TilingBy = test::ByMethod;

TEST_P(TilingBy, holds_on_aligned_bodies) {
  const Method method = GetParam();
  for (const test::NamedMesh& body : test::aligned_bodies())
    for (const int branching : {3, 8}) {
      if (method != Method::octree && body.mesh.facet_count() > 60) continue;
      const bool own = method == Method::optimized;
      EXPECT_EQ(first_fault(body.mesh, {.method = method,
                                        .branching = branching,
                                        .depth = method == Method::octree ? 3 : 1,
                                        .quality = own ? Quality::draft : Quality::standard}),
                "")
          << body.name << ", " << name(method) << ", branching " << branching;
    }
}

INSTANTIATE_TEST_SUITE_P(Quick, TilingBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, TilingBy, testing::ValuesIn(test::slow_methods), test::method_name);

// A flat prism 1e6 from the origin: its cells are so small beside the distance that ties are most of what there is.
TEST(Tiling, holds_where_ties_are_wider_than_cells) {
  Mesh mesh{{{1000000.9502357519, -999999.99999005673, 499844.63721675443},
             {999999.2649805448, -999999.99998566031, 499804.47241931793},
             {1000000.159656672, -999999.99988824304, 499891.96154726483},
             {1000000.2647150378, -1000000.0000986656, 499869.73220416572},
             {1000000.2062119478, -1000000.000023615, 500882.67795834289},
             {1000000.0728725109, -1000000.0000232186, 499256.75898374914}},
            {{0, 4, 2}, {2, 4, 1}, {1, 4, 3}, {3, 4, 0}, {2, 5, 0}, {1, 5, 2}, {3, 5, 1}, {0, 5, 3}}};
  for (const int branching : {2, 4, 8, 27})
    for (const int depth : {1, 2, 3})
      EXPECT_EQ(first_fault(mesh, {.method = Method::octree, .branching = branching, .depth = depth}), "")
          << branching << ", " << depth;
}

// Signs of rounded differences that no line can have: corners far off tie, near ones do not.
TEST(Tiling, survives_differences_that_are_not_affine) {
  Random random(5);
  for (int trial = 0; trial < 20000; ++trial) {
    // Two spheres whose bisector runs along an edge or through corners, and corners at very different distances.
    const double scale = std::pow(10.0, random.uniform(-8, 0));
    const Triangle t{Vec3{0, 0, 0}, Vec3{1, scale * std::floor(random.uniform(-2, 3)), 0},
                     Vec3{std::floor(random.uniform(0, 3)) / 2, 1, scale * random.uniform()}};
    std::vector<Sphere> spheres;
    for (int i = 0; i < 4; ++i)
      spheres.push_back({Vec3{std::floor(random.uniform(0, 5)) / 4, std::floor(random.uniform(0, 5)) / 4,
                              scale * std::floor(random.uniform(0, 3))} *
                             (i % 2 == 0 ? 1.0 : scale),
                         1});
    CutFacet cut;
    const std::array<Barycentric, 3> whole{Barycentric{1, 0, 0}, Barycentric{0, 1, 0}, Barycentric{0, 0, 1}};
    const std::vector<std::uint32_t> all{0, 1, 2, 3};
    cut_by_power({t, {0, 1, 2}}, whole, spheres, all, cut);
    double area = 0;
    for (std::size_t k = 0; k < cut.size(); ++k) {
      const auto polygon = cut.polygon(k);
      for (std::size_t i = 2; i < polygon.size(); ++i)
        area += (polygon[i - 1][1] - polygon[0][1]) * (polygon[i][2] - polygon[0][2]) -
                (polygon[i][1] - polygon[0][1]) * (polygon[i - 1][2] - polygon[0][2]);
    }
    ASSERT_NEAR(area, 1, 1e-13) << "trial " << trial;
  }
}

}  // namespace
}  // namespace morula
