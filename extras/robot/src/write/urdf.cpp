// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The robot's own files with spheres instead of shapes: URDF, SRDF, and both for VAMP.
#include <fmt/format.h>

#include <array>
#include <set>

#include "read/file_names.hpp"
#include "read/xml.hpp"
#include "write/text.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

/// A name relative to the robot's file as a copy of it in `below` has it: absolute where no relative path leads there,
/// as from one drive of Windows to another.
std::string moved(const std::string& name, const Description& d, const std::string& below) {
  const std::filesystem::path from = std::filesystem::absolute(d.options.folder / below).lexically_normal();
  const std::filesystem::path to =
      (std::filesystem::absolute(d.robot.file).parent_path() / platform::path_of(name)).lexically_normal();
  const std::filesystem::path relative = to.lexically_relative(from);
  return name_of_path(relative.empty() ? to : relative);
}

void move_meshes(XMLElement& visual, const Description& d, const std::string& below) {
  XMLElement* geometry = visual.FirstChildElement("geometry");
  XMLElement* mesh = geometry == nullptr ? nullptr : geometry->FirstChildElement("mesh");
  const char* name = mesh == nullptr ? nullptr : mesh->Attribute("filename");
  if (name == nullptr) return;
  if (!is_absolute_name(name)) set(mesh, "filename", moved(name, d, below));
}

std::string place_of(const Shape& shape, const Description& d, const std::string& below) {
  if (shape.file_name.starts_with("model://")) return "package://" + shape.file_name.substr(8);
  return is_absolute_name(shape.file_name) ? shape.file_name : moved(shape.file_name, d, below);
}

void add_origin(XMLElement* to, const RigidTransform& pose) {
  XMLElement* origin = add_element(to, "origin");
  set(origin, "xyz", words(pose.translation));
  set(origin, "rpy", words(roll_pitch_yaw(pose)));
}

XMLElement* add_geometry(XMLElement* link, const RigidTransform& pose, const char* kind) {
  XMLElement* visual = add_element(link, "visual");
  add_origin(visual, pose);
  return add_element(add_element(visual, "geometry"), kind);
}

/// A visual shape in URDF, as far as URDF has the shape.
void add_visual(XMLElement* link, const Shape& shape, const Description& d, const std::string& below) {
  const auto leave_out = [&](const char* what) {
    link->InsertEndChild(
        link->GetDocument()->NewComment(fmt::format(" {} (line {}) is left out ", what, shape.line).c_str()));
  };
  const std::string radius = fmt::format("{}", shape.radius), length = fmt::format("{}", shape.length);
  switch (shape.kind) {
    case Shape::Kind::mesh: {
      const Vec3& s = shape.scale;
      const bool turned = shape.before.rows != RigidTransform{}.rows;
      if (!shape.part.empty()) return leave_out("a part of a mesh");
      if (turned && !(s.x == s.y && s.y == s.z)) return leave_out("a mesh that is turned before it is scaled");
      // A shape scaled after a motion is a scaled shape with a scaled motion.
      RigidTransform moved = shape.before;
      moved.translation = {s.x * moved.translation.x, s.y * moved.translation.y, s.z * moved.translation.z};
      XMLElement* mesh = add_geometry(link, composed(shape.origin, moved), "mesh");
      set(mesh, "filename", place_of(shape, d, below));
      set(mesh, "scale", words(s));
      return;
    }
    case Shape::Kind::box:
      set(add_geometry(link, shape.origin, "box"), "size", words(shape.size));
      return;
    case Shape::Kind::sphere:
      set(add_geometry(link, shape.origin, "sphere"), "radius", radius);
      return;
    case Shape::Kind::cylinder:
    case Shape::Kind::capsule: {
      XMLElement* cylinder = add_geometry(link, shape.origin, "cylinder");
      set(cylinder, "radius", radius);
      set(cylinder, "length", length);
      if (shape.kind == Shape::Kind::cylinder) return;
      // Few readers accept capsules.
      for (const double end : {-0.5, 0.5}) {
        const RigidTransform cap{.translation = {0, 0, end * shape.length}};
        set(add_geometry(link, composed(shape.origin, cap), "sphere"), "radius", radius);
      }
      return;
    }
    case Shape::Kind::ellipsoid:
      return leave_out("an ellipsoid");
  }
}

