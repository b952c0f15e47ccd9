// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Solids of VTK and Gmsh, point caches, and what ParaView is given.
#include "solid_files.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/repair.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/solid_surface.hpp>
#include <morula/io/files.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/paraview_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <set>
#include <sstream>
#include <support/allocations.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

/// The oracle: the surface of a cube by counting faces in a map of sorted corners, and what a cube must have.
void expect_surface(const Mesh& mesh, const Solid& solid, double side, const std::string& name) {
  ASSERT_EQ(mesh.positions, solid.points) << name;
  std::map<std::set<std::uint32_t>, int> faces;
  for (const auto& tet : solid.tetrahedra)
    for (std::size_t leave = 0; leave < 4; ++leave) {
      std::set<std::uint32_t> face;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != leave) face.insert(tet[k]);
      ++faces[face];
    }
  std::set<std::set<std::uint32_t>> open, read;
  for (const auto& [face, count] : faces)
    if (count == 1) open.insert(face);
  for (const Facet& facet : mesh.facets) read.insert({facet[0], facet[1], facet[2]});
  EXPECT_EQ(read, open) << name;
  EXPECT_EQ(mesh.facet_count(), open.size()) << name;
  const MeshReport report = inspect(mesh);
  EXPECT_TRUE(report.has_volume()) << name;
  EXPECT_NEAR(report.volume, side * side * side, 1e-12) << name;  // positive: outward
}

TEST(SolidFiles, surface_of_tetrahedra_in_every_format) {
  const ScratchFolder folder;
  const Solid solid = tetrahedral_cube(3);
  const std::vector<std::pair<std::string, std::string>> files{
      {"text.vtk", legacy_vtk(solid, false)}, {"binary.vtk", legacy_vtk(solid, true)},
      {"text.vtu", xml_vtu(solid)},           {"text2.msh", gmsh_2(solid, false)},
      {"binary2.msh", gmsh_2(solid, true)},   {"text4.msh", gmsh_4(solid, false)},
      {"binary4.msh", gmsh_4(solid, true)},   {"text40.msh", gmsh_4_0(solid, false)},
      {"binary40.msh", gmsh_4_0(solid, true)}};
  for (const auto& [name, bytes] : files) expect_surface(read_mesh(folder.file(name, bytes)), solid, 0.75, name);
  // The same surface from memory.
  const Mesh read = read_mesh(folder.file("text.vtk", files[0].second));
  const UsedVertices in_memory = solid_surface(solid.points, solid.tetrahedra);
  EXPECT_EQ(in_memory.mesh.facets, used_vertices(read).mesh.facets);
  EXPECT_EQ(in_memory.index, used_vertices(read).index);
}

TEST(SolidFiles, other_cells_and_their_outsides) {
  const ScratchFolder folder;
  const std::string head = "# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n";
  const std::string cube = "POINTS 8 float\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\n";
  const auto read = [&](const std::string& body) { return read_mesh(folder.file("a.vtk", head + body)); };
  const auto volume = [&](const std::string& body) { return inspect(read(body)).volume; };
  EXPECT_NEAR(volume(cube + "CELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n"), 1, 1e-12);
  EXPECT_NEAR(volume(cube + "CELLS 1 9\n8 4 5 6 7 0 1 2 3\nCELL_TYPES 1\n12\n"), 1, 1e-12);  // mirrored
  EXPECT_NEAR(volume(cube + "CELLS 1 9\n8 0 1 3 2 4 5 7 6\nCELL_TYPES 1\n11\n"), 1, 1e-12);
  EXPECT_NEAR(volume(cube + "CELLS 1 7\n6 0 1 3 4 5 7\nCELL_TYPES 1\n13\n"), 0.5, 1e-12);
  EXPECT_NEAR(volume(cube + "CELLS 1 6\n5 0 1 2 3 4\nCELL_TYPES 1\n14\n"), 1.0 / 3, 1e-12);
  // Two wedges share a quadrilateral: the cube again, and its inner face is gone.
  const Mesh two = read(cube + "CELLS 2 14\n6 0 1 3 4 5 7\n6 1 2 3 5 6 7\nCELL_TYPES 2\n13\n13\n");
  EXPECT_NEAR(inspect(two).volume, 1, 1e-12);
  EXPECT_EQ(two.facet_count(), 12u);
  EXPECT_EQ(read(cube + "CELLS 3 13\n4 0 1 2 3\n4 0 1 3 2\n2 0 1\nCELL_TYPES 3\n9\n8\n3\n").facet_count(), 4u);
  const std::string poly = "# vtk DataFile Version 4.2\nt\nASCII\nDATASET POLYDATA\n";
  const Mesh strip = read_mesh(folder.file(
      "b.vtk", poly + "POINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\nLINES 1 3\n2 0 1\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\n"));
  EXPECT_EQ(strip.facets, (std::vector<Facet>{{0, 1, 2}, {2, 1, 3}}));
  const Mesh offsets = read_mesh(folder.file(
      "c.vtk",
      "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nMETADATA\nINFORMATION 0\n\n"
      "FIELD FieldData 1\ntime 1 1 double\n0.5\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\n"
      "POLYGONS 3 7\nOFFSETS vtktypeint64\n0 3 7\nCONNECTIVITY vtktypeint64\n0 1 2 0 1 3 2\nCELL_DATA 2\n"));
  EXPECT_EQ(offsets.facets, (std::vector<Facet>{{0, 1, 2}, {0, 1, 3}, {0, 3, 2}}));
}

