// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <morula/geometry/box.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/robot/robot.hpp>
#include <numbers>

#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"
#include "read/mujoco_mesh.hpp"
#include "read/xml.hpp"

namespace morula::robot {

namespace {

// A polygon about a circle sticks out by 1 / cos(π / around) − 1 at its corners.
constexpr std::uint32_t around = 64;

Mesh box_mesh(const Vec3& size) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.push_back(
        {(corner & 1 ? 0.5 : -0.5) * size.x, (corner & 2 ? 0.5 : -0.5) * size.y, (corner & 4 ? 0.5 : -0.5) * size.z});
  }
  mesh.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A closed body of rings about z, from below to above: the first and the last number are the poles' heights.
struct Ring {
  double radius, height;
};
Mesh turned_mesh(double bottom, const std::vector<Ring>& rings, double top) {
  Mesh mesh;
  mesh.positions.push_back({0, 0, bottom});
  for (const Ring& ring : rings) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const SinCos at = sin_cos(2 * std::numbers::pi * i / around);
      mesh.positions.push_back({ring.radius * at.cos, ring.radius * at.sin, ring.height});
    }
  }
  const auto last = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back({0, 0, top});
  const auto ring_count = static_cast<std::uint32_t>(rings.size());
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t next = (i + 1) % around;
    mesh.facets.push_back({0, 1 + next, 1 + i});
    for (std::uint32_t ring = 0; ring + 1 < ring_count; ++ring) {
      const std::uint32_t low = 1 + ring * around, high = low + around;
      mesh.facets.push_back({low + i, low + next, high + next});
      mesh.facets.push_back({low + i, high + next, high + i});
    }
    const std::uint32_t high = 1 + (ring_count - 1) * around;
    mesh.facets.push_back({last, high + i, high + next});
  }
  return mesh;
}

/// The factor that pays for rounding in a polyhedron that is to contain a round shape.
constexpr double outward = 1 + 0x1p-44;

Mesh cylinder_mesh(double radius, double length, RoundShapes round) {
  const bool inside = round == RoundShapes::inside;
  const double ring = inside ? radius / outward : outward * radius / sin_cos(std::numbers::pi / around).cos;
  const double half = (inside ? 1 / outward : outward) * 0.5 * length;
  return turned_mesh(-half, {{ring, -half}, {ring, half}}, half);
}

/// Contains the capsule because it is convex and every plane of a facet is `radius` or more from the segment's ends.
/// The meridians are polygons about the circle, and so are the parallels. The inner polyhedron has its corners on the
/// capsule, which is also convex.
Mesh capsule_mesh(double radius, double length, RoundShapes round) {
  constexpr int quarter = around / 4;
  const bool inside = round == RoundShapes::inside;
  const double widened = inside ? radius / outward : outward * radius / sin_cos(std::numbers::pi / around).cos;
  std::vector<Ring> rings;
  for (int i = 1; i <= quarter; ++i) {
    const SinCos at = sin_cos(0.5 * std::numbers::pi * i / quarter);
    rings.push_back({widened * at.sin, -0.5 * length - widened * at.cos});
  }
  rings.back().height = -0.5 * length;
  // The two middle rings of a ball coincide.
  const std::vector<Ring> below(rings.begin(), rings.end() - (length > 0 ? 0 : 1));
  for (auto ring = below.rbegin(); ring != below.rend(); ++ring) rings.push_back({ring->radius, -ring->height});
  const double pole = 0.5 * length + widened;
  Mesh mesh = turned_mesh(-pole, rings, pole);
  if (inside) return mesh;
  // Facets lie deeper than the edges of the profile where both kinds of polygon meet: their depth is measured, then
  // compensated.
  double least = widened;
  for (std::size_t facet = 0; facet < mesh.facet_count(); ++facet) {
    const auto [a, b, c] = mesh.corners(facet);
    const Vec3 normal = normalized(cross(b - a, c - a));
    const Vec3 end{0, 0, normal.z > 0 ? 0.5 * length : -0.5 * length};
    least = std::min(least, dot(normal, a - end));
  }
  const double growth = outward * radius / least;
  for (Vec3& p : mesh.positions) {
    const Vec3 end{0, 0, std::clamp(p.z, -0.5 * length, 0.5 * length)};
    p = end + growth * (p - end);
  }
  return mesh;
}

/// About the unit ball, or inside of it; stretched it is about an ellipsoid, as planes stay planes.
Mesh ball_mesh(RoundShapes round) {
  return capsule_mesh(1, 0, round);
}

