// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lists of spheres as other fitters write them, and our own.
#include <fmt/format.h>

#include <fstream>
#include <morula/version.hpp>
#include <numeric>
#include <toolbox/csv.hpp>

#include "platform/path_text.hpp"
#include "write/text.hpp"

namespace morula::robot {

namespace {

constexpr std::uint64_t own_version = 1;  // of write_json

Json numbers(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Json centers(std::span<const Sphere> spheres) {
  Json list = Json::array();
  for (const Sphere& s : spheres) list.push_back(numbers(s.center));
  return list;
}

Json radii(std::span<const Sphere> spheres) {
  Json list = Json::array();
  for (const Sphere& s : spheres) list.push_back(s.radius);
  return list;
}

Json or_null(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

const std::vector<Shape>& shapes_of(const Description& d, const LinkSpheres& link) {
  const Link& own = d.robot.links[link.link];
  return own.collision.empty() ? own.visual : own.collision;
}

Json link_json(const Description& d, const LinkSpheres& link) {
  const LinkFigures& f = link.figures;
  const double scale = f.solid.volume > 0 ? f.mass / f.solid.volume : 0;
  Json inertia = Json::array();
  for (const double entry : f.solid.inertia) inertia.push_back(scale * entry);
  const auto list = [](std::span<const Sphere> spheres) {
    Json json = Json::array();
    for (const Sphere& s : spheres) json.push_back({{"center", numbers(s.center)}, {"radius", s.radius}});
    return json;
  };
  Json json{
      {"link", d.robot.links[link.link].name},
      {"same_shape_as", link.same_shape_as == none ? Json(nullptr) : Json(d.robot.links[link.same_shape_as].name)},
      {"facets", f.facets},
      {"covered", f.covered},
      {"within", f.within},
      {"uncovered_share", f.uncovered_share},
      {"uncovered_distance", f.uncovered_distance},
      {"protrusion", {{"mean", f.protrusion_mean}, {"p95", f.protrusion_p95}, {"max", f.protrusion_max}}},
      {"object_volume", or_null(f.object_volume)},
      {"outside_volume", or_null(f.outside_volume)},
      {"union_volume", f.solid.volume},
      {"mass", f.mass},
      {"center_of_mass", numbers(f.solid.center)},
      {"inertia", inertia},
      {"spheres", list(link.spheres)}};
  if (f.beyond_clip) json["beyond_clip"] = *f.beyond_clip;
  if (d.spheres.inner_count() > 0) {
    json["inner_volume"] = link.inner_volume;
    json["inner_spheres"] = list(link.inner);
  }
  return json;
}

}  // namespace

std::vector<OutputFile> write_foam(const Description& d) {
  Json json = Json::object();
  for (const LinkSpheres& link : d.spheres.links) {
    const std::vector<Shape>& shapes = shapes_of(d, link);
    const bool from_mesh = !shapes.empty() && shapes[0].kind == Shape::Kind::mesh;
    const std::string key =
        fmt::format("{}::{}", d.robot.links[link.link].name, from_mesh ? shapes[0].file_name : "primitive0");
    Json spheres = Json::array();
    for (const Sphere& s : link.spheres) spheres.push_back({{"origin", numbers(s.center)}, {"radius", s.radius}});
    json[key] = Json::array({{{"mean", link.figures.protrusion_mean},
                              {"best", 0.0},
                              {"worst", link.figures.protrusion_max},
                              {"spheres", spheres}}});
  }
  return {{"foam.json", json_text(json)}};
}

std::vector<OutputFile> write_ballpark(const Description& d) {
  Json json = Json::object();
  for (const LinkSpheres& link : d.spheres.links) {
    json[d.robot.links[link.link].name] = {{"centers", centers(link.spheres)}, {"radii", radii(link.spheres)}};
  }
  return {{"ballpark.json", json_text(json)}};
}

std::vector<OutputFile> write_morphit(const Description& d) {
  std::vector<OutputFile> files;
  for (const LinkSpheres& link : d.spheres.links) {
    const std::string& name = d.robot.links[link.link].name;
    // Each sphere gets its share of the link's mass, by volume: the sum is right for any overlaps.
    double all = 0;
    for (const Sphere& s : link.spheres) all += volume(s);
    Json masses = Json::array();
    for (const Sphere& s : link.spheres) masses.push_back(all > 0 ? link.figures.mass * volume(s) / all : 0.0);
    const std::vector<Shape>& shapes = shapes_of(d, link);
    const std::string mesh = shapes.empty() ? "" : shapes[0].file_name;
    files.push_back(
        {"morphit/" + identifier(name) + ".json",
         json_text({{"centers", centers(link.spheres)},
                    {"radii", radii(link.spheres)},
                    {"masses", masses},
                    {"mesh_path", mesh},
                    {"num_spheres", link.spheres.size()},
                    {"per_sphere_mass",
                     link.spheres.empty() ? 0.0 : link.figures.mass / static_cast<double>(link.spheres.size())},
                    {"config", {{"link", name}, {"generator", fmt::format("morula {}", version)}}}})});
  }
  return files;
}

std::vector<OutputFile> write_bubblify(const Description& d) {
  std::string text;
  for (const LinkSpheres& link : d.spheres.links) {
    for (const Sphere& s : link.spheres) {
      text += fmt::format("- link: {}\n  position: {}\n  radius: {}\n", quoted(d.robot.links[link.link].name),
                          decimals(s.center), decimal(s.radius));
    }
  }
  return {{"bubblify.yml", text.empty() ? "[]\n" : text}};
}

std::vector<OutputFile> write_csv(const Description& d) {
  std::string text = "link,x,y,z,radius\n";
  for (const LinkSpheres& link : d.spheres.links) {
    for (const Sphere& s : link.spheres) {
      text += fmt::format("{},{},{},{},{}\n", toolbox::csv_cell(d.robot.links[link.link].name), s.center.x, s.center.y,
                          s.center.z, s.radius);
    }
  }
  std::string links =
      "link,facets,spheres,covered,uncovered_distance,protrusion_mean,protrusion_p95,protrusion_max,object_volume,"
      "outside_volume,union_volume,mass,center_x,center_y,center_z,ixx,ixy,ixz,iyy,iyz,izz,within,uncovered_share\n";
  for (const LinkSpheres& link : d.spheres.links) {
    const LinkFigures& f = link.figures;
    const double scale = f.solid.volume > 0 ? f.mass / f.solid.volume : 0;
    const auto cell = [](const std::optional<double>& value) {
      return value ? fmt::format("{}", *value) : std::string();
    };
    links +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", toolbox::csv_cell(d.robot.links[link.link].name),
                    f.facets, link.spheres.size(), f.covered ? 1 : 0, f.uncovered_distance, f.protrusion_mean,
                    f.protrusion_p95, f.protrusion_max, cell(f.object_volume), cell(f.outside_volume), f.solid.volume,
                    f.mass, f.solid.center.x, f.solid.center.y, f.solid.center.z);
    for (const double entry : f.solid.inertia) links += fmt::format(",{}", scale * entry);
    links += fmt::format(",{},{}\n", f.within, f.uncovered_share);
  }
  return {{"spheres.csv", text}, {"links.csv", links}};
}

std::vector<OutputFile> write_json(const Description& d) {
  Json links = Json::array(), ignored = Json::array();
  for (const LinkSpheres& link : d.spheres.links) links.push_back(link_json(d, link));
  for (const IgnoredPair& pair : d.self_collision.ignored) {
    ignored.push_back(ignored_pair_json(d.robot, d.self_collision, pair));
  }
  const Json json{{"format", "morula robot spheres"},
                  {"format_version", own_version},
                  {"robot", d.robot.name},
                  {"covered", d.spheres.covered()},
                  {"within", d.spheres.within()},
                  {"uncovered_share", d.spheres.uncovered_share()},
                  {"spheres", d.spheres.sphere_count()},
                  {"links", links},
                  {"self_collision",
                   {{"samples", d.self_collision.samples},
                    {"seed", d.options.seed},
                    {"pairs", d.self_collision.pairs},
                    {"note", ignored_note(d)},
                    {"notes", d.self_collision.notes},
                    {"ignored", ignored},
                    {"overlapping", overlapping_json(d.robot, d.self_collision)}}}};
  return {{"spheres.json", json_text(json)}};
}

std::map<std::string, std::vector<Sphere>> read_robot_spheres(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path))
    throw FileError(fmt::format("{}: cannot be read", platform::text_of(path)));
  const auto fail = [&](const std::string& text) -> FileError {
    return FileError(fmt::format("{}: {}; give a spheres.json that morula robot wrote", platform::text_of(path), text));
  };
  try {
    const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
    if (json.is_discarded()) throw fail("is not JSON");
    const auto& given = json.at("format") == "morula robot spheres" ? json.at("format_version") : nlohmann::json();
    if (!given.is_number_unsigned() || given == 0) throw fail("has another format");
    if (given > own_version)
      throw FileError(
          fmt::format("{}: format version {} is newer than Morula {}, which reads versions up to {}; update Morula, or "
                      "write the file again with this version",
                      platform::text_of(path), given.dump(), morula::version, own_version));
    std::map<std::string, std::vector<Sphere>> result;
    for (const nlohmann::json& link : json.at("links")) {
      std::vector<Sphere>& spheres = result[link.at("link").get<std::string>()];
      for (const nlohmann::json& sphere : link.at("spheres")) {
        const nlohmann::json& c = sphere.at("center");
        const Sphere s{{c.at(0).get<double>(), c.at(1).get<double>(), c.at(2).get<double>()},
                       sphere.at("radius").get<double>()};
        if (!(s.radius > 0 && s.radius < 1e30 && max_norm(s.center) < 1e30))
          throw fail("has a sphere with a radius or center out of range");
        spheres.push_back(s);
      }
    }
    return result;
  } catch (const nlohmann::json::exception&) {
    throw fail("lacks a part of such a file");
  }
}

}  // namespace morula::robot
