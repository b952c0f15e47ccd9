// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <morula/generators/build.hpp>

namespace morula::test {

/// The same tree, cover and notes on one thread without a pool and on pools of 1, 2, 3 and 8.
inline void expect_same_bits_for_any_number_of_workers(const Mesh& mesh, const BuildOptions& options) {
  const CoveredTree reference = build(mesh, options);
  for (const unsigned threads : {1u, 2u, 3u, 8u}) {
    Workers workers(threads);
    const CoveredTree again = build(mesh, options, workers);
    EXPECT_EQ(tree_hash(again.tree), tree_hash(reference.tree)) << name(options.method) << " with " << threads;
    EXPECT_EQ(again.cover.corners, reference.cover.corners);
    EXPECT_EQ(again.cover.cut_points, reference.cover.cut_points);
    EXPECT_EQ(again.cover.patch_facet, reference.cover.patch_facet);
    EXPECT_EQ(again.report.notes, reference.report.notes);
  }
}

}  // namespace morula::test
