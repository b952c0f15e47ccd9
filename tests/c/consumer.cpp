// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <morula/morula.hpp>

int main() {
  const morula::Mesh mesh = morula::sample_body("torus", 12);
  const morula::CoveredTree model = morula::build(mesh, {.method = morula::Method::octree});
  std::printf("%zu spheres\n", model.tree.node_count());
  return morula::validate(mesh, model).empty() ? 0 : 1;
}
