// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula study: the evaluation of the paper for bodies and seeds, and further measurements.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/study/study.hpp>

#include "batch/manifest.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"
#include "study_plan.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

struct StudyArguments : StudyOptions {
  std::string output = "morula-study";
  std::string shard = "1/1";
  unsigned threads = 0;
  bool json = false;
};

/// Computes the cells of one part, which a run without --shard joins.
int study_shard(const StudyArguments& o, const study::Plan& plan, const Shard& shard, Workers& workers,
                const study::Cache& cache, const Interrupt& interrupt) {
  toolbox::Stopwatch watch;
  const study::Result result = [&] {
    Progress progress("study");
    study::RunOptions options{.cache = &cache, .stop = interrupt.token()};
    options.progress = [&](double share, std::string what) { progress.update(share, std::move(what)); };
    options.shard = {shard.number, shard.count};
    return study::run(plan, workers, options);
  }();
  if (o.json) {
    print_json({{"shard", o.shard}, {"cells", result.cell_count()}, {"from_cache", result.taken_from_cache}});
  } else {
    fmt::print(
        "{} of part {} in {} ({}; {} were there already). When all parts are done, the same command without "
        "--shard joins them.\n",
        counted(result.cell_count(), "cell"), o.shard, cache.folder().string(), seconds(watch.lap()),
        result.taken_from_cache);
  }
  return exit_done;
}

std::string cell_text(const study::TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return toolbox::figure(*number);
  if (const auto* count = std::get_if<std::size_t>(&value)) return std::to_string(*count);
  return "-";
}

/// The tables of --variants and --paper-amounts as text, except for long descriptions.
std::string asked_tables(const study::Study& study) {
  std::string text;
  for (const study::Table& table : study.tables) {
    if (table.id != "variants" && table.id != "paper-amounts") continue;
    const auto kept = [&](const auto& cells, const auto& as_text) {
      std::vector<std::string> texts;
      for (std::size_t i = 0; i < cells.size(); ++i)
        if (table.columns[i] != "reading") texts.push_back(as_text(cells[i]));
      return texts;
    };
    Table shown(kept(table.columns, [](const std::string& column) { return column; }), 3);
    for (const std::vector<study::TableValue>& row : table.rows) shown.add(kept(row, cell_text));
    text += fmt::format("\n{}\n{}\n{}", table.title, wrapped(table.note), shown.text());
  }
  return text;
}

int study_command(const StudyArguments& o) {
  const fs::path folder = o.output;
  // Folders on the way are made, if there are none.
  const fs::path above = (folder.has_filename() ? folder : folder.parent_path()).parent_path();
  if (above.empty() || fs::is_directory(above)) require_folder_place(folder);
  if (!o.trees.empty()) require_not_input_folder(o.output, {o.trees});
  const Shard shard = parse_shard(o.shard);
  const std::vector<study::FigureFormat> formats = figure_formats(o.formats);
  const study::Plan plan = make_study_plan(o);
  Workers workers = make_workers(o.threads);
  const Interrupt interrupt;
  const study::Cache cache(folder / "cells");
  toolbox::Stopwatch watch;
  try {
    if (!shard.is_all()) return study_shard(o, plan, shard, workers, cache, interrupt);
    const study::Study study = [&] {
      Progress progress("study");
      return study::make_study(plan, workers, {&cache, interrupt.token(), [&](double share, std::string what) {
                                                 progress.update(share, std::move(what));
                                               }});
    }();
    const bool with_page = [&] {
      Progress progress("study");
      return write_study_folder(
          study, folder, formats, workers,
          [&](double share, std::string what) { progress.update(share, std::move(what)); },
          [&] { return interrupt.requested(); });
    }();
    note_written(folder);
    if (o.json) {
      print_json(Json::parse(study::study_json(study)));
    } else {
      fmt::print("{}\n{}{}\nFiles to look at, in {} ({}; {} of {} cells were there already)\n{}",
                 wrapped(study::trials_text(study)), wrapped(study::claims_text(study.claims)), asked_tables(study),
                 o.output, seconds(watch.lap()), study.result.taken_from_cache, study.result.cell_count(),
                 study::contents_text(study, formats));
      if (with_page) {
        fmt::print("- index.html: the claims, the figures and the body in motion: open it in a browser\n");
      } else {
        fmt::print("- no index.html: this morula was built without its page\n");
      }
    }
    const std::vector<std::string> faults = study::faults(plan, study.result);
    for (const std::string& fault : faults) complain(exit_check_failed, "{}: please report it", fault);
    return faults.empty() ? exit_done : exit_check_failed;
  } catch (const study::Stopped&) {
    return say_interrupted(interrupt.exit_code(),
                           fmt::format("; finished cells are kept in {}: the same command goes on from there",
                                       (folder / "cells").string()));
  }
}

}  // namespace

