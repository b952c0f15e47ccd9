// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Estimates of looseness on meshes that nobody made for the purpose.
#include <gtest/gtest.h>

#include <morula/io/mesh_file.hpp>
#include <support/corpus.hpp>

#include "looseness_comparison.hpp"

namespace morula {
namespace {

class EstimateCorpus : public testing::TestWithParam<const char*> {};

TEST_P(EstimateCorpus, agrees_with_voxels_on_scanned_modeled_and_machined_bodies) {
  const auto file = test::corpus_file(std::string(GetParam()) + ".off");
  if (file.empty()) GTEST_SKIP() << test::no_corpus;
  test::expect_estimates_near_voxels(GetParam(), read_mesh(file));
}

const auto body_name = [](const testing::TestParamInfo<const char*>& tested) { return std::string(tested.param); };
INSTANTIATE_TEST_SUITE_P(Quick, EstimateCorpus, testing::Values("joint"), body_name);
INSTANTIATE_TEST_SUITE_P(Nightly, EstimateCorpus,
                         testing::Values("hand", "elephant", "fandisk", "bear", "knot1", "cow", "helmet"), body_name);

}  // namespace
}  // namespace morula
