// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The mesh formats, one reader and writer each, from and to bytes in memory. docs/formats.md says what is accepted.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <string>
#include <string_view>

namespace morula {

/// What read_mesh makes of a file with these bytes; the path says the format by its extension, which must be readable.
Mesh mesh_of_bytes(const std::filesystem::path& path, std::string_view bytes);

/// Readers check every number, index and size that they use; read_mesh checks the whole. path is for messages.
Mesh read_obj(const std::filesystem::path& path, std::string_view text);
Mesh read_off(const std::filesystem::path& path, std::string_view text);
Mesh read_ply(const std::filesystem::path& path, std::string_view bytes);
Mesh read_stl(const std::filesystem::path& path, std::string_view bytes);

/// Positions may be other than the mesh's own, so that frames need no copy of the mesh.
std::string obj_text(std::span<const Vec3> positions, std::span<const Facet> facets);
std::string off_text(std::span<const Vec3> positions, std::span<const Facet> facets);
std::string ply_bytes(std::span<const Vec3> positions, std::span<const Facet> facets);

/// True for ".obj", ".off" and ".ply".
bool is_writable_mesh_extension(std::string_view extension);
/// The bytes of a file with this extension, which must be writable.
std::string mesh_bytes(std::string_view extension, std::span<const Vec3> positions, std::span<const Facet> facets);
/// True for the extensions that read_mesh knows.
bool is_readable_mesh_extension(std::string_view extension);

/// A polygon's corners one after another become a fan of facets about the first.
class FanBuilder {
 public:
  explicit FanBuilder(std::vector<Facet>& facets) : facets_(facets) {}
  void add(std::uint32_t vertex) {
    if (corners_ == 0) first_ = vertex;
    if (corners_ >= 2) facets_.push_back({first_, previous_, vertex});
    previous_ = vertex;
    ++corners_;
  }
  std::size_t corners() const { return corners_; }

 private:
  std::vector<Facet>& facets_;
  std::uint32_t first_ = 0, previous_ = 0;
  std::size_t corners_ = 0;
};

}  // namespace morula
