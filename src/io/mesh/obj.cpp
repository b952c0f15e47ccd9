// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <charconv>
#include <span>

#include "io/mesh/formats.hpp"
#include "io/number_text.hpp"
#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

// The vertex number that a face corner such as "7", "7/1", "7//3" or "-2/1/3" begins with; the rest is ignored, but
// must be well formed.
std::int64_t vertex_number(const TextScanner& in, std::string_view corner) {
  std::string_view digits = corner.substr(0, corner.find('/'));
  const std::string_view rest = corner.substr(digits.size());
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  std::int64_t number = 0;
  const char* const end = digits.data() + digits.size();
  const std::from_chars_result parsed = std::from_chars(digits.data(), end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end ||
      rest.find_first_not_of("/+-0123456789") != std::string_view::npos)
    in.fail(in_quotes(corner) + " is not a face corner; v, v/t, v//n or v/t/n with whole numbers are");
  return number;
}

// Statements that do not affect the surface, and statements of curves and of parts of free-form surfaces.
constexpr std::array<std::string_view, 35> known_statements{
    "vt",     "vn",     "vp",     "p",      "l",     "g",   "s",         "o",        "mg",
    "mtllib", "usemtl", "maplib", "usemap", "bevel", "lod", "c_interp",  "d_interp", "shadow_obj",
    "ctech",  "stech",  "deg",    "bmat",   "step",  "res", "trace_obj", "cstype",   "parm",
    "trim",   "hole",   "scrv",   "sp",     "end",   "con", "curv",      "curv2"};
// Free-form surfaces; all except the first belong to older versions.
constexpr std::array<std::string_view, 5> surface_statements{"surf", "bzp", "bsp", "cdp", "cdc"};
// Statements that include other files at their place.
constexpr std::array<std::string_view, 2> call_statements{"call", "csh"};

bool is_one_of(std::string_view keyword, std::span<const std::string_view> statements) {
  return std::find(statements.begin(), statements.end(), keyword) != statements.end();
}

// Statements that might describe surface, and are not in the mesh.
struct LeftOutStatements {
  LeftOut unknown{}, surfaces{}, calls{};
  void add(std::string_view keyword, std::size_t line) {
    if (is_one_of(keyword, surface_statements))
      surfaces.add(line, keyword);
    else if (is_one_of(keyword, call_statements))
      calls.add(line, keyword);
    else if (!is_one_of(keyword, known_statements))
      unknown.add(line, keyword);
  }
  void say(std::vector<std::string>& notes) const {
    const auto note = [&](const LeftOut& left, const std::string& what, const std::string& remedy) {
      if (left.count == 0) return;
      notes.push_back(counted(left.count, "statement") + " " + what + (left.count == 1 ? " is" : " are") +
                      " left out; the first is " + in_quotes(left.first) + " on line " + std::to_string(left.line) +
                      remedy);
    };
    note(unknown, "that OBJ does not know", "; look there for damage");
    note(surfaces, "of free-form surfaces", "; save them as polygons");
    note(calls, "that read another file", "; join the files");
  }
};

}  // namespace

Mesh read_obj(const std::filesystem::path& path, std::string_view text, MeshReading& reading) {
  Mesh mesh;
  FaceReader face(mesh, reading);
  TextScanner in(path, text, {'#', true});
  // Faces may come before their vertices: the largest number is checked when all vertices are known.
  std::int64_t largest_number = 0;
  std::size_t line_of_largest = 0;
  LeftOutStatements left_out;
  while (in.next_line()) {
    const std::string_view keyword = in.word();
    if (keyword == "v") {
      // Braces, because they are evaluated from left to right. Weights and colors after the third number are ignored.
      mesh.positions.push_back(Vec3{in.number("x"), in.number("y"), in.number("z")});
    } else if (keyword == "f" || keyword == "fo") {  // fo: keyword of versions older than 3.0
      const auto known = static_cast<std::int64_t>(mesh.vertex_count());
      face.begin();
      for (std::string_view corner = in.word(); !corner.empty(); corner = in.word()) {
        const std::int64_t number = vertex_number(in, corner);
        if (number == 0) in.fail("a face refers to vertex 0, but OBJ counts from 1; add 1 to all indices");
        if (number < -known)
          in.fail("a face refers to vertex " + std::to_string(number) + ", but only " + std::to_string(known) +
                  " vertices come before it");
        if (number > largest_number) {
          largest_number = number;
          line_of_largest = in.line();
        }
        face.add(static_cast<std::uint32_t>(number > 0 ? number - 1 : known + number));
      }
      if (face.corners() < 3)
        in.fail("a face has " + std::to_string(face.corners()) + " corners, fewer than 3; remove it or complete it");
      face.end(in.line());
    } else {
      left_out.add(keyword, in.line());
    }
  }
  if (largest_number > static_cast<std::int64_t>(mesh.vertex_count()))
    in.fail_at(line_of_largest, "a face refers to vertex " + std::to_string(largest_number) + ", but the file has " +
                                    std::to_string(mesh.vertex_count()) + " vertices");
  face.finish();
  left_out.say(reading.info.notes);
  return mesh;
}

std::string obj_text(const MeshView& mesh) {
  std::string text;
  text.reserve(mesh.vertex_count() * 64 + mesh.facet_count() * 24);
  // mutant looks-obj-written: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt(4096);
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i) {
    poll_interrupt();
    const Vec3 p = mesh.positions[i];
    text += 'v';
    for (int axis = 0; axis < 3; ++axis) {
      text += ' ';
      append_number(text, p[axis]);
    }
    text += '\n';
  }
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
    text += 'f';
    for (const std::uint32_t v : f) {
      text += ' ';
      append_number(text, std::uint64_t{v} + 1);
    }
    text += '\n';
  }
  return text;
}

}  // namespace morula::detail
