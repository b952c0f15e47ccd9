// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula view: one HTML file that shows a body and its spheres in motion.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/page/page.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct ViewArguments {
  std::string mesh;
  std::string tree;
  std::string motion;
  std::string modes;
  std::string coordinates;
  std::string output;
  std::vector<std::string> rules;
  std::string study;
  std::string title;
  std::string sph_origin = "none";
  bool measure = true;
  bool rule_given = false, weld = false;
  unsigned threads = 0;
  bool json = false;

  /// The file of frames: positions, or coordinates of modes; empty for a body at rest.
  const std::string& moving() const { return modes.empty() ? motion : coordinates; }
};

std::string file_name(const std::filesystem::path& path) {
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

PageMotion read_motion(const ViewArguments& o, const LoadedMesh& loaded) {
  const Mesh& mesh = loaded.mesh;
  PageMotion motion{.body = std::filesystem::path(o.mesh).stem().string(),
                    .name = o.moving().empty() ? "rest" : file_name(o.moving()),
                    .facets = mesh.facets,
                    .frame_names = {},
                    .frames = {}};
  if (!o.modes.empty()) {
    const Modes modes = read_modes(o.modes, mesh);
    const ModalCoordinates coordinates = read_coordinates(o.coordinates, modes.mode_count);
    for (std::size_t i = 0; i < coordinates.frame_count(); ++i) {
      motion.frame_names.push_back(fmt::format("{} frame {}", file_name(o.coordinates), i));
      move_by_modes(modes, mesh.positions, coordinates.frame(i), motion.frames.emplace_back(mesh.positions));
    }
    return motion;
  }
  if (o.motion.empty()) {
    motion.frame_names = {file_name(o.mesh)};
    motion.frames = {mesh.positions};
    return motion;
  }
  const Motion frames(o.motion, mesh, {.weld = loaded.merged()});
  Progress progress("reading");
  for (std::size_t i = 0; i < frames.frame_count(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(frames.frame_count()));
    motion.frame_names.push_back(file_name(frames.frame_name(i)));
    motion.frames.push_back(frames.frame(i));
  }
  return motion;
}

/// The text of a study.json; nothing without one.
std::string read_study(const std::string& path) {
  if (path.empty()) return {};
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UsageError(fmt::format("{}: cannot be read; --study takes the study.json of a study", path));
  std::string text(std::istreambuf_iterator<char>(file), {});
  const Json study = Json::parse(text, nullptr, false);
  const bool whole = study.is_object() && study.contains("claims") && study.contains("figures");
  if (!whole) throw UsageError(fmt::format("{}: is not the JSON of a study (claims, figures)", path));
  return text;
}

/// Spheres that are shown as they are: of every frame, or balls without a motion that they would have to follow.
bool shows_given_spheres(const ViewArguments& o) {
  const FileKind kind = file_kind(o.tree);
  return kind == FileKind::sphere_frames || (kind == FileKind::balls && o.motion.empty());
}

PageScene given_spheres(const ViewArguments& o, const Mesh& mesh, const PageMotion& motion, Workers& workers) {
  Progress progress("measuring");
  const auto tell = [&](double share) { progress.update(share); };
  if (file_kind(o.tree) == FileKind::balls) {
    SphereTree tree = read_tree(o.tree).tree;
    return show_spheres(
        motion, mesh, file_name(o.tree), "balls as they are", [&](std::size_t) { return tree; }, o.measure, workers,
        tell);
  }
  const SphereFrames frames(o.tree);
  if (frames.frame_count() != motion.frames.size()) {
    throw UsageError(fmt::format("{} in {} but {} of spheres in {}: give the motion that they were updated for",
                                 counted(motion.frames.size(), "frame"), o.motion.empty() ? o.mesh : o.motion,
                                 counted(frames.frame_count(), "frame"), o.tree));
  }
  return show_spheres(
      motion, mesh, file_name(o.tree), "spheres as they are", [&](std::size_t i) { return frames.frame(i); }, o.measure,
      workers, tell);
}

void print_result(const ViewArguments& o, const PageContent& content, const BuildReport& report, std::size_t bytes) {
  const PageMotion& motion = content.motions.front();
  std::vector<std::string> rules;
  for (const PageScene& scene : content.scenes) rules.push_back(scene.rule);
  if (o.json) {
    Json json{{"mesh", o.mesh},
              {"tree", o.tree},
              {"motion", o.moving().empty() ? Json(nullptr) : Json(o.moving())},
              {"output", o.output},
              {"rules", rules},
              {"frames", motion.frames.size()},
              {"vertices", motion.frames.front().size()},
              {"facets", motion.facets.size()},
              {"spheres", content.scenes.front().rest.node_count()},
              {"bytes", bytes}};
    if (!report.growth.empty()) json["growth"] = growth_json(report);
    print_json(json);
    return;
  }
  if (!report.growth.empty()) fmt::print("{}\n", growth_text(report));
  fmt::print("shown    {}, {}, {}\n", counted(motion.facets.size(), "facet"),
             counted(content.scenes.front().rest.node_count(), "sphere"), counted(motion.frames.size(), "frame"));
  fmt::print("rule     {}\n", fmt::join(rules, "; "));
  fmt::print("written  {}, {} MB: open it in a browser\n", o.output, figure(1e-6 * static_cast<double>(bytes)));
}

int view_command(const ViewArguments& o) {
  if (!has_page()) throw UsageError(fmt::format("this morula was built without its page: {}", why_no_page()));
  const std::string ending = extension(o.output);
  if (ending != ".html" && ending != ".htm") throw UsageError(fmt::format("{}: pages are written as .html", o.output));
  require_output_place(o.output);
  if (o.modes.empty() != o.coordinates.empty())
    throw UsageError(
        fmt::format("a modal model needs both: add {}", o.modes.empty() ? "--modes FILE" : "--coords FILE"));
  if (!o.modes.empty() && !o.motion.empty())
    throw UsageError(fmt::format("both positions ({}) and --modes are given: leave out one", o.motion));
  if (!o.modes.empty() && o.weld)
    throw UsageError(
        fmt::format("{}: modes are read for the vertices of the file; leave out --weld, and give a mesh and modes of "
                    "the welded body",
                    o.modes));
  require_not_input(o.output, {o.mesh, o.tree, o.motion, o.modes, o.coordinates, o.study});
  std::vector<std::vector<Rule>> rules;
  for (const std::string& rule : o.rules) rules.push_back(parse_rules(rule));
  for (const std::vector<Rule>& list : rules) require_position_rules(list);
  Workers workers = make_workers(o.threads);

  PageContent content;
  content.study = read_study(o.study);
  const LoadedMesh loaded = load_mesh(o.mesh, o.weld);
  const Mesh& mesh = loaded.mesh;
  const bool as_given = shows_given_spheres(o);
  if (as_given && o.rule_given) {
    throw UsageError(
        fmt::format("--rule says how a tree follows a motion, and {} is shown as it is: leave it out", o.tree));
  }
  if (as_given) rules.clear();
  const CoveredTree model =
      as_given ? CoveredTree{} : read_covered_tree(o.tree, mesh, parse_sph_origin(o.sph_origin, &mesh), workers);
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (rules[i].size() > model.tree.level_count()) {
      throw UsageError(fmt::format("--rule {}: names level {}, but {} has levels 0 to {}", o.rules[i],
                                   rules[i].size() - 1, o.tree, model.tree.level_count() - 1));
    }
  }
  content.motions.push_back(read_motion(o, loaded));
  if (as_given) content.scenes.push_back(given_spheres(o, mesh, content.motions.front(), workers));
  for (const std::vector<Rule>& list : rules) {
    Progress progress(o.measure ? "updating and measuring" : "updating");
    content.scenes.push_back(follow_motion(content.motions.front(), mesh, model, file_name(o.tree), list, o.measure,
                                           workers, [&](double share) { progress.update(share); }));
  }
  content.title = o.title.empty() ? content.motions.front().body : o.title;

  const std::string page = make_page(content);
  write_whole(o.output, page);
  note_written(o.output);
  print_result(o, content, model.report, page.size());
  return exit_done;
}

}  // namespace

