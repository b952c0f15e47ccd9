// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MuJoCo's XML: bodies become links, and joints of one body a chain. Default classes are looked up, not copied.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <morula/geometry/trigonometry.hpp>
#include <numbers>

#include "robot/read/assembly.hpp"

namespace morula::robot {

namespace {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

constexpr int deepest_body = 500, deepest_class = 64;
constexpr std::size_t most_classes = 10'000;

struct Default {
  const char* value;
  const XMLElement* at;
};
using Attributes = std::map<std::string_view, Default>;
/// What a class says about elements, by their names; those of the classes around it included.
using Class = std::map<std::string_view, Attributes>;

constexpr std::array default_elements{"geom", "joint", "mesh"};
constexpr std::array default_attributes{"type",   "class",    "pos",      "quat",    "axisangle",   "xyaxes", "zaxis",
                                        "euler",  "size",     "fromto",   "mesh",    "contype",     "group",  "axis",
                                        "range",  "limited",  "ref",      "refquat", "conaffinity", "scale",  "refpos",
                                        "hfield", "fitscale", "material", "file",    "builtin",     "vertex"};
constexpr std::array turns{"quat", "axisangle", "xyaxes", "zaxis", "euler"};

/// An element, and the class that says what it does not say itself.
struct Element {
  const XMLElement& own;
  const Attributes* defaults = nullptr;

  const char* find(const char* attribute) const {
    if (const char* value = own.Attribute(attribute)) return value;
    if (defaults == nullptr) return nullptr;
    const auto found = defaults->find(attribute);
    return found == defaults->end() ? nullptr : found->second.value;
  }
};

RigidTransform from_matrix_columns(const Vec3& x, const Vec3& y, const Vec3& z) {
  return {.rows = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}}};
}

/// The least turn that takes z to a direction.
RigidTransform z_to(const Vec3& direction) {
  const Vec3 to = normalized(direction);
  const Vec3 axis = cross({0, 0, 1}, to);
  const double sine = length(axis);
  if (sine < 1e-10) return to.z > 0 ? RigidTransform{} : RigidTransform::from_axis({1, 0, 0}, std::numbers::pi);
  return RigidTransform::from_axis(axis, angle_of(sine, to.z));
}

class MjcfReader {
 public:
  MjcfReader(const Xml& xml, const ReadOptions& options) : main_(xml), options_(options) {
    files_[xml.root().GetDocument()] = &xml;
    robot().file = xml.file();
    robot().format = Robot::Format::mjcf;
    const char* name = xml.root().Attribute("model");
    robot().name = name == nullptr || *name == '\0' ? xml.file().stem().string() : name;
  }

  Robot run() {
    const std::vector<const XMLElement*> sections = children(main_.root());
    const auto each = [&](std::string_view name, const auto& read) {
      for (const XMLElement* at : sections) {
        if (at->Name() == name) read(*at);
      }
    };
    each("compiler", [&](const XMLElement& at) { read_compiler(at); });
    classes_["main"];
    each("default", [&](const XMLElement& at) { read_default(at, "main", 0); });
    each("asset", [&](const XMLElement& at) { read_assets(at); });
    each("contact", [&](const XMLElement& at) { read_contacts(at); });
    each("deformable", [&](const XMLElement& at) { refuse_children(at); });
    each("worldbody", [&](const XMLElement& at) { reserve_names(at, 0); });
    Link world;
    world.name = "world";
    assembly_.reserve_link(world.name);
    world.line = main_.root().GetLineNum();
    robot().links.push_back(std::move(world));
    each("worldbody", [&](const XMLElement& at) { add_children(at, 0, {}, "main", 0); });
    if (robot().links.size() == 1) take_world(sections);
    each("equality", [&](const XMLElement& at) { read_equalities(at); });
    drop_world();
    if (scenery_ > 0) {
      robot().notes.push_back(fmt::format("{} of the world itself {} not of the robot and passed over",
                                          scenery_ == 1 ? std::string("a geom") : fmt::format("{} geoms", scenery_),
                                          scenery_ == 1 ? "is" : "are"));
    }
    if (loops_ > 0) {
      robot().notes.push_back(fmt::format("{} of <equality> that close loops or tie bodies are not kept", loops_));
    }
    require_no_mimic_circle(robot());
    arrange(robot());
    return std::move(robot());
  }

