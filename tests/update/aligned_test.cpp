// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rules that promise cover, on bodies whose cuts align: judged in extended precision from the public cover.
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/update/kdop_tree.hpp>
#include <support/aligned.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

struct Placed {
  long double x, y, z;
};

Placed corner_place(const Cover& cover, std::uint32_t corner, const std::vector<Vec3>& positions) {
  Placed sum{0, 0, 0};
  const auto add = [&](std::uint32_t vertex, double weight) {
    const Vec3& p = positions[vertex];
    const auto w = static_cast<long double>(weight);
    sum.x += w * p.x, sum.y += w * p.y, sum.z += w * p.z;
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
    for (int k = 0; k < 3; ++k) add(cut.vertex[k], cut.weight[k]);
  }
  return sum;
}

// The largest distance of a corner from the sphere of a node that owns it.
long double worst_excess(const Body& body, const std::vector<Vec3>& positions) {
  const Cover& cover = body.cover();
  long double worst = -1e30L;
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) {
    const Sphere s = body.sphere(node);
    for (const std::uint32_t c : cover.region_corners(node)) {
      const Placed p = corner_place(cover, c, positions);
      const long double x = p.x - s.center.x, y = p.y - s.center.y, z = p.z - s.center.z;
      worst = std::max(worst, std::sqrt(x * x + y * y + z * z) - s.radius);
    }
  }
  return worst;
}

std::vector<CoveredTree> trees_of(const Mesh& mesh) {
  std::vector<CoveredTree> trees;
  trees.push_back(build(mesh, {.method = Method::octree, .depth = 2}));
  trees.push_back(build(mesh, {.method = Method::octree, .branching = 3, .depth = 3}));
  trees.push_back(build(mesh, {.method = Method::grid, .depth = 2}));
  trees.push_back(build(mesh, {.method = Method::spawn, .depth = 1}));
  return trees;
}

TEST(Aligned, bodies_are_covered_by_every_rule_that_promises_it) {
  const std::vector<UpdateOptions> options{{.rules = {Rule::exact}},
                                           {.rules = {Rule::wrapped}},
                                           {.rules = {Rule::exact, Rule::approach2}, .conservative = true}};
  std::size_t frames = 0;
  for (const test::NamedMesh& b : test::aligned_bodies())
    for (const CoveredTree& model : trees_of(b.mesh))
      for (const UpdateOptions& how : options) {
        Body body(b.mesh, model, how);
        for (const test::Motion& motion : test::motions()) {
          const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
          ASSERT_TRUE(body.update(positions));
          EXPECT_LE(worst_excess(body, positions), 0) << b.name << ", " << motion.name;
          ++frames;
        }
      }
  EXPECT_GT(frames, 1000u);
}

TEST(Aligned, bodies_are_covered_by_modes_at_any_coordinates) {
  for (const test::NamedMesh& b : test::aligned_bodies()) {
    const CoveredTree model = build(b.mesh, {.method = Method::octree, .depth = 2});
    const Modes modes = test::linear_modes(b.mesh);
    Body body(b.mesh, model, {.rules = {Rule::modal}, .modes = modes});
    for (const double stretch : {0.5, 2.0, -1.0, 100.0}) {
      std::vector<double> coordinates(9, 0.0);
      coordinates[0] = stretch - 1;
      coordinates[5] = 0.3 * stretch;
      std::vector<Vec3> positions(b.mesh.positions.size());
      move_by_modes(modes, b.mesh.positions, coordinates, positions);
      ASSERT_TRUE(body.update_modal(coordinates));
      EXPECT_LE(worst_excess(body, positions), 0) << b.name << ", " << stretch;
    }
  }
}

TEST(Aligned, bodies_are_covered_by_slabs) {
  for (const test::NamedMesh& b : test::aligned_bodies()) {
    const CoveredTree model = build(b.mesh, {.method = Method::octree, .depth = 2});
    KDopTree slabs(b.mesh, model, 26);
    for (const test::Motion& motion : test::motions()) {
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(slabs.update(positions));
      long double worst = -1e30L;
      for (std::uint32_t node = 0; node < slabs.node_count(); ++node)
        for (const std::uint32_t c : model.cover.region_corners(node)) {
          const Placed p = corner_place(model.cover, c, positions);
          const Vec3 o = slabs.origin();
          for (std::size_t i = 0; i < slabs.directions().size(); ++i) {
            const Vec3 d = slabs.directions()[i];
            const long double height = (p.x - o.x) * d.x + (p.y - o.y) * d.y + (p.z - o.z) * d.z;
            worst = std::max({worst, height - slabs.upper(node)[i], slabs.lower(node)[i] - height});
          }
        }
      EXPECT_LE(worst, 0) << b.name << ", " << motion.name;
    }
  }
}

}  // namespace
}  // namespace morula
