// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/io/mesh_file.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

void expect_meshes_refused(const std::vector<HostileFile>& files) {
  test::expect_all_refused(files, [](const fs::path& path) { read_mesh(path); });
}

TEST(HostileMeshes, obj) {
  const std::string v3 = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_meshes_refused({
      {"empty.obj", "", 0, "has neither vertices nor facets: it is empty, or not what its name says"},
      {"blank.obj", " \n# nothing\n", 0, "it is empty, or not what its name says"},
      {"other.obj", "ISO-10303-21;\nHEADER;\n", 0, "not what its name says; 2 statements that OBJ does not know"},
      {"only_vertices.obj", v3, 0, "has 3 vertices but no facets"},
      {"no_vertices.obj", "# nothing\nf 1 2 3\n", 2, "refers to vertex 3, but the file has 0 vertices"},
      {"short_vertex.obj", "v 0 0 0\nv 1 0\n", 2, "the line ends where z should be"},
      {"word.obj", "v 0 0 0\n\nv 1 zero 0\n", 3, "'zero' is not a number"},
      {"comma.obj", "v 0,5 0 0\n", 1, "'0,5' is not a number"},
      {"glued.obj", "v 0 0 1.5abc\n", 1, "'1.5abc' is not a number"},
      {"plus_minus.obj", "v 0 0 +-1\n", 1, "'+-1' is not a number"},
      {"two_plus.obj", "v 0 0 ++1\n", 1, "'++1' is not a number"},
      {"hexadecimal.obj", "v 0 0 0x10\n", 1, "'0x10' is not a number"},
      {"nan.obj", "v 0 0 0\nv nan 0 0\n", 2, "x is not finite"},
      {"inf.obj", "v 0 -inf 0\n", 1, "y is not finite"},
      {"plus_infinity.obj", "v 0 0 +Infinity\n", 1, "z is not finite"},
      {"overflow.obj", "v 0 0 1e999\n", 1, "'1e999' is out of range"},
      {"zero.obj", v3 + "f 0 1 2\n", 4, "OBJ counts from 1"},
      {"beyond.obj", v3 + "f 1 2 3\nf 1 2 4\n", 5, "refers to vertex 4, but the file has 3 vertices"},
      {"far_beyond.obj", v3 + "f 1 2 4294967298\n", 4, "refers to vertex 4294967298"},
      {"beyond_all_numbers.obj", v3 + "f 1 2 99999999999999999999\n", 4, "is not a face corner"},
      {"negative.obj", v3 + "f -1 -2 -4\n", 4, "refers to vertex -4, but only 3 vertices come before it"},
      {"negative_early.obj", "f -1 -2 -3\n" + v3, 1, "only 0 vertices come before it"},
      {"one_corner.obj", v3 + "f 1\n", 4, "a face has 1 corners, fewer than 3"},
      {"two_corners.obj", v3 + "f 1 2\n", 4, "a face has 2 corners, fewer than 3"},
      {"no_corners.obj", v3 + "f\n", 4, "a face has 0 corners"},
      {"garbage_corner.obj", v3 + "f 1 2 x\n", 4, "'x' is not a face corner"},
      {"fraction.obj", v3 + "f 1 2 3.5\n", 4, "'3.5' is not a face corner"},
      {"slash.obj", v3 + "f 1 2 /3\n", 4, "'/3' is not a face corner"},
      {"slash_word.obj", v3 + "f 1/a 2/b 3/c\n", 4, "'1/a' is not a face corner"},
      {"joined.obj", v3 + "f 1 \\\n 2 \\\n x\n", 6, "'x' is not a face corner"},
      {"binary.obj", std::string("\x00\x01\x02v\xff\n v \x00 0 0\n", 15), 2, "is not a number"},
      {"long_word.obj", "v " + std::string(100'000, 'x') + " 0 0\n", 1, "xxx…' is not a number"},
  });
}

TEST(HostileMeshes, off) {
  const std::string v3 = "0 0 0\n1 0 0\n0 1 0\n";
  expect_meshes_refused({
      {"empty.off", "", 1, "the file is empty"},
      {"only_comments.off", "# a\n# b\n", 2, "the file is empty"},
      {"only_keyword.off", "OFF\n", 1, "ends before its counts"},
      {"other_keyword.off", "PLY\n3 1 0\n", 1, "'PLY' is not how an OFF file begins"},
      {"four_dimensions.off", "4OFF\n3 1 0\n", 1, "'4OFF' is a kind of OFF that is not read"},
      {"any_dimension.off", "nOFF 5\n3 1 0\n", 1, "is a kind of OFF that is not read"},
      {"binary.off", std::string("OFF BINARY\n\0\0\0\3", 15), 1, "binary OFF is not read"},
      {"one_count.off", "OFF\n3\n" + v3, 2, "the line ends where the number of faces should be"},
      {"word_count.off", "OFF\nthree 1 0\n", 2, "'three' is not a whole number"},
      {"fraction_count.off", "OFF\n3.5 1 0\n", 2, "'3.5' is not a whole number"},
      {"negative_count.off", "OFF\n-3 1 0\n", 2, "the number of vertices is -3"},
      {"huge_count.off", "OFF\n4000000000 1 0\n" + v3, 5, "ends after 3 of 4000000000 vertices"},
      {"huger_count.off", "OFF\n9223372036854775807 1 0\n" + v3, 5, "ends after 3 of 9223372036854775807 vertices"},
      {"too_huge_count.off", "OFF\n99999999999999999999 1 0\n", 2, "out of range for the number of vertices"},
      {"huge_face_count.off", "OFF\n3 4000000000 0\n" + v3 + "3 0 1 2\n", 6, "ends after 1 of 4000000000 faces"},
      {"fewer_vertices.off", "OFF\n4 1 0\n" + v3 + "3 0 1 2\n", 6, "ends after 0 of 1 faces"},
      {"more_faces.off", "OFF\n3 1 0\n" + v3 + "3 0 1 2\n3 2 1 0\n", 7, "'3' follows the last of 1 faces"},
      {"no_faces.off", "OFF\n3 0 0\n" + v3, 0, "has 3 vertices but no facets"},
      {"truncated_vertex.off", "OFF\n3 1 0\n0 0 0\n1 0", 4, "the line ends where z should be"},
      {"truncated_face.off", "OFF\n3 1 0\n" + v3 + "3 0 1", 6, "the line ends where a vertex index should be"},
      {"nan.off", "OFF\n3 1 0\n0 0 0\n1 NaN 0\n0 1 0\n3 0 1 2\n", 4, "y is not finite"},
      {"one_corner.off", "OFF\n3 1 0\n" + v3 + "1 0\n", 6, "a face has 1 corners"},
      {"two_corners.off", "OFF\n3 2 0\n" + v3 + "3 0 1 2\n2 0 1\n", 7, "a face has 2 corners, fewer than 3"},
      {"minus_corners.off", "OFF\n3 1 0\n" + v3 + "-3 0 1 2\n", 6, "the number of corners is -3"},
      {"huge_corners.off", "OFF\n3 1 0\n" + v3 + "4000000000 0 1 2\n", 6, "the line ends"},
      {"beyond.off", "OFF\n3 1 0\n" + v3 + "3 0 1 3\n", 6, "refers to vertex 3, but the file has 3 vertices"},
      {"negative.off", "OFF\n3 1 0\n" + v3 + "3 0 1 -1\n", 6, "refers to vertex -1"},
      {"wraps_around.off", "OFF\n3 1 0\n" + v3 + "3 0 1 4294967296\n", 6, "refers to vertex 4294967296"},
      {"fraction_index.off", "OFF\n3 1 0\n" + v3 + "3 0 1 2.0\n", 6, "'2.0' is not a whole number"},
  });
}

std::string ply(const std::string& format, const std::string& elements, const std::string& body) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n" + body;
}

TEST(HostileMeshes, text_ply) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string three = "element vertex 3\n" + xyz;
  const std::string face = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string v3 = "0 0 0\n1 0 0\n0 1 0\n";
  expect_meshes_refused({
      {"empty.ply", "", 1, "begins with a line 'ply'"},
      {"other.ply", "plywood\n", 1, "begins with a line 'ply'"},
      {"only_ply.ply", "ply\n", 1, "ends inside its header"},
      {"no_end.ply", "ply\nformat ascii 1.0\n" + three, 6, "ends inside its header"},
      {"no_format.ply", "ply\n" + three + face + "end_header\n" + v3 + "3 0 1 2\n", 8, "no line 'format'"},
      {"other_format.ply", "ply\nformat binary_middle_endian 1.0\n", 2, "'binary_middle_endian' is not a PLY format"},
      {"other_version.ply", "ply\nformat ascii 2.0\n", 2, "PLY version '2.0' is not read"},
      {"no_vertices.ply", ply("ascii", face, "3 0 1 2\n"), 5, "no element 'vertex'"},
      {"two_vertices.ply", ply("ascii", three + three + face, v3), 13, "two elements 'vertex'"},
      {"no_z.ply", ply("ascii", "element vertex 1\nproperty float x\nproperty float y\n" + face, "0 0\n"), 8,
       "one scalar property 'z'"},
      {"list_x.ply", ply("ascii", "element vertex 1\nproperty list uchar float x\n" + face, "0\n"), 7,
       "one scalar property 'x'"},
      {"no_list.ply", ply("ascii", three + "element face 1\nproperty int a\n", v3 + "1\n"), 9,
       "one list property 'vertex_indices' or 'vertex_index'"},
      {"two_lists.ply", ply("ascii", three + face + "property list int int vertex_index\n", v3 + "3 0 1 2 3 0 1 2\n"),
       10, "one list property"},
      {"float_indices.ply",
       ply("ascii", three + "element face 1\nproperty list uchar float vertex_indices\n", v3 + "3 0 1 2\n"), 9,
       "vertex indices must have an integer type"},
      {"float_length.ply", "ply\nformat ascii 1.0\nelement face 1\nproperty list float int vertex_indices\n", 4,
       "a list's length must have an integer type"},
      {"other_type.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty quad x\n", 4, "'quad' is not a PLY type"},
      {"no_name.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float\n", 4, "the name of a property"},
      {"early_property.ply", "ply\nformat ascii 1.0\nproperty float x\n", 3, "before the first element"},
      {"header_garbage.ply", "ply\nformat ascii 1.0\nelephant vertex 3\n", 3, "'elephant' is not a header line"},
      {"negative_count.ply", "ply\nformat ascii 1.0\nelement vertex -3\n", 3, "the number of elements is -3"},
      {"huge_count.ply", ply("ascii", "element vertex 4000000000\n" + xyz + face, v3), 12,
       "ends after 3 of 4000000000 rows of element 'vertex'"},
      {"only_header.ply", ply("ascii", three + face, ""), 9, "ends after 0 of 3 rows of element 'vertex'"},
      {"truncated.ply", ply("ascii", three + face, v3 + "3 0 1"), 13, "the line ends where a vertex index should be"},
      {"more_rows.ply", ply("ascii", three + face, v3 + "3 0 1 2\n3 0 1 2\n"), 14, "'3' follows the last element"},
      {"more_values.ply", ply("ascii", three + face, "0 0 0 7\n"), 10, "'7' follows the last property"},
      {"no_faces.ply", ply("ascii", three + "element face 0\nproperty list uchar int vertex_indices\n", v3), 0,
       "has 3 vertices but no facets"},
      {"no_face_element.ply", ply("ascii", three, v3), 0, "has 3 vertices but no facets"},
      {"nan.ply", ply("ascii", three + face, "0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n"), 10, "a coordinate is not finite"},
      {"lying_list.ply", ply("ascii", three + face, v3 + "4000000000 0 1 2\n"), 13, "claims 4000000000 entries"},
      {"negative_list.ply", ply("ascii", three + face, v3 + "-3 0 1 2\n"), 13, "claims -3 entries"},
      {"two_corners.ply", ply("ascii", three + face, v3 + "2 0 1\n"), 13, "a face has 2 corners, fewer than 3"},
      {"beyond.ply", ply("ascii", three + face, v3 + "3 0 1 3\n"), 13, "refers to vertex 3, but the file has 3"},
      {"negative.ply", ply("ascii", three + face, v3 + "3 0 1 -1\n"), 13, "refers to vertex -1"},
  });
}

