// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula update: the spheres of every frame of a motion.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/update/body.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <optional>

#include "commands/frames.hpp"
#include "commands/measure_table.hpp"
#include "commands/sphere_output.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/plots.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

struct UpdateArguments {
  std::string mesh;
  std::string tree;
  FrameFiles files;
  std::string output;
  std::optional<std::string> rule;
  RuleDetailNames details;
  std::optional<double> measured_share;
  std::string sph_origin = "none";
  std::string format;
  bool conservative = false;
  bool poses = true;
  bool check = true;
  bool measure = false, weld = false;
  std::string plot;
  unsigned threads = 0;
  bool json = false;
};

/// The body that moves: with the one tree, or with the tightest of those for known poses.
class Mover {
 public:
  Mover(const Mesh& mesh, const CoveredTree& model, UpdateOptions options, bool with_poses, Workers& workers) {
    if (with_poses) {
      posed_.emplace(mesh, model, RebuildOptions{.thread = RebuildThread::none}, workers);
    } else {
      body_.emplace(mesh, model, std::move(options), workers);
    }
  }
  const Body& body() const { return posed_ ? posed_->body() : *body_; }
  UpdateStatus update(const Frames& frames, const std::vector<Vec3>& positions, Workers& workers) {
    return posed_ ? posed_->update(positions, workers).update : frames.update(*body_, workers);
  }
  /// Changes from one tree to another; nothing where there is one.
  std::optional<std::uint64_t> changes() const { return posed_ ? std::optional(posed_->tree_version()) : std::nullopt; }

 private:
  std::optional<Body> body_;
  std::optional<RebuiltBody> posed_;
};

/// The results of the frames.
struct Outcome {
  std::vector<double> microseconds;
  UpdateStatus last;
  bool checked = false;
  std::size_t frames_not_covered = 0;
  double worst_excess = 0;
  std::string worst_frame;
  bool nesting_checked = false;
  std::size_t frames_not_nested = 0;
  std::vector<MeasuredFrame> measured;   // with --measure
  std::optional<std::uint64_t> changes;  // of trees, where there are some for known poses
  /// [level][frame]: the sum of radii over that at rest.
  std::vector<std::vector<std::optional<double>>> growth;
};

void add_growth(Outcome& outcome, const SphereTree& rest, const Body& body) {
  const SphereTree& tree = body.rest_tree();
  const auto spheres = body.sphere_state().spheres;
  outcome.growth.resize(rest.level_count());
  for (std::size_t level = 0; level < rest.level_count(); ++level) {
    double now = 0, before = 0;
    for (const std::uint32_t node : level_set(tree, std::min(level, tree.level_count() - 1)))
      now += static_cast<double>(spheres[node].radius);
    for (const std::uint32_t node : level_set(rest, level)) before += rest.spheres[node].radius;
    outcome.growth[level].push_back(before > 0 ? std::optional(now / before) : std::nullopt);
  }
}

toolbox::Plot update_plot(const UpdateArguments& o, const Outcome& outcome) {
  toolbox::Plot plot{.title = fmt::format("{}: spheres in motion", o.tree), .x_label = "frame", .panels = {}};
  toolbox::PlotPanel growth{.label = "radii, of those at rest", .lines = {}};
  for (std::size_t level = outcome.growth.size() > 1 ? 1 : 0; level < outcome.growth.size(); ++level)
    growth.lines.push_back(line_over_frames(fmt::format("level {}", level), outcome.growth[level], level));
  plot.panels.push_back(std::move(growth));
  if (o.measure) {
    for (toolbox::PlotPanel& panel : measure_plot({}, outcome.measured).panels) plot.panels.push_back(std::move(panel));
    if (outcome.measured.size() == 1) plot.panels.resize(1);
  }
  std::vector<std::optional<double>> times(outcome.microseconds.begin(), outcome.microseconds.end());
  plot.panels.push_back({.label = "update, µs", .lines = {line_over_frames("time", std::move(times), 7)}});
  return plot;
}

