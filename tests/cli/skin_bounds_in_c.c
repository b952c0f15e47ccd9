// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <evaluators/skin_bounds.h>

skin_bounds skin_bounds_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                             const float* bones);
skin_bounds skin_bounds_in_c(const skin_bounds_cluster* cluster, const skin_bounds_row* rows, float reach,
                             const float* bones) {
  return skin_bounds_of(cluster, rows, reach, bones);
}
