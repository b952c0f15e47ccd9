// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plan of a study from its options, and its folder of results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <morula/study/study.hpp>
#include <string>
#include <vector>

namespace morula::cli {

/// Options of a study on the command line and in Python, which gives meshes in memory.
struct StudyOptions {
  std::vector<std::string> meshes;         ///< files
  std::vector<study::NamedMesh> bodies{};  ///< in memory, before those of the files
  std::vector<std::string> samples{};      ///< names of sample bodies, before all others
  std::vector<std::string> motions{};      ///< files of frames, each of the first body that it fits
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
  std::uint64_t seed = 1;  ///< the first seed; the others follow it
  std::size_t seeds = 0;   ///< 0: three, or two of a quick study
  std::string unit = "volume";
  std::vector<std::string> formats{"svg", "csv"};
  bool quick = false;
  bool variants = false;
  bool paper_amounts = false;
  std::vector<study::FollowRule> own_rules{};  ///< rules in memory, after those of `rules`
  std::vector<std::shared_ptr<const study::OwnGenerator>> own_generators{};
  /// Motions in memory, after those of the files: each of the first body with as many vertices; `body` is not read.
  std::vector<study::RecordedMotion> own_motions{};
  std::vector<study::OwnMetric> metrics{};
};

std::vector<std::string> study_rule_names();
/// The sample bodies of a study without other bodies.
std::vector<std::string> study_body_names();
std::vector<std::string> figure_format_names();
/// Each once, in the order of study::all_figure_formats(). Throws UsageError for an unknown name.
std::vector<study::FigureFormat> figure_formats(const std::vector<std::string>& names);
/// The names of the generators that the paper has.
std::vector<std::string> paper_method_names();

/// Throws UsageError, naming the option, and FileError. Reads every file of a later step once: hours of cells must not
/// end at a missing file.
study::Plan make_study_plan(const StudyOptions& options);

/// study.json, tables, figures in these formats, and index.html where there is a page, all of them or none.
/// `is_stopped` is called before they take their places. Returns whether there is a page. Throws study::Stopped.
bool write_study_folder(const study::Study& study, const std::filesystem::path& folder,
                        const std::vector<study::FigureFormat>& formats, Workers& workers,
                        const study::Progress& progress, const std::function<bool()>& is_stopped);

}  // namespace morula::cli
