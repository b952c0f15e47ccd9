// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Real meshes, good and bad: everything that loads must get a tree with a proof.
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/update/body.hpp>
#include <scenes/scenes.hpp>
#include <support/corpus.hpp>

namespace morula {
namespace {

// The folder may come or change after the tests were listed, so they are named by parts of it, not by meshes: part p
// has every mesh whose place in the list is p, modulo the number of parts.
constexpr std::size_t parts = 8;

struct Part {
  BuildOptions options;
  std::size_t part;
};
class Corpus : public testing::TestWithParam<Part> {};

TEST_P(Corpus, gets_a_proof_of_cover_for_every_mesh_that_loads) {
  const auto paths = scenes::corpus_meshes();
  if (paths.empty()) GTEST_SKIP() << test::no_corpus;
  const auto& [options, part] = GetParam();
  Workers workers(0);
  for (std::size_t i = part; i < paths.size(); i += parts) {
    Mesh mesh;
    try {
      mesh = read_mesh(paths[i]);
    } catch (const FileError&) {
      continue;  // what can be read is the next test's
    }
    const CoveredTree model = build(mesh, options, workers);
    const auto faults = validate(mesh, model);
    EXPECT_TRUE(faults.empty()) << paths[i].filename() << ": " << faults.front();
  }
}

TEST(CorpusFiles, are_read_or_refused_by_name) {
  const auto paths = scenes::corpus_meshes();
  if (paths.empty()) GTEST_SKIP() << test::no_corpus;
  std::size_t loaded = 0;
  for (const auto& path : paths) {
    try {
      read_mesh(path);
      ++loaded;
    } catch (const FileError& e) {
      // tests/io says more of what is refused.
      EXPECT_NE(std::string(e.what()).find(path.filename().string()), std::string::npos) << e.what();
    }
  }
  EXPECT_GT(loaded, 100u) << "of " << paths.size() << " files";
}

std::vector<Part> in_parts(std::initializer_list<BuildOptions> all_options) {
  std::vector<Part> all;
  for (const BuildOptions& options : all_options)
    for (std::size_t part = 0; part < parts; ++part) all.push_back({options, part});
  return all;
}
std::string part_name(const testing::TestParamInfo<Part>& tested) {
  return std::string(name(tested.param.options.method)) + "_" + std::to_string(tested.param.part);
}
INSTANTIATE_TEST_SUITE_P(Quick, Corpus, testing::ValuesIn(in_parts({{.method = Method::octree, .depth = 3}})),
                         part_name);
INSTANTIATE_TEST_SUITE_P(
    Nightly, Corpus,
    testing::ValuesIn(in_parts({{.method = Method::grid, .depth = 3},
                                {.method = Method::hubbard, .depth = 2},
                                {.method = Method::spawn, .depth = 2},
                                {.method = Method::medial, .depth = 1},
                                {.method = Method::combined, .depth = 1},
                                {.method = Method::optimized, .depth = 3, .quality = Quality::fast}})),
    part_name);

}  // namespace
}  // namespace morula