 private:
  Robot& robot() { return assembly_.robot; }

  // Files.

  const Xml& file_of(const XMLElement& at) const { return *files_.at(at.GetDocument()); }
  [[noreturn]] void fail(const XMLElement& at, const std::string& text) const { file_of(at).fail(at, text); }

  /// Included files stand in the place of what includes them.
  std::vector<const XMLElement*> children(const XMLElement& of) {
    std::vector<const XMLElement*> result;
    for (const XMLElement* at = of.FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
      if (std::string_view(at->Name()) != "include") {
        result.push_back(at);
        continue;
      }
      const std::vector<const XMLElement*> more = children(included(*at).root());
      result.insert(result.end(), more.begin(), more.end());
    }
    return result;
  }

  const Xml& included(const XMLElement& at) {
    if (const auto found = includes_.find(&at); found != includes_.end()) return *found->second;
    const std::string name = file_of(at).text(at, "file");
    const fs::path written(name);
    // Descriptions that share parts lie side by side.
    const auto leaves = [&](const fs::path& from) {
      const fs::path way = (from / written).lexically_normal().lexically_relative(main_.file().parent_path());
      return way.empty() || (*way.begin() == ".." && way.has_parent_path() && *std::next(way.begin()) == "..");
    };
    if (written.is_absolute() || leaves(main_.file().parent_path()) || leaves(file_of(at).file().parent_path())) {
      fail(at,
           fmt::format(
               "file \"{}\" leaves the folder around that of the robot's file, which is not followed: copy it there",
               name));
    }
    // Relative to the robot's file, or to the one that includes it.
    fs::path path = (main_.file().parent_path() / written).lexically_normal();
    const fs::path beside = (file_of(at).file().parent_path() / written).lexically_normal();
    std::error_code error;
    if (!fs::is_regular_file(path, error) && !fs::is_regular_file(beside, error)) {
      fail(at, fmt::format("file \"{}\" is missing; searched: {}{}", name, path.string(),
                           beside == path ? "" : " " + beside.string()));
    }
    if (!fs::is_regular_file(path, error)) path = beside;
    const fs::path plain = fs::weakly_canonical(path);
    if (plain == fs::weakly_canonical(main_.file()) || !included_.insert(plain).second) {
      fail(at, fmt::format("file \"{}\" is included a second time, or includes itself", name));
    }
    owned_.push_back(std::make_unique<Xml>(path));
    const Xml& xml = *owned_.back();
    files_[xml.root().GetDocument()] = &xml;
    includes_[&at] = &xml;
    robot().included.push_back(path);
    const std::string_view root = xml.root().Name();
    if (root != "mujoco" && root != "mujocoinclude") {
      xml.fail(xml.root(), fmt::format("begins with <{}>, not with <mujocoinclude> or <mujoco>", root));
    }
    return xml;
  }

  // Attributes.

  std::vector<double> numbers(const Element& e, const char* attribute, std::size_t least, std::size_t most) const {
    std::vector<double> values;
    const char* text = e.find(attribute);
    if (text == nullptr || !read_numbers(text, values) || values.size() < least || values.size() > most) {
      fail(e.own,
           fmt::format("{}=\"{}\" of <{}> is not {} numbers", attribute, text == nullptr ? "" : text, e.own.Name(),
                       least == most ? std::to_string(least) : fmt::format("{} to {}", least, most)));
    }
    return values;
  }
  std::vector<double> numbers(const Element& e, const char* attribute, std::size_t count) const {
    return numbers(e, attribute, count, count);
  }
  Vec3 vector(const Element& e, const char* attribute, const Vec3& fallback) const {
    if (e.find(attribute) == nullptr) return fallback;
    const std::vector<double> v = numbers(e, attribute, 3);
    return {v[0], v[1], v[2]};
  }
  double number(const Element& e, const char* attribute, double fallback) const {
    return e.find(attribute) == nullptr ? fallback : numbers(e, attribute, 1)[0];
  }
  bool is_true(const Element& e, const char* attribute, bool fallback) const {
    const char* value = e.find(attribute);
    if (value == nullptr) return fallback;
    const std::string_view text = value;
    if (text != "true" && text != "false") {
      fail(e.own, fmt::format("{}=\"{}\" of <{}> is neither true nor false", attribute, text, e.own.Name()));
    }
    return text == "true";
  }
  double angle(double value) const { return degrees_ ? value * std::numbers::pi / 180 : value; }

