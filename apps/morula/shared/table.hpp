// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Tables for people: aligned columns, UTF-8 aware.
#pragma once

#include <string>
#include <vector>

namespace morula::cli {

/// The first `left_columns` columns are flush left, and so is the last one when it is drawn; the others flush right.
class Table {
 public:
  explicit Table(std::vector<std::string> header, std::size_t left_columns = 1, bool last_is_drawn = false);
  /// Missing cells are empty.
  void add(std::vector<std::string> cells);
  /// A line between groups of rows.
  void add_rule();
  /// With a line break after every row.
  std::string text() const;

 private:
  std::size_t left_columns_;
  bool last_is_drawn_;
  std::vector<std::vector<std::string>> rows_;  // the header first; a row without cells is a rule
};

/// Lines of at most `width` characters, broken at blanks; a continued line is indented as the line it continues, two
/// more after "- ". Words that are longer stay whole.
std::string wrapped(const std::string& text, std::size_t width = 100);

}  // namespace morula::cli
