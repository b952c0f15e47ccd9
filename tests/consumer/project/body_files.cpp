// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// With files: read a mesh, build, update, measure, and expect the surface covered.
#include <cstdio>
#include <morula/morula.hpp>

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const morula::Mesh mesh = morula::read_mesh(argv[1]);
  const morula::CoveredTree model = morula::build(mesh, {.branching = 8, .depth = 2});
  morula::Body body(mesh, model);

  morula::Mesh moved = mesh;
  moved.positions = morula::deform(mesh, {morula::Stretch{1.5}}, 1.0);
  if (!body.update(moved.positions)) return 1;

  bool covered = true;
  for (const morula::LevelMeasure& level : morula::measure(moved, body.current_tree())) {
    std::printf("level %zu: %zu spheres, looseness %.3f, bare %.3g\n", level.level, level.spheres,
                level.looseness.looseness.value_or(-1.0), level.coverage.uncovered_area);
    covered = covered && level.coverage.covered;
  }
  return covered ? 0 : 1;
}
