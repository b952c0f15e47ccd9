// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// The text of the JSON is edited, not written anew: numbers keep their digits and members their order.
#include <morula/io/skin_bounds_file.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <stdexcept>

#include "io/byte_reader.hpp"
#include "io/json_checks.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// The text of a .glb or .gltf around its JSON.
struct SplitFile {
  bool is_binary;
  std::string_view json;
  std::string_view after;  ///< the chunks of a .glb that follow its JSON
};

SplitFile split(const fs::path& path, std::string_view bytes) {
  if (!bytes.starts_with("glTF")) return {false, bytes, {}};
  ByteReader in(path, bytes, std::endian::little);
  in.skip(4, "the header");
  if (in.read<std::uint32_t>("the header") != 2) in.fail("is not glTF version 2");
  in.skip(4, "the header");
  const auto length = in.read<std::uint32_t>("a chunk");
  constexpr std::uint32_t json_type = 0x4E4F534A;
  if (in.read<std::uint32_t>("a chunk") != json_type) in.fail("the first chunk is not JSON");
  const std::size_t begin = bytes.size() - in.bytes_left();
  in.skip(length, "the JSON");
  return {true, bytes.substr(begin, length), bytes.substr(begin + length)};
}

/// An object in a text of valid JSON: the place of one member's value, and that of the closing brace.
struct ObjectText {
  std::optional<std::pair<std::size_t, std::size_t>> value{};  ///< begin and end
  std::size_t close = 0;
  bool is_empty = true;
};

/// object: valid JSON, with blanks around the object at most.
ObjectText look_into(std::string_view object, std::string_view name) {
  ObjectText found;
  int depth = 0;
  std::size_t begin = 0, key_begin = 0;
  std::string_view last_string;
  bool is_wanted = false;
  InterruptPoller poll_interrupt(1u << 20);
  for (std::size_t i = 0; i < object.size(); ++i) {
    poll_interrupt();
    const char c = object[i];
    if (c == '"') {
      key_begin = ++i;
      while (object[i] != '"') i += object[i] == '\\' ? 2 : 1;
      last_string = object.substr(key_begin, i - key_begin);
      if (depth == 1) found.is_empty = false;
    } else if (c == ':' && depth == 1) {
      is_wanted = last_string == name;
      begin = i + 1;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if ((c == ',' && depth == 1) || ((c == '}' || c == ']') && --depth == 0)) {
      if (is_wanted) found.value = {begin, i};
      is_wanted = false;
      found.close = i;
    }
  }
  return found;
}

/// The object with this member replaced, or added as the last one.
std::string with_member(std::string_view object, std::string_view name, std::string_view value) {
  const ObjectText at = look_into(object, name);
  std::string text;
  if (at.value) {
    text.append(object.substr(0, at.value->first)).append(value).append(object.substr(at.value->second));
    return text;
  }
  text.append(object.substr(0, at.close)).append(at.is_empty ? "\"" : ",\"").append(name).append("\":");
  text.append(value).append(object.substr(at.close));
  return text;
}

std::string with_extra(std::string_view json, const JsonFile& parsed, std::string_view name, std::string_view value) {
  std::string_view extras = "{}";
  if (parsed.root().contains("extras")) {
    const ObjectText at = look_into(json, "extras");
    if (!at.value || !parsed.root()["extras"].is_object())
      parsed.fail("its \"extras\" are no object, or written with escapes: nothing can be added to them; remove them");
    extras = json.substr(at.value->first, at.value->second - at.value->first);
  }
  return with_member(json, "extras", with_member(extras, name, value));
}

bool refers_to_files(const Json& root) {
  for (const char* const list : {"buffers", "images"}) {
    const auto items = root.find(list);
    if (items == root.end() || !items->is_array()) continue;
    for (const Json& item : *items) {
      if (!item.is_object() || !item.contains("uri") || !item["uri"].is_string()) continue;
      if (!item["uri"].get_ref<const std::string&>().starts_with("data:")) return true;
    }
  }
  return false;
}

void require_target(const fs::path& from, const fs::path& to, const Json& root) {
  if (lower_extension(from) != lower_extension(to))
    throw FileError(platform::text_of(to) + ": the copy of a " + lower_extension(from) +
                    " is one, too; give it that extension");
  std::error_code error;
  if (refers_to_files(root) &&
      fs::weakly_canonical(from, error).parent_path() != fs::weakly_canonical(to, error).parent_path())
    throw FileError(platform::text_of(to) + ": " + platform::text_of(from) +
                    " refers to other files; write the copy into its folder");
}

std::string glb(const fs::path& to, std::string json, std::string_view after) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::uint64_t size = 12 + 8 + std::uint64_t{json.size()} + after.size();
  if (size > 0xffffffff) throw FileError(platform::text_of(to) + ": would be larger than 4 GiB, the most of a .glb");
  std::string file = "glTF";
  store(file, std::uint32_t{2});
  store(file, static_cast<std::uint32_t>(size));
  store(file, static_cast<std::uint32_t>(json.size()));
  return file.append("JSON").append(json).append(after);
}

/// The parser takes a character 0 for the end of the text.
bool is_json(std::string_view text) {
  return text.find('\0') == text.npos && Json::accept(text);
}

}  // namespace

void write_gltf_extra(const fs::path& from, const fs::path& to, std::string_view name, std::string_view json) {
  if (!is_json(json)) throw std::invalid_argument("the value of the extra is not JSON");
  if (!is_json('"' + std::string(name) + '"') || name.find_first_of("\"\\") != name.npos)
    throw std::invalid_argument("the name of the extra needs escapes, or is not UTF-8");
  const std::string bytes = read_whole(from);
  SplitFile file = split(from, bytes);
  // JSON has no character 0 and ends there for its parser, but some writers of .glb pad with it.
  file.json = file.json.substr(0, file.json.find('\0'));
  const JsonFile parsed(from, file.json);
  const Json& root = parsed.root();
  if (!root.is_object() || !root.contains("asset")) parsed.fail("has no \"asset\"; that is no glTF");
  require_target(from, to, root);
  std::string text = with_extra(file.json, parsed, name, json);
  write_whole(to, file.is_binary ? glb(to, std::move(text), file.after) : text);
}

}  // namespace morula
