// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertices in the order of the tree.
#pragma once

#include <morula/tree/cover.hpp>

namespace morula::bench {

/// The mesh with its vertices numbered in the order in which leaves own them, so that neighbours lie together in
/// memory, which helps everybody; `built`, which was made for `mesh`, is changed to refer to it.
Mesh in_leaf_order(const Mesh& mesh, Built& built);

}  // namespace morula::bench
