// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tree of one sphere that owns a mesh's only facet.
#pragma once

#include <morula/tree/covered_tree.hpp>

namespace morula::test {

inline CoveredTree one_facet_model() {
  CoveredTree model;
  model.tree.append_level({}, std::vector<Sphere>{{{}, 1}});
  model.cover.vertex_count = 3;
  model.cover.facet_count = 1;
  model.cover.patch_facet = {0};
  model.cover.corner_begin = {0, 3};
  model.cover.corners = {0, 1, 2};
  model.cover.region_begin = {0};
  model.cover.region_end = {1};
  return model;
}

}  // namespace morula::test
