// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/node_fit.hpp"

#include <gtest/gtest.h>

#include <morula/geometry/sample_bodies.hpp>

#include "generators/driver/driver.hpp"
#include "generators/fit/object_lines.hpp"

namespace morula {
using namespace detail;
namespace {

double width_of_parts(const Mesh& mesh, std::size_t most) {
  const ObjectShape shape(mesh);
  const ObjectLines lines(mesh, shape, 64, serial_workers());
  const BuildNode root = root_node(mesh, BuildRun(BuildOptions{}, mesh), {});
  return region_points(fit_input(mesh, shape, lines), root, most, 0.1).width;
}

// Eight spheres that cover a needle of length 1.7 have a mean diameter of a fifth of it or more. A grid for parts that
// are as narrow as its area says had four million cells, for one facet.
TEST(NodeFit, parts_of_a_needle_are_as_long_as_the_spheres_that_cover_it) {
  for (const double width : {1e-3, 1e-6, 1e-12, 0.0}) {
    Mesh needle;
    needle.positions = {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5 + width, 0.5 - width}};
    needle.facets = {{0, 1, 2}};
    EXPECT_GT(width_of_parts(needle, 8), 0.1) << width;
    EXPECT_LT(width_of_parts(needle, 8), 0.22) << width;
    EXPECT_GT(width_of_parts(needle, 2), 0.4) << width;
  }
}

TEST(NodeFit, parts_of_anything_else_are_as_wide_as_their_area) {
  for (const std::string_view name : sample_body_names()) {
    const Mesh mesh = sample_body(name, 12);
    for (const std::size_t most : {2u, 8u, 64u})
      EXPECT_NEAR(width_of_parts(mesh, most), std::sqrt(surface_area(mesh) / static_cast<double>(most)), 1e-9) << name;
  }
}

}  // namespace
}  // namespace morula
