// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files that are not what their names say, files that are written in unusual ways, and parts of files that are left
// out.
#include <gtest/gtest.h>

#include <morula/geometry/inspect.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>

#include "files.hpp"
#include "solid_files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;
using namespace std::string_literals;

const std::string sound_obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const std::string sound_rows = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
const std::string sound_off = "OFF\n4 4 0\n" + sound_rows;
const std::string sound_ply =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\n"
    "property list uchar int vertex_indices\nend_header\n" +
    sound_rows;

std::string facet_text(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal 0 0 0\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}
const std::string sound_facets = facet_text("0 0 0", "0 1 0", "1 0 0") + facet_text("0 0 0", "1 0 0", "0 0 1") +
                                 facet_text("0 0 0", "0 0 1", "0 1 0") + facet_text("1 0 0", "0 1 0", "0 0 1");
const std::string sound_stl = "solid x\n" + sound_facets + "endsolid x\n";

std::string binary_solid(const std::string& head) {
  std::string bytes = head;
  bytes.resize(80, ' ');
  bytes += raw(std::uint32_t{4});
  const std::vector<std::array<float, 3>> p{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const std::array<std::size_t, 3>& f :
       std::vector<std::array<std::size_t, 3>>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    bytes += std::string(12, '\0');
    for (const std::size_t v : f)
      for (const float x : p[v]) bytes += raw(x);
    bytes += "ab";
  }
  return bytes;
}

// The tetrahedron at the corner of the unit cube.
MeshInfo expect_tetrahedron(const fs::path& path) {
  MeshInfo info;
  const Mesh mesh = read_mesh(path, info);
  const MeshReport report = inspect(mesh);
  EXPECT_EQ(report.vertex_count, 4u) << path;
  EXPECT_EQ(report.facet_count, 4u) << path;
  EXPECT_TRUE(report.has_volume()) << path;
  EXPECT_DOUBLE_EQ(report.volume, 1.0 / 6) << path;
  return info;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size()) text.replace(at, what.size(), by);
  return text;
}

std::string wide(const std::string& text, bool little) {
  std::string result;
  for (const char c : text) result += little ? std::string{c, '\0'} : std::string{'\0', c};
  return result;
}

TEST(ForeignFiles, are_named_by_their_first_bytes) {
  const std::string lfs =
      "version https://git-lfs.github.com/spec/v1\noid "
      "sha256:0000000000000000000000000000000000000000000000000000000000000000\n"
      "size 12345\n";
  std::vector<HostileFile> files;
  for (const std::string extension :
       {".obj", ".off", ".ply", ".stl", ".gltf", ".glb", ".vtk", ".vtp", ".vtu", ".msh"}) {
    const auto add = [&](const std::string& bytes, const std::string& fragment) {
      files.push_back({"a" + extension, bytes, 0, fragment});
    };
    add(lfs, "git lfs pull");
    add("\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03"s + std::string(200, 'x'), "gzip");
    add("PK\x03\x04\x14\x00\x00\x00"s + std::string(200, 'x'), "ZIP archive");
    add("\xff\xfe" + wide(sound_obj, true), "UTF-16");
    add("\xfe\xff" + wide(sound_obj, false), "UTF-16");
    add(wide(sound_obj, true), "UTF-16");
    add(wide(sound_stl, false), "UTF-16");
    add("<!DOCTYPE html>\n<html><body>Sign in</body></html>\n", "web page");
    add("\xef\xbb\xbf\n<!-- x --><HTML lang=\"en\"><body/></HTML>", "web page");
    add("404: Not Found", "download it again");
    add("\x89PNG\r\n\x1a\n"s + std::string(100, '\0'), "PNG");
    add(std::string(500, '\0'), "zero bytes");
    if (extension != ".obj" && extension != ".off") add("Kaydara FBX Binary  \0\x1a\0"s + std::string(100, 'x'), "FBX");
    if (extension != ".ply") add(sound_ply, "name it .ply");
    if (extension != ".off") add(sound_off, "name it .off");
    if (extension != ".stl") add(sound_stl, "name it .stl");
    if (extension != ".gltf" && extension != ".glb") add("glTF\x02\0\0\0"s, "name it .glb");
    if (extension != ".vtp" && extension != ".vtu") add("<?xml version=\"1.0\"?>\n<COLLADA></COLLADA>", "COLLADA");
  }
  expect_all_refused(files, [](const fs::path& path) { read_mesh(path); });
  // Of files that are no meshes, pointers are named.
  expect_all_refused({{"a.morula", lfs, 0, "git lfs pull"}, {"a.sph", lfs, 0, "git lfs pull"}},
                     [](const fs::path& path) { read_tree(path); });
}

