// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A solid cut into tetrahedra, and files of it written from the rules of VTK and Gmsh.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <string>
#include <support/raw.hpp>
#include <vector>

namespace morula::test {

struct Solid {
  std::vector<Vec3> points;
  std::vector<std::array<std::uint32_t, 4>> tetrahedra;
};

/// n × n × n cubes of six tetrahedra each.
inline Solid tetrahedral_cube(std::uint32_t n) {
  Solid solid;
  const std::uint32_t side = n + 1;
  for (std::uint32_t z = 0; z < side; ++z)
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x) solid.points.push_back(Vec3{0.25 * x, 0.25 * y, 0.25 * z});
  const auto at = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (z * side + y) * side + x; };
  constexpr std::uint32_t paths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (std::uint32_t z = 0; z < n; ++z)
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x)
        for (std::size_t p = 0; p < 6; ++p) {
          std::array<std::uint32_t, 3> c{x, y, z};
          std::array<std::uint32_t, 4> tet{at(x, y, z)};
          for (std::size_t k = 0; k < 3; ++k) {
            ++c[paths[p][k]];
            tet[k + 1] = at(c[0], c[1], c[2]);
          }
          // Every other path is mirrored; half of these are left so, for readers to turn.
          if (p == 3 || p == 4) std::swap(tet[2], tet[3]);
          solid.tetrahedra.push_back(tet);
        }
  return solid;
}

inline std::string number_text(double value) {
  std::string text = std::to_string(value);
  return text;
}

inline std::string legacy_vtk(const Solid& solid, bool binary) {
  std::string text = "# vtk DataFile Version 3.0\na solid\n" + std::string(binary ? "BINARY" : "ASCII") +
                     "\nDATASET UNSTRUCTURED_GRID\nPOINTS " + std::to_string(solid.points.size()) + " double\n";
  for (const Vec3& p : solid.points)
    for (const double v : {p.x, p.y, p.z}) text += binary ? raw(v, true) : number_text(v) + " ";
  const std::string cells = std::to_string(solid.tetrahedra.size());
  text += "\nCELLS " + cells + " " + std::to_string(5 * solid.tetrahedra.size()) + "\n";
  for (const auto& tet : solid.tetrahedra) {
    text += binary ? raw(std::int32_t{4}, true) : std::string("4");
    for (const std::uint32_t v : tet)
      text += binary ? raw(static_cast<std::int32_t>(v), true) : " " + std::to_string(v);
    if (!binary) text += "\n";
  }
  text += "\nCELL_TYPES " + cells + "\n";
  for (std::size_t i = 0; i < solid.tetrahedra.size(); ++i) text += binary ? raw(std::int32_t{10}, true) : "10\n";
  return text + "\nPOINT_DATA " + std::to_string(solid.points.size()) + "\nwhatever follows\n";
}

inline std::string xml_vtu(const Solid& solid) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<!-- a solid -->\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<UnstructuredGrid><Piece NumberOfPoints=\"" +
      std::to_string(solid.points.size()) + "\" NumberOfCells=\"" + std::to_string(solid.tetrahedra.size()) +
      "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">";
  for (const Vec3& p : solid.points)
    for (const double v : {p.x, p.y, p.z}) text += number_text(v) + " ";
  text += "</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">";
  for (const auto& tet : solid.tetrahedra)
    for (const std::uint32_t v : tet) text += std::to_string(v) + " ";
  text += "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">";
  for (std::size_t i = 0; i < solid.tetrahedra.size(); ++i) text += std::to_string(4 * i + 4) + "\n";
  text += "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">";
  for (std::size_t i = 0; i < solid.tetrahedra.size(); ++i) text += "10 ";
  return text + "</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n";
}

/// Nodes are numbered from 7, in steps of 3.
inline std::int32_t gmsh_tag(std::size_t node) {
  return static_cast<std::int32_t>(7 + 3 * node);
}

inline std::string gmsh_2(const Solid& solid, bool binary) {
  std::string text = "$MeshFormat\n2.2 " + std::string(binary ? "1" : "0") + " 8\n";
  if (binary) text += raw(std::int32_t{1}) + "\n";
  text += "$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"all of it\"\n$EndPhysicalNames\n$Nodes\n" +
          std::to_string(solid.points.size()) + "\n";
  for (std::size_t i = 0; i < solid.points.size(); ++i) {
    text += binary ? raw(gmsh_tag(i)) : std::to_string(gmsh_tag(i));
    const Vec3& p = solid.points[i];
    for (const double v : {p.x, p.y, p.z}) text += binary ? raw(v) : " " + number_text(v);
    if (!binary) text += "\n";
  }
  // A triangle first, which lies on the solid: it is no second facet.
  text +=
      (binary ? "\n" : std::string()) + "$EndNodes\n$Elements\n" + std::to_string(1 + solid.tetrahedra.size()) + "\n";
  const auto& first = solid.tetrahedra[0];
  if (binary) {
    text += raw(std::int32_t{2}) + raw(std::int32_t{1}) + raw(std::int32_t{2}) + raw(std::int32_t{1}) +
            raw(std::int32_t{9}) + raw(std::int32_t{9});
    for (std::size_t k = 0; k < 3; ++k) text += raw(gmsh_tag(first[k]));
    text += raw(std::int32_t{4}) + raw(static_cast<std::int32_t>(solid.tetrahedra.size())) + raw(std::int32_t{2});
  } else {
    text += "1 2 2 9 9";
    for (std::size_t k = 0; k < 3; ++k) text += " " + std::to_string(gmsh_tag(first[k]));
    text += "\n";
  }
  for (std::size_t i = 0; i < solid.tetrahedra.size(); ++i) {
    const auto number = static_cast<std::int32_t>(i + 2);
    text += binary ? raw(number) + raw(std::int32_t{1}) + raw(std::int32_t{1}) : std::to_string(number) + " 4 2 1 1";
    for (const std::uint32_t v : solid.tetrahedra[i])
      text += binary ? raw(gmsh_tag(v)) : " " + std::to_string(gmsh_tag(v));
    if (!binary) text += "\n";
  }
  return text + (binary ? "\n" : "") + "$EndElements\n";
}

