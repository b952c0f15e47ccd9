// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <morula/io/mesh_file.hpp>
#include <morula/io/modal_file.hpp>
#include <morula/io/skin_bounds_file.hpp>
#include <morula/io/skin_file.hpp>
#include <stdexcept>
#include <support/scratch_folder.hpp>

#include "gltf_files.hpp"

namespace morula::test {
namespace {

template <class Call>
std::string parts_error(const Call& call) {
  try {
    call();
  } catch (const FileError& error) {
    return error.what();
  }
  return {};
}

namespace fs = std::filesystem;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(GltfParts, bones_and_primitives_are_those_of_the_file_in_the_order_of_readers) {
  const ScratchFolder folder;
  GltfMaker arm = bending_arm();
  // A primitive of lines ahead of the triangles counts in numbers of primitives.
  Json& primitives = arm.json["meshes"][0]["primitives"];
  Json lines = primitives[0];
  lines["mode"] = 1;
  lines.erase("indices");
  primitives.insert(primitives.begin(), lines);
  for (std::size_t i = 0; i < arm.json["nodes"].size(); ++i) arm.json["nodes"][i]["name"] = "n" + std::to_string(i);
  const fs::path path = folder.file("arm.gltf", arm.text());
  const GltfParts parts = read_gltf_parts(path);
  const Mesh mesh = read_mesh(path);
  ASSERT_EQ(parts.bones.size(), read_skin(path, mesh).bone_count);
  // The oracle walks the JSON: nodes with a mesh in the order of the scene.
  std::size_t bone = 0, primitive = 0, facets = 0;
  for (const int node : std::vector<int>(arm.json["scenes"][0]["nodes"])) {
    const Json& own = arm.json["nodes"][static_cast<std::size_t>(node)];
    if (!own.contains("mesh")) continue;
    std::vector<int> joints;
    if (own.contains("skin"))
      joints = arm.json["skins"][own["skin"].get<std::size_t>()]["joints"].get<std::vector<int>>();
    for (std::uint32_t k = 0; k < joints.size(); ++k) {
      const GltfBone& b = parts.bones[bone++];
      EXPECT_EQ(b.node, static_cast<std::uint32_t>(joints[k]));
      EXPECT_EQ(b.name, "n" + std::to_string(joints[k]));
      EXPECT_EQ(b.skin, own["skin"].get<std::uint32_t>());
      EXPECT_EQ(b.joint, k);
      EXPECT_EQ(b.mesh_node, static_cast<std::uint32_t>(node));
    }
    if (joints.empty()) {
      const GltfBone& b = parts.bones[bone++];
      EXPECT_EQ(b.node, static_cast<std::uint32_t>(node));
      EXPECT_FALSE(b.skin || b.joint || b.mesh_node);
    }
    const Json& all = arm.json["meshes"][own["mesh"].get<std::size_t>()]["primitives"];
    for (std::uint32_t p = 0; p < all.size(); ++p) {
      if (all[p].value("mode", 4) == 1) continue;
      const GltfPrimitive& found = parts.primitives.at(primitive++);
      EXPECT_EQ(found.node, static_cast<std::uint32_t>(node));
      EXPECT_EQ(found.mesh, own["mesh"].get<std::uint32_t>());
      EXPECT_EQ(found.primitive, p);
      facets += found.facet_count;
    }
  }
  EXPECT_EQ(bone, parts.bones.size());
  EXPECT_EQ(primitive, parts.primitives.size());
  EXPECT_EQ(facets, mesh.facet_count());
  EXPECT_TRUE(parts.targets.empty());
}

TEST(GltfParts, targets_are_those_of_the_nodes_with_their_weights_at_rest) {
  const ScratchFolder folder;
  GltfMaker arm = bending_arm();
  const int still = arm.floats(std::vector<float>(30), "VEC3"), four = arm.floats(std::vector<float>(12), "VEC3");
  arm.json["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", still}}, {{"POSITION", still}}};
  arm.json["meshes"][0]["weights"] = {0.25, -1};
  arm.json["meshes"][1]["primitives"][0]["targets"] = {{{"POSITION", four}}};
  arm.json["nodes"][3]["weights"] = {3};
  const fs::path path = folder.file("arm.gltf", arm.text());
  const std::vector<GltfTarget> found = read_gltf_parts(path).targets;
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found.size(), read_modes(path, read_mesh(path)).mode_count);
  const auto expect = [&](std::size_t k, std::uint32_t node, std::uint32_t mesh, std::uint32_t target, double weight) {
    EXPECT_EQ(found[k].node, node);
    EXPECT_EQ(found[k].mesh, mesh);
    EXPECT_EQ(found[k].target, target);
    EXPECT_EQ(found[k].rest_weight, weight);
  };
  expect(0, 0, 0, 0, 0.25);
  expect(1, 0, 0, 1, -1);
  expect(2, 3, 1, 0, 3);
}

TEST(GltfExtra, all_other_bytes_of_a_text_stay_as_they_are) {
  const ScratchFolder folder;
  // Blanks, numbers with many digits, escapes, and braces in strings.
  const std::string start =
      "{ \"asset\": {\"version\" : \"2.0\", \"generator\":\"{\\\"}[,\\\\\" },\n \"x\": 0.10000000149011612,";
  const auto extended = [&](const std::string& text) {
    const fs::path from = folder.file("a.gltf", text), to = folder.path() / "b.gltf";
    write_gltf_extra(from, to, "bounds", "{\"a\":[1]}");
    return bytes_of(to);
  };
  EXPECT_EQ(extended(start + "\"y\":[{}]\n}\n"), start + "\"y\":[{}]\n,\"extras\":{\"bounds\":{\"a\":[1]}}}\n");
  EXPECT_EQ(extended(start + "\"extras\" : { } ,\"y\":\"extras\"}"),
            start + "\"extras\" : { \"bounds\":{\"a\":[1]}} ,\"y\":\"extras\"}");
  EXPECT_EQ(extended(start + "\"extras\":{\"bounds\":[2,{\"bounds\":3}], \"z\":1}}"),
            start + "\"extras\":{\"bounds\":{\"a\":[1]}, \"z\":1}}");
  EXPECT_EQ(extended(start + "\"y\":{\"extras\":5},\"extras\":{\"q\":\"bounds\"}}"),
            start + "\"y\":{\"extras\":5},\"extras\":{\"q\":\"bounds\",\"bounds\":{\"a\":[1]}}}");
}

