// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/scene_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <morula/io/file_reference.hpp>
#include <numbers>
#include <optional>
#include <set>

#include "shared/command.hpp"
#include "shared/options.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

const std::vector<std::string> known_keys{"name", "mesh",   "tree",   "motion", "translate", "rotate",
                                          "path", "static", "groups", "meets",  "weight"};

/// A value in the file, and its name in messages.
class Place {
 public:
  Place(const Json& json, std::string name) : json_(&json), name_(std::move(name)) {}
  [[noreturn]] void reject(const std::string& why) const { throw UsageError(fmt::format("{}: {}", name_, why)); }

  bool has(const char* key) const { return json_->contains(key); }
  Place at(const char* key) const { return {(*json_)[key], fmt::format("{}.{}", name_, key)}; }
  Place at(std::size_t i) const { return {(*json_)[i], fmt::format("{}[{}]", name_, i)}; }
  std::size_t size() const { return json_->size(); }
  const Json& json() const { return *json_; }

  std::string text() const {
    if (!json_->is_string() || json_->get<std::string>().empty()) reject("give a text in quotes that is not empty");
    return json_->get<std::string>();
  }
  bool flag() const {
    if (!json_->is_boolean()) reject("give true or false");
    return json_->get<bool>();
  }
  double number() const {
    if (!json_->is_number() || !std::isfinite(json_->get<double>())) reject("give a number");
    return json_->get<double>();
  }
  std::vector<double> numbers(std::size_t count, const char* such_as) const {
    if (!json_->is_array() || json_->size() != count)
      reject(fmt::format("give {} numbers, such as {}", count, such_as));
    std::vector<double> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(at(i).number());
    return all;
  }
  Vec3 vector() const {
    const std::vector<double> v = numbers(3, "[0, 0.5, 0]");
    return {v[0], v[1], v[2]};
  }
  std::uint32_t mask() const {
    if (!json_->is_array()) reject("give a list of groups, such as [0, 2]");
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      const Json& group = (*json_)[i];
      if (!group.is_number_integer() || group.get<std::int64_t>() < 0 || group.get<std::int64_t>() > 31)
        at(i).reject("groups are the whole numbers from 0 to 31");
      mask |= std::uint32_t{1} << group.get<std::uint32_t>();
    }
    return mask;
  }

 private:
  const Json* json_;
  std::string name_;
};

Json parse(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw UsageError(fmt::format("{}: there is no such file, or it cannot be read", file.string()));
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    throw UsageError(fmt::format("{}: this cannot be read as JSON: {}", file.string(), error.what()));
  }
}

RigidTransform transform_of(const Place& body) {
  const Vec3 translation = body.has("translate") ? body.at("translate").vector() : Vec3{};
  if (!body.has("rotate")) return {.translation = translation};
  const std::vector<double> turn = body.at("rotate").numbers(4, "[0, 0, 1, 90]: an axis and degrees");
  Vec3 axis{turn[0], turn[1], turn[2]};
  if (axis == Vec3{}) body.at("rotate").reject("the axis has no direction: give one such as 0, 0, 1");
  axis = axis / max_norm(axis);
  return RigidTransform::from_axis(axis, std::fmod(turn[3], 360) * std::numbers::pi / 180, translation);
}

/// The folders of a scene's files.
struct SceneFolders {
  std::filesystem::path own;
  FileRoots roots;

  std::filesystem::path file(const Place& named) const {
    const std::filesystem::path path = referenced_file(named.text(), own);
    require_inside(named, path);
    return path;
  }
  /// A file, a folder of frames, or a pattern of their names.
  std::filesystem::path motion(const Place& named) const {
    std::filesystem::path path = file(named);
    std::error_code error;
    const bool is_pattern = !std::filesystem::exists(path, error);
    const std::filesystem::path folder = is_pattern ? path.parent_path() : path;
    if (is_pattern) require_inside(named, folder);
    for (std::filesystem::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
      if (it->is_symlink(error)) require_inside(named, it->path());
    }
    return path;
  }

 private:
  void require_inside(const Place& named, const std::filesystem::path& path) const {
    if (const std::optional<std::string> outside = roots.refusal(path, "--root")) {
      named.reject(fmt::format("{} {}", path.string(), *outside));
    }
  }
};

SceneFileBody body_of(const Place& place, std::size_t i, const SceneFolders& folders) {
  if (!place.json().is_object()) place.reject("give an object, such as {\"mesh\": \"box.obj\"}");
  for (const auto& [key, value] : place.json().items())
    if (std::find(known_keys.begin(), known_keys.end(), key) == known_keys.end()) {
      const std::string nearest = nearest_name(key, known_keys);
      place.reject(fmt::format("there is no key '{}'{}", key,
                               nearest.empty() ? std::string("; docs/how-to/scene.md lists them")
                                               : fmt::format("; did you mean '{}'?", nearest)));
    }
  if (!place.has("mesh")) place.reject("there is no mesh: give \"mesh\": \"FILE\"");
  SceneFileBody body;
  body.name = place.has("name") ? place.at("name").text() : fmt::format("body {}", i);
  body.mesh = folders.file(place.at("mesh"));
  if (place.has("tree")) body.tree = folders.file(place.at("tree"));
  if (place.has("motion")) body.motion = folders.motion(place.at("motion"));
  body.transform = transform_of(place);
  if (place.has("path")) {
    const Place path = place.at("path");
    if (!path.json().is_array() || path.size() == 0) path.reject("give a list of points, one per frame");
    for (std::size_t k = 0; k < path.size(); ++k) body.path.push_back(path.at(k).vector());
  }
  if (place.has("static")) body.is_static = place.at("static").flag();
  if (body.is_static && (!body.motion.empty() || !body.path.empty()))
    place.at("static").reject("a static body has neither motion nor path: leave them out, or say false");
  if (place.has("groups")) body.category = place.at("groups").mask();
  if (body.category == 0)
    place.at("groups").reject("a body without a group forms no pair: name one, or leave the key out");
  if (place.has("meets")) body.mask = place.at("meets").mask();
  if (place.has("weight")) body.weight = place.at("weight").number();
  if (body.weight < 0) place.at("weight").reject("weights are 0 or more");
  return body;
}

}  // namespace

std::vector<SceneFileBody> read_scene_file(const std::filesystem::path& file,
                                           const std::vector<std::filesystem::path>& roots) {
  const Json json = parse(file);
  const Place scene(json, file.string());
  if (!json.is_object() || !scene.has("bodies")) scene.reject("give an object with the key \"bodies\"");
  for (const auto& [key, value] : json.items())
    if (key != "bodies") scene.reject(fmt::format("there is no key '{}': a scene has \"bodies\"", key));
  const Place bodies(json["bodies"], fmt::format("{}: bodies", file.string()));
  if (!bodies.json().is_array() || bodies.size() == 0) bodies.reject("give a list of bodies");
  SceneFolders folders{.own = file.parent_path(), .roots = FileRoots(roots)};
  folders.roots.add(folders.own);
  std::vector<SceneFileBody> all;
  std::set<std::string> names;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    all.push_back(body_of(bodies.at(i), i, folders));
    if (!names.insert(all.back().name).second)
      bodies.at(i).reject(fmt::format("there are two bodies of the name '{}': give them others", all.back().name));
  }
  return all;
}

}  // namespace morula::cli
