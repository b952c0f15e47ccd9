// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "baseline.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace morula::bench {
namespace {

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
  return cells;
}

}  // namespace

Baseline::Baseline(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  if (!std::getline(stream, line)) throw std::runtime_error(file.string() + ": cannot be read, or is empty");
  const std::vector<std::string> header = cells_of(line);
  std::array<std::size_t, 4> column{};
  constexpr std::array names{"mesh", "method", "level", "looseness"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    column[i] = static_cast<std::size_t>(std::find(header.begin(), header.end(), names[i]) - header.begin());
    if (column[i] == header.size())
      throw std::runtime_error(file.string() + ": has no column " + names[i] + " in its first line");
  }
  for (std::size_t number = 2; std::getline(stream, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.empty()) continue;
    try {
      looseness_[{cells.at(column[0]), std::stoul(cells.at(column[2])), cells.at(column[1])}] =
          std::stod(cells.at(column[3]));
    } catch (const std::logic_error&) {
      throw std::runtime_error(file.string() + ", line " + std::to_string(number) +
                               ": a level and a looseness expected");
    }
  }
}

std::optional<double> Baseline::same_method(const std::string& mesh, const std::string& method,
                                            std::size_t level) const {
  const auto found = looseness_.find({mesh, level, method});
  return found == looseness_.end() ? std::nullopt : std::optional(found->second);
}

std::optional<double> Baseline::best(const std::string& mesh, std::size_t level) const {
  std::optional<double> least;
  for (auto at = looseness_.lower_bound({mesh, level, ""}); at != looseness_.end(); ++at) {
    const auto& [of_mesh, of_level, method] = at->first;
    if (of_mesh != mesh || of_level != level) break;
    if (!least || at->second < *least) least = at->second;
  }
  return least;
}

std::vector<SummaryRow> build_summary(std::span<const Result> results) {
  std::vector<SummaryRow> rows;
  std::vector<std::vector<double>> values;
  for (const Result& result : results) {
    if (result.scenario != "build") continue;
    for (const Figure& figure : result.figures) {
      const bool wanted = figure.name == "user s" || figure.name.rfind("looseness", 0) == 0;
      if (!wanted) continue;
      auto row = std::find_if(rows.begin(), rows.end(),
                              [&](const SummaryRow& r) { return r.item == result.item && r.figure == figure.name; });
      if (row == rows.end()) {
        rows.push_back({result.item, figure.name, 0, 0, 0});
        values.emplace_back();
        row = rows.end() - 1;
      }
      values[static_cast<std::size_t>(row - rows.begin())].push_back(figure.value);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].meshes = values[i].size();
    rows[i].median = median(values[i]);
    rows[i].largest = *std::max_element(values[i].begin(), values[i].end());
  }
  if (std::none_of(rows.begin(), rows.end(), [](const SummaryRow& row) { return row.meshes > 1; })) return {};
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.item < b.item; });
  return rows;
}

}  // namespace morula::bench
