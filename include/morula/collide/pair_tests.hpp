// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pair test that all queries are made of, on plain lists of spheres: for measuring, and for walks of one's own.
#pragma once

#include <cstddef>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <string_view>

namespace morula {

/// The kinds of instructions that the test is compiled for and this processor has, narrowest first; queries use the
/// last. All give the same answers.
std::size_t pair_test_kinds();
std::string_view pair_test_kind_name(std::size_t kind);

/// How many pairs of a sphere of a and a sphere of b, moved by `transform`, overlap or cannot be told apart for
/// rounding: in blocks of eight by eight, as a tree of branching 8 asks. Coordinates: up to 2^57, radii up to 2^60.
std::size_t count_overlapping(std::span<const Spheref> a, std::span<const Spheref> b, const RigidTransform& transform,
                              std::size_t kind = pair_test_kinds() - 1);

}  // namespace morula
