// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula update: the spheres of every frame of a motion.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/io/motion_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/update/body.hpp>

#include "command.hpp"
#include "exact_check.hpp"
#include "figures.hpp"
#include "files.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "report.hpp"

namespace morula::cli {
namespace {

struct Options {
  std::string mesh;
  std::string tree;
  std::string motion;
  std::string output;
  std::string rule{name(Rule::exact)};
  RuleDetailNames details;
  std::string sph_origin = "none";
  std::string format = "sph";
  bool check = true;
  unsigned threads = 0;
  bool json = false;
};

/// What the frames showed.
struct Outcome {
  std::vector<double> microseconds;
  UpdateStatus last;
  bool checked = false;
  std::size_t frames_not_covered = 0;
  double worst_excess = 0;
  std::string worst_frame;
};

std::string why_refused(const UpdateStatus& status) {
  switch (status.code) {
    case UpdateStatus::Code::wrong_vertex_count:
      return "its vertex count is not the mesh's";
    case UpdateStatus::Code::non_finite_position:
      return fmt::format("vertex {} is not finite, or too far away for single precision", status.first_bad_vertex);
    case UpdateStatus::Code::bad_range:
    case UpdateStatus::Code::ok:
      break;
  }
  return "unknown reason";
}

Outcome update_frames(const Options& o, const Motion& motion, Body& body, const std::filesystem::path& folder,
                      Workers& workers) {
  Outcome outcome;
  outcome.checked = o.check && any_exact(body);
  Progress progress("updating");
  for (std::size_t i = 0; i < motion.frame_count(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(motion.frame_count()));
    const std::vector<Vec3> positions = motion.frame(i);
    Stopwatch watch;
    outcome.last = body.update(positions, workers);
    outcome.microseconds.push_back(1e6 * watch.lap());
    if (!outcome.last) {
      throw UsageError(fmt::format("frame {} of {}: {}; mend it, nothing was written", motion.frame_name(i), o.motion,
                                   why_refused(outcome.last)));
    }
    if (outcome.checked) {
      const Certificate certificate = certify_exact_levels(body, positions, workers);
      if (!certificate.covered) ++outcome.frames_not_covered;
      if (outcome.worst_frame.empty() || certificate.worst_excess > outcome.worst_excess) {
        outcome.worst_excess = certificate.worst_excess;
        outcome.worst_frame = motion.frame_name(i);
      }
    }
    write_tree(folder / frame_file_name(i, "." + o.format), body.current_tree());
  }
  return outcome;
}

Json outcome_json(const Options& o, const Built& built, const Body& body, const Outcome& outcome, unsigned threads) {
  const double typical = median(outcome.microseconds);
  const BindReport& bind = body.bind_report();
  Json json{{"mesh", o.mesh},
            {"tree", o.tree},
            {"motion", o.motion},
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
  if (!built.report.growth.empty()) json["growth"] = growth_json(built.report);
  return json;
}

void print_text(const Options& o, const Built& built, const Body& body, const Outcome& outcome, unsigned threads) {
  const std::vector<Rule>& rules = body.options().rules;
  const std::size_t levels = body.rest_tree().level_count();
  const double typical = median(outcome.microseconds);
  if (!built.report.growth.empty()) fmt::print("{}\n", growth_text(built.report));
  fmt::print("rule         {}\n", describe_rules(rules, levels));
  fmt::print("frames       {} of {} and {}\n", outcome.microseconds.size(),
             counted(body.vertex_count(), "vertex", "vertices"), counted(body.rest_tree().node_count(), "sphere"));
  fmt::print("time         {} µs per frame (median; worst {}), {} ns per vertex, {}\n", figure(typical),
             figure(*std::max_element(outcome.microseconds.begin(), outcome.microseconds.end())),
             figure(1e3 * typical / static_cast<double>(body.vertex_count())), counted(threads, "thread"));
  const BindReport& bind = body.bind_report();
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
  } else if (any_exact(body)) {
    fmt::print("certificate  {}\n", outcome.checked ? "FAILS" : "not checked");
  }
  if (std::any_of(rules.begin(), rules.end(), [](Rule rule) { return rule != Rule::exact; })) {
    fmt::print("note         rules other than exact may leave surface bare: morula measure says how much\n");
  }
  fmt::print("written      {}\n",
             (std::filesystem::path(o.output) / frame_file_name(0, "." + o.format)).string() + " ...");
}

int update_command(const Options& o) {
  UpdateOptions options{.rules = parse_rules(o.rule), .details = parse_rule_details(o.details)};
  check_name("format", o.format, {"sph", "json"});
  Workers workers(o.threads);
  const Mesh mesh = read_mesh(o.mesh);
  const Motion motion(o.motion, mesh);
  require_no_strangers(o.output, motion.frame_count(), "." + o.format, {".sph", ".json", ".morula"});
  const Built built = read_built(o.tree, mesh, parse_sph_origin(o.sph_origin, &mesh), workers);
  if (options.rules.size() > built.tree.level_count()) {
    throw UsageError(fmt::format("--rule {}: names level {}, but {} has levels 0 to {}", o.rule,
                                 options.rules.size() - 1, o.tree, built.tree.level_count() - 1));
  }
  Body body(mesh, built, options, workers);

  StagedFolder stage(o.output);
  const Outcome outcome = update_frames(o, motion, body, stage.path(), workers);
  stage.commit();
  if (o.json) {
    print_json(outcome_json(o, built, body, outcome, workers.thread_count()));
  } else {
    print_text(o, built, body, outcome, workers.thread_count());
  }
  if (outcome.frames_not_covered == 0) return exit_done;
  fmt::print(stderr, "morula: error: the certificate fails in {}, worst in frame {} by {}: please report it\n",
             counted(outcome.frames_not_covered, "frame"), outcome.worst_frame, figure(outcome.worst_excess));
  return exit_check_failed;
}

}  // namespace

void add_update(CLI::App& app, Run& run) {
  auto o = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("update", "Move the spheres of a tree along with a motion of its mesh");
  command->add_option("MESH", o->mesh, "Mesh at rest: " + readable_mesh_extensions())->required()->type_name("");
  command->add_option("TREE", o->tree, "Its tree: .morula; or .sph and .json, which get a cover first")
      ->required()
      ->type_name("");
  command->add_option("MOTION", o->motion, "Positions: folder of meshes, glob such as \"out/frame*.obj\", or .npy")
      ->required()
      ->type_name("");
  command->add_option("-o,--output", o->output, "Folder for 0000.sph, 0001.sph, ...")->type_name("FOLDER")->required();
  command
      ->add_option("--rule", o->rule,
                   fmt::format("{}; or by level, such as 0:exact,2:approach2", fmt::join(rule_names(), ", ")))
      ->type_name("RULE")
      ->capture_default_str();
  add_rule_details(*command, o->details);
  add_sph_origin(*command, o->sph_origin);
  command->add_option("--format", o->format, "Of the spheres: sph or json")->type_name("NAME")->capture_default_str();
  command->add_flag("--check,!--no-check", o->check,
                    "Check the certificate of exact levels in every frame (default: on)");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  command->footer("Example:\n  morula update liver.obj liver.morula motion/ -o spheres/ --rule exact");
  command->callback([o, &run] { run = [o] { return update_command(*o); }; });
}

}  // namespace morula::cli
