// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Named arrays of numbers in one run of bytes, with a JSON table of what is where: the body of native files.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/json_checks.hpp"

namespace morula::detail {

class ArrayWriter {
 public:
  /// values.size() must be a multiple of width, the numbers of a row.
  void add(const std::string& name, std::size_t width, std::span<const std::uint32_t> values);
  void add(const std::string& name, std::size_t width, std::span<const double> values);

  const nlohmann::ordered_json& table() const { return table_; }
  const std::string& bytes() const { return bytes_; }

 private:
  template <class Value>
  void add_values(const std::string& name, const char* type, std::size_t width, std::span<const Value> values);

  nlohmann::ordered_json table_ = nlohmann::ordered_json::array();
  std::string bytes_;
};

/// Throws FileError for arrays that are missing, have another type or width, or do not lie inside the bytes.
class ArrayReader {
 public:
  ArrayReader(const JsonFile& file, const nlohmann::json& table, std::string_view bytes)
      : file_(file), table_(table), bytes_(bytes) {}
  std::vector<std::uint32_t> indices(const std::string& name, std::size_t width) const;
  std::vector<double> numbers(const std::string& name, std::size_t width) const;

 private:
  template <class Value>
  std::vector<Value> values(const std::string& name, const char* type, std::size_t width) const;

  const JsonFile& file_;
  const nlohmann::json& table_;
  std::string_view bytes_;
};

}  // namespace morula::detail
