// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Divisions without a gain: a child of the node is a leaf as large as the node itself.
#pragma once

#include <cstddef>
#include <morula/tree/cover.hpp>

namespace morula::detail {

/// Makes a leaf of each node that has a leaf of at least 0.999 of its radius, about its center to 0.001 of it, among
/// its children, from the deepest level up. Such a child is in every level below, so none of them is tighter there than
/// the node by itself. The root is among the nodes if `root_too`.
///
/// The leaf owns the patches of its descendants. Its sphere contains them, as that of every inner node does. Patches
/// and their order stay. The report gets the new number of early leaves. Returns how many nodes became leaves. Cost:
/// linear in nodes.
std::size_t remove_equal_children(CoveredTree& model, bool root_too);

}  // namespace morula::detail
