// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <scenes/scenes.hpp>

#include "shared/command.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

/// The resolution of sample bodies: the limb of a full study has that of `morula sample`.
int sample_resolution(const std::string& name, bool quick) {
  return quick ? 16 : name == "limb" ? 48 : 32;
}

void add_samples(const std::vector<std::string>& names, bool quick, study::Plan& plan) {
  const std::vector<std::string> known(sample_body_names().begin(), sample_body_names().end());
  for (const std::string& name : names) {
    check_name("body", name, known);
    plan.bodies.push_back({name, sample_body(name, sample_resolution(name, quick))});
  }
}

/// Sample bodies, meshes in memory, those of files, and the corpus meshes with an inside, up to a size.
void add_bodies(const StudyOptions& o, study::Plan& plan) {
  add_samples(o.samples, o.quick, plan);
  plan.bodies.insert(plan.bodies.end(), o.bodies.begin(), o.bodies.end());
  for (const std::string& path : o.meshes) plan.bodies.push_back({fs::path(path).stem().string(), load_mesh(path)});
  if (o.corpus) {
    const std::vector<fs::path> paths = scenes::corpus_meshes();
    if (paths.empty()) throw UsageError("--corpus: there are no corpus meshes; fetch them with scripts/corpus");
    for (const fs::path& path : paths) {
      try {
        study::NamedMesh body{path.stem().string(), load_mesh(path)};
        if (body.mesh.facet_count() <= o.max_facets && inspect(body.mesh).has_volume())
          plan.bodies.push_back(std::move(body));
      } catch (const FileError&) {  // the corpus has broken files too
      }
    }
  }
  if (plan.bodies.empty() && o.trees.empty()) add_samples(study_body_names(), o.quick, plan);
  std::vector<std::string> names;
  for (study::NamedMesh& body : plan.bodies) {
    const auto same = std::count(names.begin(), names.end(), body.name);
    names.push_back(body.name);
    if (same > 0) body.name += fmt::format("-{}", same + 1);
  }
}

/// A plan's samples begin at rest: a first frame at rest is dropped, unless it is the only one.
void drop_rest(std::vector<std::vector<Vec3>>& frames, const Mesh& mesh) {
  if (frames.size() > 1 && frames.front() == mesh.positions) frames.erase(frames.begin());
}

std::vector<std::vector<Vec3>> frames_of(const Motion& motion) {
  std::vector<std::vector<Vec3>> frames;
  for (std::size_t i = 0; i < motion.frame_count(); ++i) frames.push_back(motion.frame(i));
  return frames;
}

/// The name, or with a number if another motion of the plan begins with it.
std::string free_motion_name(const study::Plan& plan, std::string name) {
  std::replace(name.begin(), name.end(), ' ', '-');
  std::string free = name;
  for (std::size_t m = 0, same = 1; m < plan.motion_count(); ++m) {
    const std::string known = plan.motion_name(m);
    if (known.substr(0, known.find(' ')) != free) continue;
    free = fmt::format("{}-{}", name, ++same);
    m = 0;
  }
  return free;
}

/// A motion belongs to the first body that its frames fit.
void add_motions(const StudyOptions& o, study::Plan& plan) {
  for (const std::string& path : o.motions) {
    study::RecordedMotion recorded{.name = free_motion_name(plan, fs::path(path).stem().string()), .frames = {}};
    for (; recorded.body < plan.bodies.size(); ++recorded.body) {
      const Mesh& mesh = plan.bodies[recorded.body].mesh;
      try {
        recorded.frames = frames_of(Motion(path, mesh));
        drop_rest(recorded.frames, mesh);
        break;
      } catch (const FileError&) {
        if (recorded.body + 1 == plan.bodies.size()) throw;
      }
    }
    plan.recorded.push_back(std::move(recorded));
  }
  for (study::RecordedMotion recorded : o.own_motions) {
    const std::size_t vertices = recorded.frames.empty() ? 0 : recorded.frames.front().size();
    const auto body = std::find_if(plan.bodies.begin(), plan.bodies.end(),
                                   [&](const study::NamedMesh& b) { return b.mesh.vertex_count() == vertices; });
    if (body == plan.bodies.end())
      throw UsageError(fmt::format("motion {}: no body has {} vertices", recorded.name, vertices));
    recorded.body = static_cast<std::size_t>(body - plan.bodies.begin());
    recorded.name = free_motion_name(plan, recorded.name);
    drop_rest(recorded.frames, body->mesh);
    plan.recorded.push_back(std::move(recorded));
  }
}

/// Reads every file of a later step once: hours of cells must not end at a missing file.
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
    plan.bodies.push_back({mesh, load_mesh(path)});
    return plan.bodies.size() - 1;
  }
  throw UsageError(
      fmt::format("{}: there is no mesh {} for it; give it with --mesh, or fetch the corpus with "
                  "scripts/corpus",
                  tree.string(), mesh));
}

void add_tree_files(const StudyOptions& o, study::Plan& plan) {
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
    plan.sources.push_back({.body = body_of(plan, mesh, file), .method = method, .file = file});
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

/// Rules that follow positions: all requested ones, otherwise the ones that differ most.
std::vector<study::FollowRule> press_rules(const study::Plan& plan, bool all) {
  std::vector<study::FollowRule> rules;
  for (const study::FollowRule& rule : plan.rules) {
    if (rule.kind != study::RuleKey::Kind::update) continue;
    const study::RuleKey key = rule.key().value();
    if (all || key == Rule::traditional || key == Rule::approach2 || key == Rule::exact) rules.push_back(rule);
  }
  return rules;
}

std::vector<std::string> names_of(const std::vector<Method>& methods) {
  std::vector<std::string> names;
  for (const Method method : methods) names.emplace_back(name(method));
  return names;
}

study::SphOrigin study_origin(const SphOrigin& given) {
  using Kind = study::SphOrigin::Kind;
  switch (given.kind) {
    case SphOrigin::Kind::none:
      break;
    case SphOrigin::Kind::box_center:
      return {Kind::box_center, {}};
    case SphOrigin::Kind::point:
      return {Kind::point, given.point};
  }
  return {};
}

}  // namespace

