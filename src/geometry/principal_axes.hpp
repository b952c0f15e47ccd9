// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Principal axes of a symmetric tensor.
#pragma once

#include <array>
#include <morula/geometry/vector.hpp>

namespace morula::detail {

struct PrincipalAxes {
  std::array<Vec3, 3> axes;  ///< orthonormal, right-handed; axis i is nearest to coordinate axis i
  Vec3 moments;              ///< moments along the axes
};
/// tensor: xx, xy, xz, yy, yz, zz. Entries off the diagonal up to the share `noise` of the largest entry count as 0.
PrincipalAxes principal_axes(const std::array<double, 6>& tensor, double noise);

}  // namespace morula::detail
