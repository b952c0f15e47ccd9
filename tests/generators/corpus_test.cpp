// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Real meshes, good and bad: everything that loads must get a tree with a proof.
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/update/body.hpp>
#include <scenes/scenes.hpp>

namespace morula {
namespace {

class Corpus : public testing::TestWithParam<BuildOptions> {};

TEST_P(Corpus, gets_a_proof_of_cover_for_every_mesh_that_loads) {
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
    const Built built = build(mesh, GetParam(), workers);
    const auto faults = validate(mesh, built);
    EXPECT_TRUE(faults.empty()) << name(GetParam().method) << " on " << path.filename() << ": " << faults.front();
  }
  EXPECT_GT(loaded, 100u) << "of " << paths.size() << " files";
}

INSTANTIATE_TEST_SUITE_P(EveryMethod, Corpus,
                         testing::Values(BuildOptions{.method = Method::octree, .depth = 3},
                                         BuildOptions{.method = Method::grid, .depth = 3},
                                         BuildOptions{.method = Method::hubbard, .depth = 2},
                                         BuildOptions{.method = Method::spawn, .depth = 2},
                                         BuildOptions{.method = Method::medial, .depth = 1},
                                         BuildOptions{.method = Method::combined, .depth = 1},
                                         BuildOptions{.method = Method::morula, .depth = 3, .quality = Quality::fast}),
                         [](const auto& tested) { return std::string(name(tested.param.method)); });

}  // namespace
}  // namespace morula