/// One lattice for all frames and levels, so that their figures compare.
MeasureOptions measure_options(const Mesh& rest) {
  MeasureOptions options{.grid = {.kind = VoxelGrid::Kind::fixed}, .with_protrusion = false};
  options.grid.voxel_edge = bounding_box(rest).diagonal() / options.grid.resolution;
  return options;
}

void check_frame(Outcome& outcome, const Body& body, const std::vector<Vec3>& positions, const std::string& frame,
                 Workers& workers) {
  const Certificate certificate = certify_promised_levels(body, positions, workers);
  if (!certificate.covered) ++outcome.frames_not_covered;
  if (outcome.worst_frame.empty() || certificate.worst_excess > outcome.worst_excess) {
    outcome.worst_excess = certificate.worst_excess;
    outcome.worst_frame = frame;
  }
}

Outcome update_frames(const UpdateArguments& o, const Mesh& rest, const SphereTree& rest_tree, Frames& frames,
                      Mover& mover, SphereOutput& output, Workers& workers) {
  Outcome outcome;
  outcome.checked = o.check && any_promises_cover(mover.body());
  outcome.nesting_checked = o.check && any_promises_nesting(mover.body());
  Progress progress(o.measure ? "updating and measuring" : "updating");
  for (std::size_t i = 0; i < frames.count(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(frames.count()));
    const std::vector<Vec3>& positions = frames.load(i, mover.body(), workers);
    toolbox::Stopwatch watch;
    outcome.last = mover.update(frames, positions, workers);
    outcome.microseconds.push_back(1e6 * watch.lap());
    if (!outcome.last) {
      throw UsageError(fmt::format("{}: {}; mend it, nothing was written", frames.name(i), message(outcome.last)));
    }
    const Body& body = mover.body();
    if (outcome.checked) check_frame(outcome, body, positions, frames.name(i), workers);
    if (outcome.nesting_checked && !certify_promised_nesting(body).nested) ++outcome.frames_not_nested;
    if (o.measure) {
      outcome.measured.push_back(
          {frames.name(i), o.tree,
           measure({positions, rest.facets}, body.current_tree(), measure_options(rest), workers)});
    }
    add_growth(outcome, rest_tree, body);
    output.write(body);
  }
  outcome.changes = mover.changes();
  return outcome;
}

Json outcome_json(const UpdateArguments& o, const CoveredTree& model, const Body& body, const Outcome& outcome,
                  unsigned threads) {
  const double typical = median(outcome.microseconds);
  const BindReport& bind = body.bind_report();
  Json json{{"mesh", o.mesh},
            {"tree", o.tree},
            {"motion", o.files.moving()},
            {"output", o.output},
            {"rule", describe_rules(body.options().rules, body.rest_tree().level_count())},
            {"frames", outcome.microseconds.size()},
            {"nodes", body.rest_tree().node_count()},
            {"vertices", body.vertex_count()},
            {"threads", threads},
            {"microseconds_median", typical},
            {"microseconds_worst", *std::max_element(outcome.microseconds.begin(), outcome.microseconds.end())},
            {"nanoseconds_per_vertex", 1e3 * typical / static_cast<double>(body.vertex_count())},
            {"points_tested", outcome.last.points_tested},
            {"void_spheres", bind.void_spheres},
            {"unlinked_spheres", bind.unlinked_spheres},
            {"degenerate_anchors", bind.degenerate_anchors},
            {"certificate", nullptr}};
  if (outcome.checked) {
    json["certificate"] = {{"covered", outcome.frames_not_covered == 0},
                           {"frames_not_covered", outcome.frames_not_covered},
                           {"worst_excess", outcome.worst_excess},
                           {"worst_frame", outcome.worst_frame}};
  }
  if (outcome.nesting_checked)
    json["nesting"] = {{"nested", outcome.frames_not_nested == 0}, {"frames_not_nested", outcome.frames_not_nested}};
  if (o.files.are_modal()) {
    json["modes"] = {{"file", o.files.modes}, {"count", body.options().modes.mode_count}};
  }
  if (o.files.are_skinned()) {
    json["skin"] = {{"file", o.files.skin}, {"bones", body.options().skin.bone_count}};
    if (o.measured_share) json["skin"]["nodes_measured"] = bind.nodes_measured;
  }
  if (outcome.changes) json["poses"] = {{"trees", model.poses.size()}, {"changes", *outcome.changes}};
  if (o.measure) json["measured"] = frames_json(outcome.measured);
  if (!model.report.growth.empty()) json["growth"] = growth_json(model.report);
  return json;
}

