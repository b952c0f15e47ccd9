// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Real meshes for tests. They are other people's and are fetched, not committed: without them such a test is skipped.
#pragma once

#include <filesystem>
#include <scenes/scenes.hpp>
#include <string>

namespace morula::test {

inline constexpr const char* no_corpus =
    "real meshes are fetched, not committed: run scripts/corpus, which needs a network, or set MORULA_CORPUS";

/// Of the corpus; empty where it is not there.
inline std::filesystem::path corpus_file(const std::string& name) {
  const auto folder = scenes::corpus_folder();
  return folder && std::filesystem::is_regular_file(*folder / name) ? *folder / name : std::filesystem::path();
}

}  // namespace morula::test
