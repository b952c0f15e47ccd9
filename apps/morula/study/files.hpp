// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A whole study: run, judged, and written as study.json, CSV and SVG files.
#pragma once

#include "study/claims.hpp"
#include "study/figures.hpp"
#include "study/tables.hpp"

namespace morula::cli {

struct StudyPicture {
  std::string id;
  std::string title;
  std::string svg;
};

struct Study {
  StudyPlan plan;
  StudyResult result;
  StudyCost cost;
  std::vector<StudyClaim> claims;  // over all bodies
  std::vector<StudyFigure> figures;
  std::vector<StudyTable> tables;
  std::vector<StudyPicture> pictures;
  Json json;  // of study.json
};

/// Throws as run_study.
Study make_study(const StudyPlan& plan, const StudyCache& cache, Workers& workers, const std::stop_token& stop,
                 const std::function<void(double, std::string)>& progress);

/// Writes into a folder that exists. Each file appears whole or not at all.
void write_study(const Study& study, const std::filesystem::path& folder);

/// What must not happen: `exact` bare, or without a crossing in its contacts, or spheres that do not come back to rest.
/// In words.
std::vector<std::string> study_faults(const StudyResult& result);

/// For people: a claim and its verdict a line, then the numbers.
std::string claims_text(const std::vector<StudyClaim>& claims);
std::string contents_text(const Study& study);

}  // namespace morula::cli