void print_measured(const std::vector<MeasuredFrame>& frames) {
  const std::vector<LevelMeasure> worst = worst_of(frames);
  fmt::print("\n{}\n{}\n", measure_table(frames, worst, false), cover_sentence(worst));
}

// How much larger spheres are than at rest; the root's value means little if there are more levels.
std::string growth_table(const Outcome& outcome) {
  Table table({"level", "radii / at rest, largest", "over the frames"}, 0, true);
  for (std::size_t level = outcome.growth.size() > 1 ? 1 : 0; level < outcome.growth.size(); ++level) {
    const std::vector<std::optional<double>>& ratios = outcome.growth[level];
    const std::optional<double> largest = *std::max_element(ratios.begin(), ratios.end());
    table.add({std::to_string(level), figure_or_na(largest), sparkline(ratios)});
  }
  return table.text();
}

// "exact, wrapped, modal and skinned".
std::string covering_rules() {
  std::vector<std::string_view> names;
  for (const RuleTraits& row : rule_table) {
    if (row.covers) names.push_back(row.name);
  }
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{} and {}", fmt::join(names, ", "), last);
}

void print_text(const UpdateArguments& o, const CoveredTree& model, const Body& body, const Outcome& outcome,
                const SphereOutput& output, unsigned threads) {
  const std::vector<Rule>& rules = body.options().rules;
  const std::size_t levels = body.rest_tree().level_count();
  const double typical = median(outcome.microseconds);
  if (!model.report.growth.empty()) fmt::print("{}\n", growth_text(model.report));
  fmt::print("rule         {}\n", describe_rules(rules, levels));
  fmt::print("frames       {} of {} and {}\n", outcome.microseconds.size(),
             counted(body.vertex_count(), "vertex", "vertices"), counted(body.rest_tree().node_count(), "sphere"));
  fmt::print("time         {} µs per frame (median; worst {}), {} ns per vertex, {}\n", figure(typical),
             figure(*std::max_element(outcome.microseconds.begin(), outcome.microseconds.end())),
             figure(1e3 * typical / static_cast<double>(body.vertex_count())), counted(threads, "thread"));
  if (outcome.changes) {
    fmt::print("poses        {} for known poses besides rest, changed {}\n", counted(model.poses.size(), "tree"),
               counted(*outcome.changes, "time"));
  }
  const BindReport& bind = body.bind_report();
  if (o.measured_share) {
    fmt::print("measured     {} on their own corners, {} moved\n", counted(bind.nodes_measured, "sphere"),
               counted(outcome.last.vertices_read, "vertex", "vertices"));
  }
  if (bind.void_spheres > 0) {
    fmt::print("note         {} enclose no vertex and follow a facet instead\n", counted(bind.void_spheres, "sphere"));
  }
  if (bind.unlinked_spheres > 0) {
    fmt::print("note         {} touch no facet and are linked to the nearest one\n",
               counted(bind.unlinked_spheres, "leaf", "leaves"));
  }
  if (outcome.checked && outcome.frames_not_covered == 0) {
    fmt::print("certificate  holds in every frame: closest to failing is {}, {} inside\n", outcome.worst_frame,
               figure(-outcome.worst_excess));
  } else if (any_promises_cover(body)) {
    fmt::print("certificate  {}\n", outcome.checked ? "FAILS" : "not checked");
  }
  if (outcome.nesting_checked) {
    fmt::print("nested       {}\n", outcome.frames_not_nested > 0
                                        ? "FAILS"
                                        : "in every frame: spheres of the rule wrapped contain their children's");
  }
  if (!std::all_of(rules.begin(), rules.end(), [&](Rule rule) { return covers(body.options(), rule); })) {
    fmt::print("note         rules other than {} may leave surface uncovered: {} shows how much\n", covering_rules(),
               o.measure ? "the table" : "--measure");
  }
  fmt::print("written      {}\n", output.name());
  if (outcome.microseconds.size() > 1) fmt::print("\n{}", growth_table(outcome));
  if (o.measure) print_measured(outcome.measured);
}

