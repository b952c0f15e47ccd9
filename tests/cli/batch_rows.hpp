// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes for a batch, and what it made of them.
#pragma once

#include <map>
#include <sstream>

#include "workbench.hpp"

namespace morula::test {

// Six meshes in a folder: three different ones, two copies of one of them, and one that is no mesh.
inline void write_meshes(const Workbench& bench) {
  std::filesystem::create_directories(bench / "in" / "more");
  bench.require("sample bar -o in/bar.obj --resolution 6");
  bench.require("sample limb -o in/limb.obj --resolution 10");
  bench.require("sample torus -o in/more/torus.ply --resolution 8");
  for (const char* copy : {"in/again.obj", "in/more/third.obj"})
    std::filesystem::copy_file(bench / "in/bar.obj", bench / copy);
  bench.write("in/broken.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n");
}

inline std::map<std::string, nlohmann::json> rows_of(const Workbench& bench, const std::string& table) {
  std::map<std::string, nlohmann::json> rows;
  std::istringstream lines(bench.read(table));
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json row = nlohmann::json::parse(line);
    rows.emplace(row.at("name"), row);
  }
  return rows;
}

// Files of results and trees by the names of their meshes.
inline std::map<std::string, std::filesystem::path> kept_files(const Workbench& bench, const std::string& out,
                                                               const std::string& folder, const std::string& ending) {
  std::map<std::string, std::filesystem::path> files;
  for (const auto& [name, row] : rows_of(bench, out + "/table.jsonl")) {
    const std::string key = row.at("key");
    files[name] = bench / out / folder / key.substr(0, 2) / (key + ending);
  }
  return files;
}

}  // namespace morula::test
