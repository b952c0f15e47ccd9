// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The robot's own files with spheres instead of shapes: URDF, SRDF, and both for VAMP.
#include <fmt/format.h>

#include <set>

#include "robot/read/xml.hpp"
#include "robot/write/text.hpp"

namespace morula::robot {

namespace {

using tinyxml2::XMLElement;

/// Names of meshes relative to the robot's file are written relative to where the copy will be.
void move_meshes(XMLElement& visual, const Description& d, const std::string& below) {
  XMLElement* geometry = visual.FirstChildElement("geometry");
  XMLElement* mesh = geometry == nullptr ? nullptr : geometry->FirstChildElement("mesh");
  const char* name = mesh == nullptr ? nullptr : mesh->Attribute("filename");
  if (name == nullptr) return;
  const std::string text = name;
  if (text.find("://") != std::string::npos || std::filesystem::path(text).is_absolute()) return;
  const std::filesystem::path from = std::filesystem::absolute(d.options.folder / below).lexically_normal();
  const std::filesystem::path to = (std::filesystem::absolute(d.robot.file).parent_path() / text).lexically_normal();
  set(mesh, "filename", to.lexically_relative(from).generic_string());
}

std::string urdf_text(const Description& d, const std::string& below) {
  Xml xml(d.robot.file, "robot");
  XMLElement* root = xml.document().RootElement();
  for (XMLElement* at = root->FirstChildElement("link"); at != nullptr; at = at->NextSiblingElement("link")) {
    while (XMLElement* old = at->FirstChildElement("collision")) at->DeleteChild(old);
    for (XMLElement* visual = at->FirstChildElement("visual"); visual != nullptr;
         visual = visual->NextSiblingElement("visual")) {
      move_meshes(*visual, d, below);
    }
    const LinkSpheres* link = d.spheres.of(d.robot.find_link(xml.text(*at, "name")));
    if (link == nullptr) continue;
    for (const Sphere& s : link->spheres) {
      XMLElement* collision = add_element(at, "collision");
      XMLElement* origin = add_element(collision, "origin");
      set(origin, "xyz", words(s.center));
      set(origin, "rpy", "0 0 0");
      set(add_element(add_element(collision, "geometry"), "sphere"), "radius", fmt::format("{}", s.radius));
    }
  }
  return xml_text(xml.document());
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
    // Without any element a reader makes one sphere round the link; one of radius 0 says that there is to be none.
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
  }
  return xml_text(document);
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
