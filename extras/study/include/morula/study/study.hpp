// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Study: its run, its claims, and its output as study.json, CSV and SVG files and as a page.
#pragma once

#include <morula/page/page.hpp>
#include <morula/study/claims.hpp>
#include <morula/study/figures.hpp>

namespace morula::study {

struct Picture {
  std::string id;
  std::string title;
  std::string svg;
  std::string pdf;
};

struct Study {
  Plan plan;
  Result result;
  Cost cost;
  std::vector<Claim> claims;           ///< claims over all trials
  std::optional<Stability> stability;  ///< verdicts of two halves of the seeds, compared
  std::vector<Figure> figures;
  std::vector<Table> tables;
  std::vector<Picture> pictures;
};

/// Makes a study. Throws like run().
Study make_study(Plan plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// The text of study.json, with everything. Only `cost` and parts marked `timed` contain times.
std::string study_json(const Study& study);
/// One line per body, tree, motion, rule, sample and level, with all digits.
std::string cells_csv(const Plan& plan, const Result& result);
/// A figure and its companions of one group: one row per curve and sample.
std::string figure_csv(std::span<const Figure> group);
std::string table_csv(const Table& table);
/// A figure and its companions as a drawing, one panel each: for pages, for print, and as pgfplots for LaTeX.
std::string figure_svg(std::span<const Figure> group);
std::string figure_pdf(std::span<const Figure> group);
std::string figure_pgf(std::span<const Figure> group);
/// The figures of each group.
std::vector<std::span<const Figure>> groups_of(std::span<const Figure> figures);

/// File formats of figures. Tables are always CSV; pictures have no CSV and no PGF.
enum class FigureFormat : std::uint8_t { svg, csv, pdf, pgf };
/// The name, which is also the file extension: "svg", "csv", "pdf", "pgf".
std::string_view name(FigureFormat format);
std::span<const FigureFormat> all_figure_formats();
std::vector<FigureFormat> default_figure_formats();

/// Writes study.json, tables and figures into an existing folder. The write of each file is atomic.
void write_study(const Study& study, const std::filesystem::path& folder,
                 const std::vector<FigureFormat>& formats = default_figure_formats());

/// index.html of a study, for make_page(): claims and figures, and next to them the first body on its medial tree (or
/// its first tree), in every motion, with approach2 and exact. The frames are the samples of the figures.
PageContent study_page(const Study& study, Workers& workers = serial_workers(), const Progress& progress = {});

/// Violated guarantees, as text: `exact` with uncovered surface or with a crossing outside its contacts, or spheres
/// that do not return to rest.
std::vector<std::string> faults(const Plan& plan, const Result& result);

/// Text for readers: a line for each claim and its verdict, then the numbers.
std::string claims_text(std::span<const Claim> claims);
/// A line about the trials, and one about the stability of verdicts, if it is known.
std::string trials_text(const Study& study);
/// The files that write_study() writes, a line each.
std::string contents_text(const Study& study, const std::vector<FigureFormat>& formats = default_figure_formats());

/// Three sentences, from the claims and the figures: claims of the paper, their verdicts, and looseness next to
/// uncovered surface.
std::vector<std::string> summary_of(const Study& study);

}  // namespace morula::study
