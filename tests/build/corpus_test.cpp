// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Real meshes, good and bad: everything that loads must get a tree with a proof.
#include <gtest/gtest.h>

#include <morula/build/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/update/body.hpp>
#include <scenes/scenes.hpp>

namespace morula {
namespace {

// quality: for method morula.
void expect_proof_on_every_mesh(Method method, int depth, Quality quality = Quality::standard) {
  const auto paths = scenes::corpus_meshes();
  if (paths.empty()) GTEST_SKIP() << "the corpus is not there: run scripts/corpus, or set MORULA_CORPUS";
  Workers workers(0);
  std::size_t loaded = 0;
  for (const auto& path : paths) {
    Mesh mesh;
    try {
      mesh = read_mesh(path);
    } catch (const FileError& e) {
      // What the reader refuses, it must refuse by name; tests/io holds it to that.
      EXPECT_NE(std::string(e.what()).find(path.filename().string()), std::string::npos) << e.what();
      continue;
    }
    ++loaded;
    const Built built = build(mesh, {.method = method, .depth = depth, .quality = quality}, workers);
    const auto faults = validate(mesh, built);
    EXPECT_TRUE(faults.empty()) << name(method) << " on " << path.filename() << ": " << faults.front();
  }
  EXPECT_GT(loaded, 100u) << "of " << paths.size() << " files";
}

TEST(Corpus, octree_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::octree, 3);
}
TEST(Corpus, grid_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::grid, 3);
}
TEST(Corpus, hubbard_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::hubbard, 2);
}
TEST(Corpus, spawn_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::spawn, 2);
}
TEST(Corpus, medial_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::medial, 1);
}
TEST(Corpus, combined_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::combined, 1);
}

TEST(Corpus, morula_proves_its_cover_on_every_mesh_that_loads) {
  expect_proof_on_every_mesh(Method::morula, 3, Quality::fast);
}

}  // namespace
}  // namespace morula
