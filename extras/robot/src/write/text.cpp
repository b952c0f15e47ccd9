// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "write/text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <morula/version.hpp>

#include "read/xml.hpp"

namespace morula::robot {

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string decimal(double value) {
  char digits[400];  // the longest double without an exponent takes about 330 characters
  const std::to_chars_result written = std::to_chars(digits, digits + sizeof digits, value, std::chars_format::fixed);
  std::string text(digits, written.ptr);
  if (text.find('.') == std::string::npos) text += ".0";
  return text;
}

std::string decimals(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", decimal(v.x), decimal(v.y), decimal(v.z));
}

std::string words(const Vec3& v) {
  return fmt::format("{} {} {}", v.x, v.y, v.z);
}

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string quoted_list(std::span<const std::string> names) {
  std::vector<std::string> all;
  for (const std::string& name : names) all.push_back(quoted(name));
  return fmt::format("[{}]", fmt::join(all, ", "));
}

std::string identifier(const std::string& text) {
  std::string result = text;
  for (char& c : result) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  if (result.empty() || std::isdigit(static_cast<unsigned char>(result[0])) != 0) result.insert(0, "_");
  return result;
}

std::string made_note(const Description& d) {
  const char* what = d.options.inner ? "; they are inside the links and do not cover them" : "";
  // mutant robot-files-silent-on-tolerance: `!d.options.inner && !d.spheres.covered()` -> `false`
  const std::string bare =
      !d.options.inner && !d.spheres.covered()
          ? fmt::format("; they leave surface uncovered: every point of the links is proven to be within {} of them",
                        d.spheres.within())
          : std::string();
  return fmt::format("Spheres by morula {}{}{}", version, what, bare);
}

std::string xml_text(tinyxml2::XMLDocument& document, const Description& d) {
  if (document.FirstChild() == nullptr || document.FirstChild()->ToDeclaration() == nullptr) {
    document.InsertFirstChild(document.NewDeclaration());
  }
  document.InsertAfterChild(document.FirstChild(), document.NewComment(fmt::format(" {} ", made_note(d)).c_str()));
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return printer.CStr();
}

tinyxml2::XMLElement* add_element(tinyxml2::XMLNode* parent, const char* name) {
  tinyxml2::XMLElement* element = parent->GetDocument()->NewElement(name);
  parent->InsertEndChild(element);
  return element;
}

void set(tinyxml2::XMLElement* at, const char* attribute, const std::string& value) {
  at->SetAttribute(attribute, value.c_str());
}

std::string guess_tool(const Robot& robot) {
  std::vector<std::size_t> chain(robot.links.size(), 0);
  std::size_t best = robot.root;
  for (const std::size_t i : robot.order) {
    const Joint& joint = robot.joints[i];
    chain[joint.child] = chain[joint.parent] + (joint.moves() && !joint.mimic ? 1 : 0);
    if (chain[joint.child] > chain[best]) best = joint.child;
  }
  const std::size_t joint = robot.links[best].joint;
  if (joint == none) return robot.links[best].name;
  // Fingers move side by side.
  const std::size_t carrier = robot.joints[joint].parent;
  const auto fingers = std::count_if(robot.joints.begin(), robot.joints.end(),
                                     [&](const Joint& other) { return other.parent == carrier && other.moves(); });
  return robot.links[fingers > 1 ? carrier : best].name;
}

std::vector<std::string> tool_frames(const Description& d) {
  return d.options.tool_frames.empty() ? std::vector{guess_tool(d.robot)} : d.options.tool_frames;
}

std::vector<std::string> own_joint_names(const Robot& robot) {
  std::vector<std::string> names;
  for (const std::size_t joint : robot.independent_joints) names.push_back(robot.joints[joint].name);
  return names;
}

std::map<std::string, std::vector<std::string>> ignored_by_link(const Description& d) {
  std::map<std::string, std::vector<std::string>> result;
  for (const IgnoredPair& pair : d.self_collision.ignored) {
    result[d.robot.links[pair.a].name].push_back(d.robot.links[pair.b].name);
  }
  return result;
}

std::string ignored_note(const Description& d) {
  const auto count = [&](IgnoreReason reason) {
    return std::count_if(d.self_collision.ignored.begin(), d.self_collision.ignored.end(),
                         [&](const IgnoredPair& pair) { return pair.reason == reason; });
  };
  std::string text = fmt::format(
      "Ignored pairs: {} given, {} neighbors, {} whose surfaces touch at rest, {} proven to be apart in every "
      "configuration",
      count(IgnoreReason::given), count(IgnoreReason::adjacent), count(IgnoreReason::rest), count(IgnoreReason::apart));
  if (d.self_collision.samples == 0) return text + "; no configurations were sampled";
  return text + fmt::format(
                    ", {} apart in each of {} sampled configurations (seed {}): each of these meets in less than "
                    "{:.2g} of all configurations, with 95 % confidence, which is no proof",
                    count(IgnoreReason::never), d.self_collision.samples, d.options.seed,
                    d.self_collision.never_bound());
}

std::string reason_text(const Description& d, IgnoreReason reason) {
  switch (reason) {
    case IgnoreReason::given:
      return "given";
    case IgnoreReason::adjacent:
      return "neighbors";
    case IgnoreReason::rest:
      return "surfaces touch at rest";
    case IgnoreReason::apart:
      return "apart in every configuration, proven";
    case IgnoreReason::never:
      break;
  }
  return fmt::format("apart in {} sampled configurations, meets in less than {:.2g} of all (95 %)",
                     d.self_collision.samples, d.self_collision.never_bound());
}

Json ignored_pair_json(const Robot& robot, const SelfCollision& self_collision, const IgnoredPair& pair) {
  Json json{{"links", {robot.links[pair.a].name, robot.links[pair.b].name}}, {"reason", name(pair.reason)}};
  if (pair.reason == IgnoreReason::apart || pair.reason == IgnoreReason::never) {
    const bool proven = pair.reason == IgnoreReason::apart;
    json["proven"] = proven;
    json["meets_below"] = proven ? 0.0 : self_collision.never_bound();
  }
  return json;
}

Json overlapping_json(const Robot& robot, const SelfCollision& self_collision) {
  Json list = Json::array();
  for (const OverlappingPair& pair : self_collision.overlapping) {
    list.push_back({{"links", {robot.links[pair.a].name, robot.links[pair.b].name}},
                    {"rest_distance", pair.rest_distance ? Json(*pair.rest_distance) : Json(nullptr)},
                    {"share", pair.share}});
  }
  return list;
}

}  // namespace morula::robot
