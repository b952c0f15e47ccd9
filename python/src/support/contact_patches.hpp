// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contact patches as copies that later runs do not change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/collide/contact_patches.hpp>
#include <span>
#include <vector>

namespace morula::python {

/// The regions of one body, patch after patch.
struct PatchRegions {
  std::vector<PatchFacet> facets;
  std::vector<VertexGradient> gradients;
  std::vector<std::size_t> facets_begin{0}, gradients_begin{0};

  void add(const PatchSide& side) {
    facets.insert(facets.end(), side.facets.begin(), side.facets.end());
    gradients.insert(gradients.end(), side.gradients.begin(), side.gradients.end());
    facets_begin.push_back(facets.size());
    gradients_begin.push_back(gradients.size());
  }
};

struct PatchPoints {
  struct Row {
    std::uint32_t patch;
    PatchPoint point;
  };
  std::vector<Row> rows;
};

/// A copy of patches, which stays when the query or scene runs again.
struct ContactPatches {
  std::vector<ContactPatch> patches;  // their spans are not used
  PatchRegions a, b;
  PatchPoints points;
  Contacts contacts;
  double volume = 0;
  bool finished = false, certified = false;

  ContactPatches(std::span<const ContactPatch> of, bool is_finished, bool is_certified);
  explicit ContactPatches(const ContactPatchQuery& query);
};

}  // namespace morula::python
