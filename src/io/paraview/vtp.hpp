// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The bytes of a .vtp.
#pragma once

#include <morula/io/paraview_file.hpp>

namespace morula::detail {

std::string vtp_text(const VtpData& data);
/// The text for a mesh alone, which read_mesh reads back as the same bits.
std::string vtp_mesh_text(const MeshView& mesh);

}  // namespace morula::detail