void add_study(CLI::App& app, Run& run) {
  auto o = std::make_shared<StudyArguments>();
  CLI::App* command = add_command(app, "study", "Repeat the evaluation of the paper, and say which claims hold");
  add_option(*command, "-o,--output", o->output, "Folder for figures, tables, pictures and finished cells")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_option(
      *command, "--bodies", o->samples,
      fmt::format("Sample bodies; default: {}, unless other bodies are given", fmt::join(study_body_names(), ", ")))
      ->type_name("LIST")
      ->delimiter(',');
  add_option(*command, "--mesh", o->meshes, "Bodies of files: " + readable_mesh_extensions())
      ->type_name("FILE")
      ->delimiter(',');
  add_option(*command, "--motion", o->motions,
             "Also motions of one body each, the first that they fit: " + motion_kinds())
      ->type_name("FILE")
      ->delimiter(',');
  add_flag(*command, "--corpus", o->corpus, "All corpus meshes with an inside, with a summary");
  add_option(*command, "--max-facets", o->max_facets, "Largest number of facets of corpus meshes")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--methods", o->methods,
             fmt::format("Methods, of {}; default: {}, optimized (not with --quick)", fmt::join(method_names(), ", "),
                         fmt::join(paper_method_names(), ", ")))
      ->type_name("LIST")
      ->delimiter(',');
  add_option(*command, "--rules", o->rules,
             fmt::format("Rules, of {}; default: all except wrapped, with --quick also without fresh",
                         fmt::join(study_rule_names(), ", ")))
      ->type_name("LIST")
      ->delimiter(',');
  add_flag(*command, "--mixes", o->mixes, "Also rank mixes of rules per level");
  add_option(*command, "--trees", o->trees, "Existing trees, named MESH-METHOD.sph")->type_name("FOLDER");
  add_sph_origin(*command, o->sph_origin);
  add_option(*command, "--frames", o->frames,
             "Number of samples of each motion, including rest and the full amount; default: 13")
      ->type_name("N")
      ->transform(whole_number(3, 1000));
  add_option(*command, "--resolution", o->resolution, "Voxels along the longest side of the level's box; default: 192")
      ->type_name("N")
      ->transform(whole_number(8, 4096));
  add_option(*command, "--unit", o->unit, "Looseness over: volume (of the object) or box (of the object, at rest)")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--branching", o->branching, "Largest number of children of a node, 2 to 64")
      ->type_name("N")
      ->transform(whole_number(2, 64))
      ->capture_default_str();
  add_option(*command, "--depth", o->depth, "Levels below the root, 1 to 6; the last two are measured; default: 3")
      ->type_name("N")
      ->transform(whole_number(1, 6));
  add_option(*command, "--formats", o->formats,
             fmt::format("Files of figures, of {}", fmt::join(figure_format_names(), ", ")))
      ->type_name("LIST")
      ->delimiter(',')
      ->capture_default_str();
  add_option(*command, "--seed", o->seed, "First seed of all random choices")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--seeds", o->seeds,
             "Number of seeds, and so of trials of each body; default: 3, or 2 with --quick")
      ->type_name("N")
      ->transform(whole_number(1, 1000));
  add_option(*command, "--shard", o->shard,
             "Only the cells of a part: 2/8 is the second of eight; a run without it joins all parts")
      ->type_name("I/N")
      ->capture_default_str();
  add_flag(*command, "--variants", o->variants,
           "Also every reading of the paper's ambiguous sentences on approach1 and approach2, as a table");
  add_flag(*command, "--paper-amounts", o->paper_amounts,
           "Also the amounts and units at which Fig. 2 ends where the paper's printed axes do");
  add_flag(*command, "--quick", o->quick, "Small bodies, few samples and voxels: a minute instead of several");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(
      *command,
      "An interrupted study goes on where it stopped when the same command is given again.\n"
      "Example:\n  morula study -o study/\n  morula study -o bunny/ --mesh bunny.obj --methods medial,grid --mixes");
  on_use(*command, [o, &run] { run = [o] { return study_command(*o); }; });
}

}  // namespace morula::cli