TEST(HostileMeshes, binary_ply) {
  const std::string three = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string face = "element face 1\nproperty list uint uint vertex_indices\n";
  std::string v3;
  for (const float value : {0, 0, 0, 1, 0, 0, 0, 1, 0}) v3 += raw(value);
  const auto list = [](std::vector<std::uint32_t> values) {
    std::string bytes;
    for (const std::uint32_t value : values) bytes += raw(value);
    return bytes;
  };
  const auto little = [&](const std::string& elements, const std::string& body) {
    return ply("binary_little_endian", elements, body);
  };
  const std::string first_byte = std::to_string(little(three + face, "").size());
  const std::string nan_vertex = raw(0.0f) + raw(std::numeric_limits<float>::quiet_NaN()) + raw(0.0f);
  expect_meshes_refused({
      {"only_header.ply", little(three + face, ""), 0, "byte " + first_byte + ": the file ends inside row 0 of 3"},
      {"truncated_vertex.ply", little(three + face, v3.substr(0, 35)), 0, "inside row 2 of 3 of element 'vertex'"},
      {"no_face_row.ply", little(three + face, v3), 0, "inside row 0 of 1 of element 'face'"},
      {"truncated_face.ply", little(three + face, v3 + list({3, 0, 1})), 0, "inside row 0 of 1 of element 'face'"},
      {"huge_count.ply", little("element vertex 4294967295" + three.substr(16) + face, v3), 0,
       "inside row 3 of 4294967295 of element 'vertex'"},
      {"lying_list.ply", little(three + face, v3 + list({4294967295u, 0, 1, 2})), 0,
       "claims 4294967295 entries, but 12 bytes are left"},
      {"lying_a_little.ply", little(three + face, v3 + list({4, 0, 1, 2})), 0, "inside row 0 of 1 of element 'face'"},
      {"lying_skipped_list.ply",
       little(three + "element other 1\nproperty list uint double a\n" + face, v3 + list({4294967295u, 0})), 0,
       "claims 4294967295 entries"},
      {"skipped_list_cut.ply",
       little(three + "element other 1\nproperty list uint double a\n" + face, v3 + list({2, 0, 0})), 0,
       "inside row 0 of 1 of element 'other'"},
      {"negative_list.ply",
       little(three + "element face 1\nproperty list int int vertex_index\n", v3 + list({0xffffffffu, 0, 1, 2})), 0,
       "claims -1 entries"},
      {"nan.ply", little(three + face, nan_vertex + nan_vertex + nan_vertex + list({3, 0, 1, 2})), 0,
       "a coordinate is not finite"},
      {"beyond.ply", little(three + face, v3 + list({3, 0, 1, 3})), 0, "refers to vertex 3"},
      {"wrong_order.ply", ply("binary_big_endian", three + face, v3 + list({3, 0, 1, 2})), 0,
       "claims 50331648 entries"},
      {"more_bytes.ply", little(three + face, v3 + list({3, 0, 1, 2, 9})), 0, "4 bytes follow the last element"},
      {"one_corner.ply", little(three + face, v3 + list({1, 0})), 0, "a face has 1 corners, fewer than 3"},
  });
}

