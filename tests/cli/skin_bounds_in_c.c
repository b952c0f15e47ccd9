// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <evaluators/skin_bounds.h>

skin_bounds skin_bounds_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                             const float* bones);
skin_bounds skin_bounds_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                             const float* bones) {
  return skin_bounds_of(cluster, rows, reach, bones);
}

skin_bounds skin_bounds_morphed_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                                     const float* bones, const skin_bounds_target* targets, uint32_t target_count,
                                     const float* morphs);
skin_bounds skin_bounds_morphed_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                                     const float* bones, const skin_bounds_target* targets, uint32_t target_count,
                                     const float* morphs) {
  skin_bounds_morph morph = {{0}, 0, {0}, 0};
  for (uint32_t i = 0; i < target_count; ++i) skin_bounds_add_target(&morph, &targets[i], morphs[targets[i].target]);
  return skin_bounds_morphed(cluster, rows, reach, bones, &morph);
}
