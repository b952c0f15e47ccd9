// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A limb, its tree of two levels, and the limb stretched to up to twice its length.
#pragma once

#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <vector>

namespace morula::test {

inline const Mesh& limb() {
  static const Mesh mesh = sample_body("limb", 16);
  return mesh;
}
inline const CoveredTree& limb_tree() {
  static const CoveredTree model = build(limb(), {.depth = 2, .quality = Quality::fast});
  return model;
}
inline std::vector<Vec3> stretched_limb(double t) {
  return deform(limb(), {Stretch{2}}, t);
}

}  // namespace morula::test