/// Packed bytes come from Python's zlib.compress, level 9.
TEST(SolidFiles, packed_base64_and_appended_arrays) {
  const ScratchFolder folder;
  const auto file = [&](const std::string& how, const std::string& array, const std::string& tail) {
    return "<VTKFile type='PolyData' byte_order='LittleEndian'" + how +
           "><PolyData><Piece NumberOfPoints='3' NumberOfPolys='1'><Points><DataArray type='Float32' "
           "NumberOfComponents='3' " +
           array +
           "</Points><Polys><DataArray type='Int32' Name='connectivity' format='ascii'>0 1 2</DataArray><DataArray "
           "type='Int32' Name='offsets' format='ascii'>3</DataArray></Polys></Piece></PolyData>" +
           tail + "</VTKFile>";
  };
  const std::vector<Vec3> expected{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  std::string points;
  for (const Vec3& p : expected)
    for (int axis = 0; axis < 3; ++axis) points += raw(static_cast<float>(p[axis]));
  const std::string size = raw(static_cast<std::uint32_t>(points.size()));
  const auto read = [&](const std::string& bytes) { return read_mesh(folder.file("a.vtp", bytes)).positions; };
  EXPECT_EQ(read(file("", "format='appended' offset='2'/>",
                      "<AppendedData encoding='raw'>\n_xx" + size + points + "</AppendedData>")),
            expected);
  // Base64 of the same 40 bytes.
  EXPECT_EQ(read(file("", "format='binary'>JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==</DataArray>", "")),
            expected);
  // Appended: other arrays come before and after, and then a tag.
  EXPECT_EQ(
      read(file(
          "", "format='appended' offset='8'/>",
          "<AppendedData encoding='base64'>_AAAAAA==JAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAA==BAAAAAAA"
          "AAA=</AppendedData>")),
      expected);
  // One block of 36 bytes, deflated; header and data are encoded by themselves.
  EXPECT_EQ(read(file(" compressor='vtkZLibDataCompressor'",
                      "format='binary'>AQAAACQAAAAkAAAAEAAAAA==eNpjYEAGDfYMWPgAFIoBfw==</DataArray>", "")),
            expected);
}

TEST(SolidFiles, vtp_meshes_read_back_as_the_same_bits) {
  const ScratchFolder folder;
  for (const Mesh& mesh : {awkward_mesh(), sample_body("limb", 8)}) {
    write_mesh(folder.path() / "a.vtp", mesh);
    EXPECT_TRUE(same_bits(read_mesh(folder.path() / "a.vtp"), mesh));
  }
}

TEST(SolidFiles, stl_is_written_with_the_same_facets_in_floats) {
  const ScratchFolder folder;
  const Mesh mesh = sample_body("limb", 8);
  write_mesh(folder.path() / "a.stl", mesh);
  const std::string bytes = bytes_of(folder.path() / "a.stl");
  ASSERT_EQ(bytes.size(), 84 + 50 * mesh.facet_count());
  EXPECT_NE(bytes.substr(0, 5), "solid");
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    std::array<float, 12> n{};
    std::memcpy(n.data(), bytes.data() + 84 + 50 * f, 48);
    Vec3 corners[3];
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.positions[mesh.facets[f][k]];
      EXPECT_EQ(Vec3f(n[3 + 3 * k], n[4 + 3 * k], n[5 + 3 * k]), Vec3f(corners[k]));
    }
    const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    EXPECT_LT(distance(normal, Vec3(Vec3f(n[0], n[1], n[2]))), 1e-6);
  }
  EXPECT_EQ(read_mesh(folder.path() / "a.stl").facet_count(), mesh.facet_count());
  EXPECT_THROW(MotionWriter(folder.path() / "frames", mesh, 1, ".stl"), std::invalid_argument);
}

