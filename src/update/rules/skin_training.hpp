// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Training of the rule `skinned`: which of its nodes are measured on their own corners, within a budget.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "update/rules/engine.hpp"
#include "update/rules/skin_measured.hpp"

namespace morula::detail {

/// Writes the spheres of all nodes of the rule from the bones of a frame alone.
using SpheresByBones = std::function<void(const RuleFrame& frame, std::span<Spheref> spheres)>;

/// The measured nodes of a body with these options, if there are any. Writes their number to the report. Throws
/// std::invalid_argument for training poses that are missing or that no update would accept.
///
/// A node gains, at a training pose, the volume of its sphere by bones over that of its measured one, less one. Nodes
/// are taken in the order of the sum of their gains over the cost that they add. The cost counts points tested, and,
/// as several of these, nodes measured and vertices that no node taken before needs. A node which does not fit into
/// the budget is left out, and smaller ones may follow.
std::optional<MeasuredNodes> trained_nodes(const Binding& binding, const SpheresByBones& by_bones);

}  // namespace morula::detail
