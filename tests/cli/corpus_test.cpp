// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A real scan of 75,000 facets through every command.
#include <gtest/gtest.h>

#include <support/corpus.hpp>

#include "workbench.hpp"

namespace morula::test {
namespace {

class CliCorpus : public testing::TestWithParam<const char*> {};

TEST_P(CliCorpus, bunny_is_built_moved_and_stays_covered) {
  const auto file = corpus_file("bunny00.off");
  if (file.empty()) GTEST_SKIP() << no_corpus;
  const Workbench bench;
  const std::string bunny = "'" + file.string() + "'";
  bench.require("info " + bunny);
  const std::string method = GetParam();
  EXPECT_TRUE(
      bench.require("build " + bunny + " -o bunny.morula --json --method " + method).json()["covered"].get<bool>());
  bench.require("info bunny.morula --check --mesh " + bunny);
  const auto measured = bench.require("measure " + bunny + " bunny.morula --no-protrusion --json").json();
  for (const auto& level : measured["frames"][0]["levels"]) {
    EXPECT_EQ(level["uncovered_area"].get<double>(), 0) << level;
    EXPECT_EQ(level["uncovered_distance"].get<double>(), 0) << level;
  }
  bench.require("deform " + bunny + " -o motion.npy --twist 90 --frames 3");
  const auto update = bench.require("update " + bunny + " bunny.morula motion.npy -o spheres --json").json();
  EXPECT_TRUE(update["certificate"]["covered"].get<bool>());
  EXPECT_EQ(bench.read("spheres/0000.sph"), bench.read("spheres/0002.sph"));
}

INSTANTIATE_TEST_SUITE_P(Quick, CliCorpus, testing::Values("octree"),
                         [](const auto& tested) { return std::string(tested.param); });
INSTANTIATE_TEST_SUITE_P(Nightly, CliCorpus, testing::Values("grid"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace morula::test
