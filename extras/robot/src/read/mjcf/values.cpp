// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/mjcf/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <morula/geometry/reproducible.hpp>
#include <numbers>

#include "platform/path_text.hpp"
#include "read/file_names.hpp"

namespace morula::robot {

using tinyxml2::XMLElement;

namespace {

constexpr int deepest_class = 64;
constexpr std::size_t most_classes = 10'000;

constexpr std::array default_elements{"geom", "joint", "mesh"};
constexpr std::array default_attributes{"type",   "class",    "pos",      "quat",    "axisangle",   "xyaxes", "zaxis",
                                        "euler",  "size",     "fromto",   "mesh",    "contype",     "group",  "axis",
                                        "range",  "limited",  "ref",      "refquat", "conaffinity", "scale",  "refpos",
                                        "hfield", "fitscale", "material", "file",    "builtin",     "vertex"};
constexpr std::array orientation_names{"quat", "axisangle", "xyaxes", "zaxis", "euler"};

RigidTransform from_matrix_columns(const Vec3& x, const Vec3& y, const Vec3& z) {
  return {.rows = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}}};
}

}  // namespace

RigidTransform turn_z_to(const Vec3& direction) {
  const Vec3 to = normalized(direction);
  const Vec3 axis = cross({0, 0, 1}, to);
  const double sine = length(axis);
  if (sine < 1e-10) return to.z > 0 ? RigidTransform{} : RigidTransform::from_axis({1, 0, 0}, std::numbers::pi);
  return RigidTransform::from_axis(axis, angle_of(sine, to.z));
}

void MjcfValues::read_compiler(const XMLElement& at) {
  const MjcfElement e{at};
  if (const char* unit = e.find("angle")) {
    const std::string_view text = unit;
    if (text != "degree" && text != "radian")
      files_.fail(at, fmt::format("angle=\"{}\" is neither degree nor radian", text));
    degrees_ = text == "degree";
  }
  if (const char* text = e.find("coordinate"); text != nullptr && std::string_view(text) != "local") {
    files_.fail(at, fmt::format("coordinate=\"{}\" is not supported: write poses relative to the parent", text));
  }
  if (const char* text = e.find("eulerseq")) {
    sequence_ = text;
    if (sequence_.size() != 3 || sequence_.find_first_not_of("xyzXYZ") != std::string::npos) {
      files_.fail(at, fmt::format("eulerseq=\"{}\" is not three of the letters xyzXYZ", text));
    }
  }
  auto_limits_ = is_true(e, "autolimits", auto_limits_);
  strip_path_ = is_true(e, "strippath", strip_path_);
  align_free_ = is_true(e, "alignfree", align_free_);
  if (const char* folder = e.find("assetdir")) mesh_folder_ = folder;
  if (const char* folder = e.find("meshdir")) mesh_folder_ = folder;
}