/// Adds the facets of a mesh, and the vertices that they have: other vertices are no part of the surface.
void add(Mesh& to, const Mesh& mesh, const Vec3& scale, const RigidTransform& origin) {
  detail::InterruptPoller poll_interrupt(1u << 14);
  std::vector<std::uint32_t> places(mesh.positions.size(), 0);  // 0: no facet has the vertex
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
    for (const std::uint32_t v : f) places[v] = 1;
  }
  for (std::size_t v = 0; v < places.size(); ++v) {
    poll_interrupt();
    // mutant robot-loose-vertices: `places[v] == 0` -> `false`
    if (places[v] == 0) continue;
    const Vec3& p = mesh.positions[v];
    places[v] = static_cast<std::uint32_t>(to.positions.size());
    to.positions.push_back(origin({scale.x * p.x, scale.y * p.y, scale.z * p.z}));
  }
  const bool mirrored = scale.x * scale.y * scale.z < 0;
  for (const Facet& f : mesh.facets) {
    poll_interrupt();
    to.facets.push_back({places[f[0]], places[f[mirrored ? 2 : 1]], places[f[mirrored ? 1 : 2]]});
  }
}

/// An STL that is nothing but a header without words: programs write that for a body without triangles.
bool is_blank_stl(const std::filesystem::path& file, const std::string& ending) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (ending != ".stl" || error || size < 80 || size > 84) return false;
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  return bytes.find_first_not_of(std::string_view("\0 ", 2)) == std::string::npos;
}

Mesh mesh_of(const Shape& shape, MeshInfo& info) {
  const std::filesystem::path& file = shape.file;
  std::string ending = platform::text_of(file.extension());
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  if (is_blank_stl(file, ending)) return {};
  if (ending != ".dae" && !shape.part.empty()) {
    throw FileError(
        fmt::format("{}: submesh {} is required, but only submeshes of COLLADA files are read: save it as a "
                    "file of its own",
                    platform::text_of(file), shape.part));
  }
  const std::span<const MeshFileKind> kinds = mesh_file_kinds();
  const auto is_known = [&](const MeshFileKind& kind) { return kind.extension == ending; };
  if (ending != ".dae" && !is_mujoco_mesh(file) && std::none_of(kinds.begin(), kinds.end(), is_known)) {
    throw FileError(fmt::format("{}: no mesh format has the extension '{}'; name a file with one of .dae {}",
                                platform::text_of(file), ending, readable_mesh_extensions()));
  }
  Mesh mesh = ending == ".dae"       ? read_collada(file, shape.part, info)
              : is_mujoco_mesh(file) ? read_mujoco_mesh(file)
                                     : read_mesh(file, info);
  if (shape.part_centered) {
    Box box;
    for (const Vec3& p : mesh.positions) box.add(p);
    for (Vec3& p : mesh.positions) p = p - box.center();
  }
  if (!(shape.before == RigidTransform{})) {
    for (Vec3& p : mesh.positions) p = shape.before(p);
  }
  return mesh;
}

[[noreturn]] void reject_scale(const std::filesystem::path& robot_file, const Shape& shape) {
  fail_at(shape.described_in.empty() ? robot_file : shape.described_in, shape.line,
          fmt::format("a {} reaches beyond {:.2g}, the largest coordinate that is usable", name(shape.kind),
                      greatest_usable_scale));
}

}  // namespace

LinkSurface surface_of(const std::filesystem::path& robot_file, std::span<const Shape> shapes, RoundShapes round) {
  LinkSurface surface;
  for (const Shape& shape : shapes) {
    detail::check_interrupt();
    const std::size_t first_vertex = surface.mesh.positions.size();
    switch (shape.kind) {
      case Shape::Kind::mesh:
        try {
          MeshInfo info;
          const Mesh mesh = mesh_of(shape, info);
          for (const std::string& note : info.notes)
            surface.notes.push_back(fmt::format("mesh {} (line {}): {}", shape.file_name, shape.line, note));
          if (mesh.facets.empty()) {
            surface.notes.push_back(
                fmt::format("mesh {} (line {}) has no facet and is left out", shape.file_name, shape.line));
          }
          add(surface.mesh, mesh, shape.scale, shape.origin);
        } catch (const FileError& error) {
          fail_at(shape.described_in.empty() ? robot_file : shape.described_in, shape.line, error.what());
        }
        break;
      case Shape::Kind::box:
        add(surface.mesh, box_mesh(shape.size), {1, 1, 1}, shape.origin);
        break;
      case Shape::Kind::cylinder:
        add(surface.mesh, cylinder_mesh(shape.radius, shape.length, round), {1, 1, 1}, shape.origin);
        break;
      case Shape::Kind::capsule:
        add(surface.mesh, capsule_mesh(shape.radius, shape.length, round), {1, 1, 1}, shape.origin);
        break;
      case Shape::Kind::ellipsoid:
        add(surface.mesh, ball_mesh(round), 0.5 * shape.size, shape.origin);
        break;
      case Shape::Kind::sphere:
        surface.spheres.push_back({shape.origin.translation, shape.radius});
        if (!has_usable_scale(surface.spheres.back())) reject_scale(robot_file, shape);
        break;
    }
    for (std::size_t v = first_vertex; v < surface.mesh.positions.size(); ++v)
      if (!(max_norm(surface.mesh.positions[v]) <= greatest_usable_scale)) reject_scale(robot_file, shape);
  }
  return surface;
}

}  // namespace morula::robot
