// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies by the rule `exact` whose leaves are fitted in every frame (LeafFits); all else is as in Body.
#pragma once

#include <morula/update/body.hpp>

namespace morula::detail {

struct FittedBody {
  /// fits_leaves: false makes a plain Body.
  static Body make(const MeshView& mesh, std::shared_ptr<const CoveredTree> model, bool fits_leaves, Workers& workers);
};

}  // namespace morula::detail