TEST(SolidFiles, used_vertices_keep_their_order_and_say_what_they_were) {
  const ScratchFolder folder;
  const Mesh mesh = read_mesh(folder.file("a.vtu", xml_vtu(tetrahedral_cube(3))));
  const UsedVertices used = used_vertices(mesh);
  EXPECT_EQ(used.mesh.vertex_count(), 4 * 4 * 4 - 2 * 2 * 2u);
  ASSERT_EQ(used.mesh.facet_count(), mesh.facet_count());
  for (std::size_t v = 1; v < used.index.size(); ++v) EXPECT_LT(used.index[v - 1], used.index[v]);
  for (std::size_t v = 0; v < used.index.size(); ++v) EXPECT_EQ(used.mesh.positions[v], mesh.positions[used.index[v]]);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(used.index[used.mesh.facets[f][k]], mesh.facets[f][k]);
}

TEST(HostileSolids, are_refused_with_the_place_and_what_is_wrong) {
  const std::string vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  const std::string three = "POINTS 3 float\n0 0 0 1 0 0 0 1 0\n";
  const std::string grid = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n" + three;
  const std::string msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n";
  const std::string nodes = "$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 0 1 0\n$EndNodes\n";
  const std::string xml = "<VTKFile type='PolyData'><PolyData><Piece NumberOfPoints='3'>";
  const std::string points =
      "<Points><DataArray type='Float32' NumberOfComponents='3' format='ascii'>0 0 0 1 0 0 0 1 "
      "0</DataArray></Points>";
  const auto polys = [](const std::string& corners, const std::string& offsets) {
    return "<Polys><DataArray Name='connectivity' type='Int32' format='ascii'>" + corners +
           "</DataArray><DataArray Name='offsets' type='Int32' format='ascii'>" + offsets +
           "</DataArray></Polys></Piece></PolyData></VTKFile>";
  };
  const std::vector<HostileFile> files{
      {"empty.vtk", "", 1, "a VTK file begins with a line"},
      {"structured.vtk", "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n", 4, "without a surface"},
      {"mode.vtk", "# vtk DataFile Version 3.0\nt\nTEXT\n", 3, "'text' is neither ASCII nor BINARY"},
      {"no_points.vtk", vtk, 4, "ends before its POINTS"},
      {"early.vtk", vtk + "POLYGONS 1 4\n3 0 1 2\n", 5, "cells come before the POINTS"},
      {"huge.vtk", vtk + "POINTS 4000000000 float\n0 0 0\n", 5, "the file counts 4000000000 points"},
      {"nan.vtk", vtk + "POINTS 1 float\n0 nan 0\n", 6, "y is not finite"},
      {"word.vtk", vtk + "POINTS 1 float\n0 zero 0\n", 6, "'zero' is not a number"},
      {"short.vtk", vtk + "POINTS 1 float\n0 0\n", 6, "ends inside z"},
      {"beyond.vtk", vtk + three + "POLYGONS 1 4\n3 0 1 3\n", 8, "refers to point 3, but the file has 3 points"},
      {"negative.vtk", vtk + three + "POLYGONS 1 4\n3 0 1 -1\n", 8, "refers to point -1"},
      {"size.vtk", vtk + three + "POLYGONS 1 5\n3 0 1 2\n", 8, "take 4 numbers, but the list has 5"},
      {"two.vtk", vtk + three + "POLYGONS 1 3\n2 0 1\n", 8, "has 2 points, fewer than 3"},
      {"types.vtk", grid + "CELLS 1 5\n4 0 1 2 2\n", 8, "has 1 CELLS, but 0 CELL_TYPES"},
      {"type.vtk", grid + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n77\n", 10, "is of type 77"},
      {"tet.vtk", grid + "CELLS 1 4\n3 0 1 2\nCELL_TYPES 1\n10\n", 10, "has 3 points, fewer than 4"},
      {"part.vtk", vtk + "SPLINES 3\n", 5, "'splines' is not a part"},
      {"none.vtk", vtk + three, 0, "no facets"},
      {"empty.msh", "", 1, "begins with a line '$MeshFormat'"},
      {"old.msh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n", 2, "version '3.0' is not read"},
      {"size.msh", "$MeshFormat\n2.2 0 4\n$EndMeshFormat\n", 2, "numbers of 4 bytes"},
      {"no_nodes.msh", msh, 3, "ends before a section '$Nodes'"},
      {"early.msh", msh + "$Elements\n", 4, "'$Elements' comes before '$Nodes'"},
      {"huge.msh", msh + "$Nodes\n4000000000\n1 0 0 0\n", 5, "the file counts 4000000000 nodes"},
      {"twice.msh", msh + "$Nodes\n2\n1 0 0 0\n1 0 0 0\n$EndNodes\n", 7, "two nodes have the number 1"},
      {"count.msh", msh + "$Nodes\n2\n1 0 0 0\n2 0 0 0\n3 0 0 0\n$EndNodes\n", 8, "'$EndNodes' does not follow"},
      {"beyond.msh", msh + nodes + "$Elements\n1\n1 2 0 1 2 4\n$EndElements\n", 12, "refers to node 4, which"},
      {"type.msh", msh + nodes + "$Elements\n1\n1 77 0 1 2 3\n$EndElements\n", 12, "elements of type 77"},
      {"cut.msh", msh + nodes + "$Elements\n1\n1 2 0 1 2", 12, "ends inside a node of an element"},
      {"open.msh", msh + "$Comments\nnever ends\n", 4, "the file ends inside '$Comments'"},
      {"empty.vtp", "", 1, "does not begin with <VTKFile>"},
      {"other.vtp", "<VTKFile type='UnstructuredGrid'>", 1, "holds 'UnstructuredGrid', not PolyData"},
      {"entity.vtp", "<!DOCTYPE x [<!ENTITY a 'b'>]><VTKFile type='PolyData'>", 1, "entities are not read"},
      {"packer.vtp", "<VTKFile type='PolyData' compressor='vtkLZ4DataCompressor'>", 1, "'vtkLZ4DataCompressor'"},
      {"cut.vtp", xml + points, 1, "ends inside a <Piece>"},
      {"tag.vtp", "<VTKFile type='Poly", 1, "ends inside a tag"},
      {"huge.vtp", "<VTKFile type='PolyData'><Piece NumberOfPoints='4000000000'>" + points + "</Piece></VTKFile>", 1,
       "has 9 numbers, not the 12000000000"},
      {"beyond.vtp", xml + points + polys("0 1 3", "3"), 1, "cell 0 refers to a point that is not among the 3"},
      {"offset.vtp", xml + points + polys("0 1 2", "4"), 1, "offset 0 is out of place"},
      {"two.vtp", xml + points + polys("0 1", "2"), 1, "has 2 points, fewer than 3"},
      {"nowhere.vtp",
       xml + "<Points><DataArray type='Float32' NumberOfComponents='3' format='appended' offset='0'/></Points></Piece>",
       1, "the file has none"},
      {"base64.vtp",
       xml +
           "<Points><DataArray type='Float32' NumberOfComponents='3' format='binary'>J!AA</DataArray></Points></Piece>",
       1, "end too early, or are not of its encoding"},
  };
  expect_all_refused(files, [](const fs::path& path) { read_mesh(path); });
}

TEST(HostileSolids, counts_take_no_memory) {
  const ScratchFolder folder;
  for (const std::string n : {"1000000", "2147483647", "4294967296", "9223372036854775807"}) {
    const std::string vtk = "# vtk DataFile Version 3.0\nt\n", poly = "\nDATASET POLYDATA\n";
    const std::string msh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                      new_msh = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.vtk", vtk + "ASCII" + poly + "POINTS " + n + " float\n0 0 0\n"},
        {"a.vtk", vtk + "BINARY" + poly + "POINTS " + n + " float\n0 0 0\n"},
        {"a.vtk", vtk + "ASCII" + poly + "POINTS 1 float\n0 0 0\nPOLYGONS " + n + " " + n + "\n3 0 0 0\n"},
        {"a.vtk", vtk + "BINARY" + poly + "FIELD F " + n + "\nx 1 " + n + " int\n"},
        {"a.vtk", vtk + "ASCII" + poly + "FIELD F 1\nx " + n + " " + n + " int\n0\n"},
        {"a.vtk", vtk + "ASCII" + poly + "POINTS 1 float\n0 0 0\nPOLYGONS " + n + " 3\nOFFSETS vtktypeint64\n0\n"},
        {"a.msh", msh + "$Nodes\n" + n + "\n1 0 0 0\n"},
        {"a.msh", msh + "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n" + n + "\n1 2 0 1 1 1\n"},
        {"a.msh", msh + "$Nodes\n1\n1 0 0 0\n$EndNodes\n$Elements\n1\n1 2 " + n + " 1 1 1\n"},
        {"a.msh", new_msh + "$Nodes\n1 " + n + " 1 1\n2 1 0 " + n + "\n1\n"},
        {"a.msh", new_msh + "$Nodes\n" + n + " 1 1 1\n2 1 0 1\n1\n0 0 0\n"},
        {"a.vtp", "<VTKFile type='PolyData'><Piece NumberOfPoints='" + n +
                      "'><Points><DataArray type='Float32' NumberOfComponents='3' format='binary'>" +
                      "/////w==</DataArray></Points></Piece></VTKFile>"},
        {"a.vtu", "<VTKFile type='UnstructuredGrid' compressor='vtkZLibDataCompressor'><Piece NumberOfPoints='" + n +
                      "'><Points><DataArray type='Float32' NumberOfComponents='3' format='binary'>" +
                      "////////////////////////</DataArray></Points></Piece></VTKFile>"}};
    for (const auto& [name, bytes] : files) {
      const fs::path path = folder.file(name, bytes);
      const std::size_t before = allocated_bytes;
      EXPECT_THROW(read_mesh(path), FileError) << name << ": " << bytes;
      EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20) << name << ": " << bytes;
    }
  }
}

