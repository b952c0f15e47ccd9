// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/deform/deformation.hpp>

namespace morula {

std::vector<double> frame_parameters(std::size_t frame_count, bool and_back) {
  std::vector<double> parameters(frame_count, 0.0);
  if (frame_count == 0) return parameters;
  const std::size_t last = frame_count - 1;
  const std::size_t steps = and_back ? last / 2 : last;  // from rest to the full amount
  for (std::size_t i = 0; steps > 0 && i <= last; ++i) {
    const std::size_t step = and_back ? std::min(i, last - i) : i;
    parameters[i] = static_cast<double>(step) / static_cast<double>(steps);
  }
  return parameters;
}

}  // namespace morula
