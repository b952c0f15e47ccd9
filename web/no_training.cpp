// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// In place of src/update/rules/skin_training.cpp: bodies of the C interface have no training poses, so they measure no
// nodes.
#include <stdexcept>

#include "update/rules/skin_training.hpp"

namespace morula::detail {

std::optional<MeasuredNodes> trained_nodes(const Binding& binding, const SpheresByBones& /*by_bones*/) {
  if (binding.options.details.skinned_measured > 0) throw std::logic_error("this module has no training of skins");
  return std::nullopt;
}

}  // namespace morula::detail
