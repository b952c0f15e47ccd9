// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>

#include "geometry/index_table.hpp"
#include "io/byte_reader.hpp"
#include "io/mesh/formats.hpp"
#include "io/text_scanner.hpp"
#include "io/whole_file.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t binary_header = 84;  // 80 arbitrary bytes, then the number of facets
constexpr std::size_t binary_facet = 50;   // normal, three corners, two arbitrary bytes

// Bitwise equal corners become one vertex; −0 equals 0.
class Welder {
 public:
  explicit Welder(Mesh& mesh) : mesh_(mesh) {}
  /// p: finite.
  std::uint32_t vertex(const Vec3& p) {
    const std::uint32_t known = vertices_.find(hash_of(p), [&](std::uint32_t v) { return mesh_.positions[v] == p; });
    if (known != IndexTable::none) return known;
    const auto added = static_cast<std::uint32_t>(mesh_.vertex_count());
    mesh_.positions.push_back(p);
    vertices_.add(added, [&](std::uint32_t v) { return hash_of(mesh_.positions[v]); });
    return added;
  }

 private:
  static std::uint64_t hash_of(const Vec3& p) { return hash_of_numbers(p.x, p.y, p.z); }

  Mesh& mesh_;
  IndexTable vertices_;
};

// Whether bytes are less than a facet, or only padding: then no facet is lost when they are ignored.
bool is_padding(std::string_view bytes) {
  // mutant stl-padding-of-facets: `bytes.size() < binary_facet` -> `true`
  return bytes.size() < binary_facet || bytes.find_first_not_of(std::string_view("\0 \t\r\n", 5)) == bytes.npos;
}

Mesh read_binary(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  ByteReader in(path, bytes, std::endian::little);
  in.skip(80, "the header of a binary STL");
  const auto count = in.read<std::uint32_t>("the header of a binary STL");
  const std::uint64_t expected = binary_header + binary_facet * std::uint64_t{count};
  const bool has_more = bytes.size() > expected;
  if (has_more && is_padding(bytes.substr(static_cast<std::size_t>(expected))))
    reading.info.notes.push_back(counted(bytes.size() - expected, "byte") + " after the last facet " +
                                 (bytes.size() - expected == 1 ? "is" : "are") + " left out");
  else if (bytes.size() != expected)
    in.fail("the header counts " + std::to_string(count) + " facets, which take " + std::to_string(expected) +
            " bytes, but the file has " + std::to_string(bytes.size()) + "; it was cut short, or the count is wrong");
  Mesh mesh;
  mesh.facets.reserve(count);
  Welder welder(mesh);
  // mutant looks-stl-read: `12` -> `30`
  InterruptPoller poll_interrupt(1u << 12);
  for (std::uint32_t f = 0; f < count; ++f) {
    poll_interrupt();
    in.skip(12, "a normal");
    Facet facet;
    for (std::uint32_t& v : facet) {
      float p[3];
      for (float& coordinate : p) coordinate = in.read<float>("a corner");
      const Vec3 corner(p[0], p[1], p[2]);
      if (!is_finite(corner))
        in.fail("a corner of facet " + std::to_string(f) +
                " is not finite; remove or repair it where the file was made");
      v = welder.vertex(corner);
    }
    in.skip(2, "a facet");
    mesh.facets.push_back(facet);
  }
  return mesh;
}

