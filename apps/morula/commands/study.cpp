// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula study: the evaluation of the paper again, and beside it what the paper did not measure.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/study/study.hpp>
#include <scenes/scenes.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string output = "morula-study";
  std::vector<std::string> meshes;
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
  unsigned threads = 0;
  bool json = false;
};

/// The corpus meshes with an inside, up to a size, and those that were asked for.
void add_bodies(const Options& o, study::Plan& plan) {
  for (const std::string& path : o.meshes) plan.bodies.push_back({fs::path(path).stem().string(), read_mesh(path)});
  if (o.corpus) {
    const std::vector<fs::path> paths = scenes::corpus_meshes();
    if (paths.empty()) throw UsageError("--corpus: there are no corpus meshes; fetch them with scripts/corpus");
    for (const fs::path& path : paths) {
      try {
        study::NamedMesh body{path.stem().string(), read_mesh(path)};
        if (body.mesh.facet_count() <= o.max_facets && inspect(body.mesh).has_volume())
          plan.bodies.push_back(std::move(body));
      } catch (const FileError&) {  // the corpus has broken files too
      }
    }
  }
  if (plan.bodies.empty() && o.trees.empty()) plan.bodies.push_back({"limb", sample_body("limb", o.quick ? 12 : 48)});
  std::vector<std::string> names;
  for (study::NamedMesh& body : plan.bodies) {
    const auto same = std::count(names.begin(), names.end(), body.name);
    names.push_back(body.name);
    if (same > 0) body.name += fmt::format("-{}", same + 1);
  }
}

/// Everything that is read later, read once now: hours of cells must not end at a file that was never there.
void require_sound_inputs(const study::Plan& plan) {
  for (const study::NamedMesh& body : plan.bodies) require_usable_scale(body.mesh);
  for (const study::Source& source : plan.sources)
    if (!source.file.empty()) read_tree(source.file);
}

/// The body of a tree file named MESH-METHOD.sph: one of --mesh, or of the corpus.
std::size_t body_of(study::Plan& plan, const std::string& mesh, const fs::path& tree) {
  for (std::size_t i = 0; i < plan.bodies.size(); ++i)
    if (plan.bodies[i].name == mesh) return i;
  for (const fs::path& path : scenes::corpus_meshes()) {
    if (path.stem() != mesh) continue;
    plan.bodies.push_back({mesh, read_mesh(path)});
    return plan.bodies.size() - 1;
  }
  throw UsageError(
      fmt::format("{}: there is no mesh {} for it; give it with --mesh, or fetch the corpus with "
                  "scripts/corpus",
                  tree.string(), mesh));
}

void add_tree_files(const Options& o, study::Plan& plan) {
  if (!fs::is_directory(o.trees)) throw UsageError(fmt::format("--trees {}: is no folder", o.trees));
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(o.trees))
    if (entry.is_regular_file() && entry.path().extension() == ".sph") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const bool chosen = !plan.bodies.empty();
  for (const fs::path& file : files) {
    const std::string stem = file.stem().string();
    const std::size_t dash = stem.rfind('-');
    if (dash == std::string::npos || dash == 0 || dash + 1 == stem.size()) {
      throw UsageError(fmt::format("{}: trees are to be named MESH-METHOD.sph", file.string()));
    }
    const std::string mesh = stem.substr(0, dash);
    const std::string method = stem.substr(dash + 1);
    if (!o.methods.empty() && std::find(o.methods.begin(), o.methods.end(), method) == o.methods.end()) continue;
    const bool known = std::any_of(plan.bodies.begin(), plan.bodies.end(),
                                   [&](const study::NamedMesh& body) { return body.name == mesh; });
    if (chosen && !known) continue;  // --mesh says which
    plan.sources.push_back({body_of(plan, mesh, file), method, std::nullopt, file});
  }
  if (plan.sources.empty()) {
    throw UsageError(
        fmt::format("--trees {}: no tree in it is of these meshes and methods; they are to be named "
                    "MESH-METHOD.sph",
                    o.trees));
  }
  for (std::size_t body = 0; body < plan.bodies.size(); ++body) {
    if (std::any_of(plan.sources.begin(), plan.sources.end(), [&](const study::Source& s) { return s.body == body; }))
      continue;
    throw UsageError(fmt::format("--trees {}: holds no tree of {}; name it {}-METHOD.sph", o.trees,
                                 plan.bodies[body].name, plan.bodies[body].name));
  }
  std::stable_sort(plan.sources.begin(), plan.sources.end(),
                   [](const study::Source& a, const study::Source& b) { return a.body < b.body; });
}

