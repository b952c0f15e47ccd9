// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Specimen of seeds and fuzzers: a body that files are read for.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <support/scratch_folder.hpp>

namespace morula::fuzz {

/// A tetrahedron: the smaller the files that belong to a mesh, the more of them are tried.
const Mesh& specimen_mesh();

}  // namespace morula::fuzz
