// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The properties on which inside and outside depend, without the rest of inspect().
#pragma once

#include <morula/geometry/inspect.hpp>

namespace morula::detail {

/// Counts of edges and of non-manifold vertices, whether the surface is closed, oriented and manifold, and its volume;
/// all other fields are those of a new report. Cost: linear; inspect() also sorts.
MeshReport inspect_sides(const MeshView& mesh, const Connectivity& connectivity);

/// −1 for a closed mesh inside out, else 1.
inline double orientation(const MeshReport& report) {
  return report.has_volume() && report.volume < 0 ? -1 : 1;
}

}  // namespace morula::detail