TEST(ForeignFiles, a_binary_stl_may_begin_with_anything) {
  const ScratchFolder folder;
  for (const std::string& head : {"PK\x03\x04"s, "\x1f\x8b"s, "<html"s, "version https://git"s, "\xff\xfe"s, "ply\n"s})
    EXPECT_TRUE(expect_tetrahedron(folder.file("a.stl", binary_solid(head))).notes.empty());
}

TEST(ForeignFiles, lines_may_end_in_carriage_returns_alone) {
  const ScratchFolder folder;
  const std::string vtk =
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nPOLYGONS 4 16\n"
      "3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3\n";
  for (const auto& [name, text] :
       {std::pair("a.obj", "# a comment\n" + sound_obj), std::pair("a.off", sound_off), std::pair("a.ply", sound_ply),
        std::pair("a.stl", sound_stl), std::pair("a.vtk", vtk)}) {
    for (const std::string end : {"\r", "\r\n"})
      EXPECT_TRUE(expect_tetrahedron(folder.file(name, replaced(text, "\n", end))).notes.empty()) << name;
  }
  // A continued line, and the number of the line that is wrong.
  expect_tetrahedron(folder.file("a.obj", replaced(replaced(sound_obj, "f 1 3", "f 1 \\\n3"), "\n", "\r")));
  const fs::path wrong = folder.file("b.obj", "v 0 0 0\rv 1 0 0\rv 0 x 0\r");
  expect_file_error(wrong, 3, "'x' is not a number", [&] { read_mesh(wrong); });
  // A header in this way, its data binary and full of line feeds.
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty uchar x\nproperty uchar y\n"
      "property uchar z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
  binary = replaced(binary, "\n", "\r") + "\n\r\n\r\n\r\r\r\r\x03"s + std::string("\0\1\2", 3);
  const Mesh mesh = read_mesh(folder.file("b.ply", binary));
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{10, 13, 10}, {13, 10, 13}, {13, 13, 13}}));
}

TEST(ForeignFiles, stl_in_unusual_ways_is_read) {
  const ScratchFolder folder;
  const auto notes = [&](const std::string& bytes) { return expect_tetrahedron(folder.file("a.stl", bytes)).notes; };
  EXPECT_TRUE(notes("\xef\xbb\xbf" + sound_stl).empty());
  EXPECT_TRUE(notes(replaced(sound_stl, "endsolid", "end solid")).empty());
  EXPECT_TRUE(notes(replaced(replaced(sound_stl, "endfacet", "end facet"), "endloop", "END LOOP")).empty());
  EXPECT_TRUE(notes(replaced(sound_stl, "normal 0 0 0", "normal 1.#IND 1.#IND 1.#QNAN")).empty());
  const auto cut = notes("solid x\n" + sound_facets);
  ASSERT_EQ(cut.size(), 1u);
  EXPECT_NE(cut[0].find("no 'endsolid'"), std::string::npos) << cut[0];
  for (const std::string& more : {"\0"s, std::string(49, 'x'), std::string(4096, '\0'), std::string(100, '\n')}) {
    const auto trailing = notes(binary_solid("x") + more);
    ASSERT_EQ(trailing.size(), 1u);
    EXPECT_EQ(trailing[0].find(std::to_string(more.size()) + " byte"), 0u) << trailing[0];
  }
  const fs::path whole_facet = folder.file("b.stl", binary_solid("x") + std::string(50, 'x'));
  expect_file_error(whole_facet, 0, "counts 4 facets", [&] { read_mesh(whole_facet); });
}

