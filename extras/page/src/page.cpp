// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <morula/page/page.hpp>
#include <morula/version.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "data.hpp"
#include "template.hpp"

namespace morula {
namespace {

using namespace page;

/// Keys keep the order of insertion.
using Json = nlohmann::ordered_json;

constexpr int page_format = 1;

/// The fault of joints, or null.
const char* fault_of(const PageJoints& joints, std::size_t vertices) {
  const std::size_t parts = joints.parts.size();
  for (const PageJoints::Part& part : joints.parts) {
    if (part.vertex_begin > part.vertex_end || part.vertex_end > vertices)
      return "a part has vertices that are not there";
  }
  std::vector<bool> carried(parts, false);
  for (std::size_t i = 0; i < joints.joints.size(); ++i) {
    const PageJoints::Joint& joint = joints.joints[i];
    if (joint.parent >= parts || joint.child >= parts || joint.parent == joint.child) return "a joint names no parts";
    if (carried[joint.child]) return "two joints carry one part";
    carried[joint.child] = true;
    const auto carries_parent = [&](const PageJoints::Joint& other) { return other.child == joint.parent; };
    if (std::any_of(joints.joints.begin() + static_cast<std::ptrdiff_t>(i), joints.joints.end(), carries_parent)) {
      return "a joint stands before the one that carries its parent";
    }
    if (joint.leader && *joint.leader >= joints.joints.size()) return "a joint follows one that is not there";
    std::size_t steps = 0;
    for (const PageJoints::Joint* at = &joint; at->leader; at = &joints.joints[*at->leader]) {
      if (*at->leader >= joints.joints.size() || ++steps > joints.joints.size()) return "joints follow each other";
    }
  }
  if (!joints.reasons.empty() && joints.reasons.size() != joints.ignored.size())
    return "not one reason per ignored pair";
  for (const std::array<std::size_t, 2>& pair : joints.ignored) {
    if (pair[0] >= pair[1] || pair[1] >= parts) return "a pair of parts is none";
  }
  return nullptr;
}

/// Rejects content that the page cannot show, ahead of any coding.
void check_content(const PageContent& content) {
  if (content.scenes.empty()) throw std::invalid_argument("a page needs at least one scene");
  for (std::size_t i = 0; i < content.motions.size(); ++i) {
    const PageMotion& motion = content.motions[i];
    const auto reject = [&](const char* what) {
      throw std::invalid_argument(fmt::format("motion {} of the page: {}", i, what));
    };
    if (motion.facets.empty() || motion.frames.empty()) reject("no facets or no frames");
    if (motion.frame_names.size() != motion.frames.size()) reject("not one name per frame");
    const std::size_t vertices = motion.frames.front().size();
    for (const std::vector<Vec3>& frame : motion.frames) {
      if (frame.size() != vertices) reject("frames differ in their number of vertices");
    }
    for (const Facet& facet : motion.facets) {
      if (*std::max_element(facet.begin(), facet.end()) >= vertices) reject("a facet names a vertex that is not there");
    }
    if (!motion.joints) continue;
    if (motion.frames.size() != 1) reject("joints move one frame, and there are more");
    if (const char* fault = fault_of(*motion.joints, vertices)) reject(fault);
  }
  for (std::size_t i = 0; i < content.scenes.size(); ++i) {
    const PageScene& scene = content.scenes[i];
    const auto reject = [&](const char* what) {
      throw std::invalid_argument(fmt::format("scene {} of the page: {}", i, what));
    };
    if (scene.motion >= content.motions.size()) reject("its motion is not there");
    const std::size_t frames = content.motions[scene.motion].frames.size();
    const std::size_t nodes = scene.rest.node_count();
    if (nodes == 0) reject("its tree has no nodes");
    if (scene.frames.size() != frames) reject("not as many frames as its motion");
    for (const std::vector<Sphere>& spheres : scene.frames) {
      if (spheres.size() != nodes) reject("not one sphere per node");
    }
    if (!scene.measured.empty() && scene.measured.size() != frames) reject("not measured in every frame");
    for (const std::vector<LevelMeasure>& levels : scene.measured) {
      if (levels.size() != scene.rest.level_count()) reject("not measured at every level");
    }
    if (!scene.empty_share.empty() && scene.empty_share.size() != frames) reject("empty shares miss a frame");
    for (const std::vector<float>& shares : scene.empty_share) {
      if (shares.size() != nodes) reject("not one empty share per node");
    }
    if (!scene.contacts.empty() && scene.contacts.size() != frames) reject("contacts miss a frame");
    if (!scene.patches.empty() && scene.patches.size() != frames) reject("patches miss a frame");
    for (const PagePatches& patches : scene.patches)
      for (const PagePatches::Patch& patch : patches.patches)
        for (const PagePatchFacet& part : patch.facets)
          if (part.facet >= content.motions[scene.motion].facets.size())
            reject("a patch has a facet that is not there");
    const std::optional<PageJoints>& joints = content.motions[scene.motion].joints;
    if (scene.parts.size() != (joints ? scene.rest.child_count[0] : 0)) reject("not one part per child of the root");
    for (const std::uint32_t part : scene.parts) {
      if (part >= joints->parts.size()) reject("a part is not there");
    }
  }
}

/// Null for an empty text.
Json parse_study(const std::string& text) {
  if (text.empty()) return nullptr;
  Json study = Json::parse(text, nullptr, false);
  const bool whole = study.is_object() && study.contains("claims") && study.contains("figures");
  if (!whole) throw std::invalid_argument("what the page is to show is not the JSON of a study (claims, figures)");
  return study;
}

/// JSON that may stand inside a <script> element.
std::string script_json(const Json& json) {
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  for (const char c : text) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string data_element(const std::string& id, const std::string& bytes) {
  return fmt::format("<script type=\"application/octet-stream\" id=\"{}\">{}</script>\n", id, base64(bytes));
}

Json bytes_json(const std::string& id, const std::string& bytes) {
  return {{"id", id}, {"bytes", bytes.size()}, {"checksum", checksum(bytes)}};
}

Json vector_json(const Vec3& v) {
  return Json::array({v.x, v.y, v.z});
}

/// A figure as [level][frame]; null if it is unknown.
template <class Figure>
Json by_level(const PageScene& scene, const Figure& figure) {
  Json levels = Json::array();
  for (std::size_t level = 0; level < scene.rest.level_count(); ++level) {
    Json frames = Json::array();
    for (const std::vector<LevelMeasure>& measured : scene.measured) {
      const std::optional<double> value = figure(measured[level]);
      frames.push_back(value && std::isfinite(*value) ? Json(*value) : Json(nullptr));
    }
    levels.push_back(std::move(frames));
  }
  return levels;
}

Json measured_json(const PageScene& scene) {
  if (scene.measured.empty()) return nullptr;
  using Value = std::optional<double>;
  return {{"looseness", by_level(scene, [](const LevelMeasure& m) { return m.looseness.looseness; })},
          {"uncovered_area", by_level(scene, [](const LevelMeasure& m) { return Value(m.coverage.uncovered_area); })},
          {"uncovered_distance",
           by_level(scene, [](const LevelMeasure& m) { return Value(m.coverage.uncovered_distance); })}};
}

/// Per frame the volume, depth and number of facets of every patch, and the number of segments.
Json patches_json(const PageScene& scene) {
  Json frames = nullptr;
  for (const PagePatches& patches : scene.patches) {
    Json volumes = Json::array(), depths = Json::array(), facets = Json::array();
    for (const PagePatches::Patch& patch : patches.patches) {
      volumes.push_back(patch.volume);
      depths.push_back(patch.depth);
      facets.push_back(patch.facets.size());
    }
    frames.push_back({{"volumes", volumes}, {"depths", depths}, {"facets", facets}, {"curves", patches.curves.size()}});
  }
  return frames;
}

Json spheres_json(const std::vector<Sphere>& spheres) {
  Json list = Json::array();
  for (const Sphere& s : spheres) list.push_back({s.center.x, s.center.y, s.center.z, s.radius});
  return list;
}

Json joints_json(const PageJoints& joints) {
  Json parts = Json::array(), list = Json::array();
  for (const PageJoints::Part& part : joints.parts) {
    parts.push_back({{"name", part.name},
                     {"vertices", {part.vertex_begin, part.vertex_end}},
                     {"protrusion", part.protrusion ? Json(*part.protrusion) : Json(nullptr)},
                     {"spheres", spheres_json(part.spheres)},
                     {"balls", spheres_json(part.balls)}});
  }
  for (const PageJoints::Joint& joint : joints.joints) {
    constexpr std::array kinds{"fixed", "turns", "slides"};
    Json rows = Json::array();
    for (const Vec3& row : joint.origin.rows) rows.push_back(vector_json(row));
    list.push_back({{"name", joint.name},
                    {"kind", kinds[static_cast<std::size_t>(joint.kind)]},
                    {"parent", joint.parent},
                    {"child", joint.child},
                    {"rows", rows},
                    {"translation", vector_json(joint.origin.translation)},
                    {"axis", vector_json(joint.axis)},
                    {"lower", joint.lower},
                    {"upper", joint.upper},
                    {"rest", joint.rest},
                    {"leader", joint.leader ? Json(*joint.leader) : Json(nullptr)},
                    {"factor", joint.factor},
                    {"offset", joint.offset}});
  }
  return {{"parts", parts},
          {"joints", list},
          {"ignored", joints.ignored},
          {"reasons", joints.reasons},
          {"command", joints.command}};
}

struct Packer {
  Json motions = Json::array();
  Json scenes = Json::array();
  std::string elements;
  std::vector<Vec3> origins;

  void add(const PageMotion& motion) {
    const std::string id = fmt::format("morula-motion-{}", motions.size());
    const Quantization grid = quantization(motion.facets, motion.frames);
    PackedBytes packed;
    pack_facets(packed, motion.facets);
    pack_positions(packed, grid, motion.frames);
    motions.push_back({{"body", motion.body},
                       {"name", motion.name},
                       {"vertices", motion.frames.front().size()},
                       {"facets", motion.facets.size()},
                       {"frames", motion.frame_names},
                       {"origin", vector_json(grid.origin)},
                       {"step", vector_json(grid.step)},
                       {"joints", motion.joints ? joints_json(*motion.joints) : Json(nullptr)},
                       {"data", bytes_json(id, packed.bytes())}});
    elements += data_element(id, packed.bytes());
    origins.push_back(grid.origin);
  }

  void add(const PageScene& scene) {
    const std::string id = fmt::format("morula-scene-{}", scenes.size());
    PackedBytes packed;
    pack_spheres(packed, origins[scene.motion], scene.rest.spheres);
    for (const std::vector<Sphere>& frame : scene.frames) pack_spheres(packed, origins[scene.motion], frame);
    for (const std::vector<float>& shares : scene.empty_share) {
      for (const float share : shares) {
        packed.add_uint16(static_cast<std::uint16_t>(std::lround(std::clamp(share, 0.0f, 1.0f) * 65535.0f)));
      }
    }
    Json contact_counts = nullptr;
    for (const std::vector<PageContact>& contacts : scene.contacts) {
      contact_counts.push_back(contacts.size());
      pack_contacts(packed, origins[scene.motion], contacts);
    }
    for (const PagePatches& patches : scene.patches) pack_patches(packed, origins[scene.motion], patches);
    scenes.push_back({{"motion", scene.motion},
                      {"tree", scene.tree},
                      {"rule", scene.rule},
                      {"branching", scene.rest.branching},
                      {"level_begin", scene.rest.level_begin},
                      {"child_count", scene.rest.child_count},
                      {"empty_share", !scene.empty_share.empty()},
                      {"measured", measured_json(scene)},
                      {"contacts", contact_counts},
                      {"patches", patches_json(scene)},
                      {"parts", scene.parts},
                      {"inside", scene.inside},
                      {"data", bytes_json(id, packed.bytes())}});
    elements += data_element(id, packed.bytes());
  }
};

}  // namespace

bool has_page() {
  return why_no_page().empty();
}

std::string why_no_page() {
  return page::why_no_template();
}

std::string make_page(const PageContent& content) {
  if (!has_page()) throw std::runtime_error(fmt::format("Morula was built without its page: {}", why_no_page()));
  check_content(content);
  const Json study = parse_study(content.study);
  Packer packer;
  for (const PageMotion& motion : content.motions) packer.add(motion);
  for (const PageScene& scene : content.scenes) packer.add(scene);
  const Json manifest{{"format", page_format},     {"morula", version},       {"title", content.title},
                      {"motions", packer.motions}, {"scenes", packer.scenes}, {"study", study}};

  std::string page = page_template();
  const std::string mark = page_data_mark;
  const std::size_t place = page.find(mark);
  if (place == std::string::npos) throw std::logic_error("the page has no place for data");
  // The last element distinguishes a whole file from a truncated one.
  std::string data =
      fmt::format("<script type=\"application/json\" id=\"morula-manifest\">{}</script>\n{}{}", script_json(manifest),
                  packer.elements, "<script type=\"application/json\" id=\"morula-end\">true</script>");
  page.replace(place, mark.size(), data);
  return page;
}

}  // namespace morula
