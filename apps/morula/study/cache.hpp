// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Finished parts of a study, kept under the content of their settings: an interrupted study goes on where it stopped.
#pragma once

#include <filesystem>
#include <morula/tree/cover.hpp>
#include <optional>
#include <string>

#include "shared/report.hpp"

namespace morula::cli {

/// Several threads may ask and store at once, for different settings.
class StudyCache {
 public:
  /// Makes the folder. Throws FileError when it cannot.
  explicit StudyCache(std::filesystem::path folder);

  /// What was stored for exactly these settings; nothing when there is none, or it cannot be read.
  std::optional<Json> find(const std::string& stem, const Json& settings) const;
  /// Written whole or not at all.
  void store(const std::string& stem, const Json& settings, const Json& result) const;

  std::optional<Built> find_tree(const std::string& stem, const Json& settings, const Mesh& mesh) const;
  void store_tree(const std::string& stem, const Json& settings, const Built& built) const;

 private:
  std::filesystem::path path(const std::string& stem, const Json& settings, const char* extension) const;

  std::filesystem::path folder_;
};

}  // namespace morula::cli