TEST(GltfExtra, a_binary_file_keeps_its_chunks_and_is_read_as_before) {
  const ScratchFolder folder;
  const std::string bytes = bending_arm().glb();
  const fs::path from = folder.file("arm.glb", bytes), to = folder.path() / "with.glb";
  for (const std::string value : {"1", "12", "123", "1234"}) {
    write_gltf_extra(from, to, "bounds", value);
    const std::string copy = bytes_of(to);
    const auto number = [](const std::string& text, std::size_t at) {
      std::uint32_t value_at = 0;
      for (std::size_t k = 4; k-- > 0;) value_at = value_at << 8 | static_cast<unsigned char>(text[at + k]);
      return value_at;
    };
    EXPECT_EQ(number(copy, 8), copy.size());
    const std::size_t old_json = number(bytes, 12), new_json = number(copy, 12);
    EXPECT_EQ(new_json % 4, 0u);
    EXPECT_EQ(copy.substr(20 + new_json), bytes.substr(20 + old_json));
    Json json = Json::parse(copy.substr(20, new_json));
    EXPECT_EQ(json["extras"]["bounds"].dump(), value);
    json.erase("extras");
    EXPECT_EQ(json, Json::parse(bytes.substr(20, old_json)));
    EXPECT_EQ(read_mesh(to).positions, read_mesh(from).positions);
  }
}

// For the parser, the text ends at a character 0.
TEST(GltfExtra, what_follows_the_text_is_no_part_of_it) {
  const ScratchFolder folder;
  const std::string object = "{\"asset\":{\"version\":\"2.0\"}";
  for (const std::string after : {"", "\"", "{}", "}", ",\"extras\":{\"a\":1}}", "[[["}) {
    const fs::path from = folder.file("a.gltf", object + "}" + '\0' + after), to = folder.path() / "b.gltf";
    write_gltf_extra(from, to, "bounds", "1");
    EXPECT_EQ(bytes_of(to), object + ",\"extras\":{\"bounds\":1}}") << after;
  }
  std::string json = object + "}";
  json.resize((json.size() / 4 + 1) * 4, '\0');
  std::string bytes = "glTF";
  const auto append = [&](std::size_t number) {
    for (int k = 0; k < 4; ++k) bytes += static_cast<char>(number >> 8 * k);
  };
  append(2), append(20 + json.size()), append(json.size());
  const fs::path from = folder.file("a.glb", bytes + "JSON" + json), to = folder.path() / "b.glb";
  write_gltf_extra(from, to, "bounds", "1");
  const std::string copy = bytes_of(to);
  EXPECT_EQ(copy.find('\0', 20), copy.npos);
  EXPECT_EQ(Json::parse(copy.substr(20))["extras"]["bounds"], 1);

  const auto write = [&](const std::string& name, const std::string& value) {
    write_gltf_extra(from, to, name, value);
  };
  using namespace std::string_literals;
  EXPECT_THROW(write("bounds", "1\0\""s), std::invalid_argument);
  EXPECT_THROW(write("\xff", "1"), std::invalid_argument);
  EXPECT_THROW(write("a\0b"s, "1"), std::invalid_argument);
  EXPECT_THROW(write("a\\u0041", "1"), std::invalid_argument);
  EXPECT_THROW(write("a\":1,\"b", "1"), std::invalid_argument);
  write("\xc3\xa9", "1");
}

TEST(GltfExtra, files_that_cannot_have_one_are_named) {
  const ScratchFolder folder;
  const auto problem = [&](const std::string& text, const fs::path& to) {
    const fs::path from = folder.file("a.gltf", text);
    return parts_error([&] { write_gltf_extra(from, to, "bounds", "1"); });
  };
  const fs::path to = folder.path() / "b.gltf";
  const std::string asset = "{\"asset\":{\"version\":\"2.0\"}";
  EXPECT_NE(problem("{}", to).find("that is no glTF"), std::string::npos);
  EXPECT_NE(problem("{", to).find("is not JSON"), std::string::npos);
  EXPECT_NE(problem(asset + ",\"extras\":3}", to).find("are no object"), std::string::npos);
  EXPECT_NE(problem(asset + ",\"extr\\u0061s\":{}}", to).find("escapes"), std::string::npos);
  EXPECT_NE(problem(asset + "}", folder.path() / "b.glb").find("give it that extension"), std::string::npos);
  fs::create_directory(folder.path() / "other");
  const std::string with_file = asset + ",\"images\":[{\"uri\":\"skin.png\"}]}";
  EXPECT_NE(problem(with_file, folder.path() / "other" / "b.gltf").find("into its folder"), std::string::npos);
  EXPECT_FALSE(fs::exists(to));
  EXPECT_EQ(problem(with_file, to), "");
  EXPECT_THROW(write_gltf_extra(folder.path() / "a.gltf", to, "bounds", "{"), std::invalid_argument);
  EXPECT_THROW(write_gltf_extra(folder.path() / "a.gltf", to, "a\"b", "1"), std::invalid_argument);
}

}  // namespace
}  // namespace morula::test