/// PC2: "POINTCACHE2\0", version, points, start, rate, frames, little-endian. MDD: frames, points, times, big-endian.
TEST(PointCaches, hold_frames_in_floats_and_read_back) {
  const ScratchFolder folder;
  const Mesh mesh = sample_body("bar", 4);
  std::vector<std::vector<Vec3>> frames(3, mesh.positions);
  for (std::size_t f = 0; f < frames.size(); ++f)
    for (Vec3& p : frames[f]) p = p * (1 + 0.1 * static_cast<double>(f)) + Vec3{1.0 / 3, 0, -2};
  for (const std::string name : {"a.pc2", "a.mdd"}) {
    MotionWriter writer(folder.path() / name, mesh, frames.size());
    for (const auto& frame : frames) writer.write(frame);
    writer.finish();
    const std::string bytes = bytes_of(folder.path() / name);
    const bool is_pc2 = name == "a.pc2";
    const std::size_t begin = is_pc2 ? 32 : 8 + 4 * frames.size();
    ASSERT_EQ(bytes.size(), begin + 12 * mesh.vertex_count() * frames.size());
    const auto points = static_cast<std::int32_t>(mesh.vertex_count());
    if (is_pc2) {
      EXPECT_EQ(bytes.substr(0, 32), std::string("POINTCACHE2\0", 12) + raw(std::int32_t{1}) + raw(points) + raw(0.0f) +
                                         raw(1.0f) + raw(std::int32_t{3}));
    } else {
      EXPECT_EQ(bytes.substr(0, 12), raw(std::int32_t{3}, true) + raw(points, true) + raw(0.0f, true));
    }
    std::string expected;
    for (const auto& frame : frames)
      for (const Vec3& p : frame)
        for (int axis = 0; axis < 3; ++axis) expected += raw(static_cast<float>(p[axis]), !is_pc2);
    EXPECT_EQ(bytes.substr(begin), expected);
    const Motion motion(folder.path() / name, mesh);
    ASSERT_EQ(motion.frame_count(), 3u);
    for (std::size_t f = 0; f < 3; ++f) {
      const std::vector<Vec3> read = motion.frame(f);
      for (std::size_t v = 0; v < read.size(); ++v) EXPECT_EQ(read[v], Vec3(Vec3f(frames[f][v])));
    }
  }
}