UpdateOptions update_options(const UpdateArguments& o) {
  // A given modal model is used by default; with positions `exact` is best.
  const Rule usual = o.files.are_modal() ? Rule::modal : Rule::exact;
  UpdateOptions options{.rules = o.rule ? parse_rules(*o.rule) : std::vector<Rule>{usual},
                        .conservative = o.conservative,
                        .details = parse_rule_details(o.details)};
  if (o.measured_share) {
    if (std::find(options.rules.begin(), options.rules.end(), Rule::skinned) == options.rules.end()) {
      throw UsageError("--measured is for nodes of the rule skinned: add --rule skinned");
    }
    options.details.skinned_measured = *o.measured_share;
  }
  return options;
}

/// Trees for known poses follow positions, by the rule that keeps what it promises whatever tree serves.
bool follows_poses(const UpdateArguments& o, const CoveredTree& model, const UpdateOptions& options) {
  const bool exact = std::all_of(options.rules.begin(), options.rules.end(), [](Rule r) { return r == Rule::exact; });
  return !model.poses.empty() && exact && o.files.follow() == RuleTraits::Follows::positions;
}

int update_command(const UpdateArguments& given) {
  UpdateArguments o = given;
  require_frames(o.files);
  UpdateOptions options = update_options(o);
  require_rules_followed(options.rules, o.files);
  const std::string format = sphere_format(o.format, o.output);
  require_plot_output(o.plot, {o.mesh, o.tree, o.files.motion, o.files.modes, o.files.coordinates, o.files.skin,
                               o.files.transforms, o.output});
  Workers workers = make_workers(o.threads);
  const LoadedMesh loaded = load_mesh(o.mesh, o.weld);
  const Mesh& mesh = loaded.mesh;
  Frames frames(o.files, loaded);
  options.modes = frames.take_modes();
  options.skin = frames.take_skin();
  if (o.measured_share) options.training = frames.transforms();
  require_sphere_output(
      o.output, format, frames.count(),
      {o.mesh, o.tree, o.files.motion, o.files.modes, o.files.coordinates, o.files.skin, o.files.transforms});
  const CoveredTree model = read_covered_tree(o.tree, mesh, parse_sph_origin(o.sph_origin, &mesh), workers);
  if (options.rules.size() > model.tree.level_count()) {
    throw UsageError(fmt::format("--rule {}: names level {}, but {} has levels 0 to {}", *o.rule,
                                 options.rules.size() - 1, o.tree, model.tree.level_count() - 1));
  }
  const bool with_poses = o.poses && follows_poses(o, model, options);
  if (with_poses && format == "npz") {
    throw UsageError(
        fmt::format("{}: an archive has one tree, but {} has {} for known poses: write a folder, or add "
                    "--no-poses",
                    o.output, o.tree, model.poses.size()));
  }
  Mover mover(mesh, model, std::move(options), with_poses, workers);

  SphereOutput output(o.output, format, mover.body().current_tree(), frames.count());
  const Outcome outcome = update_frames(o, mesh, model.tree, frames, mover, output, workers);
  output.commit();
  note_written(o.output);
  write_plot(o.plot, update_plot(o, outcome));
  if (o.json) {
    print_json(outcome_json(o, model, mover.body(), outcome, workers.thread_count()));
  } else {
    print_text(o, model, mover.body(), outcome, output, workers.thread_count());
  }
  if (outcome.frames_not_nested > 0) {
    return complain(exit_check_failed, "spheres stick out of their parents in {}: please report it",
                    counted(outcome.frames_not_nested, "frame"));
  }
  if (outcome.frames_not_covered == 0) return exit_done;
  return complain(exit_check_failed, "the certificate fails in {}, worst in frame {} by {}: please report it",
                  counted(outcome.frames_not_covered, "frame"), outcome.worst_frame, figure(outcome.worst_excess));
}

}  // namespace

