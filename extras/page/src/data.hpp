// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The arrays of a page, packed small: what viewer/src/decode.js unpacks. The coding is described in
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
  /// The nearest of the 65536 places along each axis; 0 for what is not finite (vertices that no facet uses).
  std::array<std::int32_t, 3> operator()(const Vec3& p) const;
};
/// Of the box of all frames, unused vertices left aside.
Quantization quantization(std::span<const Facet> facets, std::span<const std::vector<Vec3>> frames);

/// Bytes that grow at the end.
class PackedBytes {
 public:
  /// Seven bits a byte, low ones first; small numbers of either sign take one byte (zigzag).
  void add_varint(std::int64_t value);
  void add_float(float value);
  void add_uint16(std::uint16_t value);
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

void pack_facets(PackedBytes& out, std::span<const Facet> facets);
/// Every frame against the one before it, every vertex against what the vertex before it did.
void pack_positions(PackedBytes& out, const Quantization& grid, std::span<const std::vector<Vec3>> frames);
/// Centers about the origin of the grid and radii, as floats.
void pack_spheres(PackedBytes& out, const Vec3& origin, std::span<const Sphere> spheres);
/// Points about that origin, normals and depths, as floats.
void pack_contacts(PackedBytes& out, const Vec3& origin, std::span<const PageContact> contacts);

std::string base64(std::string_view bytes);
/// 32-bit FNV-1a.
std::uint32_t checksum(std::string_view bytes);

}  // namespace morula::page
