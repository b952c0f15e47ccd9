// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a batch keeps, byte by byte: names as text without loss, and results that are whole or none.
#include <gtest/gtest.h>

#include <batch/manifest.hpp>
#include <batch/task.hpp>
#include <set>
#include <shared/name_text.hpp>
#include <string>

#include "workbench.hpp"

namespace morula::test {
namespace {

using nlohmann::json;

bool is_utf8(const std::string& text) {
  try {
    return !json(text).dump().empty();
  } catch (const json::type_error&) {
    return false;
  }
}

// Names of up to four pieces, of which some are bytes of UTF-8, some are none, and some look like what stands for them.
std::vector<std::string> names() {
  const std::vector<std::string> pieces{"a",    "\\",      "x",    "F",        "\\xFF",        "\xff",
                                        "\xc3", "\xa9",    "\xe0", "\xed\xa0", "\xf4\x90\x80", "\n",
                                        "\x7f", "\xc3\xa9"};
  std::vector<std::string> all{""};
  for (std::size_t begin = 0, length = 0; length < 4; ++length) {
    const std::size_t end = all.size();
    for (; begin < end; ++begin)
      for (const std::string& piece : pieces) all.push_back(all[begin] + piece);
  }
  return all;
}

TEST(NameText, is_utf8_and_loses_nothing) {
  std::set<std::string> distinct;
  for (const std::string& name : names()) {
    const std::string text = cli::text_of_name(name);
    ASSERT_TRUE(is_utf8(text));
    ASSERT_EQ(cli::name_of_text(text), name) << text;
    if (is_utf8(name) && name.find("\\x") == std::string::npos) {
      ASSERT_EQ(text, name) << "UTF-8 stays as it is";
    }
    distinct.insert(name);
  }
  std::set<std::string> texts;
  for (const std::string& name : distinct) texts.insert(cli::text_of_name(name));
  EXPECT_EQ(texts.size(), distinct.size());
  EXPECT_EQ(cli::text_of_name("a\xff\\b"), "a\\xFF\\\\b");
}

std::string real_result(const std::string& key) {
  cli::ProcessEnd end;
  end.out = R"({"vertices":74,"facets":144,"mesh_hash":"0x1","method":"octree","branching":8,"depth":1,"spheres":8,
                "tree_hash":"0x2","complete":true,"covered":true,"levels":[{"nodes":1},{"nodes":8}]})";
  const ScratchFolder folder;
  cli::BatchTask task;
  task.key = key;
  task.mesh = "bar.obj";
  task.tree = folder.file("bar.morula", "a tree");
  bool is_kept = false;
  const cli::Json result = cli::result_of(end, task, is_kept);
  EXPECT_TRUE(is_kept);
  EXPECT_EQ(result.at("status"), "ok") << result;
  EXPECT_EQ(result.at("nodes"), 9);
  return cli::result_text(result);
}

TEST(BatchResult, is_whole_or_none) {
  const std::string key(32, 'a'), text = real_result(key);
  ASSERT_TRUE(cli::whole_result(text, key));
  EXPECT_FALSE(cli::whole_result(text, std::string(32, 'b'))) << "another key's";
  for (std::size_t length = 0; length + 2 < text.size(); ++length)
    EXPECT_FALSE(cli::whole_result(text.substr(0, length), key)) << length;
  for (std::size_t i = 0; i < text.size(); ++i) {
    for (const char other : {'0', 'x', '"', '}', '\xff'}) {
      std::string changed = text;
      changed[i] = other;
      if (json::accept(changed) && json::parse(changed) == json::parse(text)) continue;
      EXPECT_FALSE(cli::whole_result(changed, key)) << changed;
    }
  }
}

