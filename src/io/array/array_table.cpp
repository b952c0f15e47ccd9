// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/array/array_table.hpp"

#include "io/byte_reader.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {

void ArrayWriter::add(const std::string& name, std::size_t width, std::span<const std::uint32_t> values) {
  add_values(name, "uint32", width, values);
}

void ArrayWriter::add(const std::string& name, std::size_t width, std::span<const double> values) {
  add_values(name, "float64", width, values);
}

template <class Value>
void ArrayWriter::add_values(const std::string& name, const char* type, std::size_t width,
                             std::span<const Value> values) {
  // Multiples of 8, so that a program that maps the file can use the arrays where they are.
  bytes_.resize((bytes_.size() + 7) / 8 * 8);
  nlohmann::ordered_json entry;
  entry["name"] = name;
  entry["type"] = type;
  entry["width"] = width;
  entry["rows"] = values.size() / width;
  entry["offset"] = bytes_.size();
  table_.push_back(std::move(entry));
  AskNowAndThen ask_now_and_then(1u << 16);
  for (const Value value : values) {
    ask_now_and_then();
    store(bytes_, value);
  }
}

std::vector<std::uint32_t> ArrayReader::indices(const std::string& name, std::size_t width) const {
  return values<std::uint32_t>(name, "uint32", width);
}

std::vector<double> ArrayReader::numbers(const std::string& name, std::size_t width) const {
  return values<double>(name, "float64", width);
}

template <class Value>
std::vector<Value> ArrayReader::values(const std::string& name, const char* type, std::size_t width) const {
  const std::string label = "array " + name;
  if (!table_.is_array()) file_.fail("the table of arrays is not a list");
  for (const nlohmann::json& entry : table_) {
    if (file_.member(entry, "name", "an array") != name) continue;
    if (file_.member(entry, "type", label) != type || file_.unsigned_member(entry, "width", label) != width)
      file_.fail(label + " is not of type " + type + " and width " + std::to_string(width));
    const std::uint64_t rows = file_.unsigned_member(entry, "rows", label);
    const std::uint64_t offset = file_.unsigned_member(entry, "offset", label);
    // Divided, not multiplied: no number overflows.
    if (offset > bytes_.size() || rows > (bytes_.size() - offset) / (width * sizeof(Value)))
      file_.fail(label + " reaches past the end of the file");
    std::vector<Value> values(rows * width);
    AskNowAndThen ask_now_and_then(1u << 16);
    for (std::size_t i = 0; i < values.size(); ++i) {
      ask_now_and_then();
      values[i] = load<Value>(bytes_.data() + offset + i * sizeof(Value));
    }
    return values;
  }
  file_.fail(label + " is missing");
}

}  // namespace morula::detail
