// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/mjcf/geoms.hpp"

#include <fmt/format.h>

#include <morula/io/mesh_file.hpp>
#include <optional>

#include "platform/path_text.hpp"
#include "read/assembly.hpp"

namespace morula::robot {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

void MjcfGeoms::read_assets(const XMLElement& of) {
  for (const XMLElement* at : files_.children(of)) {
    if (std::string_view(at->Name()) != "mesh") continue;
    const MjcfElement e = values_.element(*at, "main");
    Mesh mesh;
    std::string name;
    if (const char* file = e.find("file")) mesh.file = file;
    if (const char* own = at->Attribute("name")) {
      name = own;
    } else {
      name = platform::text_of(platform::path_of(mesh.file).stem());
    }
    if (name.empty()) files_.fail(*at, "a <mesh> has neither name nor file");
    mesh.scale = values_.vector(e, "scale", {1, 1, 1});
    if (e.find("refquat") != nullptr) {
      const std::vector<double> q = values_.numbers(e, "refquat", 4);
      mesh.before = RigidTransform::from_quaternion(q[0], q[1], q[2], q[3]);
    }
    mesh.before.translation = values_.vector(e, "refpos", {});
    mesh.before = inverse(mesh.before);
    const auto [known, fresh] = meshes_.emplace(name, std::pair{mesh, at});
    if (!fresh && !(known->second.first == mesh)) files_.fail(*at, fmt::format("there are two meshes {}", name));
  }
}

std::vector<double> MjcfGeoms::sizes(const MjcfElement& e, std::size_t count) const {
  if (e.find("size") == nullptr) files_.fail(e.own, "a geom has no size");
  std::vector<double> values = values_.numbers(e, "size", count, 3);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(values[i] >= 0)) files_.fail(e.own, fmt::format("size=\"{}\" of a geom is below 0", e.find("size")));
  }
  return values;
}

void MjcfGeoms::add(const XMLElement& at, Link& link, const RigidTransform& frame, const std::string& child_class,
                    const std::string& suffix) {
  const MjcfElement e = values_.element(at, child_class);
  const char* name = at.Attribute("name");
  const bool collides = values_.number(e, "contype", 1) != 0 || values_.number(e, "conaffinity", 1) != 0 ||
                        (name != nullptr && (paired_.count(name) != 0 || paired_.count(name + suffix) != 0));
  const double group = values_.number(e, "group", 0);
  const bool seen = group >= 0 && group <= 2;
  const bool needed = (options_.visual ? seen : collides) && options_.skip.count(link.name) == 0;
  if (!collides && !seen) return;
  try {
    const std::optional<Shape> shape = shape_of(e, link.name, frame, needed);
    if (!shape || !has_surface(*shape, link.name, needed, notes_)) return;
    if (collides) link.collision.push_back(*shape);
    if (seen) link.visual.push_back(*shape);
  } catch (const FileError& error) {
    if (needed) throw;
    notes_.push_back(unread_shape_note(link.name, error));
  }
}

std::optional<Shape> MjcfGeoms::shape_of(const MjcfElement& e, const std::string& link, const RigidTransform& frame,
                                         bool needed) {
  const XMLElement& at = e.own;
  const char* given = e.find("type");
  std::string_view type = given == nullptr ? "sphere" : given;
  Shape shape;
  shape.line = at.GetLineNum();
  if (files_.file_of(at).file() != files_.main().file()) shape.described_in = files_.file_of(at).file();
  if (type == "plane" || type == "hfield" || type == "sdf") {
    if (!needed) return std::nullopt;
    if (type != "plane") {
      files_.fail(
          at, fmt::format("a geom is a {}, which no spheres are made for: sphere, capsule, ellipsoid, cylinder, box "
                          "and mesh are known",
                          type));
    }
    notes_.push_back(endless_plane_note(link, at.GetLineNum()));
    return std::nullopt;
  }
  if (type != "mesh" && e.find("mesh") != nullptr) {
    // The fit would depend on the version that fits. The mesh is the robot's true shape.
    if (needed) {
      notes_.push_back(
          fmt::format("the {} that MuJoCo fits to mesh {} (line {}) is not made: the mesh itself is covered", type,
                      e.find("mesh"), at.GetLineNum()));
    }
    type = "mesh";
  }
  shape.origin = composed(frame, values_.pose(e));
  std::optional<double> span;  // half of fromto
  if (e.find("fromto") != nullptr && type != "mesh" && type != "sphere") {
    const std::vector<double> v = values_.numbers(e, "fromto", 6);
    const Vec3 from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]};
    span = 0.5 * distance(from, to);
    if (!(*span > 0)) files_.fail(at, "fromto of a geom names one point twice");
    RigidTransform own = turn_z_to(from - to);
    own.translation = 0.5 * (from + to);
    shape.origin = composed(frame, own);
  }
  if (type == "sphere") {
    shape.kind = Shape::Kind::sphere;
    shape.radius = sizes(e, 1)[0];
  } else if (type == "capsule" || type == "cylinder") {
    shape.kind = type == "capsule" ? Shape::Kind::capsule : Shape::Kind::cylinder;
    const std::vector<double> size = sizes(e, span ? 1 : 2);
    shape.radius = size[0];
    shape.length = 2 * (span ? *span : size[1]);
  } else if (type == "box" || type == "ellipsoid") {
    shape.kind = type == "box" ? Shape::Kind::box : Shape::Kind::ellipsoid;
    const std::vector<double> size = sizes(e, span ? 1 : 3);
    shape.size = span ? Vec3{2 * size[0], 2 * size[0], 2 * *span} : Vec3{2 * size[0], 2 * size[1], 2 * size[2]};
  } else if (type == "mesh") {
    const char* asset = e.find("mesh");
    if (asset == nullptr) files_.fail(at, "a geom of type mesh names no mesh");
    const auto found = meshes_.find(asset);
    if (found == meshes_.end()) files_.fail(at, fmt::format("there is no mesh {} in <asset>", asset));
    if (needed || !found->second.first.file.empty())
      set_mesh(shape, found->second.first, *found->second.second, needed);
    if (shape.file_name.empty()) return std::nullopt;
  } else {
    files_.fail(at, fmt::format("a geom is a {}: sphere, capsule, ellipsoid, cylinder, box and mesh are known", type));
  }
  return shape;
}

void MjcfGeoms::set_mesh(Shape& shape, const Mesh& mesh, const XMLElement& at, bool needed) const {
  if (mesh.file.empty()) {
    files_.fail(at, "a mesh that is written out or built in is not supported: save it as OBJ or STL and name the file");
  }
  shape.file_name = values_.mesh_name(mesh.file);
  shape.scale = mesh.scale;
  shape.before = mesh.before;
  if (!needed) return;
  try {
    shape.file = find_mesh(shape.file_name, files_.main().file(), options_.package_paths, at.GetLineNum());
  } catch (const FileError& error) {
    if (&files_.file_of(at) == &files_.main()) throw;
    files_.fail(at, error.what());
  }
}

}  // namespace morula::robot
