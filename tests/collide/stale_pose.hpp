// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A collider whose spheres have moved while nobody gave the positions of the frame.
#pragma once

#include <morula/collide/collider.hpp>
#include <vector>

namespace morula::test {

struct StalePose {
  PosedSpheres spheres;
  Collider collider;

  StalePose(const Mesh& mesh, const Cover& cover, const SphereState& pose)
      : spheres(pose), collider(mesh, cover, spheres.sphere_state()) {
    next_frame();
  }
  void next_frame() {
    const std::vector<Spheref> same(spheres.sphere_state().spheres.begin(), spheres.sphere_state().spheres.end());
    spheres.set(same, spheres.sphere_state().origin);
  }
};

}  // namespace morula::test
