// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/io/mesh_file.hpp>
#include <support/meshes.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

const std::vector<Vec3> tetrahedron{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
const std::vector<Facet> tetrahedron_facets{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

void expect_tetrahedron(const Mesh& mesh) {
  EXPECT_EQ(mesh.positions, tetrahedron);
  EXPECT_EQ(mesh.facets, tetrahedron_facets);
}

TEST(MeshFile, every_written_format_reads_back_bit_for_bit) {
  const ScratchFolder folder;
  const Mesh awkward = awkward_mesh();
  for (const std::string extension : {".obj", ".off", ".ply", ".OBJ"}) {
    SCOPED_TRACE(extension);
    const fs::path path = folder.path() / ("mesh" + extension);
    write_mesh(path, awkward);
    EXPECT_TRUE(same_bits(read_mesh(path), awkward));
    for (const NamedMesh& named : all_meshes()) {
      write_mesh(path, named.mesh);
      EXPECT_TRUE(same_bits(read_mesh(path), named.mesh)) << named.name;
    }
  }
}

TEST(MeshFile, same_mesh_gives_same_bytes) {
  const ScratchFolder folder;
  for (const std::string extension : {".obj", ".off", ".ply"}) {
    write_mesh(folder.path() / ("a" + extension), small_mesh());
    write_mesh(folder.path() / ("b" + extension), small_mesh());
    EXPECT_EQ(bytes_of(folder.path() / ("a" + extension)), bytes_of(folder.path() / ("b" + extension)));
  }
}

TEST(MeshFile, obj_takes_all_forms_of_faces_and_ignores_the_rest) {
  const ScratchFolder folder;
  expect_tetrahedron(read_mesh(folder.file("a.obj",
                                           "\xef\xbb\xbf# a comment\r\n"
                                           "mtllib some thing.mtl\r\n"
                                           "o name\r\n"
                                           "v 0 0 0\r\n"
                                           "v +1.0 0 -0.0e0 0.5 0.5 0.5\r\n"
                                           "v\t0 \\\r\n  1 0 1.0\r\n"
                                           "\r\n"
                                           "f 1/1/1 3/3/1 2/2/1\r\n"  // before its last vertex
                                           "f -3//1 2// 4//7\r\n"
                                           "v 0 0 1 # a tip\r\n"
                                           "vt nan 0\r\nvn 0 0 1\r\ns off\r\ng C:\\dir\\\r\nusemtl x\r\n"
                                           "f 1/1 \\\r\n 4/2 3/3\r\n"
                                           "l 1 2\r\n"
                                           "f -3 +3 -1")));
}

TEST(MeshFile, polygons_become_fans) {
  const ScratchFolder folder;
  const std::vector<Facet> fan{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  const std::string vertices = "0 0 0\n2 0 0\n3 1 0\n2 2 0\n0 2 0\n";
  EXPECT_EQ(read_mesh(folder.file("a.off", "OFF 5 1 0\n" + vertices + "5 0 1 2 3 4\n")).facets, fan);
  EXPECT_EQ(read_mesh(folder.file("a.obj", "v 0 0 0\nv 2 0 0\nv 3 1 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4 5\n")).facets, fan);
  EXPECT_EQ(read_mesh(folder.file("a.ply",
                                  "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                                  "property float z\nelement face 1\nproperty list uchar int vertex_index\n"
                                  "end_header\n" +
                                      vertices + "5 0 1 2 3 4\n"))
                .facets,
            fan);
}

TEST(MeshFile, off_takes_all_headers_and_ignores_colors) {
  const ScratchFolder folder;
  const std::string plain = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  for (const std::string header :
       {"OFF\n4 4 6\n", "OFF 4 4 6\n", "OFF\n4 4\n", "OFF4 4 6\n", "# x\n\nOFF # y\n\n# z\n4 4 0\n"}) {
    SCOPED_TRACE(header);
    expect_tetrahedron(read_mesh(folder.file("a.off", header + plain)));
  }
  for (const std::string keyword : {"COFF", "NOFF", "STOFF", "CNOFF", "STCNOFF"}) {
    SCOPED_TRACE(keyword);
    expect_tetrahedron(read_mesh(folder.file("a.off", keyword + "\r\n4 4 6\r\n"
                                                                "0 0 0 255 0 0 255\r\n"
                                                                "1 0 0 1 nan 0 0 # red\r\n\r\n"
                                                                "0 1 0 0 255 0 255\r\n"
                                                                "  0 0 1 0 0 255 255\r\n"
                                                                "3 0 2 1 255 0 0\r\n"
                                                                "3 0 1 3 0.5 0.5 0.5 1\r\n"
                                                                "# between\r\n"
                                                                "3 0 3 2\r\n"
                                                                "3 1 2 3")));
  }
}

// The tetrahedron with everything that PLY allows around it.
std::string rich_ply(const std::string& format) {
  const bool text = format == "ascii", big = format == "binary_big_endian";
  std::string ply = "ply\nformat " + format +
                    " 1.0\ncomment made by hand\nobj_info nothing\n"
                    "element header 2\nproperty uchar a\nproperty list ushort double b\n"
                    "element nothing 4000000000\n"
                    "element vertex 4\nproperty float quality\nproperty double z\nproperty list uint8 int16 extra\n"
                    "property float32 x\nproperty short y\nproperty uint32 flags\n"
                    "element face 4\nproperty uint8 red\nproperty list uint8 uint16 vertex_indices\n"
                    "property list int float texcoord\n"
                    "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n";
  const auto put = [&](auto value) {
    if (text)
      ply += std::to_string(value) + " ";
    else
      ply += raw(value, big);
  };
  const auto end_row = [&] {
    if (text) ply += "\n";
  };
  put(std::uint8_t{1}), put(std::uint16_t{0}), end_row();
  put(std::uint8_t{2}), put(std::uint16_t{2}), put(0.5), put(-1.5), end_row();
  for (const Vec3& p : tetrahedron) {
    put(std::numeric_limits<float>::quiet_NaN()), put(p.z), put(std::uint8_t{1}), put(std::int16_t{-7});
    put(static_cast<float>(p.x)), put(static_cast<std::int16_t>(p.y)), put(std::uint32_t{4294967295u}), end_row();
  }
  for (const Facet& f : tetrahedron_facets) {
    put(std::uint8_t{255}), put(std::uint8_t{3});
    for (const std::uint32_t v : f) put(static_cast<std::uint16_t>(v));
    put(std::int32_t{2}), put(0.25f), put(0.75f), end_row();
  }
  put(std::int32_t{0}), put(std::int32_t{1}), end_row();
  return ply;
}

TEST(MeshFile, ply_takes_all_encodings_and_skips_what_it_does_not_know) {
  const ScratchFolder folder;
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(format);
    expect_tetrahedron(read_mesh(folder.file("a.ply", rich_ply(format))));
  }
}

template <class Coordinate>
std::string vertices_ply(const std::string& type, bool big) {
  std::string ply = std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
                    "_endian 1.0\r\nelement vertex 3\r\nproperty " + type + " x\r\nproperty " + type +
                    " y\r\nproperty " + type +
                    " z\r\nelement face 1\r\nproperty list int int vertex_index\r\nend_header\r\n";
  for (const int value : {0, 0, 0, 1, 2, 3, 100, 5, 6}) ply += raw(static_cast<Coordinate>(value), big);
  for (const int value : {3, 0, 1, 2}) ply += raw(value, big);
  return ply;
}

TEST(MeshFile, ply_takes_all_scalar_types) {
  const ScratchFolder folder;
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 2, 3}, {100, 5, 6}};
  for (const bool big : {false, true}) {
    for (const std::string& ply : {vertices_ply<std::int8_t>("char", big), vertices_ply<std::uint8_t>("uint8", big),
                                   vertices_ply<std::int16_t>("int16", big), vertices_ply<std::uint16_t>("ushort", big),
                                   vertices_ply<std::int32_t>("int", big), vertices_ply<std::uint32_t>("uint32", big),
                                   vertices_ply<float>("float32", big), vertices_ply<double>("double", big)})
      EXPECT_EQ(read_mesh(folder.file("a.ply", ply)).positions, positions) << ply.substr(0, 100);
  }
}

