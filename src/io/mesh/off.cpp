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

// The layout of numbers on lines. The first layout that fits the whole file is used.
enum class Layout {
  rows,       // a vertex or a face per line; the rest of the line is color
  long_rows,  // the same, but a row may continue on the next lines
  many_rows   // the same, and a line may have several; there is no color
};

class OffReader {
 public:
  OffReader(const std::filesystem::path& path, std::string_view text, Layout layout)
      : in_(path, text, {'#', false}), layout_(layout) {}

  Mesh read(MeshReading& reading) {
    if (!in_.next_line()) in_.fail("the file is empty; an OFF file begins with OFF");
    read_keyword(in_);
    if (in_.at_line_end() && !in_.next_line()) in_.fail("the file ends before its counts; it was cut short");
    const std::uint64_t vertex_count = count("the number of vertices");
    const std::uint64_t face_count = count("the number of faces");
    if (layout_ == Layout::many_rows) count("the number of edges");
    // The shortest lines are "0 0 0" and "3 0 1 2": so no count causes an allocation out of proportion to the file.
    Mesh mesh;
    mesh.positions.reserve(std::min<std::uint64_t>(vertex_count, in_.bytes_left() / 6 + 1));
    for (std::uint64_t i = 0; i < vertex_count; ++i) {
      begin_row(i, vertex_count, "vertices");
      mesh.positions.push_back(Vec3{number("x"), number("y"), number("z")});
      end_row();
    }
    mesh.facets.reserve(std::min<std::uint64_t>(face_count, in_.bytes_left() / 8 + 1));
    FaceReader face(mesh, reading);
    for (std::uint64_t i = 0; i < face_count; ++i) {
      begin_row(i, face_count, "faces");
      read_face(face, vertex_count);
    }
    if (layout_ == Layout::many_rows ? !in_.at_line_end() || in_.next_line() : in_.next_line())
      in_.fail(in_quotes(in_.word()) + " follows the last of " + std::to_string(face_count) +
               " faces; correct the counts at the top, or remove the rest");
    face.finish();
    return mesh;
  }

 private:
  void begin_row(std::uint64_t row, std::uint64_t total, std::string_view kind) {
    poll_interrupt_();  // one line may hold all rows
    if (layout_ != Layout::many_rows || in_.at_line_end()) in_.require_line(row, total, kind);
    began_on_ = in_.line();
  }
  void end_row() {
    // Otherwise a missing number would be taken from the next row, and all following numbers would be shifted.
    // mutant off-row-takes-from-the-next: `if ... ) in_.require_line_end("a row that began on another line")` -> ``
    if (in_.line() != began_on_) in_.require_line_end("a row that began on another line");
  }
  /// Steps to the next line if a row may continue there.
  void go_on() {
    if (layout_ != Layout::rows && in_.at_line_end()) in_.next_line();
  }
  double number(std::string_view what) {
    go_on();
    return in_.number(what);
  }
  std::uint64_t count(std::string_view what) {
    go_on();
    return in_.count(what);
  }

  void read_face(FaceReader& face, std::uint64_t vertex_count) {
    const std::uint64_t corners = count("the number of corners");
    if (corners < 3)
      in_.fail("a face has " + std::to_string(corners) + " corners, fewer than 3; remove it or complete it");
    face.begin();
    for (std::uint64_t k = 0; k < corners; ++k) {
      go_on();
      const std::int64_t vertex = in_.integer("a vertex index");
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count)
        in_.fail("a face refers to vertex " + std::to_string(vertex) + ", but the file has " +
                 std::to_string(vertex_count) + " vertices, counted from 0");
      face.add(static_cast<std::uint32_t>(vertex));
    }
    end_row();
    face.end(began_on_);
  }

  TextScanner in_;
  Layout layout_;
  // mutant looks-off-read: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt_{4096};
  std::size_t began_on_ = 0;
};

bool read_off_as(const std::filesystem::path& path, std::string_view text, Layout layout, MeshReading& reading,
                 Mesh& mesh) {
  MeshReading own{.cut_like = reading.cut_like, .cut_like_vertex = reading.cut_like_vertex};
  try {
    mesh = OffReader(path, text, layout).read(own);
  } catch (const FileError&) {
    return false;
  }
  reading.info = std::move(own.info);
  return true;
}

}  // namespace

Mesh read_off(const std::filesystem::path& path, std::string_view text, MeshReading& reading) {
  try {
    MeshReading own{.cut_like = reading.cut_like, .cut_like_vertex = reading.cut_like_vertex};
    Mesh mesh = OffReader(path, text, Layout::rows).read(own);
    reading.info = std::move(own.info);
    return mesh;
  } catch (const FileError&) {
    Mesh mesh;
    for (const Layout layout : {Layout::long_rows, Layout::many_rows})
      if (read_off_as(path, text, layout, reading, mesh)) return mesh;
    // Most files have rows, so their error names the right line.
    throw;
  }
}

std::string off_text(const MeshView& mesh) {
  std::string text = "OFF\n";
  text.reserve(mesh.vertex_count() * 64 + mesh.facet_count() * 24);
  append_number(text, mesh.vertex_count());
  text += ' ';
  append_number(text, mesh.facet_count());
  text += " 0\n";
  // mutant looks-off-written: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt(4096);
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i) {
    poll_interrupt();
    for (int axis = 0; axis < 3; ++axis) {
      append_number(text, mesh.positions[i][axis]);
      text += axis < 2 ? ' ' : '\n';
    }
  }
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
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