constexpr double unknown_velocity = 2, unknown_effort = 100;

void add_urdf_joint(XMLElement* root, const Robot& robot, const Joint& joint) {
  XMLElement* at = add_element(root, "joint");
  set(at, "name", joint.name);
  set(at, "type", std::string(name(joint.kind)));
  set(add_element(at, "parent"), "link", robot.links[joint.parent].name);
  set(add_element(at, "child"), "link", robot.links[joint.child].name);
  add_origin(at, joint.origin);
  if (!joint.moves()) return;
  set(add_element(at, "axis"), "xyz", words(joint.axis));
  XMLElement* limit = add_element(at, "limit");
  if (joint.kind != Joint::Kind::continuous) {
    set(limit, "lower", fmt::format("{}", joint.lower));
    set(limit, "upper", fmt::format("{}", joint.upper));
  }
  set(limit, "velocity", fmt::format("{}", joint.velocity > 0 ? joint.velocity : unknown_velocity));
  set(limit, "effort", fmt::format("{}", joint.effort > 0 ? joint.effort : unknown_effort));
  if (!joint.mimic) return;
  XMLElement* mimic = add_element(at, "mimic");
  set(mimic, "joint", robot.joints[joint.mimic->joint].name);
  set(mimic, "multiplier", fmt::format("{}", joint.mimic->multiplier));
  set(mimic, "offset", fmt::format("{}", joint.mimic->offset));
}

