// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// tinygltf gets only the data that it needs: the JSON is parsed and cut down to shape and motion here, so that it meets
// neither images nor extensions, and of a .glb it gets that JSON and the binary chunk as if it were a file. It decodes
// data URIs and fills structures.
#define TINYGLTF_IMPLEMENTATION
#include "io/gltf/model.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <morula/io/file_reference.hpp>
#include <morula/io/mesh_file.hpp>
#include <nlohmann/json.hpp>

#include "io/byte_reader.hpp"
#include "io/interruptible_text.hpp"
#include "io/whole_file.hpp"
#include "parallel/interruption.hpp"
#include "platform/path_text.hpp"

namespace morula::gltf {
using namespace detail;
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view binary_chunk = "morula:binary-chunk";

// A file's parts, ahead of decoding.
struct Container {
  fs::path path;
  std::string_view json, binary;
  bool is_binary = false;
};

Container opened(const fs::path& path, std::string_view bytes) {
  Container file{.path = path, .json = bytes, .binary = {}};
  // tinygltf takes 32-bit counts.
  if (bytes.size() > 0x7fffffff) throw FileError(platform::text_of(path) + ": is larger than 2 GiB, which is not read");
  if (bytes.substr(0, 4) != "glTF") return file;
  file.is_binary = true;
  ByteReader in(path, bytes, std::endian::little);
  in.skip(4, "the header");
  if (const auto version = in.read<std::uint32_t>("the header"); version != 2)
    in.fail("is glTF version " + std::to_string(version) + "; write it as version 2");
  if (in.read<std::uint32_t>("the header") > bytes.size()) in.fail("the file is shorter than its header says");
  constexpr std::uint32_t json_type = 0x4E4F534A, binary_type = 0x004E4942;
  for (bool first = true; in.bytes_left() >= 8; first = false) {
    const auto length = in.read<std::uint32_t>("a chunk");
    const auto type = in.read<std::uint32_t>("a chunk");
    const std::string_view chunk = bytes.substr(bytes.size() - in.bytes_left(), length);
    in.skip(length, "a chunk");
    if (first != (type == json_type)) in.fail(first ? "the first chunk is not JSON" : "there is a second JSON chunk");
    if (first) file.json = chunk;
    if (type == binary_type && file.binary.empty()) file.binary = chunk;
  }
  if (file.json.data() == bytes.data()) in.fail("the file ends before its JSON");
  return file;
}

// Extensions that change no position: a file may require these.
bool is_harmless(std::string_view extension) {
  constexpr std::array<std::string_view, 6> prefixes{"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                                     "KHR_lights_",    "KHR_xmp",      "MSFT_texture_"};
  return extension == "KHR_mesh_quantization" ||
         std::any_of(prefixes.begin(), prefixes.end(), [&](std::string_view p) { return extension.starts_with(p); });
}

// Extensions of nodes and meshes that do not affect the surface.
bool is_metadata(std::string_view extension) {
  constexpr std::array<std::string_view, 14> names{
      "EXT_structural_metadata",
      "EXT_mesh_features",
      "EXT_instance_features",
      "KHR_audio_emitter",
      "KHR_node_hoverability",
      "KHR_node_selectability",
      "MOZ_hubs_components",
      "VRM",
      "VRMC_vrm",
      "AGI_articulations",
      "EXT_lights_image_based",
      "FB_geometry_metadata",
      "KHR_animation_pointer",
      "KHR_draco_mesh_compression"};  // the last two are checked by themselves
  return is_harmless(extension) || std::find(names.begin(), names.end(), extension) != names.end();
}

// Counts the uses of each other extension, at any place.
void count_extensions(const Json& value, std::map<std::string, std::size_t>& uses) {
  if (value.is_object()) {
    const auto own = value.find("extensions");
    if (own != value.end() && own->is_object())
      for (const auto& [name, content] : own->items())
        if (!is_metadata(name)) ++uses[name];
  }
  if (value.is_structured())
    for (const auto& [key, part] : value.items())
      if (key != "extensions" && key != "extras") count_extensions(part, uses);
}

// The extension of an object, or null.
const Json* extension_of(const Json& owner, const char* name) {
  if (!owner.is_object()) return nullptr;
  const auto all = owner.find("extensions");
  if (all == owner.end() || !all->is_object()) return nullptr;
  const auto found = all->find(name);
  return found == all->end() ? nullptr : &*found;
}

// The list of a key; empty if there is none.
const Json& list_in(const Json& owner, const char* key) {
  static const Json empty = Json::array();
  if (!owner.is_object()) return empty;
  const auto found = owner.find(key);
  return found == owner.end() || !found->is_array() ? empty : *found;
}

// Channels whose pointer leads to nodes or to weights of meshes; others move colors.
std::size_t count_pointers(const Json& kept) {
  std::size_t count = 0;
  for (const Json& animation : list_in(kept, "animations"))
    for (const Json& channel : list_in(animation, "channels")) {
      if (!channel.is_object() || !channel.contains("target")) continue;
      const Json* const pointer = extension_of(channel["target"], "KHR_animation_pointer");
      if (!pointer || !pointer->is_object() || !pointer->contains("pointer") || !(*pointer)["pointer"].is_string())
        continue;
      const auto target = (*pointer)["pointer"].get<std::string>();
      if (target.starts_with("/nodes/") || target.starts_with("/meshes/")) ++count;
    }
  return count;
}

// Whether an accessor has data of its own, without the extension that packs them.
bool has_plain_data(const Json& kept, const Json& index) {
  const Json& accessors = list_in(kept, "accessors");
  if (!index.is_number_unsigned() || index.get<std::size_t>() >= accessors.size()) return true;
  const Json& accessor = accessors[index.get<std::size_t>()];
  return accessor.contains("bufferView") || accessor.contains("sparse");
}

// An accessor without data is full of zeros, which differ from the data of a packed primitive.
bool is_packed_alone(const Json& kept, const Json& primitive) {
  if (!extension_of(primitive, "KHR_draco_mesh_compression")) return false;
  if (primitive.contains("indices") && !has_plain_data(kept, primitive["indices"])) return true;
  const auto attributes = primitive.find("attributes");
  return attributes != primitive.end() && attributes->is_object() && attributes->contains("POSITION") &&
         !has_plain_data(kept, (*attributes)["POSITION"]);
}

bool has_packed_primitive(const Json& kept) {
  for (const Json& mesh : list_in(kept, "meshes"))
    for (const Json& primitive : list_in(mesh, "primitives"))
      if (is_packed_alone(kept, primitive)) return true;
  return false;
}

std::string times(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// Notes on shapes and motions of the file by extensions that are not read.
std::vector<std::string> notes_of(const Json& all, const Json& kept) {
  std::map<std::string, std::size_t> uses;
  count_extensions(kept, uses);
  if (extension_of(all, "CESIUM_RTC")) ++uses["CESIUM_RTC"];
  std::vector<std::string> notes;
  for (const auto& [name, count] : uses)
    notes.push_back(
        name == "EXT_mesh_gpu_instancing"
            ? times(count, "node shows its mesh", "nodes show their meshes") +
                  " many times by EXT_mesh_gpu_instancing, which is not read: once each is there; write the "
                  "instances as nodes"
            : "the extension " + in_quotes(name) + " is used in " + times(count, "place", "places") +
                  " and not read: what it adds, hides or moves is as without it");
  if (const std::size_t count = count_pointers(kept); count > 0)
    notes.push_back(times(count, "channel of an animation moves", "channels of animations move") +
                    " what KHR_animation_pointer points at, which is not read: it stands still");
  return notes;
}

// Removes all data that are neither shape nor motion, at any place.
void strip(Json& value) {
  if (value.is_object())
    for (const char* const key : {"extensions", "extras"}) value.erase(key);
  if (value.is_structured())
    for (Json& part : value) strip(part);
}

// The nesting depth of lists and objects in a JSON text: brackets in strings do not count.
int depth_of(std::string_view text) {
  int depth = 0, deepest = 0;
  bool is_in_string = false;
  InterruptPoller poll_interrupt(1u << 20);
  for (std::size_t i = 0; i < text.size(); ++i) {
    poll_interrupt();
    const char c = text[i];
    if (is_in_string && c == '\\')
      ++i;
    else if (c == '"')
      is_in_string = !is_in_string;
    else if (!is_in_string && (c == '[' || c == '{'))
      deepest = std::max(deepest, ++depth);
    else if (!is_in_string && (c == ']' || c == '}'))
      --depth;
  }
  return deepest;
}

Json parsed(const Container& file) {
  const std::string name = platform::text_of(file.path);
  // glTF is at most 8 deep; with this limit, functions that recurse, here and in tinygltf, cannot run out of stack.
  constexpr int deepest = 32;
  if (depth_of(file.json) > deepest) throw FileError(name + ": its JSON is nested more than 32 deep; that is no glTF");
  try {
    const InterruptibleText interruptible(file.json);
    return Json::parse(interruptible.begin(), interruptible.end());
  } catch (const Json::parse_error& error) {
    throw FileError(name + ": is not JSON at byte " + std::to_string(error.byte) +
                    " of its text; it was cut short or edited wrongly");
  } catch (const Json::exception&) {
    throw FileError(name + ": holds a number that is too large for double precision");
  }
}

Json cut_down(const Container& file, std::vector<std::string>& notes) {
  const auto fail = [&](const std::string& problem) { throw FileError(platform::text_of(file.path) + ": " + problem); };
  Json all = parsed(file), kept;
  if (!all.is_object()) fail("is JSON, but no glTF: that is an object");
  if (const auto required = all.find("extensionsRequired"); required != all.end() && required->is_array())
    for (const Json& extension : *required)
      if (!extension.is_string() || !is_harmless(extension.get<std::string>()))
        fail("requires the extension " + in_quotes(extension.is_string() ? extension.get<std::string>() : "?") +
             ", which is not read; write the file without it (uncompressed)");
  // Version 1 has objects where version 2 has lists.
  if (const auto asset = all.find("asset"); asset != all.end() && asset->is_object()) {
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string() || !version->get<std::string>().starts_with("2."))
      fail("is not glTF version 2" +
           (version != asset->end() && version->is_string() ? " but " + in_quotes(version->get<std::string>()) : "") +
           "; convert it to that");
  } else {
    fail("has no \"asset\" with the version; that is no glTF");
  }
  for (const char* const key :
       {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "skins", "animations"}) {
    const auto member = all.find(key);
    if (member == all.end()) continue;
    const bool is_list = std::string_view(key) != "asset" && std::string_view(key) != "scene";
    if (is_list && !member->is_array()) fail("\"" + std::string(key) + "\" is not a list");
    if (is_list)
      for (const Json& item : *member)
        if (!item.is_object()) fail("\"" + std::string(key) + "\" holds something that is not an object");
    kept[key] = std::move(*member);
  }
  if (has_packed_primitive(kept))
    fail(
        "has primitives that are there by KHR_draco_mesh_compression alone, which is not read; write the file without "
        "it (uncompressed)");
  notes = notes_of(all, kept);
  strip(kept);
  // tinygltf requires members that glTF leaves out.
  if (kept.contains("skins"))
    for (Json& skin : kept["skins"])
      if (!skin.contains("inverseBindMatrices")) skin["inverseBindMatrices"] = -1;
  if (kept.contains("animations"))
    for (Json& animation : kept["animations"]) {
      const auto channels = animation.find("channels");
      if (channels == animation.end() || !channels->is_array()) continue;
      Json with_node = Json::array();
      for (Json& channel : *channels)
        if (channel.is_object() && channel.contains("target") && channel["target"].is_object() &&
            channel["target"].contains("node"))
          with_node.push_back(std::move(channel));
      *channels = std::move(with_node);
    }
  if (file.is_binary && kept.contains("buffers") && !kept["buffers"].empty() && !kept["buffers"][0].contains("uri"))
    kept["buffers"][0]["uri"] = binary_chunk;
  return kept;
}

// The path of a file next to the glTF file; names that lead elsewhere are rejected.
fs::path beside(const Container& file, const std::string& uri) {
  const fs::path relative = platform::path_of(uri);
  const bool is_inside =
      !uri.empty() && relative.is_relative() && !relative.has_root_path() &&
      uri.find_first_of(std::string_view("\\:\0", 3)) == std::string::npos &&
      std::none_of(relative.begin(), relative.end(), [](const fs::path& part) { return part == ".."; });
  if (!is_inside)
    throw FileError(platform::text_of(file.path) + ": a buffer is " + in_quotes(uri) +
                    "; only files in its folder are read, by relative names without '..'");
  const fs::path path = file.path.parent_path() / relative;
  std::error_code error;
  // mutant gltf-buffer-through-link: `fs::exists(path, error)` -> `false`
  if (fs::exists(path, error) && !FileRoots({file.path.parent_path()}).hold(path))
    throw FileError(platform::text_of(file.path) + ": a buffer is " + in_quotes(uri) +
                    ", a link out of its folder; only files in its folder are read: copy it there");
  return path;
}

// Reads a buffer for tinygltf. It compares the size with the announced one; a chunk may have padding.
bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string& uri, void* user) {
  const auto& file = *static_cast<const Container*>(user);
  const auto whole = [&](const fs::path& path) {
    try {
      return read_whole(path);
    } catch (const FileError& error) {
      throw FileError(platform::text_of(file.path) + ": its buffer " + in_quotes(uri) +
                      " cannot be read: " + error.what());
    }
  };
  const std::string read = uri == binary_chunk ? std::string() : whole(beside(file, uri));
  const std::string_view bytes = uri == binary_chunk ? file.binary : std::string_view(read);
  out->reserve(bytes.size());
  for (std::size_t begin = 0; begin < bytes.size(); begin += bytes_per_look) {
    check_interrupt();
    const std::string_view part = bytes.substr(begin, bytes_per_look);
    out->insert(out->end(), part.begin(), part.end());
  }
  return true;
}

// The file callbacks of tinygltf: buffers only. From 2.9 on it requests their sizes first.
template <class Callbacks>
Callbacks callbacks_for(Container& file) {
  Callbacks callbacks{};
  callbacks.FileExists = [](const std::string&, void*) { return true; };
  callbacks.ExpandFilePath = [](const std::string& name, void*) { return name; };
  callbacks.ReadWholeFile = read_buffer;
  callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  if constexpr (requires { callbacks.GetFileSizeInBytes; }) {
    callbacks.GetFileSizeInBytes = [](std::size_t* size, std::string* error, const std::string& uri, void* user) {
      std::vector<unsigned char> bytes;
      if (!read_buffer(&bytes, error, uri, user)) return false;
      *size = bytes.size();
      return true;
    };
  }
  callbacks.user_data = &file;
  return callbacks;
}

morula_tinygltf::Model decoded(Container& file, std::vector<std::string>& notes) {
  Json json = cut_down(file, notes);
  // The chunk may be up to three bytes longer than its buffer.
  if (json.contains("buffers"))
    for (Json& buffer : json["buffers"]) {
      if (!buffer.contains("uri") || buffer["uri"] != binary_chunk) continue;
      const auto length = buffer.find("byteLength");
      if (length == buffer.end() || !length->is_number_unsigned() ||
          length->get<std::uint64_t>() > file.binary.size() || file.binary.size() - length->get<std::uint64_t>() > 3)
        throw FileError(platform::text_of(file.path) +
                        ": its first buffer has not the length of the file's binary chunk, " +
                        std::to_string(file.binary.size()) + " bytes; it was cut short, or its counts are wrong");
      file.binary = file.binary.substr(0, length->get<std::size_t>());
    }
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  morula_tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(callbacks_for<morula_tinygltf::FsCallbacks>(file));
  morula_tinygltf::Model model;
  std::string error, warning;
  bool good = false;
  try {
    good = loader.LoadASCIIFromString(&model, &error, &warning, text.data(), static_cast<unsigned>(text.size()), "");
  } catch (const FileError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& problem) {
    error = problem.what();
  }
  // mutant gltf-ended-is-a-fault: `check_interrupt()` -> ``
  check_interrupt();  // an interruption while a buffer was read is no fault of the file
  // tinygltf continues after certain errors, and leaves out unknown data.
  if (!good || !error.empty()) {
    while (!error.empty() && (error.back() == '\n' || error.back() == '.')) error.pop_back();
    for (char& c : error)
      if (c < ' ' || c > '~') c = ' ';
    if (error.size() > 300) error.resize(300);
    throw FileError(platform::text_of(file.path) +
                    ": is no glTF that can be read: " + (error.empty() ? "unknown fault" : error));
  }
  return model;
}

}  // namespace

LoadedModel load_model(const fs::path& path, std::string_view bytes) {
  Container file = opened(path, bytes);
  LoadedModel loaded{};
  loaded.model = decoded(file, loaded.notes);
  loaded.bytes = file.json.size();
  for (const morula_tinygltf::Buffer& buffer : loaded.model.buffers) loaded.bytes += buffer.data.size();
  return loaded;
}

}  // namespace morula::gltf
