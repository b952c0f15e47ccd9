// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Polygons of files: every format cuts them alike, and says what it could not cut well. Areas and volumes are those
// that the bodies have on paper.
#include <gtest/gtest.h>

#include <morula/geometry/inspect.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>

#include "files.hpp"

namespace morula::test {
namespace {

namespace fs = std::filesystem;

// A prism over an L of area 5 and outline 12, of height 1: two hexagons and six squares.
constexpr double ell_area = 22, ell_volume = 5;
const std::vector<Vec3> ell_points{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0},
                                   {0, 0, 1}, {3, 0, 1}, {3, 1, 1}, {1, 1, 1}, {1, 3, 1}, {0, 3, 1}};
using Faces = std::vector<std::vector<int>>;
Faces ell_faces(std::size_t first_corner) {
  Faces faces{{5, 4, 3, 2, 1, 0}, {6, 7, 8, 9, 10, 11}};
  for (int k = 0; k < 6; ++k) faces.push_back({k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k});
  for (std::vector<int>& face : faces)
    std::rotate(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(first_corner % face.size()), face.end());
  return faces;
}

std::string text_of(const std::vector<Vec3>& points, const std::string& before) {
  std::string text;
  for (const Vec3& p : points)
    text += before + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  return text;
}

std::string obj_of(const std::vector<Vec3>& points, const Faces& faces, bool faces_first) {
  std::string all;
  for (const auto& face : faces) {
    all += "f";
    for (const int v : face) all += " " + std::to_string(v + 1);
    all += "\n";
  }
  const std::string vertices = text_of(points, "v ");
  return faces_first ? all + vertices : vertices + all;
}

std::string rows_of(const Faces& faces) {
  std::string text;
  for (const auto& face : faces) {
    text += std::to_string(face.size());
    for (const int v : face) text += " " + std::to_string(v);
    text += "\n";
  }
  return text;
}

std::string off_of(const std::vector<Vec3>& points, const Faces& faces) {
  return "OFF\n" + std::to_string(points.size()) + " " + std::to_string(faces.size()) + " 0\n" + text_of(points, "") +
         rows_of(faces);
}

std::string ply_of(const std::vector<Vec3>& points, const Faces& faces, bool binary, bool faces_first = false) {
  const std::string vertex = "element vertex " + std::to_string(points.size()) +
                             "\nproperty double x\nproperty double y\nproperty double z\n",
                    face =
                        "element face " + std::to_string(faces.size()) + "\nproperty list uchar int vertex_indices\n";
  std::string head = std::string("ply\nformat ") + (binary ? "binary_little_endian" : "ascii") + " 1.0\n" +
                     (faces_first ? face + vertex : vertex + face) + "end_header\n";
  std::string points_rows, face_rows;
  if (binary) {
    for (const Vec3& p : points) points_rows += raw(p.x) + raw(p.y) + raw(p.z);
    for (const auto& f : faces) {
      face_rows += raw(static_cast<std::uint8_t>(f.size()));
      for (const int v : f) face_rows += raw(v);
    }
  } else {
    points_rows = text_of(points, "");
    face_rows = rows_of(faces);
  }
  return head + (faces_first ? face_rows + points_rows : points_rows + face_rows);
}

std::size_t corner_count(const Faces& faces) {
  std::size_t count = 0;
  for (const auto& face : faces) count += face.size();
  return count;
}

std::string vtk_of(const std::vector<Vec3>& points, const Faces& faces) {
  return "# vtk DataFile Version 3.0\nx\nASCII\nDATASET POLYDATA\nPOINTS " + std::to_string(points.size()) +
         " double\n" + text_of(points, "") + "POLYGONS " + std::to_string(faces.size()) + " " +
         std::to_string(corner_count(faces) + faces.size()) + "\n" + rows_of(faces);
}

std::string xml_of(const std::vector<Vec3>& points, const Faces& faces, bool grid) {
  const std::string type = grid ? "UnstructuredGrid" : "PolyData", group = grid ? "Cells" : "Polys";
  std::string corners, offsets, types;
  std::size_t end = 0;
  for (const auto& face : faces) {
    for (const int v : face) corners += std::to_string(v) + " ";
    offsets += std::to_string(end += face.size()) + " ";
    types += face.size() == 4 ? "9 " : "7 ";
  }
  return "<VTKFile type=\"" + type + "\"><" + type + "><Piece NumberOfPoints=\"" + std::to_string(points.size()) +
         (grid ? "\" NumberOfCells=\"" : "\" NumberOfPolys=\"") + std::to_string(faces.size()) +
         "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">" + text_of(points, "") +
         "</DataArray></Points><" + group + "><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">" +
         corners + "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" + offsets +
         "</DataArray>" +
         (grid ? "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">" + types + "</DataArray>" : "") + "</" +
         group + "></Piece></" + type + "></VTKFile>";
}

TEST(PolygonFiles, concave_polygons_have_their_area_in_every_format) {
  const ScratchFolder folder;
  std::size_t by_ears = 0;
  for (std::size_t k = 0; k < 6; ++k) {
    const Faces faces = ell_faces(k);
    const std::vector<std::pair<std::string, std::string>> files{
        {"a.obj", obj_of(ell_points, faces, false)}, {"b.obj", obj_of(ell_points, faces, true)},
        {"a.off", off_of(ell_points, faces)},        {"a.ply", ply_of(ell_points, faces, false)},
        {"b.ply", ply_of(ell_points, faces, true)},  {"c.ply", ply_of(ell_points, faces, true, true)},
        {"a.vtk", vtk_of(ell_points, faces)},        {"a.vtp", xml_of(ell_points, faces, false)},
        {"a.vtu", xml_of(ell_points, faces, true)},
    };
    std::vector<Facet> same;
    for (const auto& [name, bytes] : files) {
      SCOPED_TRACE(name + " from corner " + std::to_string(k));
      MeshInfo info;
      const Mesh mesh = read_mesh(folder.file(name, bytes), info);
      const MeshReport report = inspect(mesh);
      EXPECT_DOUBLE_EQ(report.area, ell_area);
      EXPECT_TRUE(report.has_volume());
      EXPECT_DOUBLE_EQ(report.volume, ell_volume);
      EXPECT_EQ(info.polygons, 8u);
      EXPECT_EQ(info.crossing_polygons + info.bent_polygons, 0u);
      EXPECT_TRUE(info.notes.empty());
      if (same.empty()) same = mesh.facets;
      EXPECT_EQ(mesh.facets, same);
      by_ears += info.concave_polygons;
    }
  }
  // Facets about the reflex corner alone, and about the one across, see the whole L.
  EXPECT_EQ(by_ears, 9u * (2 * 6 - 4));
}

TEST(PolygonFiles, quadrilaterals_of_solids_and_of_gmsh_are_cut_alike) {
  const ScratchFolder folder;
  // A prism over a dart of area 4, whose reflex corner the fan of no other corner beside it sees: as a hexahedron and
  // as quadrilaterals. Sides of length 4, 4 and the square root of 10, twice.
  const double area = 2 * 4 + 2 * 4 + 2 * std::sqrt(10.0);
  const Faces sides{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (int turn = 0; turn < 4; ++turn) {
    const std::vector<Vec3> dart{{0, 0, 0}, {4, 0, 0}, {1, 1, 0}, {0, 4, 0}};
    std::vector<Vec3> points;
    for (const double z : {0.0, 1.0})
      for (int k = 0; k < 4; ++k) points.push_back(dart[static_cast<std::size_t>((k + turn) % 4)] + Vec3{0, 0, z});
    std::string nodes = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n", quads = "$Elements\n6\n";
    for (std::size_t k = 0; k < 8; ++k) nodes += std::to_string(k + 1) + " " + text_of({points[k]}, "");
    for (std::size_t k = 0; k < 6; ++k) {
      quads += std::to_string(k + 1) + " 3 0";
      for (const int v : sides[k]) quads += " " + std::to_string(v + 1);
      quads += "\n";
    }
    const std::string end = "$EndNodes\n";
    for (const std::string& elements :
         {quads + "$EndElements\n", std::string("$Elements\n1\n1 5 0 1 2 3 4 5 6 7 8\n$EndElements\n")}) {
      MeshInfo info;
      const MeshReport report = inspect(read_mesh(folder.file("a.msh", nodes + end + elements), info));
      EXPECT_NEAR(report.area, area, 1e-12);
      EXPECT_NEAR(report.volume, 4, 1e-12);
      EXPECT_TRUE(report.has_volume());
      EXPECT_EQ(info.polygons, 6u);
      EXPECT_EQ(info.concave_polygons, turn % 2 == 0 ? 0u : 2u);
    }
  }
}

TEST(PolygonFiles, those_that_cannot_be_cut_well_are_named) {
  const ScratchFolder folder;
  // Two bow ties, then a square that is folded along a diagonal.
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}};
  const Faces faces{{0, 1, 2}, {0, 2, 1, 3}, {0, 2, 1, 3}, {0, 1, 2, 4}};
  MeshInfo info;
  const Mesh mesh = read_mesh(folder.file("a.obj", obj_of(points, faces, false)), info);
  EXPECT_EQ(mesh.facet_count(), 7u);
  EXPECT_EQ(info.polygons, 3u);
  EXPECT_EQ(info.crossing_polygons, 2u);
  EXPECT_EQ(info.bent_polygons, 1u);
  ASSERT_EQ(info.notes.size(), 2u);
  EXPECT_NE(info.notes[0].find("2 faces cross themselves"), std::string::npos) << info.notes[0];
  EXPECT_NE(info.notes[0].find("the first is face 1, counted from 0, on line 7"), std::string::npos) << info.notes[0];
  EXPECT_NE(info.notes[1].find("1 face is far from flat"), std::string::npos) << info.notes[1];
  EXPECT_NE(info.notes[1].find("face 3, counted from 0, on line 9"), std::string::npos) << info.notes[1];
  read_mesh(folder.file("a.ply", ply_of(points, faces, true)), info);
  ASSERT_EQ(info.notes.size(), 2u);
  EXPECT_TRUE(info.notes[0].ends_with("the first is face 1, counted from 0")) << info.notes[0];
}

TEST(PolygonFiles, frames_are_cut_as_the_mesh_at_rest) {
  const ScratchFolder folder;
  // A square whose corner goes inwards until no fan is right, and a dart that becomes a square.
  const Faces face{{0, 1, 2, 3}};
  const std::vector<Vec3> square{{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
  const std::vector<Vec3> dart{{0, 0, 0}, {1, 1, 0}, {4, 4, 0}, {0, 4, 0}},
      deep{{0, 0, 0}, {1, 2, 0}, {4, 4, 0}, {0, 4, 0}};
  for (const auto& rest : {square, deep}) {
    const Mesh mesh = read_mesh(folder.file("rest.obj", obj_of(rest, face, false)));
    fs::create_directories(folder.path() / "frames");
    int frame = 0;
    for (const auto& points : {square, dart, deep, rest}) {
      const std::string name = std::to_string(frame++);
      folder.file("frames/" + name + ".obj", obj_of(points, face, frame % 2 == 0));
    }
    const Motion motion(folder.path() / "frames", mesh);
    ASSERT_EQ(motion.frame_count(), 4u);
    EXPECT_EQ(motion.frame(0), square);
    EXPECT_EQ(motion.frame(2), deep);
    EXPECT_EQ(motion.frame(3), rest);
  }
  // Other corners are other facets, whichever way they are cut.
  const Mesh mesh = read_mesh(folder.file("rest.obj", obj_of(deep, face, false)));
  const fs::path other = folder.file("other.obj", obj_of(deep, {{0, 3, 2, 1}}, false));
  expect_file_error(other, 0, "facet 0", [&] { Motion(other, mesh).frame(0); });
}

}  // namespace
}  // namespace morula::test
