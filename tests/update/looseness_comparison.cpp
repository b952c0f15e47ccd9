// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "looseness_comparison.hpp"

#include <gtest/gtest.h>

#include <morula/accuracy/looseness.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/update/looseness_estimate.hpp>

#include "bodies.hpp"

namespace morula::test {

void expect_estimates_near_voxels(const std::string& name, const Mesh& mesh) {
  const CoveredTree model = build(mesh, {.method = Method::optimized, .depth = 3, .quality = Quality::fast});
  Body body(mesh, model);
  LoosenessEstimator estimator(mesh);
  const LoosenessMeter meter(mesh);
  std::vector<double> estimate(model.tree.level_count());
  std::vector<Sphere> spheres;
  for (const Deformation& deformation :
       {Deformation(Rotate{0}), Deformation(Stretch{1.4}), Deformation(Stretch{2}), Deformation(Twist{180}),
        Deformation(Bend{60}), Deformation(Noise{}), Deformation(Poke{})}) {
    // Walls that lie in the voxels' planes are counted in or out as a whole.
    const auto positions = rotated(deform(mesh, {deformation}, 1.0), {1, 2, 3}, 25);
    ASSERT_TRUE(body.update(positions));
    body.copy_spheres(spheres);
    estimator.pose(positions);
    estimator.estimate(body, estimate);
    for (std::size_t level = 0; level < estimate.size(); ++level) {
      const auto measured =
          meter.measure(positions, level_set_spheres(model.tree, spheres, level), {.resolution = 256}).looseness;
      ASSERT_TRUE(measured) << name;
      if (*measured <= 1.5) {
        EXPECT_NEAR(estimate[level], *measured, 0.15 * *measured)
            << name << ", " << describe(deformation) << ", level " << level;
      }
    }
  }
}

}  // namespace morula::test