void MjcfValues::read_default(const XMLElement& at, const std::string& parent, int depth) {
  if (depth > deepest_class) files_.fail(at, "default classes are nested more than 64 deep");
  const char* own = at.Attribute("class");
  if (depth > 0 && own == nullptr) files_.fail(at, "a <default> in another has no class");
  // The outermost is called main, regardless of older files.
  const std::string name = depth > 0 ? own : "main";
  if (depth > 0) {
    if (classes_.size() >= most_classes) files_.fail(at, "there are more than 10,000 default classes");
    if (!classes_.emplace(name, classes_[parent]).second) {
      files_.fail(at, fmt::format("there are two default classes {}", name));
    }
  }
  const std::vector<const XMLElement*> all = files_.children(at);
  for (const XMLElement* it : all) {
    if (std::find(default_elements.begin(), default_elements.end(), std::string_view(it->Name())) ==
        default_elements.end()) {
      continue;
    }
    MjcfAttributes& attributes = classes_[name][it->Name()];
    const bool turned = std::any_of(orientation_names.begin(), orientation_names.end(),
                                    [&](const char* t) { return it->Attribute(t) != nullptr; });
    for (const char* t : orientation_names) {
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

void MjcfValues::require_class(const XMLElement& at, const std::string& name) const {
  if (classes_.find(name) == classes_.end()) files_.fail(at, fmt::format("there is no default class {}", name));
}

std::vector<double> MjcfValues::numbers(const MjcfElement& e, const char* attribute, std::size_t least,
                                        std::size_t most) const {
  std::vector<double> values;
  const char* text = e.find(attribute);
  if (text == nullptr || !read_numbers(text, values) || values.size() < least || values.size() > most) {
    files_.fail(e.own,
                fmt::format("{}=\"{}\" of <{}> is not {} numbers", attribute, text == nullptr ? "" : text, e.own.Name(),
                            least == most ? std::to_string(least) : fmt::format("{} to {}", least, most)));
  }
  return values;
}

Vec3 MjcfValues::vector(const MjcfElement& e, const char* attribute, const Vec3& fallback) const {
  if (e.find(attribute) == nullptr) return fallback;
  const std::vector<double> v = numbers(e, attribute, 3);
  return {v[0], v[1], v[2]};
}

double MjcfValues::number(const MjcfElement& e, const char* attribute, double fallback) const {
  return e.find(attribute) == nullptr ? fallback : numbers(e, attribute, 1)[0];
}

bool MjcfValues::is_true(const MjcfElement& e, const char* attribute, bool fallback) const {
  const char* value = e.find(attribute);
  if (value == nullptr) return fallback;
  const std::string_view text = value;
  if (text != "true" && text != "false") {
    files_.fail(e.own, fmt::format("{}=\"{}\" of <{}> is neither true nor false", attribute, text, e.own.Name()));
  }
  return text == "true";
}

double MjcfValues::angle(double value) const {
  return degrees_ ? value * std::numbers::pi / 180 : value;
}

MjcfElement MjcfValues::element(const XMLElement& at, const std::string& child_class) const {
  const char* name = at.Attribute("class");
  const auto found = classes_.find(name == nullptr ? child_class : std::string(name));
  if (found == classes_.end())
    files_.fail(at, fmt::format("there is no default class {}", name == nullptr ? child_class : name));
  const auto kind = found->second.find(at.Name());
  return {at, kind == found->second.end() ? nullptr : &kind->second};
}

RigidTransform MjcfValues::turn_by_euler(const Vec3& angles) const {
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

RigidTransform MjcfValues::turn(const MjcfElement& e) const {
  const char* given = nullptr;
  for (const char* name : orientation_names) {
    if (e.own.Attribute(name) == nullptr) continue;
    if (given != nullptr)
      files_.fail(e.own, fmt::format("both {} and {} turn one <{}>: leave out one", given, name, e.own.Name()));
    given = name;
  }
  for (const char* name : orientation_names) {
    if (given == nullptr && e.find(name) != nullptr) given = name;
  }
  if (given == nullptr) return {};
  const std::string_view kind = given;
  const auto nothing = [&] { files_.fail(e.own, fmt::format("{} of <{}> gives no direction", kind, e.own.Name())); };
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
    return turn_z_to(z);
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
  return turn_by_euler(vector(e, "euler", {}));
}

RigidTransform MjcfValues::pose(const MjcfElement& e) const {
  RigidTransform result = turn(e);
  result.translation = vector(e, "pos", {});
  return result;
}

std::string MjcfValues::mesh_name(const std::string& file) const {
  // A path would lose one of the slashes of a URI.
  const std::string name = strip_path_ ? platform::text_of(platform::path_of(file).filename()) : file;
  if (mesh_folder_.empty() || name.find("://") != std::string::npos) return name;
  return name_of_path(platform::path_of(mesh_folder_) / platform::path_of(name));
}

}  // namespace morula::robot