std::vector<std::string> study_body_names() {
  return {"limb", "bar", "torus", "blob", "hand", "vessel"};
}

std::vector<std::string> study_rule_names() {
  std::vector<std::string> names;
  for (const study::RuleKey& key : study::all_rule_keys()) names.push_back(name(key));
  return names;
}

std::vector<std::string> figure_format_names() {
  std::vector<std::string> names;
  for (const study::FigureFormat format : study::all_figure_formats()) names.emplace_back(name(format));
  return names;
}

std::vector<study::FigureFormat> figure_formats(const std::vector<std::string>& names) {
  for (const std::string& given : names) check_name("format", given, figure_format_names());
  std::vector<study::FigureFormat> formats;
  for (const study::FigureFormat format : study::all_figure_formats())
    if (std::find(names.begin(), names.end(), name(format)) != names.end()) formats.push_back(format);
  return formats;
}

std::vector<std::string> paper_method_names() {
  return names_of(study::paper_methods());
}

study::Plan make_study_plan(const StudyOptions& o) {
  study::Plan plan;
  figure_formats(o.formats);  // unknown names end here, before any work
  std::vector<std::string> methods = o.methods;
  if (methods.empty()) {
    methods = paper_method_names();
    if (!o.quick) methods.emplace_back("optimized");
  }
  require_once("--methods", methods);
  if (o.trees.empty()) {
    for (const std::string& method : methods) parse_method(method);
  }
  std::vector<std::string> rules = o.rules.empty() ? std::vector<std::string>{"traditional", "weighted", "approach1",
                                                                              "approach2",   "exact",    "rebuilt"}
                                                   : o.rules;
  if (o.rules.empty() && !o.quick) rules.emplace_back("fresh");  // new trees take more time than all else
  require_once("--rules", rules);
  for (const std::string& rule : rules) {
    check_name("rule", rule, study_rule_names());
    plan.rules.emplace_back(*study::rule_key_from_name(rule));
  }
  check_name("unit", o.unit, {"volume", "box"});
  plan.unit = o.unit == "box" ? study::ErrorUnit::box : study::ErrorUnit::volume;
  plan.samples = o.frames > 0 ? o.frames : o.quick ? 5 : 13;
  // Every other sample decides, rest and the full amount among them.
  if (!o.quick && plan.samples % 2 == 1 && plan.samples >= 9)
    for (std::size_t i = 0; i < plan.samples; i += 2) plan.decisive.push_back(i);
  plan.resolution = o.resolution > 0 ? o.resolution : o.quick ? 64 : 192;
  plan.measures.half_grid = true;
  plan.fresh_poses = o.quick ? 1 : 2;
  plan.branching = o.branching;
  plan.depth = o.depth > 0 ? o.depth : 3;
  plan.seeds.clear();
  for (std::size_t i = 0; i < (o.seeds > 0 ? o.seeds : o.quick ? 2 : 3); ++i) plan.seeds.push_back(o.seed + i);
  plan.quick = o.quick;
  plan.sph_origin = study_origin(parse_sph_origin(o.sph_origin));
  plan.cost_repeats = o.quick ? 3 : 9;
  if (o.quick) plan.needle_sides = 16;
  plan.motions = study::paper_motions();
  if (o.mixes) plan.mixes = study::rule_mixes(plan.depth);
  plan.press_rules = press_rules(plan, !o.rules.empty());
  plan.rules.insert(plan.rules.end(), o.own_rules.begin(), o.own_rules.end());
  plan.metrics = o.metrics;
  plan.variants = o.variants;
  plan.paper_amounts = o.paper_amounts;
  add_bodies(o, plan);
  add_motions(o, plan);
  if (!o.trees.empty()) {
    add_tree_files(o, plan);
    plan.needle_sides = 0;
  } else {
    std::vector<Method> generators;
    for (const std::string& method : methods) generators.push_back(parse_method(method));
    plan.sources = study::sources_of(plan.bodies, generators, plan.seeds);
    if (o.methods.empty() && !o.quick) plan.press_sources = study::sources_of(plan.bodies, {Method::octree});
  }
  for (std::size_t body = 0; body < plan.bodies.size(); ++body)
    for (const auto& generator : o.own_generators) plan.sources.push_back(study::own_source(body, generator));
  std::stable_sort(plan.sources.begin(), plan.sources.end(),
                   [](const study::Source& a, const study::Source& b) { return a.body < b.body; });
  require_sound_inputs(plan);
  return plan;
}

bool write_study_folder(const study::Study& study, const fs::path& folder,
                        const std::vector<study::FigureFormat>& formats, Workers& workers,
                        const study::Progress& progress, const std::function<bool()>& is_stopped) {
  // Into a folder in use: finished cells stay where they are, and results change together.
  WholeFolder results(folder, WholeFolder::Mode::merge);
  study::write_study(study, results.path(), formats);
  const bool with_page = has_page();
  if (with_page) {
    const PageContent page = study::study_page(study, workers, progress);
    write_whole(results.path() / "index.html", make_page(page));
  }
  if (is_stopped()) throw study::Stopped();
  results.commit();
  return with_page;
}

}  // namespace morula::cli
