// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/mjcf/files.hpp"

#include <fmt/format.h>

#include <optional>
#include <string_view>

#include "platform/path_text.hpp"

namespace morula::robot {

namespace fs = std::filesystem;
using tinyxml2::XMLElement;

MjcfFiles::MjcfFiles(const Xml& main, std::span<const fs::path> package_paths, std::vector<fs::path>& names)
    : main_(main), folders_(main.file(), package_paths), names_(names) {
  files_[main.root().GetDocument()] = &main;
}

std::vector<const XMLElement*> MjcfFiles::children(const XMLElement& of) {
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

const Xml& MjcfFiles::included(const XMLElement& at) {
  if (const auto found = includes_.find(&at); found != includes_.end()) return *found->second;
  const std::string name = file_of(at).text(at, "file");
  const fs::path path = find_included(at, name);
  const fs::path plain = fs::weakly_canonical(path);
  if (plain == fs::weakly_canonical(main_.file()) || !included_.insert(plain).second) {
    fail(at, fmt::format("file \"{}\" is included a second time, or includes itself", name));
  }
  owned_.push_back(std::make_unique<Xml>(path));
  const Xml& xml = *owned_.back();
  files_[xml.root().GetDocument()] = &xml;
  includes_[&at] = &xml;
  names_.push_back(path);
  const std::string_view root = xml.root().Name();
  if (root != "mujoco" && root != "mujocoinclude") {
    xml.fail(xml.root(), fmt::format("begins with <{}>, not with <mujocoinclude> or <mujoco>", root));
  }
  return xml;
}

fs::path MjcfFiles::find_included(const XMLElement& at, const std::string& name) const {
  const FileReference reference = parse_file_reference(name);
  if (!reference.scheme.empty())
    fail(at, fmt::format("file \"{}\" is not on this disk: save it next to this one", name));
  std::string searched;
  for (const std::string& spelling : reference.paths) {
    // Relative to the robot's file, or to the one that includes it.
    for (const Xml* from : {&main_, &file_of(at)}) {
      const fs::path path = (from->file().parent_path() / platform::path_of(spelling)).lexically_normal();
      std::error_code error;
      if (!fs::is_regular_file(path, error)) {
        if (const std::string text = " " + platform::text_of(path); searched.find(text) == std::string::npos)
          searched += text;
        continue;
      }
      const std::optional<std::string> outside = folders_.roots().refusal(path, root_option);
      // mutant robot-include-outside: `if (!outside) return` -> `return`
      if (!outside) return path;
      fail(at, fmt::format("file \"{}\" is {}, which {}", name, platform::text_of(path), *outside));
    }
  }
  fail(at, fmt::format("file \"{}\" is missing; searched:{}", name, searched));
}

}  // namespace morula::robot