void add_update(CLI::App& app, Run& run) {
  auto o = std::make_shared<UpdateArguments>();
  CLI::App* command = add_command(app, "update", "Move the spheres of a tree along with a motion of its mesh");
  add_option(*command, "MESH", o->mesh, "Mesh at rest: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "TREE", o->tree,
             "Its tree: .morula; or .sph, .json, .npz and a flat set (.ply), for which a cover is made first")
      ->required()
      ->type_name("");
  add_option(*command, "MOTION", o->files.motion, fmt::format("Positions: {}", motion_kinds()))->type_name("");
  add_option(*command, "-o,--output", o->output, "Folder for 0000.sph, 0001.sph, ...; or FILE.npz for all frames")
      ->type_name("PATH")
      ->required();
  add_weld(*command, o->weld, "MESH");
  add_option(*command, "--modes", o->files.modes, "Instead of MOTION: modes, a .npy of shape (modes, vertices, 3)")
      ->type_name("FILE");
  add_option(*command, "--coords", o->files.coordinates, "Coordinates of the modes, a .npy of shape (frames, modes)")
      ->type_name("FILE");
  add_option(*command, "--skin", o->files.skin,
             "Instead of MOTION: weights, a .npy of shape (vertices, bones); or glTF")
      ->type_name("FILE");
  add_option(*command, "--transforms", o->files.transforms,
             "Transforms of the skin's bones, relative to rest, a .npy of shape (frames, bones, 3, 4); or glTF")
      ->type_name("FILE");
  add_option(*command, "--fps", o->files.animation.frames_per_second, "Frames per second of glTF; default: 30")
      ->type_name("RATE")
      ->transform(number_above_zero());
  add_option(*command, "--animation", o->files.animation.animation, "Animation of glTF, counted from 0")
      ->type_name("N")
      ->transform(whole_number(0, 1000000));
  add_option(*command, "--rule", o->rule,
             fmt::format("{}; or by level, such as 0:exact,2:approach2; default: exact, or modal with --modes",
                         fmt::join(rule_names(), ", ")))
      ->type_name("RULE");
  add_flag(*command, "--conservative", o->conservative,
           "Grow the radii of other rules until each sphere contains its region, so that every level covers");
  add_rule_details(*command, o->details);
  add_option(*command, "--measured", o->measured_share,
             "With --rule skinned: cost of nodes that are measured on their own corners, over that of all; the frames "
             "decide which")
      ->type_name("SHARE")
      ->transform(real_number(0.0, 1.0));
  add_sph_origin(*command, o->sph_origin);
  add_option(*command, "--format", o->format,
             "Format of the spheres: sph, json or npz; default: npz for FILE.npz, otherwise sph")
      ->type_name("NAME");
  add_flag(*command, "--poses,!--no-poses", o->poses,
           "Use the trees for known poses in TREE (default: on, with positions and the rule exact)");
  add_flag(*command, "--check,!--no-check", o->check,
           "Check the certificate of levels that guarantee cover in every frame (default: on)");
  add_flag(*command, "--measure", o->measure,
           "Measure looseness, uncovered area and distance of every level in every frame");
  add_plot(*command, o->plot, "radii and time over the frames; with --measure also looseness and uncovered area");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula update liver.obj liver.morula motion/ -o spheres/ --rule exact\n"
             "  morula update liver.obj liver.morula --modes modes.npy --coords coords.npy -o spheres.npz --measure");
  on_use(*command, [o, &run] { run = [o] { return update_command(*o); }; });
}

}  // namespace morula::cli