void require_once(const char* option, const std::vector<std::string>& names) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (std::find(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(i), names[i]) !=
        names.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError(fmt::format("{} names {} twice", option, names[i]));
}

/// Those that follow positions: all that were asked for, else the ones that differ most.
std::vector<study::FollowRule> press_rules(const study::Plan& plan, bool all) {
  std::vector<study::FollowRule> rules;
  for (const study::FollowRule& rule : plan.rules) {
    if (rule.kind != study::RuleKey::Kind::update) continue;
    const study::RuleKey key = rule.key().value();
    if (all || key == Rule::traditional || key == Rule::approach2 || key == Rule::exact) rules.push_back(rule);
  }
  return rules;
}

std::vector<std::string> study_rule_names() {
  std::vector<std::string> names;
  for (const study::RuleKey& key : study::all_rule_keys()) names.push_back(name(key));
  return names;
}

std::vector<std::string> names_of(const std::vector<Method>& methods) {
  std::vector<std::string> names;
  for (const Method method : methods) names.emplace_back(name(method));
  return names;
}

study::Plan make_plan(const Options& o) {
  study::Plan plan;
  std::vector<std::string> methods = o.methods;
  if (methods.empty()) {
    methods = names_of(study::paper_methods());
    if (!o.quick) methods.emplace_back("morula");
  }
  require_once("--methods", methods);
  if (o.trees.empty()) {
    for (const std::string& method : methods) parse_method(method);
  }
  const std::vector<std::string> rules =
      o.rules.empty()
          ? std::vector<std::string>{"traditional", "weighted", "approach1", "approach2", "exact", "rebuilt", "fresh"}
          : o.rules;
  require_once("--rules", rules);
  for (const std::string& rule : rules) {
    check_name("rule", rule, study_rule_names());
    plan.rules.emplace_back(*study::rule_key_from_name(rule));
  }
  check_name("unit", o.unit, {"volume", "box"});
  plan.unit = o.unit == "box" ? study::ErrorUnit::box : study::ErrorUnit::volume;
  plan.samples = o.frames > 0 ? o.frames : o.quick ? 5 : 13;
  plan.resolution = o.resolution > 0 ? o.resolution : o.quick ? 64 : 192;
  plan.fresh_poses = o.quick ? 1 : 2;
  plan.branching = o.branching;
  plan.depth = o.depth > 0 ? o.depth : o.quick ? 2 : 3;
  plan.seed = o.seed;
  plan.quick = o.quick;
  plan.sph_origin = parse_sph_origin(o.sph_origin);
  plan.cost_repeats = o.quick ? 3 : 9;
  if (o.quick) plan.needle_sides = 16;
  plan.motions = study::paper_motions();
  if (o.mixes) plan.mixes = study::rule_mixes(plan.depth);
  plan.press_rules = press_rules(plan, !o.rules.empty());
  add_bodies(o, plan);
  if (!o.trees.empty()) {
    add_tree_files(o, plan);
    plan.needle_sides = 0;
  } else {
    std::vector<Method> generators;
    for (const std::string& method : methods) generators.push_back(parse_method(method));
    plan.sources = study::sources_of(plan.bodies, generators);
    if (o.methods.empty() && !o.quick) plan.press_sources = study::sources_of(plan.bodies, {Method::octree});
  }
  return plan;
}