TEST(PointCaches, are_refused_where_they_do_not_fit) {
  const ScratchFolder folder;
  const Mesh& mesh = one_facet();
  const std::string mark("POINTCACHE2\0", 12);
  const auto pc2 = [&](std::int32_t version, std::int32_t points, std::int32_t frames, std::size_t numbers) {
    return mark + raw(version) + raw(points) + raw(0.0f) + raw(1.0f) + raw(frames) + std::string(4 * numbers, '\0');
  };
  const auto points = static_cast<std::int32_t>(mesh.vertex_count());
  const std::size_t numbers = 3 * mesh.vertex_count();
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::string& reason) {
    const fs::path path = folder.file(name, bytes);
    const std::size_t before = allocated_bytes;
    expect_file_error(path, 0, reason, [&] {
      const Motion motion(path, mesh);
      motion.frame(0);
    });
    EXPECT_LE(allocated_bytes - before, std::size_t{64} << 20);
  };
  EXPECT_EQ(Motion(folder.file("good.pc2", pc2(1, points, 1, numbers)), mesh).frame_count(), 1u);
  refused("a.pc2", "", "ends inside its header");
  refused("a.pc2", std::string(32, 'x'), "begins with 'POINTCACHE2'");
  refused("a.pc2", pc2(2, points, 1, numbers), "version 2 is not read");
  refused("a.pc2", pc2(1, points, 0, 0), "has no frames");
  refused("a.pc2", pc2(1, points + 1, 1, numbers), "but the mesh has");
  refused("a.pc2", pc2(1, points, 2, numbers), "counts 2 frames");
  refused("a.pc2", pc2(1, points, 2147483647, numbers), "counts 2147483647 frames");
  refused("a.pc2", pc2(1, points, -1, numbers), "less than none");
  refused("a.mdd", raw(std::int32_t{2147483647}, true) + raw(points, true), "counts 2147483647 frames");
  std::string nan = pc2(1, points, 1, numbers);
  nan.replace(32, 4, raw(std::numeric_limits<float>::quiet_NaN()));
  refused("a.pc2", nan, "frame 0: vertex 0 has a coordinate that is not finite");
}

