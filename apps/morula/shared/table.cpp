// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/table.hpp"

#include <algorithm>
#include <sstream>

namespace morula::cli {
namespace {

/// Characters, not bytes: continuation bytes of UTF-8 are 10xxxxxx.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0u) != 0x80u; }));
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t most) {
  std::string result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blanks = std::min(line.find_first_not_of(' '), line.size());
    const std::string indent(blanks + (line.compare(blanks, 2, "- ") == 0 ? 2 : 0), ' ');
    while (width(line) > most) {
      // The last blank within the width; for a word that is longer, the first blank after it.
      std::size_t end = std::string::npos;
      for (std::size_t at = line.find(' ', indent.size()); at != std::string::npos; at = line.find(' ', at + 1)) {
        if (end != std::string::npos && width(line.substr(0, at)) > most) break;
        end = at;
      }
      const std::size_t rest = end == std::string::npos ? end : line.find_first_not_of(' ', end);
      if (rest == std::string::npos) break;
      result += line.substr(0, end) + '\n';
      line = indent + line.substr(rest);
    }
    result += line + '\n';
  }
  return result;
}

Table::Table(std::vector<std::string> header, std::size_t left_columns, bool last_is_drawn)
    : left_columns_(left_columns), last_is_drawn_(last_is_drawn) {
  rows_.push_back(std::move(header));
}

void Table::add(std::vector<std::string> cells) {
  cells.resize(rows_.front().size());
  rows_.push_back(std::move(cells));
}

void Table::add_rule() {
  rows_.emplace_back();
}

std::string Table::text() const {
  const std::size_t columns = rows_.front().size();
  std::vector<std::size_t> widths(columns, 0);
  for (const auto& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c]));
  }
  std::string text;
  for (const auto& row : rows_) {
    std::string line;
    for (std::size_t c = 0; c < columns; ++c) {
      if (c > 0) line += "  ";
      if (row.empty()) {
        line.append(widths[c], '-');
        continue;
      }
      const std::size_t padding = widths[c] - width(row[c]);
      const bool left = c < left_columns_ || (last_is_drawn_ && c + 1 == columns);
      if (!left) line.append(padding, ' ');
      line += row[c];
      if (left) line.append(padding, ' ');
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace morula::cli
