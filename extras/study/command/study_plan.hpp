// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a study is about, from its options; and its folder of results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <morula/study/study.hpp>
#include <string>
#include <vector>

namespace morula::cli {

/// What a study is asked for on the command line and in Python, where meshes are given as they are.
struct StudyOptions {
  std::vector<std::string> meshes;         ///< files
  std::vector<study::NamedMesh> bodies{};  ///< in memory, before those of the files
  bool corpus = false;
  std::size_t max_facets = 20000;
  std::vector<std::string> methods;
  std::vector<std::string> rules;
  bool mixes = false;
  std::string trees;
  std::string sph_origin = "bbox-center";
  std::size_t frames = 0;
  int resolution = 0;
  int branching = 8;
  int depth = 0;
  std::uint64_t seed = 1;
  std::string unit = "volume";
  bool quick = false;
  bool variants = false;
  bool paper_amounts = false;
  std::vector<study::FollowRule> own_rules{};  ///< rules in memory, after those of `rules`
  std::vector<std::shared_ptr<const study::OwnGenerator>> own_generators{};
  std::vector<study::OwnMetric> metrics{};
};

std::vector<std::string> study_rule_names();
/// The names of the generators that the paper has.
std::vector<std::string> paper_method_names();

/// Throws UsageError, naming the option, and FileError. What is read later is read once now: hours of cells must not
/// end at a file that was never there.
study::Plan make_study_plan(const StudyOptions& options);

/// study.json, CSV and SVG files, and index.html where there is a page, all of them or none. `is_stopped` is asked
/// before they take their places. Returns whether there is a page. Throws study::Stopped.
bool write_study_folder(const study::Study& study, const std::filesystem::path& folder, Workers& workers,
                        const study::Progress& progress, const std::function<bool()>& is_stopped);

}  // namespace morula::cli