// A reader of .vtp by the rules of its XML, for what we write alone: inline base64, headers of 64 bits.
std::string decoded(const std::string& text) {
  const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(alphabet.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255u);
  }
  return bytes;
}

std::map<std::string, std::vector<double>> arrays_in(const std::string& text) {
  std::map<std::string, std::vector<double>> arrays;
  for (std::size_t at = text.find("<DataArray "); at != std::string::npos; at = text.find("<DataArray ", at + 1)) {
    const std::size_t close = text.find('>', at), end = text.find('<', close);
    const std::string tag = text.substr(at, close - at);
    const auto attribute = [&](const std::string& key) {
      const std::size_t begin = tag.find(key + "=\"") + key.size() + 2;
      return tag.substr(begin, tag.find('"', begin) - begin);
    };
    const std::string bytes = decoded(text.substr(close + 1, end - close - 1)), type = attribute("type");
    std::uint64_t size = 0;
    std::memcpy(&size, bytes.data(), 8);
    EXPECT_EQ(size, bytes.size() - 8);
    const std::size_t width = type == "Int32" ? 4 : 8;
    std::vector<double>& values = arrays[attribute("Name")];
    for (std::size_t i = 8; i < bytes.size(); i += width) {
      double real = 0;
      std::int32_t small = 0;
      std::int64_t large = 0;
      if (type == "Float64") std::memcpy(&real, bytes.data() + i, 8);
      if (type == "Int32") std::memcpy(&small, bytes.data() + i, 4);
      if (type == "Int64") std::memcpy(&large, bytes.data() + i, 8);
      values.push_back(real + small + static_cast<double>(large));
    }
  }
  return arrays;
}