TEST(HostileMeshes, stl) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const std::string solid = "solid x\n" + facet + "endsolid x\n";
  const std::string head(80, ' ');
  std::string triangle(12, '\0');
  for (const float value : {0, 0, 0, 1, 0, 0, 0, 1, 0}) triangle += raw(value);
  triangle += "ab";
  std::string nan_triangle = triangle;
  nan_triangle.replace(12, 4, raw(std::numeric_limits<float>::quiet_NaN()));
  expect_meshes_refused({
      {"empty.stl", "", 0, "the file ends inside the header of a binary STL"},
      {"short_header.stl", head, 0, "byte 80: the file ends inside the header"},
      {"no_facets.stl", head + raw(0), 0, "has neither vertices nor facets"},
      {"short_body.stl", head + raw(2) + triangle, 0, "counts 2 facets, which take 184 bytes, but the file has 134"},
      {"long_body.stl", head + raw(1) + triangle + triangle, 0, "counts 1 facets"},
      {"huge_count.stl", head + raw(0xffffffffu) + triangle, 0, "counts 4294967295 facets"},
      {"solid_short_body.stl", "solid" + head.substr(5) + raw(2) + triangle, 0, "counts 2 facets"},
      {"binary_nan.stl", head + raw(1) + nan_triangle, 0, "a corner of facet 0 is not finite"},
      {"no_solid.stl", "solid nothing\nendsolid nothing\n", 0, "has neither vertices nor facets"},
      {"cut_solid.stl", "solid x\n" + facet + "facet normal 0 0 1\n", 9, "ends inside a solid"},
      {"only_solid.stl", "solid x\n", 1, "ends inside a solid"},
      {"cut_facet.stl", solid.substr(0, solid.find("endloop")), 6, "ends inside a solid"},
      {"two_corners.stl", "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\nendsolid\n", 7,
       "a facet has 2 corners, not 3"},
      {"four_corners.stl",
       "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 0\nendloop\nendfacet\n", 9,
       "a facet has 4 corners, not 3"},
      {"nan.stl", "solid x\nfacet\nouter loop\nvertex 0 0 nan\n", 4, "z is not finite"},
      {"short_vertex.stl", "solid x\nfacet\nouter loop\nvertex 0 0\n", 4, "the line ends where z should be"},
      {"long_vertex.stl", "solid x\nfacet\nouter loop\nvertex 0 0 0 0\n", 4, "'0' follows a corner"},
      {"garbage.stl", "solid x\nfacet\nouter loop\nvertex 0 0 O\n", 4, "'O' is not a number"},
      {"misplaced.stl", "solid x\nvertex 0 0 0\n", 2, "'vertex' is out of place"},
      {"unclosed.stl", "solid x\n" + facet.substr(0, facet.find("endfacet")) + facet, 8, "'facet' is out of place"},
      {"unknown_word.stl", "solid x\ntriangle 0 0 0\n", 2, "'triangle' is not a keyword of STL"},
  });
}

TEST(HostileMeshes, names_that_are_not_mesh_files) {
  const ScratchFolder folder;
  const auto refused = [&](const fs::path& path, const std::string& fragment) {
    expect_file_error(path, 0, fragment, [&] { read_mesh(path); });
  };
  refused(folder.path() / "missing.obj", "there is no such file");
  refused(folder.file("file", "x") / "mesh.obj", "");
  fs::create_directory(folder.path() / "folder.off");
  refused(folder.path() / "folder.off", "is a folder, not a file");
  refused(folder.file("mesh.xyz", "0 0 0\n"),
          "extension '.xyz' says no known mesh format; name a file with one of .obj");
  refused(folder.file("mesh", "0 0 0\n"), "no extension says no known mesh format");
  refused(folder.path(), "no extension");
  if (!can_make_links()) return;
  fs::create_symlink(folder.path() / "nowhere.obj", folder.path() / "dangling.obj");
  refused(folder.path() / "dangling.obj", "there is no such file");
}

}  // namespace
}  // namespace morula::test
