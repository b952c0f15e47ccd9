// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file: its elements, and the properties of their rows.
#pragma once

#include <bit>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/text_scanner.hpp"

namespace morula::detail {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t byte_size(PlyType type);
inline bool is_integer(PlyType type) {
  return type != PlyType::float32 && type != PlyType::float64;
}

struct PlyProperty {
  std::string name;
  PlyType type;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;
};

/// Whether a property is the list of a face's corners, under either of its two usual names.
inline bool is_vertex_list(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Triangle strips one after another, an index below 0 between two.
inline constexpr std::string_view strips_name = "tristrips";

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  bool is_text = false;
  std::endian order = std::endian::little;
  std::vector<PlyElement> elements;
  std::uint64_t vertex_count = 0;
};

/// A scanner for the header, and for the rows if they are text. Lines end like the header's lines, whatever bytes
/// follow it.
TextScanner ply_scanner(const std::filesystem::path& path, std::string_view bytes);

/// Leaves the scanner on the line "end_header". After: one vertex element with scalars x, y and z, at most one face
/// element and one of strips, which have one integer list of vertices; all lists have integer lengths.
PlyHeader read_ply_header(TextScanner& in);

/// Whether vertices have one scalar property `radius`, and there are no faces.
bool holds_balls(const PlyHeader& header);

}  // namespace morula::detail