TEST(ParaView, points_and_facets_with_numbers_on_them) {
  const ScratchFolder folder;
  VtpData data{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0.5}}, {{0, 1, 2}}, {}, {}};
  data.point_arrays = {{"distance <&\"", {0.1, -0.2, 0.3}}, {"normal", {1, 2, 3, 4, 5, 6, 7, 8, 9}, 3}};
  data.facet_arrays = {{"uncovered", {1}, 1, true}};
  write_vtp(folder.path() / "a.vtp", data);
  const std::string text = bytes_of(folder.path() / "a.vtp");
  EXPECT_NE(text.find("NumberOfPoints=\"3\" NumberOfVerts=\"0\""), std::string::npos);
  auto arrays = arrays_in(text);
  EXPECT_EQ(arrays["distance &lt;&amp;&quot;"], data.point_arrays[0].values);
  EXPECT_EQ(arrays["normal"], data.point_arrays[1].values);
  EXPECT_EQ(arrays["uncovered"], std::vector<double>{1});
  EXPECT_EQ(arrays["Points"], (std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0.5}));
  EXPECT_EQ(arrays["connectivity"], (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(arrays["offsets"], std::vector<double>{3});
  // Points alone are shown as points.
  write_vtp(folder.path() / "b.vtp", {{{1, 2, 3}}, {}, {{"radius", {0.5}}}, {}});
  arrays = arrays_in(bytes_of(folder.path() / "b.vtp"));
  EXPECT_EQ(arrays["connectivity"], std::vector<double>{0});
  EXPECT_EQ(arrays["radius"], std::vector<double>{0.5});
  EXPECT_THROW(write_vtp(folder.path() / "c.vtp", {{{1, 2, 3}}, {}, {{"radius", {}}}, {}}), std::invalid_argument);
  EXPECT_THROW(write_vtp(folder.path() / "c.vtp", {{{1, 2, 3}}, {{0, 0, 1}}, {}, {}}), std::invalid_argument);
  EXPECT_FALSE(fs::exists(folder.path() / "c.vtp"));
  const std::vector<PvdEntry> entries{{0, "a.vtp"}, {0.5, "b.vtp"}};
  write_pvd(folder.path() / "a.pvd", entries);
  const std::string pvd = bytes_of(folder.path() / "a.pvd");
  EXPECT_NE(pvd.find("<VTKFile type=\"Collection\""), std::string::npos);
  EXPECT_NE(pvd.find("<DataSet timestep=\"0.5\" group=\"\" part=\"0\" file=\"b.vtp\"/>"), std::string::npos);
}

/// What SOFA's loader does: it steps over the first line, then reads words; `sphe` has an index and four numbers.
TEST(Sofa, spheres_in_its_dialect) {
  const ScratchFolder folder;
  const std::vector<Sphere> spheres{{{0.1, -2, 3e-20}, 0.5}, {{1, 1, 1}, 2}};
  write_sofa_spheres(folder.path() / "a.sph", spheres);
  std::istringstream in(bytes_of(folder.path() / "a.sph"));
  std::string line, word;
  std::getline(in, line);
  std::vector<Sphere> read;
  std::size_t count = 0;
  while (in >> word) {
    if (word == "nums") {
      in >> count;
    } else if (word == "sphe") {
      std::size_t index = 0;
      Sphere s;
      in >> index >> s.center.x >> s.center.y >> s.center.z >> s.radius;
      read.push_back(s);
    } else {
      ADD_FAILURE() << word;
    }
  }
  EXPECT_GE(line.size(), 6u);  // fgets takes six characters before the rest of the line is skipped
  EXPECT_EQ(count, spheres.size());
  EXPECT_EQ(read, spheres);
}

TEST(FileFormats, list_every_mesh_format_as_it_is) {
  for (const MeshFileKind& kind : mesh_file_kinds()) {
    bool found = false;
    for (const FileFormat& format : file_formats()) {
      if (format.extension != kind.extension || format.purpose != "meshes") continue;
      found = true;
      EXPECT_TRUE(format.is_read);
      EXPECT_EQ(format.is_written, kind.is_written);
      EXPECT_FALSE(format.program.empty());
    }
    EXPECT_TRUE(found) << kind.extension;
  }
}

}  // namespace
}  // namespace morula::test