TEST(ForeignFiles, numbers_that_old_compilers_write_are_not_finite) {
  expect_all_refused({{"a.obj", "v 0 0 0\nv 0 0 1.#IND00\n", 2, "z is not finite"},
                      {"b.obj", "v -1.#INF 0 0\n", 1, "x is not finite"},
                      {"a.off", "OFF\n1 0 0\n0 1.#QNAN0 0\n", 3, "y is not finite"},
                      {"a.stl", "solid x\nfacet\nouter loop\nvertex 0 -1.#IND 0\n", 4, "y is not finite"},
                      {"a.ply", replaced(sound_ply, "0 0 1\n", "0 0 1.#SNAN\n"), 13, "a coordinate is not finite"},
                      {"a.vtk", "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 1.#IND 0\n",
                       6, "y is not finite"}},
                     [](const fs::path& path) { read_mesh(path); });
}

TEST(ForeignFiles, obj_says_which_statements_it_leaves_out) {
  const ScratchFolder folder;
  const auto notes = [&](const std::string& more) {
    return expect_tetrahedron(folder.file("a.obj", sound_obj + more)).notes;
  };
  EXPECT_TRUE(notes("vn 0 0 1\nvt 0 0\nvp 0\no a\ng b\ns off\nusemtl c\nmtllib d.mtl\nl 1 2\np 1\ncurv 0 1 1 2\nend\n")
                  .empty());
  const auto unknown = notes("\0f 1 2 3\nF 1 2 3\n1 2 3\n"s);
  ASSERT_EQ(unknown.size(), 1u);
  EXPECT_NE(unknown[0].find("3 statements that OBJ does not know are left out; the first is '?f' on line 9"),
            std::string::npos)
      << unknown[0];
  const auto surfaces = notes("surf 0 1 0 1 1 2 3 4\ncall other.obj\n");
  ASSERT_EQ(surfaces.size(), 2u);
  EXPECT_NE(surfaces[0].find("1 statement of free-form surfaces is left out"), std::string::npos) << surfaces[0];
  EXPECT_NE(surfaces[1].find("'call' on line 10"), std::string::npos) << surfaces[1];
  // Faces of old versions; and a file with nothing that is known says why it has none.
  EXPECT_TRUE(expect_tetrahedron(folder.file("b.obj", replaced(sound_obj, "f ", "fo "))).notes.empty());
  const fs::path damaged = folder.file("c.obj", replaced(sound_obj, "f ", "\0f "s));
  expect_file_error(damaged, 0, "4 statements that OBJ does not know", [&] { read_mesh(damaged); });
}

TEST(ForeignFiles, off_may_lie_on_lines_as_it_likes) {
  const ScratchFolder folder;
  for (
      const std::string& text :
      {"OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0\n2 1\n3 0 1 3\n3\n0\n3 2\n3 1 2 3\n"s,
       "OFF # x\n4 4\n6 # y\n0 0 # z\n0\n1 0 0\n0 1 0\n\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 # c\n2 3\n"s,
       "OFF 4 4 6 0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3"s,
       "OFF\n4 4 6\n0 0 0 1 0 0\n0 1 0 0 0 1\n3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3\n"s,
       "COFF\n4 4 6\n0 0 0 255 0 0 255\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n0 0 1 1 0 0 1\n3 0 2 1 255 0 0\n3 0\n1 3\n3 0 3 2\n3 1 2 3 1\n"s})
    expect_tetrahedron(folder.file("a.off", text));
  // A number that is missing is not made up for by the next line.
  expect_all_refused({{"a.off", "OFF\n4 4 6\n0 0 0\n1 0\n0 1 0 7\n0 0 1 7\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
                       4, "the line ends where z should be"}},
                     [](const fs::path& path) { read_mesh(path); });
}

