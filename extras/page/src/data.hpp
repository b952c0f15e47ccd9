// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The arrays of a page, in a compact coding, which viewer/src/decode.js decodes. The coding is described in
// extras/page/docs/view.md.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/page/page.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula::page {

/// Steps of 1/65535 of a box along each axis: coordinate = origin + step × whole number.
struct Quantization {
  Vec3 origin{0, 0, 0};
  Vec3 step{1, 1, 1};
  /// The nearest of the 65536 places along each axis; 0 for coordinates that are not finite (vertices that no facet
  /// uses).
  std::array<std::int32_t, 3> operator()(const Vec3& p) const;
};
/// The quantization of the box of all frames, without unused vertices.
Quantization quantization(std::span<const Facet> facets, std::span<const std::vector<Vec3>> frames);

/// Bytes that grow at the end.
class PackedBytes {
 public:
  /// Adds a number, seven bits per byte, low ones first; small numbers of either sign take one byte (zigzag).
  void add_varint(std::int64_t value);
  void add_float(float value);
  void add_uint16(std::uint16_t value);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

void pack_facets(PackedBytes& out, std::span<const Facet> facets);
/// Codes every frame as differences from the preceding frame, and every vertex as the difference from the preceding
/// vertex's motion.
void pack_positions(PackedBytes& out, const Quantization& grid, std::span<const std::vector<Vec3>> frames);
/// Centers about the origin of the grid and radii, as floats.
void pack_spheres(PackedBytes& out, const Vec3& origin, std::span<const Sphere> spheres);
/// Points about that origin, normals and depths, as floats.
void pack_contacts(PackedBytes& out, const Vec3& origin, std::span<const PageContact> contacts);
/// For each facet of a patch its index, low half first, and its share of 65535, as 16-bit numbers; then both ends of
/// each curve about that origin, as floats.
void pack_patches(PackedBytes& out, const Vec3& origin, const PagePatches& patches);

std::string base64(std::string_view bytes);
/// 32-bit FNV-1a.
std::uint32_t checksum(std::string_view bytes);

}  // namespace morula::page
