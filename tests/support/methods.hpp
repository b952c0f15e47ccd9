// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Generators as parameters of tests: those that every test can afford, and those whose tests are labeled `long`.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <morula/generators/build.hpp>
#include <string>

namespace morula::test {

/// Method optimized is quick at the quality `fast`.
inline constexpr std::array quick_methods{Method::octree, Method::grid, Method::spawn, Method::optimized};
/// They make medial balls of every node.
inline constexpr std::array slow_methods{Method::hubbard, Method::medial, Method::combined};

/// A fixture of tests that every method passes; both instances are needed:
/// INSTANTIATE_TEST_SUITE_P(Quick, Suite, testing::ValuesIn(quick_methods), method_name);
/// INSTANTIATE_TEST_SUITE_P(Long, Suite, testing::ValuesIn(slow_methods), method_name);
using ByMethod = testing::TestWithParam<Method>;

inline std::string method_name(const testing::TestParamInfo<Method>& tested) {
  return std::string(name(tested.param));
}

}  // namespace morula::test
