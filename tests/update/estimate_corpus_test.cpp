// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Estimates of looseness on meshes that nobody made for the purpose.
#include <gtest/gtest.h>

#include <filesystem>
#include <morula/io/mesh_file.hpp>
#include <scenes/scenes.hpp>

#include "looseness_comparison.hpp"

namespace morula {
namespace {

TEST(EstimateCorpus, agrees_with_voxels_on_scanned_modelled_and_machined_bodies) {
  const auto corpus = scenes::corpus_folder();
  if (!corpus) GTEST_SKIP() << "the corpus is not there: run scripts/corpus, or set MORULA_CORPUS";
  for (const char* name : {"hand", "elephant", "fandisk", "bear", "knot1", "cow", "joint", "helmet"}) {
    const auto file = *corpus / (std::string(name) + ".off");
    if (std::filesystem::exists(file)) test::expect_estimates_near_voxels(name, read_mesh(file));
  }
}

}  // namespace
}  // namespace morula
