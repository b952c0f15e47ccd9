// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A case: a seed and a number choose mesh, tree, rules and motions, and everything that is promised of them is judged.
#pragma once

#include <cstdint>
#include <optional>

#include "record.hpp"
#include "trees.hpp"

namespace morula::properties {

/// specimens: kept from case to case, to save time; the same cases come of new ones.
void run_case(std::uint64_t seed, std::uint64_t number, Specimens& specimens, Record& record);

/// A build of a small body far from the origin, by this method or by any (nothing).
void run_far_build(std::uint64_t seed, std::uint64_t number, std::optional<Method> method, Record& record);

}  // namespace morula::properties