  Element element(const XMLElement& at, const std::string& child_class) const {
    const char* name = at.Attribute("class");
    const auto found = classes_.find(name == nullptr ? child_class : std::string(name));
    if (found == classes_.end())
      fail(at, fmt::format("there is no default class {}", name == nullptr ? child_class : name));
    const auto kind = found->second.find(at.Name());
    return {at, kind == found->second.end() ? nullptr : &kind->second};
  }

  RigidTransform turn(const Element& e) const {
    const char* given = nullptr;
    for (const char* name : turns) {
      if (e.own.Attribute(name) == nullptr) continue;
      if (given != nullptr)
        fail(e.own, fmt::format("both {} and {} turn one <{}>: leave out one", given, name, e.own.Name()));
      given = name;
    }
    for (const char* name : turns) {
      if (given == nullptr && e.find(name) != nullptr) given = name;
    }
    if (given == nullptr) return {};
    const std::string_view kind = given;
    const auto nothing = [&] { fail(e.own, fmt::format("{} of <{}> gives no direction", kind, e.own.Name())); };
    if (kind == "quat") {
      const std::vector<double> q = numbers(e, "quat", 4);
      if (!(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] > 0)) nothing();
      return RigidTransform::from_quaternion(q[0], q[1], q[2], q[3]);
    }
    if (kind == "axisangle") {
      const std::vector<double> a = numbers(e, "axisangle", 4);
      const Vec3 axis{a[0], a[1], a[2]};
      if (!(length(axis) > 0)) nothing();
      return RigidTransform::from_axis(axis, angle(a[3]));
    }
    if (kind == "zaxis") {
      const Vec3 z = vector(e, "zaxis", {});
      if (!(length(z) > 0)) nothing();
      return z_to(z);
    }
    if (kind == "xyaxes") {
      const std::vector<double> a = numbers(e, "xyaxes", 6);
      const Vec3 x = normalized(Vec3{a[0], a[1], a[2]});
      Vec3 y{a[3], a[4], a[5]};
      y = y - dot(x, y) * x;
      if (!(length(x) > 0 && length(y) > 0)) nothing();
      y = normalized(y);
      return from_matrix_columns(x, y, cross(x, y));
    }
    const Vec3 angles = vector(e, "euler", {});
    RigidTransform result;
    for (int i = 0; i < 3; ++i) {
      const char letter = sequence_[static_cast<std::size_t>(i)];
      Vec3 axis;
      axis[std::tolower(static_cast<unsigned char>(letter)) - 'x'] = 1;
      const RigidTransform step = RigidTransform::from_axis(axis, angle(angles[i]));
      // Small letters turn about axes that have moved, large ones about those that stay.
      result = letter >= 'x' ? composed(result, step) : composed(step, result);
    }
    return result;
  }

  RigidTransform pose(const Element& e) const {
    RigidTransform result = turn(e);
    result.translation = vector(e, "pos", {});
    return result;
  }

  // Sections.

  void read_compiler(const XMLElement& at) {
    const Element e{at};
    if (const char* unit = e.find("angle")) {
      const std::string_view text = unit;
      if (text != "degree" && text != "radian")
        fail(at, fmt::format("angle=\"{}\" is neither degree nor radian", text));
      degrees_ = text == "degree";
    }
    if (const char* text = e.find("coordinate"); text != nullptr && std::string_view(text) != "local") {
      fail(at, fmt::format("coordinate=\"{}\" is not supported: write poses relative to what is around", text));
    }
    if (const char* text = e.find("eulerseq")) {
      sequence_ = text;
      if (sequence_.size() != 3 || sequence_.find_first_not_of("xyzXYZ") != std::string::npos) {
        fail(at, fmt::format("eulerseq=\"{}\" is not three of the letters xyzXYZ", text));
      }
    }
    auto_limits_ = is_true(e, "autolimits", auto_limits_);
    strip_path_ = is_true(e, "strippath", strip_path_);
    if (const char* folder = e.find("assetdir")) mesh_folder_ = folder;
    if (const char* folder = e.find("meshdir")) mesh_folder_ = folder;
  }

  void read_default(const XMLElement& at, const std::string& parent, int depth) {
    if (depth > deepest_class) fail(at, "default classes are nested more than 64 deep");
    const char* own = at.Attribute("class");
    if (depth > 0 && own == nullptr) fail(at, "a <default> in another has no class");
    // The outermost is called main, whatever older files say.
    const std::string name = depth > 0 ? own : "main";
    if (depth > 0) {
      if (classes_.size() >= most_classes) fail(at, "there are more than 10,000 default classes");
      if (!classes_.emplace(name, classes_[parent]).second) {
        fail(at, fmt::format("there are two default classes {}", name));
      }
    }
    const std::vector<const XMLElement*> all = children(at);
    for (const XMLElement* it : all) {
      if (std::find(default_elements.begin(), default_elements.end(), std::string_view(it->Name())) ==
          default_elements.end()) {
        continue;
      }
      Attributes& attributes = classes_[name][it->Name()];
      const bool turned =
          std::any_of(turns.begin(), turns.end(), [&](const char* t) { return it->Attribute(t) != nullptr; });
      for (const char* t : turns) {
        if (turned) attributes.erase(t);
      }
      for (const char* attribute : default_attributes) {
        if (const char* value = it->Attribute(attribute)) attributes[attribute] = {value, it};
      }
    }
    if (depth == 0 && own != nullptr && name != own) classes_[own] = classes_[name];
    for (const XMLElement* it : all) {
      if (std::string_view(it->Name()) == "default") read_default(*it, name, depth + 1);
    }
  }

  struct MeshAsset {
    std::string file;
    Vec3 scale{1, 1, 1};
    RigidTransform before{};
    bool operator==(const MeshAsset&) const = default;
  };

  void read_assets(const XMLElement& of) {
    for (const XMLElement* at : children(of)) {
      if (std::string_view(at->Name()) != "mesh") continue;
      const Element e = element(*at, "main");
      MeshAsset mesh;
      std::string name;
      if (const char* file = e.find("file")) mesh.file = file;
      if (const char* own = at->Attribute("name")) {
        name = own;
      } else {
        name = fs::path(mesh.file).stem().string();
      }
      if (name.empty()) fail(*at, "a <mesh> has neither name nor file");
      mesh.scale = vector(e, "scale", {1, 1, 1});
      if (mesh.scale.x == 0 || mesh.scale.y == 0 || mesh.scale.z == 0) {
        fail(*at, "a mesh is scaled by 0, which leaves nothing of it");
      }
      if (e.find("refquat") != nullptr) {
        const std::vector<double> q = numbers(e, "refquat", 4);
        mesh.before = RigidTransform::from_quaternion(q[0], q[1], q[2], q[3]);
      }
      mesh.before.translation = vector(e, "refpos", {});
      mesh.before = inverse(mesh.before);
      const auto [known, fresh] = meshes_.emplace(name, std::pair{mesh, at});
      if (!fresh && !(known->second.first == mesh)) fail(*at, fmt::format("there are two meshes {}", name));
    }
  }

  void refuse_children(const XMLElement& of) {
    for (const XMLElement* at : children(of)) {
      if (std::string_view(at->Name()) == "skin") continue;  // is seen and touches nothing
      fail(*at, fmt::format("<{}> of <{}> is not supported: take it out of the robot's file", at->Name(), of.Name()));
    }
  }

  void read_contacts(const XMLElement& of) {
    for (const XMLElement* at : children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "exclude") {
        robot().ignored.push_back({file_of(*at).text(*at, "body1"), file_of(*at).text(*at, "body2")});
      } else if (kind == "pair") {
        for (const char* side : {"geom1", "geom2"}) {
          if (const char* name = at->Attribute(side)) paired_.insert(name);
        }
      }
    }
  }

  void reserve_names(const XMLElement& of, int depth) {
    if (depth > deepest_body) fail(of, "bodies are nested more than 500 deep");
    for (const XMLElement* at : children(of)) {
      const std::string_view kind = at->Name();
      if (const char* name = at->Attribute("name"); name != nullptr && *name != '\0') {
        std::set<std::string>* names = kind == "body"                           ? &body_names_
                                       : kind == "joint" || kind == "freejoint" ? &joint_names_
                                                                                : nullptr;
        if (names != nullptr && !names->insert(name).second) {
          fail(*at, fmt::format("there are two {} {}", kind == "body" ? "bodies" : "joints", name));
        }
        if (kind == "body" && std::string_view(name) == "world") fail(*at, "a <body> is called world, as the world is");
        if (kind == "body") assembly_.reserve_link(name);
        if (names == &joint_names_) assembly_.reserve_joint(name);
      }
      if (kind == "body" || kind == "frame") reserve_names(*at, depth + 1);
    }
  }

  // Bodies.

  struct Body {
    std::size_t link;
    RigidTransform pose;
    std::vector<Movement> movements{};
    bool free = false;
  };

  void add_body(const XMLElement& at, std::size_t parent, const RigidTransform& frame, std::string child_class,
                int depth) {
    if (const char* own = at.Attribute("childclass")) child_class = own;
    require_class(at, child_class);
    Link link;
    const char* name = at.Attribute("name");
    link.name = name != nullptr && *name != '\0' ? name : assembly_.fresh_link("body");
    link.line = at.GetLineNum();
    Body body{robot().links.size(), composed(frame, pose({at}))};
    robot().links.push_back(std::move(link));
    // Joints stand before the bodies below in the chain, wherever they are written.
    add_own(at, body, {}, child_class, depth);
    if (body.free) {
      if (parent != 0 || !body.movements.empty()) {
        fail(at, "a free joint is the only joint of a body of the world itself, which this is not");
      }
      Joint joint;
      joint.name = assembly_.fresh_joint(robot().links[body.link].name + "_free");
      joint.kind = Joint::Kind::floating;
      joint.line = at.GetLineNum();
      joint.parent = parent, joint.child = body.link, joint.origin = body.pose;
      robot().links[body.link].joint = robot().joints.size();
      robot().joints.push_back(std::move(joint));
    } else {
      assembly_.carry(parent, body.link, body.pose, body.movements, at.GetLineNum());
    }
    add_children(at, body.link, {}, child_class, depth);
  }

  /// Joints, geoms and inertia of a body, those in frames included.
  void add_own(const XMLElement& of, Body& body, const RigidTransform& frame, const std::string& child_class,
               int depth) {
    if (depth > deepest_body) fail(of, "frames are nested more than 500 deep");
    for (const XMLElement* at : children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "joint" || kind == "freejoint") {
        add_joint(*at, body, frame, child_class);
      } else if (kind == "geom") {
        add_geom(*at, robot().links[body.link], frame, child_class);
      } else if (kind == "inertial") {
        robot().links[body.link].inertial = inertial(*at, frame);
      } else if (kind == "frame") {
        const std::string inner = at->Attribute("childclass") == nullptr ? child_class : at->Attribute("childclass");
        require_class(*at, inner);
        add_own(*at, body, composed(frame, pose({*at})), inner, depth + 1);
      } else if (kind != "body" && kind != "site" && kind != "camera" && kind != "light" && kind != "plugin") {
        fail(*at, fmt::format("<{}> is not supported: write out the bodies and geoms that it stands for", kind));
      }
    }
  }

  /// The bodies of a body or of the world, those in frames included.
  void add_children(const XMLElement& of, std::size_t link, const RigidTransform& frame, const std::string& child_class,
                    int depth) {
    if (depth > deepest_body) fail(of, "bodies are nested more than 500 deep");
    for (const XMLElement* at : children(of)) {
      const std::string_view kind = at->Name();
      if (kind == "body") {
        add_body(*at, link, frame, child_class, depth + 1);
      } else if (kind == "frame") {
        const std::string inner = at->Attribute("childclass") == nullptr ? child_class : at->Attribute("childclass");
        require_class(*at, inner);
        add_children(*at, link, composed(frame, pose({*at})), inner, depth + 1);
      } else if (link == 0) {
        if (kind == "geom") {
          ++scenery_;
        } else if (kind != "site" && kind != "camera" && kind != "light" && kind != "plugin") {
          fail(*at, fmt::format("<{}> in the world is not supported: write out the bodies that it stands for", kind));
        }
      }
    }
  }

  void require_class(const XMLElement& at, const std::string& name) const {
    if (classes_.find(name) == classes_.end()) fail(at, fmt::format("there is no default class {}", name));
  }

  void add_joint(const XMLElement& at, Body& body, const RigidTransform& frame, const std::string& child_class) {
    const Element e = element(at, child_class);
    const char* given = std::string_view(at.Name()) == "freejoint" ? "free" : e.find("type");
    const std::string_view type = given == nullptr ? "hinge" : given;
    if (type == "free") {
      body.free = true;
      return;
    }
    if (type == "fixed") {
      // Not MuJoCo's: other simulators read it in its files. A body without a joint is fixed anyway.
      robot().notes.push_back(
          fmt::format("a joint in {} (line {}) is fixed, which MuJoCo does not know: it is passed over",
                      robot().links[body.link].name, at.GetLineNum()));
      return;
    }
    if (type != "hinge" && type != "slide" && type != "ball") {
      fail(at, fmt::format("a joint is {}: hinge, slide, ball and free are known", type));
    }
    const char* own = at.Attribute("name");
    const std::string name =
        own != nullptr && *own != '\0' ? own : assembly_.fresh_joint(robot().links[body.link].name + "_joint");
    const Vec3 anchor = frame(vector(e, "pos", {}));
    if (type == "ball") {
      for (Movement& m : ball_movements(name, anchor, at.GetLineNum())) {
        m.name = assembly_.fresh_joint(m.name);
        body.movements.push_back(std::move(m));
      }
      if (e.find("range") != nullptr) {
        robot().notes.push_back(
            fmt::format("joint {} (line {}) is a ball with a limit, which three turns do not have: it turns freely",
                        name, at.GetLineNum()));
      }
      return;
    }
    const bool slides = type == "slide";
    Movement m{
        .name = name, .axis = frame.turn(vector(e, "axis", {0, 0, 1})), .anchor = anchor, .line = at.GetLineNum()};
    if (!(length(m.axis) > 0)) fail(at, fmt::format("joint {} has an axis of length 0", name));
    m.axis = normalized(m.axis);
    const auto in_unit = [&](double value) { return slides ? value : angle(value); };
    m.reference = in_unit(number(e, "ref", 0));
    joint_references_[name] = m.reference;
    std::vector<double> range{0, 0};
    if (e.find("range") != nullptr) range = numbers(e, "range", 2);
    bool limited = auto_limits_ && range[0] != range[1];
    if (const char* text = e.find("limited"); text != nullptr && std::string_view(text) != "auto") {
      limited = is_true(e, "limited", false);
    }
    if (limited) {
      m.kind = slides ? Joint::Kind::prismatic : Joint::Kind::revolute;
      m.lower = in_unit(range[0]), m.upper = in_unit(range[1]);
      if (!(m.lower < m.upper)) fail(at, fmt::format("range=\"{} {}\" of joint {} is empty", range[0], range[1], name));
    } else if (slides) {
      m.kind = Joint::Kind::prismatic;
      robot().notes.push_back(fmt::format("joint {} (line {}) has no limits and is taken to stay at 0", name, m.line));
    } else {
      m.kind = Joint::Kind::continuous;
      m.lower = -std::numbers::pi, m.upper = std::numbers::pi;
    }
    body.movements.push_back(std::move(m));
  }

  Inertial inertial(const XMLElement& at, const RigidTransform& frame) const {
    const Element e{at};
    Inertial result;
    result.mass = numbers(e, "mass", 1)[0];
    result.origin = composed(frame, pose(e));
    if (e.find("fullinertia") != nullptr) {
      const std::vector<double> m = numbers(e, "fullinertia", 6);
      result.inertia = {m[0], m[3], m[4], m[1], m[5], m[2]};
    } else if (e.find("diaginertia") != nullptr) {
      const std::vector<double> m = numbers(e, "diaginertia", 3);
      result.inertia = {m[0], 0, 0, m[1], 0, m[2]};
    }
    return result;
  }

  /// The first `count` numbers of size, which have to be above 0.
  std::vector<double> sizes(const Element& e, std::size_t count) const {
    if (e.find("size") == nullptr) fail(e.own, "a geom has no size");
    const std::vector<double> values = numbers(e, "size", count, 3);
    for (std::size_t i = 0; i < count; ++i) {
      if (!(values[i] > 0)) fail(e.own, fmt::format("size=\"{}\" of a geom is not above 0", e.find("size")));
    }
    return values;
  }

  void add_geom(const XMLElement& at, Link& link, const RigidTransform& frame, const std::string& child_class) {
    const Element e = element(at, child_class);
    const char* name = at.Attribute("name");
    const bool collides = number(e, "contype", 1) != 0 || number(e, "conaffinity", 1) != 0 ||
                          (name != nullptr && paired_.count(name) != 0);
    const double group = number(e, "group", 0);
    const bool seen = group >= 0 && group <= 2;
    const bool needed = options_.visual ? seen : collides;
    if (!collides && !seen) return;
    const char* given = e.find("type");
    std::string_view type = given == nullptr ? "sphere" : given;
    Shape shape;
    shape.line = at.GetLineNum();
    if (file_of(at).file() != main_.file()) shape.described_in = file_of(at).file();
    if (type == "plane" || type == "hfield" || type == "sdf") {
      if (!needed) return;
      if (type != "plane") {
        fail(at, fmt::format("a geom is a {}, which no spheres are made for: sphere, capsule, ellipsoid, cylinder, box "
                             "and mesh are known",
                             type));
      }
      robot().notes.push_back(endless_plane_note(link.name, at.GetLineNum()));
      return;
    }
    if (type != "mesh" && e.find("mesh") != nullptr) {
      // The fit would depend on the version that fits. The mesh is what the robot is.
      if (needed) {
        robot().notes.push_back(
            fmt::format("the {} that MuJoCo fits to mesh {} (line {}) is not made: the mesh itself is covered", type,
                        e.find("mesh"), at.GetLineNum()));
      }
      type = "mesh";
    }
    shape.origin = composed(frame, pose(e));
    std::optional<double> span;  // half of fromto
    if (e.find("fromto") != nullptr && type != "mesh" && type != "sphere") {
      const std::vector<double> v = numbers(e, "fromto", 6);
      const Vec3 from{v[0], v[1], v[2]}, to{v[3], v[4], v[5]};
      span = 0.5 * distance(from, to);
      if (!(*span > 0)) fail(at, "fromto of a geom names one point twice");
      RigidTransform own = z_to(from - to);
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
      if (asset == nullptr) fail(at, "a geom of type mesh names no mesh");
      const auto found = meshes_.find(asset);
      if (found == meshes_.end()) fail(at, fmt::format("there is no mesh {} in <asset>", asset));
      if (needed || !found->second.first.file.empty())
        set_mesh(shape, found->second.first, *found->second.second, needed);
      if (shape.file_name.empty()) return;
    } else {
      fail(at, fmt::format("a geom is a {}: sphere, capsule, ellipsoid, cylinder, box and mesh are known", type));
    }
    if (collides) link.collision.push_back(shape);
    if (seen) link.visual.push_back(std::move(shape));
  }

  void set_mesh(Shape& shape, const MeshAsset& mesh, const XMLElement& at, bool needed) const {
    if (mesh.file.empty()) {
      fail(at, "a mesh that is written out or built in is not supported: save it as OBJ or STL and name the file");
    }
    fs::path name = strip_path_ ? fs::path(mesh.file).filename() : fs::path(mesh.file);
    if (!mesh_folder_.empty()) name = fs::path(mesh_folder_) / name;
    shape.file_name = name.generic_string();
    shape.scale = mesh.scale;
    shape.before = mesh.before;
    if (!needed) return;
    try {
      shape.file = find_mesh(shape.file_name, main_.file(), options_.package_paths, at.GetLineNum());
    } catch (const FileError& error) {
      if (&file_of(at) == &main_) throw;
      fail(at, error.what());
    }
  }

  void read_equalities(const XMLElement& of) {
    for (const XMLElement* at : children(of)) {
      const Element e{*at};
      if (!is_true(e, "active", true)) continue;
      if (std::string_view(at->Name()) != "joint" || at->Attribute("joint1") == nullptr ||
          at->Attribute("joint2") == nullptr) {
        ++loops_;
        continue;
      }
      const std::size_t follower = robot().find_joint(at->Attribute("joint1")),
                        leader = robot().find_joint(at->Attribute("joint2"));
      std::vector<double> c{0, 1, 0, 0, 0};
      if (e.find("polycoef") != nullptr) {
        const std::vector<double> given = numbers(e, "polycoef", 1, 5);
        std::copy(given.begin(), given.end(), c.begin());
      }
      const bool curved = c[2] != 0 || c[3] != 0 || c[4] != 0;
      if (follower == none || leader == none || curved || robot().joints[follower].mimic) {
        robot().notes.push_back(fmt::format("joint {} (line {}) follows {} {}: it moves by itself",
                                            at->Attribute("joint1"), at->GetLineNum(), at->Attribute("joint2"),
                                            curved ? "along a curve" : "in a way that is not kept"));
        continue;
      }
      const double offset =
          c[0] + joint_references_[at->Attribute("joint1")] - c[1] * joint_references_[at->Attribute("joint2")];
      robot().joints[follower].mimic = Joint::Mimic{leader, c[1], offset};
    }
  }

  /// Of a file without bodies: a part or a prop, which others put somewhere.
  void take_world(const std::vector<const XMLElement*>& sections) {
    Body world{0, {}};
    for (const XMLElement* at : sections) {
      if (std::string_view(at->Name()) == "worldbody") add_own(*at, world, {}, "main", 0);
    }
    const Link& link = robot().links[0];
    if (!world.movements.empty() || world.free) fail(main_.root(), "there is a joint of the world itself");
    if (link.collision.empty() && link.visual.empty()) fail(main_.root(), "there is no <body> in a <worldbody>");
    robot().notes.push_back("there is no body: geoms of the world itself are taken for the only link");
    scenery_ = 0;
  }

  /// The world is left out where the robot is one body in its origin, or a free one.
  void drop_world() {
    Robot& r = robot();
    if (r.joints.empty()) return;
    const auto on_world = std::count_if(r.joints.begin(), r.joints.end(), [](const Joint& j) { return j.parent == 0; });
    const Joint& first = r.joints[0];
    const bool free = first.kind == Joint::Kind::floating;
    if (on_world != 1 || first.parent != 0 ||
        (!free && (first.kind != Joint::Kind::fixed || !(first.origin == RigidTransform{})))) {
      return;
    }
    if (free) {
      r.notes.push_back(fmt::format("{} moves freely: poses are given in its axes", r.links[first.child].name));
    }
    r.links.erase(r.links.begin());
    r.joints.erase(r.joints.begin());
    for (Joint& joint : r.joints) {
      --joint.parent, --joint.child;
      if (joint.mimic) --joint.mimic->joint;
    }
    for (Link& link : r.links) link.joint = link.joint == none || link.joint == 0 ? none : link.joint - 1;
  }

  const Xml& main_;
  const ReadOptions& options_;
  Assembly assembly_;
  std::map<const tinyxml2::XMLDocument*, const Xml*> files_;
  std::vector<std::unique_ptr<Xml>> owned_;
  std::map<const XMLElement*, const Xml*> includes_;
  std::set<fs::path> included_;
  std::map<std::string, Class> classes_;
  std::map<std::string, std::pair<MeshAsset, const XMLElement*>> meshes_;
  std::set<std::string> body_names_, joint_names_, paired_;
  std::map<std::string, double> joint_references_;
  std::string sequence_ = "xyz", mesh_folder_;
  bool degrees_ = true, auto_limits_ = true, strip_path_ = false;
  std::size_t scenery_ = 0, loops_ = 0;
};

}  // namespace

Robot read_mjcf(const Xml& xml, const ReadOptions& options) {
  return MjcfReader(xml, options).run();
}

}  // namespace morula::robot