std::string stl_facet(const std::string& a, const std::string& b, const std::string& c) {
  return "facet normal nan 0 0\n outer loop\n  vertex " + a + "\n  vertex " + b + "\n  vertex " + c +
         "\n endloop\nendfacet\n";
}

TEST(MeshFile, stl_corners_are_welded_exactly_in_order_of_first_use) {
  const ScratchFolder folder;
  const Mesh mesh =
      read_mesh(folder.file("a.stl", "solid one\n" + stl_facet("0 0 0", "1 0 0", "0 1 0") +
                                         "endsolid one\nSOLID two words\n" + stl_facet("-0.0 0 0", "0 1 0", "0 0 1") +
                                         stl_facet("0 1 0", "1e-300 0 0", "1.0 0.0 +0") + "EndSolid\n"));
  // Next to nothing is not nothing: 1e-300 is a vertex of its own.
  const std::vector<Vec3> positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1e-300, 0, 0}};
  EXPECT_EQ(mesh.positions, positions);
  EXPECT_EQ(mesh.facets, (std::vector<Facet>{{0, 1, 2}, {0, 2, 3}, {2, 4, 1}}));
}

std::string binary_stl(const Mesh& mesh, std::string header) {
  header.resize(80);
  std::string stl = header + raw(static_cast<std::uint32_t>(mesh.facet_count()));
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    for (int k = 0; k < 3; ++k) stl += raw(std::numeric_limits<float>::quiet_NaN());
    for (const Vec3& p : mesh.corners(f))
      for (int axis = 0; axis < 3; ++axis) stl += raw(static_cast<float>(p[axis]));
    stl += raw(std::uint16_t{0xffff});
  }
  return stl;
}