TEST(ForeignFiles, ply_strips_are_read) {
  const ScratchFolder folder;
  // A cube in three strips: its area and volume say that every other triangle is turned.
  const std::vector<int> strip{0, 1, 3, 2, 7, 6, 4, 5, -1, 0, 4, 1, 5, 2, 6, 3, 7, -1, 0, 3, 4, 7};
  const std::string head =
      "element vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n";
  const std::vector<Vec3> cube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  std::string text = "ply\nformat ascii 1.0\n" + head, binary = "ply\nformat binary_big_endian 1.0\n" + head;
  for (const Vec3& p : cube) {
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    for (int axis = 0; axis < 3; ++axis) binary += raw(static_cast<float>(p[axis]), true);
  }
  text += std::to_string(strip.size());
  binary += raw(static_cast<std::int32_t>(strip.size()), true);
  for (const int v : strip) {
    text += " " + std::to_string(v);
    binary += raw(static_cast<std::int32_t>(v), true);
  }
  for (const std::string& bytes : {text, binary}) {
    const Mesh mesh = read_mesh(folder.file("a.ply", bytes));
    // Worked by hand from the strip's rule.
    const std::vector<Facet> expected{{0, 1, 3}, {3, 1, 2}, {3, 2, 7}, {7, 2, 6}, {7, 6, 4}, {4, 6, 5}, {0, 4, 1},
                                      {1, 4, 5}, {1, 5, 2}, {2, 5, 6}, {2, 6, 3}, {3, 6, 7}, {0, 3, 4}, {4, 3, 7}};
    EXPECT_EQ(mesh.facets, expected);
  }
  const fs::path beyond = folder.file("b.ply", replaced(text, " 7 6 4", " 8 6 4"));
  expect_file_error(beyond, 18, "a strip refers to vertex 8, but the file has 8 vertices", [&] { read_mesh(beyond); });
}

TEST(ForeignFiles, shells_beside_solids_are_counted) {
  const ScratchFolder folder;
  const std::string head =
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 float\n"
      "0 0 0 1 0 0 0 1 0 0 0 1 5 0 0 6 0 0 5 1 0\n";
  const auto notes = [&](const std::string& cells) {
    MeshInfo info;
    const Mesh mesh = read_mesh(folder.file("a.vtk", head + cells), info);
    EXPECT_EQ(mesh.facet_count(), 4u);
    EXPECT_DOUBLE_EQ(inspect(mesh).volume, 1.0 / 6);
    return info.notes;
  };
  EXPECT_TRUE(notes("CELLS 2 9\n4 0 1 2 3\n3 1 0 2\nCELL_TYPES 2\n10\n5\n").empty());  // a face of the solid again
  const auto shell = notes("CELLS 3 13\n4 0 1 2 3\n3 4 5 6\n3 0 1 4\nCELL_TYPES 3\n10\n5\n5\n");
  ASSERT_EQ(shell.size(), 1u);
  EXPECT_EQ(shell[0].find("2 triangles of shells besides the solids lie on no face"), 0u) << shell[0];
  // A hexahedron whose quadrilaterals are listed again as triangles: none of them is a shell.
  const std::string hexahedron =
      "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n"
      "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 4 22\n8 0 1 2 3 4 5 6 7\n"
      "3 0 1 2\n3 1 2 3\n4 0 1 5 4\nCELL_TYPES 4\n12\n5\n5\n9\n";
  MeshInfo info;
  read_mesh(folder.file("b.vtk", hexahedron), info);
  EXPECT_TRUE(info.notes.empty());
}

}  // namespace
}  // namespace morula::test
