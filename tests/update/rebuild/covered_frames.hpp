// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies whose tree or centers change from frame to frame, moved about; every frame is certified.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <string>
#include <vector>

#include "../bodies.hpp"
#include "limb.hpp"

namespace morula::test {

inline void expect_cover(const Body& body, const PositionView& positions, const std::string& where) {
  const std::vector<Sphere> spheres = spheres_of(body);
  const Certificate c = certify(body.cover(), positions, spheres);
  EXPECT_TRUE(c.covered) << where << ": node " << c.worst_node << " by " << c.worst_excess;
}

/// Three noisy frames of each of motions(). after: of every frame; where: its name.
inline void move_a_specimen(
    const Specimen& b, RebuiltBody& body,
    const std::function<void(const std::string& where)>& after = [](const std::string&) {}) {
  for (const Motion& motion : motions())
    for (std::uint64_t frame = 0; frame < 3; ++frame) {
      const std::string where = b.name + ", " + motion.name + ", frame " + std::to_string(frame);
      const std::vector<Vec3> positions = noisy(motion.apply(b.mesh.positions), 1e-3, frame);
      ASSERT_TRUE(body.update(positions));
      expect_cover(body.body(), positions, where);
      after(where);
    }
}

/// Of six edges around, with octrees, about the origin and far from it: stretched and twisted in twelve frames.
inline void move_coarse_bodies(
    const RebuildOptions& options, const std::function<void(const RebuiltBody&, const std::string& name)>& after =
                                       [](const RebuiltBody&, const std::string&) {}) {
  for (const char* name : {"limb", "torus"})
    for (const double away : {0.0, 1e6}) {
      Mesh mesh = sample_body(name, 6);
      for (Vec3& p : mesh.positions) p += Vec3{away, 0, 0};
      RebuiltBody body(mesh, build(mesh, {.method = Method::octree, .depth = 3}), options);
      for (int frame = 1; frame <= 12; ++frame) {
        const std::vector<Vec3> positions = deform(mesh, {Stretch{3}, Twist{180}}, frame / 12.0);
        ASSERT_TRUE(body.update(positions));
        expect_cover(body.body(), positions, std::string(name) + ", frame " + std::to_string(frame));
      }
      after(body, name);
    }
}

/// The stretched limb, which gets a new tree in every other frame.
inline void move_while_trees_change(RebuildOptions options) {
  options.rebuild_every = 2, options.min_improvement = -1e9, options.thread = RebuildThread::caller;
  RebuiltBody body(limb(), limb_tree(), options);
  for (int frame = 1; frame <= 10; ++frame) {
    const std::vector<Vec3> positions = stretched_limb(frame / 10.0);
    ASSERT_TRUE(body.update(positions));
    expect_cover(body.body(), positions, "frame " + std::to_string(frame));
  }
  EXPECT_GT(body.report().swapped, 2u);
}

/// Of the limb, in six frames of a stretch.
inline std::vector<std::uint64_t> hashes_of_a_stretch(RebuiltBody& body) {
  std::vector<std::uint64_t> hashes;
  for (int frame = 1; frame <= 6; ++frame) {
    EXPECT_TRUE(body.update(stretched_limb(frame / 6.0)));
    hashes.push_back(body.body().hash());
  }
  return hashes;
}

/// A body that was updated: positions that are no numbers change nothing.
inline void refuse_bad_positions(RebuiltBody& body, std::vector<Vec3> positions) {
  const std::uint64_t hash = body.body().hash();
  positions[7].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(body.update(positions));
  EXPECT_EQ(body.body().hash(), hash);
}

}  // namespace morula::test
