// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Small glTF files made by hand.
#pragma once

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace morula::test {

using Json = nlohmann::json;

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

/// A file in the making: its JSON, and the bytes of its one buffer.
struct GltfMaker {
  Json json{{"asset", {{"version", "2.0"}}}};
  std::string buffer;

  /// A view of the next bytes; returns its number. Aligned to 4.
  int view(std::string_view bytes, int stride = 0) {
    while (buffer.size() % 4 != 0) buffer += '\0';
    Json own{{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) own["byteStride"] = stride;
    json["bufferViews"].push_back(own);
    buffer += bytes;
    return static_cast<int>(json["bufferViews"].size()) - 1;
  }
  int accessor(Json own) {
    json["accessors"].push_back(std::move(own));
    return static_cast<int>(json["accessors"].size()) - 1;
  }
  /// An accessor over a view of its own. type: "VEC3"; component: 5126.
  template <class Number>
  int add(const std::vector<Number>& numbers, const char* type, int component, bool normalized = false) {
    const std::size_t width = type == std::string_view("SCALAR") ? 1
                              : type == std::string_view("VEC3") ? 3
                              : type == std::string_view("VEC4") ? 4
                                                                 : 16;
    std::string bytes(numbers.size() * sizeof(Number), '\0');
    std::memcpy(bytes.data(), numbers.data(), bytes.size());
    Json own{
        {"bufferView", view(bytes)}, {"componentType", component}, {"count", numbers.size() / width}, {"type", type}};
    if (normalized) own["normalized"] = true;
    return accessor(own);
  }
  int floats(const std::vector<float>& numbers, const char* type) { return add(numbers, type, 5126); }
  int shorts(const std::vector<std::uint16_t>& numbers, const char* type) { return add(numbers, type, 5123); }

  /// The numbers of what was added last to a list, such as "nodes".
  int push(const char* list, Json item) {
    json[list].push_back(std::move(item));
    return static_cast<int>(json[list].size()) - 1;
  }

  std::string with_uri(const std::string& uri) const {
    Json copy = json;
    if (!buffer.empty()) copy["buffers"] = {{{"uri", uri}, {"byteLength", buffer.size()}}};
    return copy.dump();
  }
  /// A .gltf with its buffer inside.
  std::string text() const { return with_uri("data:application/octet-stream;base64," + base64(buffer)); }
  std::string glb() const {
    Json copy = json;
    copy["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string words = copy.dump(), bytes = buffer;
    while (words.size() % 4 != 0) words += ' ';
    while (bytes.size() % 4 != 0) bytes += '\0';
    const auto number = [](std::size_t value) {
      std::string text(4, '\0');
      for (std::size_t k = 0; k < 4; ++k) text[k] = static_cast<char>(value >> (8 * k) & 255);
      return text;
    };
    return "glTF" + number(2) + number(28 + words.size() + bytes.size()) + number(words.size()) + "JSON" + words +
           number(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
};

/// A tetrahedron under one node, in floats and 16-bit indices.
inline GltfMaker tetrahedron() {
  GltfMaker file;
  const int positions = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1.5f}, "VEC3");
  const int indices = file.shorts({0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, "SCALAR");
  file.push("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  file.push("nodes", {{"mesh", 0}});
  file.push("scenes", {{"nodes", {0}}});
  file.json["scene"] = 0;
  return file;
}

/// A strip of quads along x, its two joints bending it at x = 2; the second joint turns by 90 degrees about z within a
/// second. A second node, a tetrahedron without a skin, is carried up meanwhile.
inline GltfMaker bending_arm() {
  GltfMaker file;
  std::vector<float> positions, weights;
  std::vector<std::uint16_t> joints, indices;
  for (int i = 0; i <= 4; ++i)
    for (int side = 0; side < 2; ++side) {
      for (const float x : {static_cast<float>(i), static_cast<float>(side), 0.0f}) positions.push_back(x);
      const float second = i < 2 ? 0.0f : i == 2 ? 0.5f : 1.0f;
      for (const float w : {1 - second, second, 0.0f, 0.0f}) weights.push_back(w);
      for (const std::uint16_t j : {0, 1, 0, 0}) joints.push_back(j);
    }
  for (std::uint16_t i = 0; i < 8; i += 2)
    for (const int k : {0, 2, 1, 1, 2, 3}) indices.push_back(static_cast<std::uint16_t>(i + k));
  const int p = file.floats(positions, "VEC3"), w = file.floats(weights, "VEC4"), j = file.shorts(joints, "VEC4"),
            f = file.shorts(indices, "SCALAR");
  const int inverse = file.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1,   //
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -2, 0, 0, 1},  // joint 1 stands at x = 2
                                  "MAT4");
  const int times = file.floats({0, 1}, "SCALAR");
  const float half = 0.70710678f;
  const int turns = file.floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4");
  const int rises = file.floats({0, 0, 5, 0, 2, 5}, "VEC3");
  const int four = file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3"),
            faces = file.shorts({0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, "SCALAR");
  file.push("meshes",
            {{"primitives", {{{"attributes", {{"POSITION", p}, {"JOINTS_0", j}, {"WEIGHTS_0", w}}}, {"indices", f}}}}});
  file.push("meshes", {{"primitives", {{{"attributes", {{"POSITION", four}}}, {"indices", faces}}}}});
  file.push("nodes", {{"mesh", 0}, {"skin", 0}, {"translation", {100, 100, 100}}});  // which a skin ignores
  file.push("nodes", {{"children", {2}}});
  file.push("nodes", {{"translation", {2, 0, 0}}});
  file.push("nodes", {{"mesh", 1}, {"translation", {0, 0, 5}}, {"scale", {2, 2, 2}}});
  file.push("scenes", {{"nodes", {0, 1, 3}}});
  file.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", inverse}});
  file.push("animations", {{"samplers", {{{"input", times}, {"output", turns}}, {{"input", times}, {"output", rises}}}},
                           {"channels",
                            {{{"sampler", 0}, {"target", {{"node", 2}, {"path", "rotation"}}}},
                             {{"sampler", 1}, {"target", {{"node", 3}, {"path", "translation"}}}}}}});
  return file;
}

}  // namespace morula::test
