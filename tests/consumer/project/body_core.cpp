// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The core alone: a body made by formula follows a bend, and the proof of its cover is checked.
#include <cstdio>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <morula/version.hpp>

int main() {
  const morula::Mesh mesh = morula::sample_body("bar", 8);
  const morula::CoveredTree model = morula::build(mesh, {.depth = 2});
  morula::Body body(mesh, model);

  const std::vector<morula::Vec3> bent = morula::deform(mesh, {morula::Bend{60}}, 1.0);
  if (!body.update(bent)) return 1;
  std::vector<morula::Sphere> spheres;
  body.copy_spheres(spheres);
  const bool covered = morula::certify(body.cover(), bent, spheres).covered;
  std::printf("%zu spheres, %s\n", spheres.size(), covered ? "covered" : "bare");
  return covered ? 0 : 1;
}
