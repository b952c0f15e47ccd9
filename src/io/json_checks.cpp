// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "io/json_checks.hpp"

#include <algorithm>
#include <iterator>

#include "io/interruptible_text.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::detail {

JsonFile::JsonFile(const std::filesystem::path& path, std::string_view text) : name_(platform::text_of(path)) {
  try {
    const InterruptibleText interruptible(text);
    root_ = nlohmann::json::parse(interruptible.begin(), interruptible.end());
  } catch (const nlohmann::json::parse_error& error) {
    const std::size_t before = std::min(text.size(), error.byte);
    const auto lines = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(before), '\n');
    throw FileError(name_ + ":" + std::to_string(lines + 1) + ": is not JSON here; it was cut short or edited wrongly");
  } catch (const nlohmann::json::exception&) {
    fail("holds a number that is too large for double precision");
  }
}

const nlohmann::json& JsonFile::member(const nlohmann::json& object, const char* key, const std::string& owner) const {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end()) fail(owner + " has no \"" + key + "\"");
  return *found;
}

std::uint64_t JsonFile::unsigned_member(const nlohmann::json& object, const char* key, const std::string& owner) const {
  const nlohmann::json& value = member(object, key, owner);
  if (!value.is_number_unsigned()) fail("\"" + std::string(key) + "\" of " + owner + " is not a whole number from 0");
  return value.get<std::uint64_t>();
}

bool JsonFile::flag(const nlohmann::json& object, const char* key, const std::string& owner) const {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (found == object.end()) return false;
  if (!found->is_boolean()) fail("\"" + std::string(key) + "\" of " + owner + " is neither true nor false");
  return found->get<bool>();
}

void JsonFile::forget_lists() {
  // The C library joins small free blocks when a large one becomes free. So a block of 96 KiB is freed with each part:
  // otherwise all would be joined at once, at the end.
  constexpr std::ptrdiff_t elements_at_once = 6144;
  for (nlohmann::json& member : root_) {
    if (!member.is_array()) continue;
    auto& list = member.get_ref<nlohmann::json::array_t&>();
    while (!list.empty()) {
      // mutant looks-json-forgotten: `check_interrupt()` -> ``
      check_interrupt();
      const auto begin = list.end() - std::min(elements_at_once, std::ssize(list));
      const nlohmann::json::array_t part(std::make_move_iterator(begin), std::make_move_iterator(list.end()));
      list.erase(begin, list.end());
    }
  }
}

void JsonFile::fail(const std::string& problem) const {
  throw FileError(name_ + ": " + problem);
}

}  // namespace morula::detail
