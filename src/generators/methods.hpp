// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The methods that build() chooses from.
#pragma once

#include <morula/parallel/workers.hpp>

#include "generators/driver/build_run.hpp"

namespace morula::detail {

/// The generators. A generator divides nodes, with whatever its divisions need to have of the mesh.
CoveredTree build_octree(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_grid(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_hubbard(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_spawn(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_medial(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_combined(const MeshView& mesh, const BuildRun& run, Workers& workers);
CoveredTree build_optimized(const MeshView& mesh, const BuildRun& run, Workers& workers);

}  // namespace morula::detail
