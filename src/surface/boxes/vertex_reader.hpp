// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertex reader: positions of one kind, read without a test of the kind for each vertex.
#pragma once

#include <cstring>
#include <morula/geometry/positions.hpp>
#include <optional>
#include <vector>

namespace morula::detail {

template <class Scalar>
struct VertexReader {
  const PositionView& view;
  Vec3 operator()(std::uint32_t v) const {
    Scalar xyz[3];
    std::memcpy(xyz, view.address(v), sizeof xyz);
    return {xyz[0], xyz[1], xyz[2]};
  }
};

/// Calls f(reader) with the reader of a view, or of the rest positions if there is no view.
template <class F>
void with_reader(const std::optional<PositionView>& view, const std::vector<Vec3>& rest, const F& f) {
  if (!view) {
    f([&](std::uint32_t v) { return rest[v]; });
  } else if (view->is_double()) {
    f(VertexReader<double>{*view});
  } else {
    f(VertexReader<float>{*view});
  }
}

}  // namespace morula::detail
