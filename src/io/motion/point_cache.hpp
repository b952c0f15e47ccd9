// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Point caches of animation programs: PC2 and MDD, positions of all vertices frame after frame in single precision.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "io/byte_source.hpp"
#include "io/mesh/formats.hpp"

namespace morula::detail {

bool is_point_cache(std::string_view extension);
/// Throws FileError for a file that is no such cache, has another number of points than the mesh, or another size than
/// its header says.
std::shared_ptr<const FrameSource> open_point_cache(const ByteSource& source, const MeshView& mesh);

/// All bytes that precede the numbers of the first frame. extension: ".pc2" or ".mdd"; frames 1/30 s apart.
std::string point_cache_start(std::string_view extension, std::size_t vertex_count, std::size_t frame_count);
/// Appends a frame. Throws std::invalid_argument for values out of the range of single precision.
void append_point_cache_frame(std::string& bytes, std::string_view extension, std::span<const Vec3> positions);

}  // namespace morula::detail
