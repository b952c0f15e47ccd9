// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cache of a study: finished parts, stored under a hash of their settings, so that an interrupted study continues from
// them.
#pragma once

#include <filesystem>

namespace morula::study {

/// A folder of finished parts. Several threads and several studies may use it at once.
class Cache {
 public:
  /// Creates the folder. Throws FileError if this fails.
  explicit Cache(std::filesystem::path folder);
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace morula::study