inline std::string gmsh_4(const Solid& solid, bool binary) {
  const auto size = [&](std::uint64_t value) { return binary ? raw(value) : std::to_string(value) + " "; };
  const auto whole = [&](std::int32_t value) { return binary ? raw(value) : std::to_string(value) + " "; };
  const std::uint64_t points = solid.points.size(), cells = solid.tetrahedra.size();
  std::string text = "$MeshFormat\n4.1 " + std::string(binary ? "1" : "0") + " 8\n";
  if (binary) text += raw(std::int32_t{1}) + "\n";
  text += "$EndMeshFormat\n$Nodes\n";
  // Two blocks, the second with parameters, as nodes on a surface have.
  const std::uint64_t half = points / 2;
  text += size(2) + size(points) + size(7) + size(7 + 3 * points) + "\n";
  if (binary) text.pop_back();
  const auto block = [&](std::uint64_t begin, std::uint64_t end, bool parametric) {
    text += whole(parametric ? 2 : 3) + whole(1) + whole(parametric ? 1 : 0) + size(end - begin);
    for (std::uint64_t i = begin; i < end; ++i) text += size(static_cast<std::uint64_t>(gmsh_tag(i)));
    for (std::uint64_t i = begin; i < end; ++i) {
      const Vec3& p = solid.points[i];
      for (const double v : {p.x, p.y, p.z}) text += binary ? raw(v) : number_text(v) + " ";
      for (int k = 0; parametric && k < 2; ++k) text += binary ? raw(0.5) : std::string("0.5 ");
    }
  };
  block(0, half, false);
  block(half, points, true);
  text += "\n$EndNodes\n$Elements\n" + size(1) + size(cells) + size(1) + size(cells) + whole(3) + whole(1) + whole(4) +
          size(cells);
  for (std::uint64_t i = 0; i < cells; ++i) {
    text += size(i + 1);
    for (const std::uint32_t v : solid.tetrahedra[i]) text += size(static_cast<std::uint64_t>(gmsh_tag(v)));
  }
  return text + "\n$EndElements\n";
}

/// Numbers of entities come before their dimensions, tags have 32 bits and stand beside their nodes.
inline std::string gmsh_4_0(const Solid& solid, bool binary) {
  const auto size = [&](std::uint64_t value) { return binary ? raw(value) : std::to_string(value) + " "; };
  const auto whole = [&](std::int32_t value) { return binary ? raw(value) : std::to_string(value) + " "; };
  const std::uint64_t points = solid.points.size(), cells = solid.tetrahedra.size();
  std::string text = "$MeshFormat\n4 " + std::string(binary ? "1" : "0") + " 8\n";
  if (binary) text += raw(std::int32_t{1}) + "\n";
  text += "$EndMeshFormat\n$Nodes\n" + size(2) + size(points);
  const std::uint64_t half = points / 2;
  const auto block = [&](std::uint64_t begin, std::uint64_t end, std::int32_t dimension) {
    text += whole(5) + whole(dimension) + whole(dimension == 1 ? 1 : 0) + size(end - begin);
    for (std::uint64_t i = begin; i < end; ++i) {
      const Vec3& p = solid.points[i];
      text += whole(gmsh_tag(i));
      for (const double v : {p.x, p.y, p.z}) text += binary ? raw(v) : number_text(v) + " ";
      if (dimension == 1) text += binary ? raw(0.25) : std::string("0.25 ");
    }
  };
  block(0, half, 3);
  block(half, points, 1);
  text += "\n$EndNodes\n$Elements\n" + size(1) + size(cells) + whole(9) + whole(3) + whole(4) + size(cells);
  for (std::uint64_t i = 0; i < cells; ++i) {
    text += whole(static_cast<std::int32_t>(i + 1));
    for (const std::uint32_t v : solid.tetrahedra[i]) text += whole(gmsh_tag(v));
  }
  return text + "\n$EndElements\n";
}

}  // namespace morula::test
