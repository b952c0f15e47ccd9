// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The file of a robot and those that it includes.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "read/folders.hpp"
#include "read/xml.hpp"

namespace morula::robot {

class MjcfFiles {
 public:
  /// Names of files that are included are added to `names`.
  MjcfFiles(const Xml& main, std::span<const std::filesystem::path> package_paths,
            std::vector<std::filesystem::path>& names);

  const Xml& main() const { return main_; }
  const Xml& file_of(const tinyxml2::XMLElement& at) const { return *files_.at(at.GetDocument()); }
  [[noreturn]] void fail(const tinyxml2::XMLElement& at, const std::string& text) const { file_of(at).fail(at, text); }

  /// The children of an element; included files replace the elements that include them.
  std::vector<const tinyxml2::XMLElement*> children(const tinyxml2::XMLElement& of);

 private:
  const Xml& included(const tinyxml2::XMLElement& at);
  /// The file that an <include> means. Throws FileError where it is missing or may not be opened.
  std::filesystem::path find_included(const tinyxml2::XMLElement& at, const std::string& name) const;

  const Xml& main_;
  RobotFolders folders_;
  std::vector<std::filesystem::path>& names_;
  std::map<const tinyxml2::XMLDocument*, const Xml*> files_;
  std::vector<std::unique_ptr<Xml>> owned_;
  std::map<const tinyxml2::XMLElement*, const Xml*> includes_;
  std::set<std::filesystem::path> included_;
};

}  // namespace morula::robot
