// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cache of a study: finished parts, kept under the content of their settings, so that an interrupted study goes on
// where it stopped.
#pragma once

#include <filesystem>

namespace morula::study {

/// A folder. Several threads, and several studies, may use it at once.
class Cache {
 public:
  /// Makes the folder. Throws FileError when it cannot.
  explicit Cache(std::filesystem::path folder);
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

}  // namespace morula::study
