// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layer patches as copies that later runs do not change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/surface/layer_patches.hpp>
#include <vector>

namespace morula::python {

/// The sides of one surface, patch after patch.
struct LayerRegions {
  std::vector<std::uint32_t> facets;
  std::vector<VertexGradient> gradients;
  std::vector<std::size_t> facets_begin{0}, gradients_begin{0};

  void add(const LayerSide& side);
};

struct LayerPoints {
  struct Row {
    std::uint32_t patch;
    LayerPoint point;
  };
  std::vector<Row> rows;
};

struct LayerPatches {
  std::vector<LayerPatch> patches;  // their spans are not used
  LayerRegions a, b;
  LayerPoints points;
  double volume = 0;

  explicit LayerPatches(const LayerPatchQuery& query);
};

}  // namespace morula::python