TEST(BatchResult, of_other_json_is_none) {
  const std::string key(32, 'a'), text = real_result(key);
  for (const char* other : {"", "null", "1", "\"ok\"", "[]", "{}", R"({"status":"ok"})", R"([{"status":"ok"}])", "[[[[",
                            R"({"key":1,"hash":2,"status":3,"message":4})"})
    EXPECT_FALSE(cli::whole_result(other, key)) << other;
  const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
  EXPECT_FALSE(cli::whole_result(deep, key));
  EXPECT_FALSE(cli::whole_result("{\"x\":" + deep + "," + text.substr(text.find('{') + 1), key));
  EXPECT_FALSE(cli::whole_result(std::string(1'000'000, '['), key));
  const json result = json::parse(text);
  for (const auto& [name, value] : result.items()) {
    for (const json& wrong : {json(), json(7), json("7"), json::array(), json::object(), json(true)}) {
      json changed = result;
      changed[name] = wrong;
      if (wrong == value) continue;
      EXPECT_FALSE(cli::whole_result(changed.dump(), key)) << name << ": " << wrong;
    }
    json missing = result;
    missing.erase(name);
    EXPECT_FALSE(cli::whole_result(missing.dump(), key)) << name;
  }
}

// Whoever makes the hash fit finds no way to end a batch either.
TEST(BatchResult, that_is_forged_makes_a_table_or_is_none) {
  const std::string key(32, 'a');
  const cli::Json result = cli::Json::parse(real_result(key));
  int whole = 0;
  for (const auto& [name, value] : result.items()) {
    for (const cli::Json& wrong :
         {cli::Json(), cli::Json(7), cli::Json("7"), cli::Json::array(), cli::Json::object()}) {
      cli::Json forged = result;
      forged[name] = wrong;
      const auto kept = cli::whole_result(cli::result_text(cli::with_hash(forged)), key);
      if (!kept) continue;
      ++whole;
      EXPECT_NO_THROW(cli::batch_tables({{"bar.obj", key, ""}}, {{key, *kept}}, false)) << forged;
    }
  }
  EXPECT_GT(whole, 20);
}

// One chunk, of JSON.
std::string binary_gltf(const std::string& json) {
  const auto number = [](std::size_t n) {
    return std::string{static_cast<char>(n & 255), static_cast<char>(n >> 8 & 255), static_cast<char>(n >> 16 & 255),
                       static_cast<char>(n >> 24)};
  };
  return "glTF" + number(2) + number(20 + json.size()) + number(json.size()) + "JSON" + json;
}

TEST(BatchKey, of_gltf_counts_its_buffers) {
  for (const bool is_binary : {false, true}) {
    const ScratchFolder folder;
    const std::string name = is_binary ? "meshes/a.glb" : "meshes/a.gltf";
    const auto write = [&](const std::string& json) { folder.file(name, is_binary ? binary_gltf(json) : json); };
    const auto key = [&] {
      return cli::key_of_file({"a", "a", folder.path() / name, {}}, {"--method", "octree"}, nullptr).key;
    };
    write(R"({"buffers":[{"uri":"a%20b.bin"},{"uri":"../c.bin"},{"uri":"data:,x"},{"uri":7},7]})");
    const std::string without = key();
    folder.file("meshes/a b.bin", "one");
    const std::string first = key();
    folder.file("meshes/a b.bin", "two");
    EXPECT_EQ((std::set<std::string>{without, first, key()}).size(), 3u) << name;
    folder.file("meshes/a b.bin", "one");
    EXPECT_EQ(key(), first) << name;
    // What no reader opens is not looked at.
    folder.file("c.bin", "one");
    EXPECT_EQ(key(), first) << name;
    const std::string deep = std::string(1'000'000, '[') + std::string(1'000'000, ']');
    write(R"({"buffers":)" + deep + "}");
    EXPECT_FALSE(key().empty()) << name;
  }
  EXPECT_TRUE(cli::buffers_of(binary_gltf(R"({"buffers":[{"uri":"a"}]})").substr(0, 30), ".glb").empty());
  EXPECT_TRUE(cli::buffers_of("glTF", ".glb").empty());
}

}  // namespace
}  // namespace morula::test