void add_view(CLI::App& app, Run& run) {
  auto o = std::make_shared<ViewArguments>();
  o->rules = {"exact"};
  CLI::App* command = add_command(app, "view", "Write a page that shows a body and its spheres in motion");
  add_option(*command, "MESH", o->mesh, "Mesh at rest: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "TREE", o->tree,
             "Its tree: .morula; or .sph, .json and .npz, for which a cover is made first; or the .npz of update, or "
             "balls (.ply)")
      ->required()
      ->type_name("");
  add_option(*command, "MOTION", o->motion, fmt::format("Positions: {}; without it the body at rest", motion_kinds()))
      ->type_name("");
  add_weld(*command, o->weld, "MESH");
  add_option(*command, "--modes", o->modes, "Instead of MOTION: modes, a .npy of shape (modes, vertices, 3)")
      ->type_name("FILE");
  add_option(*command, "--coords", o->coordinates, "Coordinates of the modes, a .npy of shape (frames, modes)")
      ->type_name("FILE");
  add_option(*command, "-o,--output", o->output, "Page: one .html file that needs no network")
      ->type_name("PAGE")
      ->required();
  CLI::Option* const rule =
      add_option(
          *command, "--rule", o->rules,
          fmt::format("{}; or by level, such as 0:exact,2:approach2; repeated: a choice in the page; default: exact",
                      fmt::join(rule_names(), ", ")))
          ->type_name("RULE")
          ->expected(1)
          ->take_all();
  add_flag(*command, "--measure,!--no-measure", o->measure,
           "Measure looseness, uncovered area and distance of every frame and level (default: on)");
  add_option(*command, "--study", o->study, "Results to show next to the body: the study.json of a study")
      ->type_name("FILE");
  add_option(*command, "--title", o->title, "Title of the page; default: the name of the mesh")->type_name("TEXT");
  add_sph_origin(*command, o->sph_origin);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula view liver.obj liver.morula motion/ -o liver.html\n"
             "  morula view liver.obj liver.morula motion/ -o liver.html --rule exact --rule approach2");
  on_use(*command, [o, rule, &run] {
    o->rule_given = rule->count() > 0;
    run = [o] { return view_command(*o); };
  });
}

}  // namespace morula::cli