bool equal_without_case(std::string_view word, std::string_view lower) {
  if (word.size() != lower.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if ((word[i] >= 'A' && word[i] <= 'Z' ? word[i] - 'A' + 'a' : word[i]) != lower[i]) return false;
  return true;
}

Mesh read_text(const std::filesystem::path& path, std::string_view text, MeshReading& reading) {
  enum class Inside { file, solid, facet, loop };
  // Each keyword is right in one place and leads to the next; the rest of its line (names, normals, which are often
  // wrong or NaN) is ignored.
  struct Step {
    std::string_view keyword;
    Inside where, next;
  };
  constexpr std::array<Step, 7> steps{{{"solid", Inside::file, Inside::solid},
                                       {"facet", Inside::solid, Inside::facet},
                                       {"outer", Inside::facet, Inside::loop},
                                       {"vertex", Inside::loop, Inside::loop},
                                       {"endloop", Inside::loop, Inside::facet},
                                       {"endfacet", Inside::facet, Inside::solid},
                                       {"endsolid", Inside::solid, Inside::file}}};
  Mesh mesh;
  Welder welder(mesh);
  TextScanner in(path, text);
  Inside inside = Inside::file;
  std::size_t corners = 0;  // corners of the present facet
  Facet facet{};
  while (in.next_line()) {
    std::string keyword(in.word());
    if (equal_without_case(keyword, "end")) keyword += in.word();  // "end solid" also occurs
    const Step* step = nullptr;
    for (const Step& s : steps)
      if (equal_without_case(keyword, s.keyword)) step = &s;
    if (!step) in.fail(in_quotes(keyword) + " is not a keyword of STL");
    if (step->where != inside) in.fail(in_quotes(keyword) + " is out of place; the file was cut or joined wrongly");
    inside = step->next;
    if (step->keyword == "facet") corners = 0;
    if (step->keyword == "vertex") {
      const Vec3 corner{in.number("x"), in.number("y"), in.number("z")};
      in.require_line_end("a corner");
      if (corners < 3) facet[corners] = welder.vertex(corner);
      ++corners;
    }
    if (step->keyword == "endfacet") {
      if (corners != 3) in.fail("a facet has " + std::to_string(corners) + " corners, not 3; split or remove it");
      mesh.facets.push_back(facet);
    }
  }
  // An incomplete facet is an error. Between facets, a truncated file cannot be distinguished from one whose writer
  // omitted the end, and such writers exist.
  if (inside == Inside::solid && !mesh.facets.empty())
    reading.info.notes.push_back("there is no 'endsolid': unless its writer left it out, the file was cut short");
  else if (inside != Inside::file)
    in.fail("the file ends inside a solid; it was cut short");
  return mesh;
}

}  // namespace

bool is_exactly_binary_stl(std::string_view bytes) {
  return bytes.size() >= binary_header &&
         bytes.size() == binary_header + binary_facet * std::uint64_t{load<std::uint32_t>(bytes.data() + 80)};
}

Mesh read_stl(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  // Binary files may begin with "solid" too: only their size distinguishes them, and zero bytes reveal a wrong size.
  bool is_binary = is_exactly_binary_stl(bytes);
  if (!is_binary) {
    // A byte order mark counts as a blank here.
    const std::size_t word = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
    is_binary = word == std::string_view::npos || !equal_without_case(bytes.substr(word, 5), "solid") ||
                bytes.find('\0') != std::string_view::npos;
  }
  return is_binary ? read_binary(path, bytes, reading) : read_text(path, bytes, reading);
}

std::string stl_bytes(const MeshView& mesh) {
  // The header must not begin with "solid", as text does.
  std::string bytes = "binary STL of triangles";
  bytes.resize(80, ' ');
  store(bytes, static_cast<std::uint32_t>(mesh.facet_count()));
  // mutant looks-stl-written: `4096` -> `1u << 30`
  InterruptPoller poll_interrupt(4096);
  for (const Facet& facet : mesh.facets) {
    poll_interrupt();
    const Vec3 a = mesh.positions[facet[0]], b = mesh.positions[facet[1]], c = mesh.positions[facet[2]];
    const Vec3 up = cross(b - a, c - a);
    const double size = length(up);
    const bool has_normal = size > 0 && std::isfinite(size);
    const Vec3 normal = has_normal ? up / size : Vec3{};
    for (const Vec3& v : {normal, a, b, c}) {
      for (int axis = 0; axis < 3; ++axis) store(bytes, static_cast<float>(v[axis]));
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

}  // namespace morula::detail
