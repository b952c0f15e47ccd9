// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// tinygltf is given no more than it needs: the JSON is parsed and cut down to shape and motion here, so that it meets
// neither images nor extensions, and of a .glb it gets that JSON and the binary chunk as if it were a file. It decodes
// data URIs and fills structures; what these say is checked here, because it leaves indices, sizes and types unchecked.
#include "io/gltf/document.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>  // which tinygltf uses and forgets
#include <map>
#include <morula/io/mesh_file.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "io/byte_reader.hpp"
#include "io/whole_file.hpp"

// In a namespace of our own: a program that also has tinygltf links it once more without a clash.
#define tinygltf morula_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

namespace morula::gltf {
using namespace detail;

void Document::fail(const std::string& problem) const {
  throw FileError(name + ": " + problem);
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::string_view binary_chunk = "morula:binary-chunk";

// A file's parts, before anything is decoded.
struct Container {
  fs::path path;
  std::string_view json, binary;
  bool is_binary = false;
};

Container opened(const fs::path& path, std::string_view bytes) {
  Container file{.path = path, .json = bytes, .binary = {}};
  // Counts of what tinygltf is given are 32-bit.
  if (bytes.size() > 0x7fffffff) throw FileError(path.string() + ": is larger than 2 GiB, which is not read");
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

// What is neither shape nor motion goes, wherever it is.
void strip(Json& value) {
  if (value.is_object())
    for (const char* const key : {"extensions", "extras"}) value.erase(key);
  if (value.is_structured())
    for (Json& part : value) strip(part);
}

Json parsed(const Container& file) {
  const std::string name = file.path.string();
  // As deep as glTF goes is 8; what recurses after this, here and in tinygltf, then cannot run out of stack.
  constexpr int deepest = 32;
  const auto is_shallow = [&](int depth, Json::parse_event_t, Json&) {
    if (depth > deepest) throw FileError(name + ": its JSON is nested more than 32 deep; that is no glTF");
    return true;
  };
  try {
    return Json::parse(file.json.begin(), file.json.end(), is_shallow);
  } catch (const Json::parse_error& error) {
    throw FileError(name + ": is not JSON at byte " + std::to_string(error.byte) +
                    " of its text; it was cut short or edited wrongly");
  } catch (const Json::exception&) {
    throw FileError(name + ": holds a number that is too large for double precision");
  }
}

Json cut_down(const Container& file) {
  const auto fail = [&](const std::string& problem) { throw FileError(file.path.string() + ": " + problem); };
  Json all = parsed(file), kept;
  if (!all.is_object()) fail("is JSON, but no glTF: that is an object");
  if (const auto required = all.find("extensionsRequired"); required != all.end() && required->is_array())
    for (const Json& extension : *required)
      if (!extension.is_string() || !is_harmless(extension.get<std::string>()))
        fail("requires the extension " + in_quotes(extension.is_string() ? extension.get<std::string>() : "?") +
             ", which is not read; write the file without it (uncompressed)");
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
  strip(kept);
  if (const auto asset = kept.find("asset"); asset != kept.end() && asset->is_object()) {
    const auto version = asset->find("version");
    if (version == asset->end() || !version->is_string() || !version->get<std::string>().starts_with("2."))
      fail("is not glTF version 2; write it as that");
  } else {
    fail("has no \"asset\" with the version; that is no glTF");
  }
  // tinygltf asks for what glTF leaves out.
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

// Names beside the file: none that leads elsewhere.
fs::path beside(const Container& file, const std::string& uri) {
  const fs::path relative(uri);
  const bool is_inside =
      !uri.empty() && relative.is_relative() && !relative.has_root_path() &&
      uri.find_first_of(std::string_view("\\:\0", 3)) == std::string::npos &&
      std::none_of(relative.begin(), relative.end(), [](const fs::path& part) { return part == ".."; });
  if (!is_inside)
    throw FileError(file.path.string() + ": a buffer is " + in_quotes(uri) +
                    "; only files in its folder are read, by relative names without '..'");
  return file.path.parent_path() / relative;
}

// A buffer, as tinygltf asks for it. It checks the size against what was announced, a chunk may have padding.
bool read_buffer(std::vector<unsigned char>* out, std::string*, const std::string& uri, void* user) {
  const auto& file = *static_cast<const Container*>(user);
  const auto whole = [&](const fs::path& path) {
    try {
      return read_whole(path);
    } catch (const FileError& error) {
      throw FileError(file.path.string() + ": its buffer " + in_quotes(uri) + " cannot be read: " + error.what());
    }
  };
  const std::string bytes = uri == binary_chunk ? std::string(file.binary) : whole(beside(file, uri));
  out->assign(bytes.begin(), bytes.end());
  return true;
}

morula_tinygltf::Model loaded(Container& file) {
  Json json = cut_down(file);
  // The chunk may be up to three bytes longer than its buffer.
  if (json.contains("buffers"))
    for (Json& buffer : json["buffers"]) {
      if (!buffer.contains("uri") || buffer["uri"] != binary_chunk) continue;
      const auto length = buffer.find("byteLength");
      if (length == buffer.end() || !length->is_number_unsigned() ||
          length->get<std::uint64_t>() > file.binary.size() || file.binary.size() - length->get<std::uint64_t>() > 3)
        throw FileError(file.path.string() + ": its first buffer has not the length of the file's binary chunk, " +
                        std::to_string(file.binary.size()) + " bytes; it was cut short, or its counts are wrong");
      file.binary = file.binary.substr(0, length->get<std::size_t>());
    }
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  morula_tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(
      {[](const std::string&, void*) { return true; }, [](const std::string& name, void*) { return name; }, read_buffer,
       [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }, &file});
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
  // It goes on after some errors, and leaves out what it did not understand.
  if (!good || !error.empty()) {
    while (!error.empty() && (error.back() == '\n' || error.back() == '.')) error.pop_back();
    for (char& c : error)
      if (c < ' ' || c > '~') c = ' ';
    if (error.size() > 300) error.resize(300);
    throw FileError(file.path.string() + ": is no glTF that can be read: " + (error.empty() ? "unknown fault" : error));
  }
  return model;
}

// Numbers out of buffers.
class Accessors {
 public:
  Accessors(const Document& document, const morula_tinygltf::Model& model, std::size_t bytes)
      : document_(document), model_(model), most_numbers_(most_numbers_per_byte * bytes) {}

  std::size_t count_of(int index, const std::string& owner) const { return at(index, owner).count; }

  // components: a type that has as many numbers. Checks that they are finite.
  std::vector<double> numbers(int index, int type, const std::string& owner) const {
    const morula_tinygltf::Accessor& a = at(index, owner);
    if (a.type != type) document_.fail(owner + " has an accessor of another type than it needs");
    const std::size_t width = width_of(type);
    std::vector<double> values;
    // The same bytes may be read again and again, and numbers of sparse accessors have none.
    if (a.count > (most_numbers_ - numbers_) / width)
      document_.fail(owner + " brings more numbers than a file of this size can mean");
    numbers_ += a.count * width;
    if (a.bufferView >= 0) {
      const Strided from = strided(a.bufferView, a.byteOffset, a.componentType, width, a.count, true, owner);
      values.reserve(a.count * width);
      for (std::size_t i = 0; i < a.count; ++i)
        for (std::size_t k = 0; k < width; ++k) values.push_back(from.number(i, k, a.normalized));
    } else {
      values.resize(a.count * width);
    }
    if (a.sparse.isSparse) replace_sparse(a, width, values, owner);
    for (const double value : values)
      if (!std::isfinite(value)) document_.fail(owner + " has a number that is not finite");
    return values;
  }

  std::vector<Vec3> vectors(int index, const std::string& owner) const {
    const std::vector<double> values = numbers(index, TINYGLTF_TYPE_VEC3, owner);
    std::vector<Vec3> vectors;
    vectors.reserve(values.size() / 3);
    for (std::size_t i = 0; i < values.size(); i += 3) vectors.push_back({values[i], values[i + 1], values[i + 2]});
    return vectors;
  }

  std::vector<std::uint32_t> indices(int index, int type, const std::string& owner) const {
    const morula_tinygltf::Accessor& a = at(index, owner);
    if (a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        a.componentType != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      document_.fail(owner + " has numbers that are no unsigned integers");
    std::vector<std::uint32_t> result;
    if (a.normalized) document_.fail(owner + " has normalised numbers, which are no indices");
    for (const double value : numbers(index, type, owner)) result.push_back(static_cast<std::uint32_t>(value));
    return result;
  }

 private:
  struct Strided {
    const unsigned char* first;
    std::size_t stride;
    int type;
    std::size_t size;

    double number(std::size_t i, std::size_t k, bool normalized) const {
      const char* const at = reinterpret_cast<const char*>(first + i * stride + k * size);
      switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
          return normalized ? std::max(load<std::int8_t>(at) / 127.0, -1.0) : load<std::int8_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
          return load<std::uint8_t>(at) / (normalized ? 255.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
          return normalized ? std::max(load<std::int16_t>(at) / 32767.0, -1.0) : load<std::int16_t>(at);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
          return load<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
          return load<std::uint32_t>(at);
        default:
          return static_cast<double>(load<float>(at));
      }
    }
  };

  const morula_tinygltf::Accessor& at(int index, const std::string& owner) const {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size())
      document_.fail(owner + " refers to accessor " + std::to_string(index) + " of " +
                     std::to_string(model_.accessors.size()));
    return model_.accessors[static_cast<std::size_t>(index)];
  }

  static std::size_t width_of(int type) {
    return type == TINYGLTF_TYPE_SCALAR ? 1 : type == TINYGLTF_TYPE_VEC3 ? 3 : type == TINYGLTF_TYPE_VEC4 ? 4 : 16;
  }

  std::size_t size_of(int type, const std::string& owner) const {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
      case TINYGLTF_COMPONENT_TYPE_SHORT:
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
      default:
        document_.fail(owner + " has numbers of a type that glTF does not know");
    }
  }

  // Where `count` groups of numbers are; all of them are inside their buffer.
  Strided strided(int view_index, std::uint64_t offset, int type, std::size_t width, std::uint64_t count,
                  bool may_have_stride, const std::string& owner) const {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model_.bufferViews.size())
      document_.fail(owner + " refers to buffer view " + std::to_string(view_index) + " of " +
                     std::to_string(model_.bufferViews.size()));
    const morula_tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
      document_.fail(owner + " refers to buffer " + std::to_string(view.buffer) + " of " +
                     std::to_string(model_.buffers.size()));
    const std::vector<unsigned char>& buffer = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    const std::size_t size = size_of(type, owner);
    const std::uint64_t group = size * width;
    const std::uint64_t stride = may_have_stride && view.byteStride != 0 ? view.byteStride : group;
    const std::uint64_t length = view.byteLength;
    if (stride < group) document_.fail(owner + " has groups of numbers that overlap: its stride is too short");
    // Compared so that nothing overflows.
    const bool view_fits = view.byteOffset <= buffer.size() && length <= buffer.size() - view.byteOffset;
    const bool fits = view_fits && (count == 0 || (offset <= length && group <= length - offset &&
                                                   count - 1 <= (length - offset - group) / stride));
    if (!fits) document_.fail(owner + " lies outside its buffer; it was cut short, or its counts are wrong");
    return {buffer.data() + view.byteOffset + (count == 0 ? 0 : offset), static_cast<std::size_t>(stride), type, size};
  }

  void replace_sparse(const morula_tinygltf::Accessor& a, std::size_t width, std::vector<double>& values,
                      const std::string& owner) const {
    if (a.sparse.count < 0 || a.sparse.indices.byteOffset < 0 || a.sparse.values.byteOffset < 0)
      document_.fail(owner + " has a negative count or offset");
    const int type = a.sparse.indices.componentType;
    if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      document_.fail(owner + " has sparse indices that are no unsigned integers");
    const auto count = static_cast<std::uint64_t>(a.sparse.count);
    const Strided where = strided(a.sparse.indices.bufferView, static_cast<std::uint64_t>(a.sparse.indices.byteOffset),
                                  type, 1, count, false, owner);
    const Strided from = strided(a.sparse.values.bufferView, static_cast<std::uint64_t>(a.sparse.values.byteOffset),
                                 a.componentType, width, count, false, owner);
    for (std::size_t i = 0; i < count; ++i) {
      const auto target = static_cast<std::size_t>(where.number(i, 0, false));
      if (target >= a.count)
        document_.fail(owner + " replaces number " + std::to_string(target) + " of " + std::to_string(a.count));
      for (std::size_t k = 0; k < width; ++k) values[target * width + k] = from.number(i, k, a.normalized);
    }
  }

  static constexpr std::size_t most_numbers_per_byte = 1024;
  const Document& document_;
  const morula_tinygltf::Model& model_;
  std::size_t most_numbers_;
  mutable std::size_t numbers_ = 0;
};

class Reader {
 public:
  // bytes: of the text and of all buffers.
  Reader(const fs::path& path, const morula_tinygltf::Model& model, std::size_t bytes)
      : model_(model), bytes_(bytes), accessors_(document_, model, bytes) {
    document_.name = path.string();
  }

  Document read() {
    read_nodes();
    for (std::size_t i = 0; i < model_.meshes.size(); ++i) read_mesh_data(i);
    for (std::size_t i = 0; i < model_.skins.size(); ++i) read_skin_data(i);
    for (const std::uint32_t node : document_.drawn) check_drawn(node);
    require_modest();
    for (std::size_t i = 0; i < model_.animations.size(); ++i) read_animation(i);
    return std::move(document_);
  }

 private:
  static std::string called(const char* what, std::size_t i) { return std::string(what) + " " + std::to_string(i); }

  std::uint32_t index(int value, std::size_t count, const std::string& owner, const char* what) const {
    if (value < 0 || static_cast<std::size_t>(value) >= count)
      document_.fail(owner + " refers to " + what + " " + std::to_string(value) + " of " + std::to_string(count));
    return static_cast<std::uint32_t>(value);
  }

  void require_finite(const std::vector<double>& values, std::size_t count, const std::string& owner) const {
    if (!values.empty() && count != 0 && values.size() != count)
      document_.fail(owner + " has " + std::to_string(values.size()) + " numbers where " + std::to_string(count) +
                     " are needed");
    for (const double value : values)
      if (!std::isfinite(value)) document_.fail(owner + " has a number that is not finite");
  }

  AffineTransform matrix(const double* m, const std::string& owner) const {
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
      document_.fail(owner + " has a matrix whose last row is not 0 0 0 1");
    return {{Vec3{m[0], m[1], m[2]}, Vec3{m[4], m[5], m[6]}, Vec3{m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
  }

  void read_nodes() {
    const std::size_t count = model_.nodes.size();
    document_.nodes.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const morula_tinygltf::Node& from = model_.nodes[i];
      const std::string owner = called("node", i);
      Node& node = document_.nodes[i];
      if (from.mesh != -1) node.mesh = index(from.mesh, model_.meshes.size(), owner, "mesh");
      if (from.skin != -1) node.skin = index(from.skin, model_.skins.size(), owner, "skin");
      require_finite(from.matrix, 16, owner + "'s matrix");
      require_finite(from.translation, 3, owner + "'s translation");
      require_finite(from.rotation, 4, owner + "'s rotation");
      require_finite(from.scale, 3, owner + "'s scale");
      require_finite(from.weights, 0, owner + "'s weights");
      node.weights = from.weights;
      if (!from.matrix.empty()) {
        node.has_matrix = true;
        node.matrix = matrix(from.matrix.data(), owner);
      }
      if (!from.translation.empty())
        node.pose.translation = {from.translation[0], from.translation[1], from.translation[2]};
      if (!from.rotation.empty()) std::copy(from.rotation.begin(), from.rotation.end(), node.pose.rotation.begin());
      if (!from.scale.empty()) node.pose.scale = {from.scale[0], from.scale[1], from.scale[2]};
    }
    for (std::size_t i = 0; i < count; ++i)
      for (const int child : model_.nodes[i].children) {
        Node& below = document_.nodes[index(child, count, called("node", i), "node")];
        if (below.parent != none) document_.fail(called("node", static_cast<std::size_t>(child)) + " has two parents");
        below.parent = static_cast<std::uint32_t>(i);
      }
    for (std::uint32_t i = 0; i < count; ++i)
      if (document_.nodes[i].parent == none) walk(i, document_.parents_first);
    // With one parent each, what no root reaches goes round in a circle.
    if (document_.parents_first.size() != count) document_.fail("its nodes contain each other in a circle");
    find_drawn();
  }

  // The node and all below it, parents first, children in order.
  void walk(std::uint32_t root, std::vector<std::uint32_t>& order) const {
    std::vector<std::uint32_t> waiting{root};
    while (!waiting.empty()) {
      const std::uint32_t node = waiting.back();
      waiting.pop_back();
      order.push_back(node);
      const std::vector<int>& children = model_.nodes[node].children;
      for (auto child = children.rbegin(); child != children.rend(); ++child)
        waiting.push_back(static_cast<std::uint32_t>(*child));
    }
  }

  void find_drawn() {
    std::vector<std::uint32_t> order;
    if (model_.scenes.empty()) {
      order = document_.parents_first;
    } else {
      const int chosen = model_.defaultScene == -1 ? 0 : model_.defaultScene;
      const auto& scene = model_.scenes[index(chosen, model_.scenes.size(), "the file", "scene")];
      std::vector<bool> seen(model_.nodes.size());
      for (const int root : scene.nodes) {
        const std::uint32_t node =
            index(root, model_.nodes.size(), called("scene", static_cast<std::size_t>(chosen)), "node");
        if (seen[node] || document_.nodes[node].parent != none)
          document_.fail(called("node", node) + " is in a scene twice, or is no root");
        seen[node] = true;
        walk(node, order);
      }
    }
    for (const std::uint32_t node : order)
      if (document_.nodes[node].mesh != none) document_.drawn.push_back(node);
  }

  using Attributes = std::vector<std::pair<std::string, int>>;

  void read_mesh_data(std::size_t i) {
    MeshData mesh;
    std::map<Attributes, std::size_t> known;  // primitives with the same attributes share their vertices
    const std::string owner = called("mesh", i);
    std::size_t target_count = 0;
    for (std::size_t p = 0; p < model_.meshes[i].primitives.size(); ++p) {
      const morula_tinygltf::Primitive& from = model_.meshes[i].primitives[p];
      const std::string own = owner + ", primitive " + std::to_string(p);
      if (from.mode < 0 || from.mode > 6) document_.fail(own + " has a mode that glTF does not know");
      if (from.mode < TINYGLTF_MODE_TRIANGLES) continue;  // points and lines
      const auto position = from.attributes.find("POSITION");
      if (position == from.attributes.end()) document_.fail(own + " has no positions");
      Attributes attributes{{"POSITION", position->second}};
      for (const auto& [attribute, accessor] : from.attributes)
        if (attribute.starts_with("JOINTS_") || attribute.starts_with("WEIGHTS_"))
          attributes.emplace_back(attribute, accessor);
      for (const auto& target : from.targets) {
        const auto moved = target.find("POSITION");
        attributes.emplace_back("target", moved == target.end() ? -1 : moved->second);
      }
      target_count = std::max(target_count, from.targets.size());
      const auto [place, is_new] = known.emplace(attributes, mesh.vertices.size());
      if (is_new) mesh.vertices.push_back(read_vertices(attributes, own));
      mesh.primitives.push_back({place->second, read_facets(from, mesh.vertices[place->second], own)});
    }
    mesh.weights = model_.meshes[i].weights;
    require_finite(mesh.weights, 0, owner + "'s weights");
    if (!mesh.weights.empty() && mesh.weights.size() != target_count)
      document_.fail(owner + " has " + std::to_string(mesh.weights.size()) + " weights for " +
                     std::to_string(target_count) + " morph targets");
    mesh.weights.resize(target_count);
    document_.meshes.push_back(std::move(mesh));
  }

  VertexSet read_vertices(const Attributes& attributes, const std::string& owner) const {
    VertexSet set;
    set.positions = accessors_.vectors(attributes[0].second, owner + "'s positions");
    const std::size_t count = set.positions.size();
    for (const auto& [name, accessor] : attributes) {
      if (name != "target") continue;
      if (accessor == -1) {  // of normals alone
        set.targets.emplace_back();
        continue;
      }
      if (accessors_.count_of(accessor, owner) != count)
        document_.fail(owner + " has a morph target with another number of vertices");
      set.targets.push_back(accessors_.vectors(accessor, owner + "'s morph target"));
    }
    read_influences(attributes, set, owner);
    return set;
  }

  void read_influences(const Attributes& attributes, VertexSet& set, const std::string& owner) const {
    const std::map<std::string, int> by_name(attributes.begin(), attributes.end());
    const std::size_t count = set.positions.size();
    std::vector<std::vector<std::uint32_t>> joints;
    std::vector<std::vector<double>> weights;
    for (std::size_t k = 0;; ++k) {
      const auto j = by_name.find("JOINTS_" + std::to_string(k)), w = by_name.find("WEIGHTS_" + std::to_string(k));
      if (j == by_name.end() && w == by_name.end()) break;
      if (j == by_name.end() || w == by_name.end())
        document_.fail(owner + " has joints without weights, or the reverse");
      if (accessors_.count_of(j->second, owner) != count || accessors_.count_of(w->second, owner) != count)
        document_.fail(owner + " has joints or weights of another number of vertices");
      joints.push_back(accessors_.indices(j->second, TINYGLTF_TYPE_VEC4, owner + "'s joints"));
      weights.push_back(accessors_.numbers(w->second, TINYGLTF_TYPE_VEC4, owner + "'s weights"));
    }
    if (joints.empty()) return;
    set.begin.push_back(0);
    for (std::size_t v = 0; v < count; ++v) {
      double sum = 0;
      const std::size_t first = set.joints.size();
      for (std::size_t k = 0; k < joints.size(); ++k)
        for (std::size_t c = 4 * v; c < 4 * v + 4; ++c) {
          if (weights[k][c] < 0) document_.fail(owner + " has a negative weight of vertex " + std::to_string(v));
          if (weights[k][c] == 0) continue;
          sum += weights[k][c];
          set.joints.push_back(joints[k][c]);
          set.weights.push_back(weights[k][c]);
        }
      if (!(sum > 0)) document_.fail(owner + " has no weights of vertex " + std::to_string(v));
      for (std::size_t k = first; k < set.weights.size(); ++k) set.weights[k] /= sum;
      set.begin.push_back(static_cast<std::uint32_t>(set.joints.size()));
    }
  }

  std::vector<Facet> read_facets(const morula_tinygltf::Primitive& from, const VertexSet& set,
                                 const std::string& owner) const {
    std::vector<std::uint32_t> corners;
    if (from.indices >= 0) {
      corners = accessors_.indices(from.indices, TINYGLTF_TYPE_SCALAR, owner + "'s indices");
    } else {
      corners.resize(set.positions.size());
      for (std::size_t v = 0; v < corners.size(); ++v) corners[v] = static_cast<std::uint32_t>(v);
    }
    for (const std::uint32_t v : corners)
      if (v >= set.positions.size())
        document_.fail(owner + " refers to vertex " + std::to_string(v) + " of " +
                       std::to_string(set.positions.size()));
    std::vector<Facet> facets;
    if (from.mode == TINYGLTF_MODE_TRIANGLES) {
      if (corners.size() % 3 != 0)
        document_.fail(owner + " has " + std::to_string(corners.size()) + " corners, no whole number of triangles");
      for (std::size_t i = 0; i < corners.size(); i += 3)
        facets.push_back({corners[i], corners[i + 1], corners[i + 2]});
      return facets;
    }
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
      if (from.mode == TINYGLTF_MODE_TRIANGLE_FAN)
        facets.push_back({corners[i + 1], corners[i + 2], corners[0]});
      else
        facets.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
    }
    return facets;
  }

  void read_skin_data(std::size_t i) {
    const std::string owner = called("skin", i);
    SkinData skin;
    for (const int joint : model_.skins[i].joints)
      skin.joints.push_back(index(joint, model_.nodes.size(), owner, "node"));
    skin.inverse_bind.resize(skin.joints.size());
    if (const int accessor = model_.skins[i].inverseBindMatrices; accessor != -1) {
      if (accessors_.count_of(accessor, owner) < skin.joints.size())
        document_.fail(owner + " has fewer inverse bind matrices than joints");
      const std::vector<double> numbers =
          accessors_.numbers(accessor, TINYGLTF_TYPE_MAT4, owner + "'s inverse bind matrices");
      for (std::size_t k = 0; k < skin.joints.size(); ++k) skin.inverse_bind[k] = matrix(&numbers[16 * k], owner);
    }
    document_.skins.push_back(std::move(skin));
  }

  void check_drawn(std::uint32_t i) const {
    const Node& node = document_.nodes[i];
    const MeshData& mesh = document_.meshes[node.mesh];
    if (!node.weights.empty() && node.weights.size() != mesh.weights.size())
      document_.fail(called("node", i) + " has " + std::to_string(node.weights.size()) + " weights for " +
                     std::to_string(mesh.weights.size()) + " morph targets");
    if (node.skin == none) return;
    for (const VertexSet& set : mesh.vertices) {
      if (set.begin.empty()) document_.fail(called("node", i) + " has a skin, but its mesh has no joints and weights");
      for (const std::uint32_t joint : set.joints)
        if (joint >= document_.skins[node.skin].joints.size())
          document_.fail(called("node", i) + " refers to joint " + std::to_string(joint) + " of " +
                         std::to_string(document_.skins[node.skin].joints.size()));
    }
  }

  // Many nodes may show one mesh: each has vertices and facets of its own.
  void require_modest() const {
    constexpr std::size_t most_per_byte = 256;
    std::size_t count = 0;
    for (const std::uint32_t i : document_.drawn) {
      for (const VertexSet& set : document_.meshes[document_.nodes[i].mesh].vertices) count += set.positions.size();
      for (const Primitive& p : document_.meshes[document_.nodes[i].mesh].primitives) count += p.facets.size();
      if (count > most_per_byte * bytes_) document_.fail("shows more vertices than a file of this size can mean");
    }
  }

  void read_animation(std::size_t i) {
    const morula_tinygltf::Animation& from = model_.animations[i];
    std::vector<Channel> channels;
    std::set<std::pair<std::uint32_t, Channel::Path>> moved;
    for (std::size_t c = 0; c < from.channels.size(); ++c) {
      const morula_tinygltf::AnimationChannel& own = from.channels[c];
      const std::string owner = called("animation", i) + ", channel " + std::to_string(c);
      Channel channel{};
      channel.node = index(own.target_node, document_.nodes.size(), owner, "node");
      if (own.target_path == "translation")
        channel.path = Channel::Path::translation;
      else if (own.target_path == "rotation")
        channel.path = Channel::Path::rotation;
      else if (own.target_path == "scale")
        channel.path = Channel::Path::scale;
      else if (own.target_path == "weights")
        channel.path = Channel::Path::weights;
      else
        document_.fail(owner + " moves " + in_quotes(own.target_path) + ", which glTF does not know");
      const Node& node = document_.nodes[channel.node];
      if (!moved.insert({channel.node, channel.path}).second) document_.fail(owner + " moves what another one moves");
      if (node.has_matrix && channel.path != Channel::Path::weights)
        document_.fail(owner + " moves a node that has a matrix");
      const auto& sampler = from.samplers[index(own.sampler, from.samplers.size(), owner, "sampler")];
      read_keys(sampler, node, channel, owner);
      channels.push_back(std::move(channel));
    }
    document_.animations.push_back(std::move(channels));
  }

  void read_keys(const morula_tinygltf::AnimationSampler& sampler, const Node& node, Channel& channel,
                 const std::string& owner) const {
    const std::string& kind = sampler.interpolation;
    if (kind == "LINEAR")
      channel.interpolation = Channel::Interpolation::linear;
    else if (kind == "STEP")
      channel.interpolation = Channel::Interpolation::step;
    else if (kind == "CUBICSPLINE")
      channel.interpolation = Channel::Interpolation::cubic;
    else
      document_.fail(owner + " is interpolated by " + in_quotes(kind) + ", which glTF does not know");
    channel.times = accessors_.numbers(sampler.input, TINYGLTF_TYPE_SCALAR, owner + "'s times");
    if (channel.times.empty()) document_.fail(owner + " has no times");
    for (std::size_t k = 0; k < channel.times.size(); ++k)
      if (channel.times[k] < 0 || (k > 0 && !(channel.times[k] > channel.times[k - 1])))
        document_.fail(owner + " has times that are negative or do not go up");
    const bool is_weights = channel.path == Channel::Path::weights;
    channel.width = is_weights ? (node.mesh == none ? 0 : document_.meshes[node.mesh].weights.size())
                    : channel.path == Channel::Path::rotation ? 4
                                                              : 3;
    if (channel.width == 0) document_.fail(owner + " moves weights of a node without morph targets");
    const int type = is_weights ? TINYGLTF_TYPE_SCALAR : channel.width == 4 ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3;
    channel.values = accessors_.numbers(sampler.output, type, owner + "'s values");
    const std::size_t each = channel.interpolation == Channel::Interpolation::cubic ? 3 : 1;
    const std::size_t groups = channel.values.size() / (each * channel.width);
    if (groups != channel.times.size() || channel.values.size() % (each * channel.width) != 0)
      document_.fail(owner + " has " + std::to_string(channel.times.size()) + " times, but values for " +
                     std::to_string(groups));
  }

  const morula_tinygltf::Model& model_;
  std::size_t bytes_;
  Document document_;
  Accessors accessors_;
};

}  // namespace

Document read_document(const fs::path& path, std::string_view bytes) {
  Container file = opened(path, bytes);
  const morula_tinygltf::Model model = loaded(file);
  std::size_t size = file.json.size();
  for (const morula_tinygltf::Buffer& buffer : model.buffers) size += buffer.data.size();
  return Reader(path, model, size).read();
}

}  // namespace morula::gltf
