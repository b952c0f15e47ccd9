// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Looseness of other trees for the same meshes, and what comes out over all meshes.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <tuple>

#include "scenario.hpp"

namespace morula::bench {

/// A CSV with the columns mesh, method, level and looseness; others are passed over.
class Baseline {
 public:
  /// Throws std::runtime_error, naming file and line.
  explicit Baseline(const std::filesystem::path& file);

  std::optional<double> same_method(const std::string& mesh, const std::string& method, std::size_t level) const;
  /// Of all methods in the file.
  std::optional<double> best(const std::string& mesh, std::size_t level) const;

 private:
  std::map<std::tuple<std::string, std::size_t, std::string>, double> looseness_;  // mesh, level, method
};

/// A figure over all meshes it is known for.
struct SummaryRow {
  std::string item;
  std::string figure;
  std::size_t meshes;
  double median, largest;
};
/// Of `build`: time, looseness and ratios per method and level; nothing for fewer than two meshes.
std::vector<SummaryRow> build_summary(std::span<const Result> results);

}  // namespace morula::bench