/// A robot of another format, without its shapes of collision.
void describe(tinyxml2::XMLDocument& document, const Description& d, const std::string& below) {
  XMLElement* root = add_element(&document, "robot");
  set(root, "name", d.robot.name);
  for (const Link& link : d.robot.links) {
    XMLElement* at = add_element(root, "link");
    set(at, "name", link.name);
    if (link.inertial) {
      XMLElement* inertial = add_element(at, "inertial");
      add_origin(inertial, link.inertial->origin);
      set(add_element(inertial, "mass"), "value", fmt::format("{}", link.inertial->mass));
      XMLElement* matrix = add_element(inertial, "inertia");
      constexpr std::array names{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"};
      for (std::size_t i = 0; i < 6; ++i) set(matrix, names[i], fmt::format("{}", link.inertial->inertia[i]));
    }
    for (const Shape& shape : link.visual) add_visual(at, shape, d, below);
  }
  root->InsertEndChild(
      document.NewComment(fmt::format(" velocity {} and effort {} stand where the robot's file gives none ",
                                      unknown_velocity, unknown_effort)
                              .c_str()));
  for (const std::size_t i : d.robot.order) add_urdf_joint(root, d.robot, d.robot.joints[i]);
}

std::string urdf_text(const Description& d, const std::string& below) {
  tinyxml2::XMLDocument fresh;
  std::optional<Xml> given;
  if (d.robot.format == Robot::Format::urdf) {
    if (d.robot.expanded.empty()) {
      given.emplace(d.robot.file, "robot");
    } else {
      given.emplace(d.robot.file, XmlText{d.robot.expanded});
    }
  } else {
    describe(fresh, d, below);
  }
  tinyxml2::XMLDocument& document = given ? given->document() : fresh;
  XMLElement* root = document.RootElement();
  for (XMLElement* at = root->FirstChildElement("link"); at != nullptr; at = at->NextSiblingElement("link")) {
    while (XMLElement* old = at->FirstChildElement("collision")) at->DeleteChild(old);
    for (XMLElement* visual = given ? at->FirstChildElement("visual") : nullptr; visual != nullptr;
         visual = visual->NextSiblingElement("visual")) {
      move_meshes(*visual, d, below);
    }
    const LinkSpheres* link = d.spheres.of(d.robot.find_link(at->Attribute("name")));
    if (link == nullptr) continue;
    for (const Sphere& s : link->spheres) {
      XMLElement* collision = add_element(at, "collision");
      XMLElement* origin = add_element(collision, "origin");
      set(origin, "xyz", words(s.center));
      set(origin, "rpy", "0 0 0");
      set(add_element(add_element(collision, "geometry"), "sphere"), "radius", fmt::format("{}", s.radius));
    }
  }
  return xml_text(document, d);
}

std::string srdf_text(const Description& d) {
  tinyxml2::XMLDocument fresh;
  std::optional<Xml> given;
  if (d.options.srdf) given.emplace(*d.options.srdf, "robot");
  tinyxml2::XMLDocument& document = given ? given->document() : fresh;
  if (!given) set(add_element(&fresh, "robot"), "name", d.robot.name);
  XMLElement* root = document.RootElement();
  while (XMLElement* old = root->FirstChildElement("link_sphere_approximation")) root->DeleteChild(old);
  for (std::size_t i = 0; i < d.robot.links.size(); ++i) {
    const LinkSpheres* link = d.spheres.of(i);
    XMLElement* at = add_element(root, "link_sphere_approximation");
    set(at, "link", d.robot.links[i].name);
    // Without any element a reader makes one sphere round the link; one of radius 0 prevents that.
    const std::vector<Sphere> nothing{Sphere{}};
    for (const Sphere& s : link == nullptr ? nothing : link->spheres) {
      XMLElement* sphere = add_element(at, "sphere");
      set(sphere, "center", words(s.center));
      set(sphere, "radius", fmt::format("{}", s.radius));
    }
  }
  root->InsertEndChild(document.NewComment(fmt::format(" {} ", ignored_note(d)).c_str()));
  std::set<std::pair<std::string, std::string>> there;
  constexpr const char* element = "disable_collisions";
  for (XMLElement* at = root->FirstChildElement(element); at != nullptr; at = at->NextSiblingElement(element)) {
    const char *a = at->Attribute("link1"), *b = at->Attribute("link2");
    if (a != nullptr && b != nullptr) there.insert({a, b}), there.insert({b, a});
  }
  for (const IgnoredPair& pair : d.self_collision.ignored) {
    const std::string &a = d.robot.links[pair.a].name, &b = d.robot.links[pair.b].name;
    if (there.count({a, b}) != 0) continue;
    XMLElement* at = add_element(root, element);
    set(at, "link1", a);
    set(at, "link2", b);
    set(at, "reason", std::string(name(pair.reason)));
    set(at, "detail", reason_text(d, pair.reason));  // readers ignore unknown attributes
  }
  return xml_text(document, d);
}

}  // namespace

std::vector<OutputFile> write_urdf(const Description& d) {
  return {{identifier(d.robot.name) + "_spherized.urdf", urdf_text(d, "")}};
}

std::vector<OutputFile> write_srdf(const Description& d) {
  return {{identifier(d.robot.name) + ".srdf", srdf_text(d)}};
}

std::vector<OutputFile> write_vamp(const Description& d) {
  const std::string id = identifier(d.robot.name);
  // Paths are relative to the JSON.
  const Json json{{"name", id},
                  {"urdf", id + "_spherized.urdf"},
                  {"srdf", id + ".srdf"},
                  {"end_effector", tool_frames(d).front()},
                  {"resolution", 32},
                  {"template", "templates/fk_template.hh"},
                  {"subtemplates", Json::array({{{"name", "ccfk"}, {"template", "templates/ccfk_template.hh"}}})},
                  {"output", id + "_fk.hh"}};
  return {{"vamp/" + id + "_spherized.urdf", urdf_text(d, "vamp")},
          {"vamp/" + id + ".srdf", srdf_text(d)},
          {"vamp/" + id + ".json", json_text(json)}};
}

}  // namespace morula::robot