TEST(MeshFile, binary_stl_is_told_by_its_size_even_if_it_begins_with_solid) {
  const ScratchFolder folder;
  const Mesh mesh{{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {2, 1, 3}}};
  for (const std::string header : {"", "made by somebody", "solid this is binary"})
    EXPECT_TRUE(same_bits(read_mesh(folder.file("a.stl", binary_stl(mesh, header))), mesh)) << header;
}

TEST(MeshFile, numbers_mean_the_same_in_every_locale) {
  const ScratchFolder folder;
  const CommaLocale commas;
  for (const std::string extension : {".obj", ".off", ".ply"}) {
    write_mesh(folder.path() / ("a" + extension), awkward_mesh());
    EXPECT_TRUE(same_bits(read_mesh(folder.path() / ("a" + extension)), awkward_mesh())) << extension;
  }
  expect_tetrahedron(read_mesh(folder.file("b.ply", rich_ply("ascii"))));
}

TEST(MeshFile, a_failed_write_changes_nothing) {
  const ScratchFolder folder;
  const fs::path path = folder.file("a.obj", "precious");
  Mesh mesh = small_mesh();
  mesh.positions.push_back({0, std::numeric_limits<double>::infinity(), 0});  // unused, but not to be read back
  EXPECT_THROW(write_mesh(path, mesh), std::invalid_argument);
  mesh = small_mesh();
  mesh.facets.push_back({0, 1, 1000});
  EXPECT_THROW(write_mesh(path, mesh), std::invalid_argument);
  EXPECT_THROW(write_mesh(path, Mesh{}), std::invalid_argument);
  EXPECT_EQ(bytes_of(path), "precious");

  const fs::path occupied = folder.path() / "folder.obj";
  fs::create_directory(occupied);
  expect_file_error(occupied, 0, "is a folder", [&] { write_mesh(occupied, small_mesh()); });
  const fs::path nowhere = folder.path() / "missing" / "a.obj";
  expect_file_error(nowhere, 0, "make the folder first", [&] { write_mesh(nowhere, small_mesh()); });
  const fs::path msh = folder.path() / "a.msh";
  expect_file_error(msh, 0, "Gmsh's format is read but not written", [&] { write_mesh(msh, small_mesh()); });
  const fs::path unknown = folder.path() / "a.xyz";
  expect_file_error(unknown, 0, "use .obj, .off, .ply, .stl or .vtp", [&] { write_mesh(unknown, small_mesh()); });
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"a.obj", "folder.obj"}));
}

TEST(MeshFile, writing_replaces_the_file_at_once_and_leaves_nothing_beside_it) {
  const ScratchFolder folder;
  // Left behind by somebody who crashed: stepped over, not touched.
  folder.file(".morula-0.tmp", "left over");
  const fs::path path = folder.file("a.ply", "old");
  write_mesh(path, small_mesh());
  EXPECT_TRUE(same_bits(read_mesh(path), small_mesh()));
  EXPECT_EQ(folder.names(), (std::vector<std::string>{".morula-0.tmp", "a.ply"}));
  EXPECT_EQ(bytes_of(folder.path() / ".morula-0.tmp"), "left over");
}

TEST(MeshFile, writes_any_pose_of_a_mesh) {
  const ScratchFolder folder;
  const Mesh rest = small_mesh();
  std::vector<Vec3f> floats;
  for (const Vec3& p : rest.positions) floats.emplace_back(Vec3{0.1, 0.2, 0.3} + p / 3);
  for (const char* name : {"pose.obj", "pose.off", "pose.ply"}) {
    write_mesh(folder.path() / name, {floats, rest.facets});
    const Mesh read = read_mesh(folder.path() / name);
    EXPECT_EQ(read.facets, rest.facets) << name;
    ASSERT_EQ(read.vertex_count(), floats.size()) << name;
    for (std::size_t i = 0; i < floats.size(); ++i) EXPECT_EQ(read.positions[i], Vec3(floats[i])) << name;
  }
}

}  // namespace
}  // namespace morula::test
