// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "run/cell_store.hpp"

#include <fmt/format.h>

#include <fstream>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>

namespace morula::study {
namespace {

/// 64-bit FNV-1a.
std::uint64_t content_hash(const std::string& text) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

std::filesystem::path path_of(const Cache& cache, const std::string& stem, const Json& settings,
                              const char* extension) {
  std::string safe = stem;
  for (char& c : safe)
    if (c == ' ' || c == '/' || c == '\\' || c == ':') c = '-';
  return cache.folder() / fmt::format("{}-{:016x}{}", safe, content_hash(json_text(settings, -1)), extension);
}

}  // namespace

Cache::Cache(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) throw FileError(fmt::format("cannot make {}: {}", folder_.string(), error.message()));
}

std::optional<Json> find(const Cache* cache, const std::string& stem, const Json& settings) {
  if (cache == nullptr) return std::nullopt;
  std::ifstream file(path_of(*cache, stem, settings, ".json"), std::ios::binary);
  if (!file) return std::nullopt;
  const Json stored = Json::parse(file, nullptr, false);
  if (!stored.is_object() || !stored.contains("settings") || !stored.contains("result")) return std::nullopt;
  if (stored["settings"] != settings) return std::nullopt;
  return stored["result"];
}

void store(const Cache* cache, const std::string& stem, const Json& settings, const Json& result) {
  if (cache == nullptr) return;
  write_whole(path_of(*cache, stem, settings, ".json"),
              json_text({{"settings", settings}, {"result", result}}, -1) + "\n");
}

std::optional<CoveredTree> find_tree(const Cache* cache, const std::string& stem, const Json& settings,
                                     const Mesh& mesh) {
  if (cache == nullptr) return std::nullopt;
  const std::filesystem::path file = path_of(*cache, stem, settings, ".morula");
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  try {
    return read_covered_tree(file, mesh);
  } catch (const FileError&) {
    return std::nullopt;
  }
}

void store_tree(const Cache* cache, const std::string& stem, const Json& settings, const CoveredTree& model) {
  if (cache != nullptr) write_tree(path_of(*cache, stem, settings, ".morula"), model);
}

}  // namespace morula::study
