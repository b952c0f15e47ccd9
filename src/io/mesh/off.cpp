// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/formats.hpp"
#include "io/number_text.hpp"
#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

// Steps over "OFF" and what may surround it: ST, C and N announce columns after the coordinates, which are ignored; the
// counts may follow on the same line, even without a blank (the ModelNet files do that).
void read_keyword(TextScanner& in) {
  const std::string_view word = in.word();
  const std::size_t at = word.find("OFF");
  if (at == std::string_view::npos)
    in.fail(in_quotes(word) + " is not how an OFF file begins; the first word must be OFF");
  std::string_view before = word.substr(0, at);
  const std::string_view after = word.substr(at + 3);
  for (const std::string_view letters : {"ST", "C", "N"})
    if (before.substr(0, letters.size()) == letters) before.remove_prefix(letters.size());
  if (!before.empty() || after.find_first_not_of("0123456789") != std::string_view::npos)
    in.fail(in_quotes(word) + " is a kind of OFF that is not read; write it as plain three-dimensional OFF");
  in.back_up(after.size());
  const std::string_view next = in.word();
  if (next == "BINARY") in.fail("binary OFF is not read; write it as text");
  in.back_up(next.size());
}

}  // namespace

Mesh read_off(const std::filesystem::path& path, std::string_view text) {
  TextScanner in(path, text, {'#', false});
  if (!in.next_line()) in.fail("the file is empty; an OFF file begins with OFF");
  read_keyword(in);
  if (in.at_line_end() && !in.next_line()) in.fail("the file ends before its counts; it was cut short");
  const std::uint64_t vertex_count = in.count("the number of vertices");
  const std::uint64_t face_count = in.count("the number of faces");

  // The shortest lines are "0 0 0" and "3 0 1 2": no count makes this allocate more than the file is worth.
  Mesh mesh;
  mesh.positions.reserve(std::min<std::uint64_t>(vertex_count, in.bytes_left() / 6 + 1));
  for (std::uint64_t i = 0; i < vertex_count; ++i) {
    in.require_line(i, vertex_count, "vertices");
    mesh.positions.push_back(Vec3{in.number("x"), in.number("y"), in.number("z")});
  }
  mesh.facets.reserve(std::min<std::uint64_t>(face_count, in.bytes_left() / 8 + 1));
  for (std::uint64_t i = 0; i < face_count; ++i) {
    in.require_line(i, face_count, "faces");
    const std::uint64_t corners = in.count("the number of corners");
    if (corners < 3)
      in.fail("a face has " + std::to_string(corners) + " corners, fewer than 3; remove it or complete it");
    FanBuilder fan(mesh.facets);
    for (std::uint64_t k = 0; k < corners; ++k) {
      const std::int64_t vertex = in.integer("a vertex index");
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count)
        in.fail("a face refers to vertex " + std::to_string(vertex) + ", but the file has " +
                std::to_string(vertex_count) + " vertices, counted from 0");
      fan.add(static_cast<std::uint32_t>(vertex));
    }
  }
  if (in.next_line())
    in.fail(in_quotes(in.word()) + " follows the last of " + std::to_string(face_count) +
            " faces; correct the counts at the top, or remove the rest");
  return mesh;
}

std::string off_text(const MeshView& mesh) {
  std::string text = "OFF\n";
  text.reserve(mesh.vertex_count() * 64 + mesh.facet_count() * 24);
  append_number(text, mesh.vertex_count());
  text += ' ';
  append_number(text, mesh.facet_count());
  text += " 0\n";
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i)
    for (int axis = 0; axis < 3; ++axis) {
      append_number(text, mesh.positions[i][axis]);
      text += axis < 2 ? ' ' : '\n';
    }
  for (const Facet& f : mesh.facets) {
    text += '3';
    for (const std::uint32_t v : f) {
      text += ' ';
      append_number(text, v);
    }
    text += '\n';
  }
  return text;
}

}  // namespace morula::detail