int study_command(const Options& o) {
  const fs::path folder = o.output;
  // Folders on the way are made, if there are none.
  const fs::path above = (folder.has_filename() ? folder : folder.parent_path()).parent_path();
  if (above.empty() || fs::is_directory(above)) require_folder_place(folder);
  if (!o.trees.empty()) require_not_input_folder(o.output, {o.trees});
  const study::Plan plan = make_plan(o);
  require_sound_inputs(plan);
  Workers workers = make_workers(o.threads);
  const Interrupt interrupt;
  const study::Cache cache(folder / "cells");
  Stopwatch watch;
  try {
    const study::Study study = [&] {
      Progress progress("study");
      return study::make_study(plan, workers, {&cache, interrupt.token(), [&](double share, std::string what) {
                                                 progress.update(share, std::move(what));
                                               }});
    }();
    // Into a folder in use: finished cells stay where they are, and results change together.
    WholeFolder results(folder, WholeFolder::Mode::merge);
    study::write_study(study, results.path());
    const bool with_page = has_page();
    if (with_page) {
      Progress progress("study");
      const PageContent page = study::study_page(
          study, workers, [&](double share, std::string what) { progress.update(share, std::move(what)); });
      write_whole(results.path() / "index.html", make_page(page));
    }
    if (interrupt.requested()) throw study::Stopped();
    results.commit();
    note_written(folder);
    if (o.json) {
      print_json(Json::parse(study::study_json(study)));
    } else {
      fmt::print("{}\nWhat to look at, in {} ({}; {} of {} cells were there already)\n{}",
                 study::claims_text(study.claims, o.quick), o.output, seconds(watch.lap()),
                 study.result.taken_from_cache, study.result.cell_count(), study::contents_text(study));
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
  auto o = std::make_shared<Options>();
  CLI::App* command = add_command(app, "study", "Repeat the evaluation of the paper, and say which claims hold");
  add_option(*command, "-o,--output", o->output, "Folder for figures, tables, pictures and finished cells")
      ->type_name("FOLDER")
      ->capture_default_str();
  add_option(*command, "--mesh", o->meshes, "Bodies in the place of the limb: " + readable_mesh_extensions())
      ->type_name("FILE")
      ->delimiter(',');
  add_flag(*command, "--corpus", o->corpus, "All corpus meshes with an inside, with a summary");
  add_option(*command, "--max-facets", o->max_facets, "Of the corpus, meshes of at most so many facets")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--methods", o->methods,
             fmt::format("Of {}; default: {}, morula (not with --quick)", fmt::join(method_names(), ", "),
                         fmt::join(names_of(study::paper_methods()), ", ")))
      ->type_name("LIST")
      ->delimiter(',');
  add_option(*command, "--rules", o->rules,
             fmt::format("Of {}; default: all but wrapped", fmt::join(study_rule_names(), ", ")))
      ->type_name("LIST")
      ->delimiter(',');
  add_flag(*command, "--mixes", o->mixes, "Also rank mixes of rules per level");
  add_option(*command, "--trees", o->trees, "Trees built elsewhere, named MESH-METHOD.sph")->type_name("FOLDER");
  add_sph_origin(*command, o->sph_origin);
  add_option(*command, "--frames", o->frames,
             "Samples of each motion, rest and the full amount among them; default: 13")
      ->type_name("N")
      ->transform(whole_number(3, 1000));
  add_option(*command, "--resolution", o->resolution, "Voxels along the longest side of the level's box; default: 192")
      ->type_name("N")
      ->transform(whole_number(8, 4096));
  add_option(*command, "--unit", o->unit, "Looseness over: volume (of the object) or box (of the object, at rest)")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--branching", o->branching, "Most children of a node, 2 to 64")
      ->type_name("N")
      ->transform(whole_number(2, 64))
      ->capture_default_str();
  add_option(*command, "--depth", o->depth, "Levels below the root, 1 to 6; the last two are measured; default: 3")
      ->type_name("N")
      ->transform(whole_number(1, 6));
  add_option(*command, "--seed", o->seed, "Of every random choice")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_flag(*command, "--quick", o->quick, "A small limb, depth 2, few samples and voxels: seconds instead of minutes");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(
      *command,
      "An interrupted study goes on where it stopped when the same command is given again.\n"
      "Example:\n  morula study -o study/\n  morula study -o bunny/ --mesh bunny.obj --methods medial,grid --mixes");
  on_use(*command, [o, &run] { run = [o] { return study_command(*o); }; });
}

}  // namespace morula::cli
