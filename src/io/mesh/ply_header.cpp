// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/ply_header.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

PlyType read_type(TextScanner& in) {
  // Both spellings are in use.
  constexpr std::array<std::pair<std::string_view, PlyType>, 16> names{{{"char", PlyType::int8},
                                                                        {"uchar", PlyType::uint8},
                                                                        {"short", PlyType::int16},
                                                                        {"ushort", PlyType::uint16},
                                                                        {"int", PlyType::int32},
                                                                        {"uint", PlyType::uint32},
                                                                        {"float", PlyType::float32},
                                                                        {"double", PlyType::float64},
                                                                        {"int8", PlyType::int8},
                                                                        {"uint8", PlyType::uint8},
                                                                        {"int16", PlyType::int16},
                                                                        {"uint16", PlyType::uint16},
                                                                        {"int32", PlyType::int32},
                                                                        {"uint32", PlyType::uint32},
                                                                        {"float32", PlyType::float32},
                                                                        {"float64", PlyType::float64}}};
  const std::string_view word = in.word();
  for (const auto& [name, type] : names)
    if (word == name) return type;
  in.fail(in_quotes(word) + " is not a PLY type such as float or uchar");
}

std::string read_name(TextScanner& in, const std::string& what) {
  const std::string_view word = in.word();
  if (word.empty()) in.fail("the line ends where the name of " + what + " should be");
  return std::string(word);
}

void read_format(TextScanner& in, PlyHeader& header) {
  const std::string_view format = in.word();
  header.is_text = format == "ascii";
  header.order = format == "binary_big_endian" ? std::endian::big : std::endian::little;
  if (!header.is_text && format != "binary_big_endian" && format != "binary_little_endian")
    in.fail(in_quotes(format) + " is not a PLY format; ascii, binary_little_endian and binary_big_endian are");
  const std::string_view version = in.word();
  if (version != "1.0") in.fail("PLY version " + in_quotes(version) + " is not read; 1.0 is");
}

PlyProperty read_property(TextScanner& in) {
  PlyProperty property;
  const std::string_view word = in.word();
  property.is_list = word == "list";
  if (property.is_list) {
    property.count_type = read_type(in);
    if (!is_integer(property.count_type)) in.fail("a list's length must have an integer type");
  } else {
    in.back_up(word.size());
  }
  property.type = read_type(in);
  property.name = read_name(in, "a property");
  return property;
}

void require_vertex_list(const TextScanner& in, const PlyElement* element) {
  if (!element) return;
  if (std::count_if(element->properties.begin(), element->properties.end(), is_vertex_list) != 1)
    in.fail("element " + in_quotes(element->name) + " must have one list property 'vertex_indices' or 'vertex_index'");
  for (const PlyProperty& property : element->properties)
    if (is_vertex_list(property) && !is_integer(property.type)) in.fail("vertex indices must have an integer type");
}

void require_mesh(const TextScanner& in, PlyHeader& header) {
  const PlyElement *vertices = nullptr, *faces = nullptr, *strips = nullptr;
  for (const PlyElement& element : header.elements) {
    const PlyElement** place = element.name == "vertex"      ? &vertices
                               : element.name == "face"      ? &faces
                               : element.name == strips_name ? &strips
                                                             : nullptr;
    if (!place) continue;
    if (*place) in.fail("the header has two elements " + in_quotes(element.name));
    *place = &element;
  }
  if (!vertices) in.fail("the header has no element 'vertex'");
  for (const std::string_view axis : {"x", "y", "z"}) {
    const auto is_axis = [&](const PlyProperty& p) { return p.name == axis && !p.is_list; };
    if (std::count_if(vertices->properties.begin(), vertices->properties.end(), is_axis) != 1)
      in.fail("element 'vertex' must have one scalar property " + in_quotes(axis));
  }
  header.vertex_count = vertices->count;
  require_vertex_list(in, faces);
  require_vertex_list(in, strips);
}

}  // namespace

std::size_t byte_size(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 8;
}

TextScanner ply_scanner(const std::filesystem::path& path, std::string_view bytes) {
  const std::string_view header = bytes.substr(0, bytes.find("end_header"));
  return {path, bytes, {.line_end = line_end_of(header)}};
}

PlyHeader read_ply_header(TextScanner& in) {
  PlyHeader header;
  if (!in.next_line() || in.word() != "ply") in.fail("a PLY file begins with a line 'ply'");
  bool has_format = false;
  while (true) {
    if (!in.next_line()) in.fail("the file ends inside its header, which 'end_header' should close");
    const std::string_view keyword = in.word();
    if (keyword == "end_header") break;
    if (keyword == "comment" || keyword == "obj_info") continue;
    if (keyword == "format") {
      read_format(in, header);
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = read_name(in, "an element");
      element.count = in.count("the number of elements");
      header.elements.push_back(std::move(element));
    } else if (keyword == "property") {
      if (header.elements.empty()) in.fail("a property comes before the first element");
      header.elements.back().properties.push_back(read_property(in));
    } else {
      in.fail(in_quotes(keyword) + " is not a header line of PLY");
    }
    in.require_line_end("the header line");
  }
  if (!has_format) in.fail("the header has no line 'format'");
  require_mesh(in, header);
  return header;
}

}  // namespace morula::detail
