// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/object_shape.hpp"

#include <gtest/gtest.h>

#include <morula/geometry/sample_bodies.hpp>
#include <support/meshes.hpp>

#include "generators/divide/demand.hpp"

namespace morula {
using namespace detail;
namespace {

std::vector<std::pair<const char*, Mesh>> objects() {
  Mesh stray = test::icosphere(2);
  stray.positions.push_back({7, 8, 9});  // which no facet has
  return {{"icosphere", test::icosphere(3)},
          {"inside out", test::inverted(test::box_mesh({0, 0, 0}, {1, 2, 3}, 2))},
          {"open", test::grid_plate(6)},
          {"soup", test::facet_soup(40, 3)},
          {"stray vertex", std::move(stray)},
          {"two", test::joined(test::icosphere(2), test::translated(test::icosphere(2), {0.5, 0, 0}))}};
}

TEST(ObjectShape, knows_the_same_with_its_index_and_without) {
  for (const auto& [name, mesh] : objects()) {
    SCOPED_TRACE(name);
    const ObjectShape quick(mesh), asked(mesh, serial_workers());
    EXPECT_FALSE(quick.has_index());
    EXPECT_TRUE(asked.has_index());
    const SignedDistance distance(mesh);
    for (const ObjectShape* shape : {&quick, &asked}) {
      EXPECT_EQ(shape->has_volume(), distance.has_volume());
      EXPECT_EQ(shape->orientation(), distance.orientation());
      EXPECT_EQ(shape->bounding_box().lower, distance.bvh().bounding_box().lower);
      EXPECT_EQ(shape->bounding_box().upper, distance.bvh().bounding_box().upper);
    }
    EXPECT_FALSE(quick.has_index());
  }
}

TEST(ObjectShape, makes_its_index_once_whoever_asks) {
  const Mesh mesh = sample_body("limb", 24);
  const ObjectShape shape(mesh);
  const SignedDistance distance(mesh);
  constexpr std::size_t askers = 16;
  std::vector<const SignedDistance*> answers(askers, nullptr);
  Workers workers(4);
  workers.run(askers, [&](std::size_t k) { answers[k] = &shape.distance(); });
  for (const SignedDistance* answer : answers) EXPECT_EQ(answer, answers[0]);
  for (const Vec3& p : mesh.positions) EXPECT_EQ((*answers[0])(p * 0.9), distance(p * 0.9));
}

TEST(ObjectShape, of_a_quick_tree_needs_no_index) {
  for (const char* body : {"limb", "torus", "blob", "plate"}) {
    const Mesh mesh = sample_body(body, 24);
    const ObjectShape shape(mesh);
    const BuildRun run({.method = Method::optimized, .depth = 3, .quality = Quality::fast}, mesh);
    const ObjectLines lines(mesh, shape, lattice_cells(mesh, shape, run.branching, run.depth), serial_workers());
    EXPECT_GT(fast_tree(fit_input(mesh, shape, lines), run, serial_workers()).tree.node_count(), 64u) << body;
    EXPECT_FALSE(shape.has_index()) << body;
  }
}

}  // namespace
}  // namespace morula
