// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula build: a mesh to a tree that covers it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <memory>
#include <morula/generators/build.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/update/known_poses.hpp>
#include <optional>

#include "commands/build_report.hpp"
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

struct BuildArguments {
  std::string mesh;
  std::string output;
  std::string method{name(BuildOptions{}.method)};
  int branching = BuildOptions{}.branching;
  std::string depth_text = "auto";
  std::optional<int> depth;  // nothing: automatic
  std::optional<std::size_t> spheres;
  std::optional<double> max_protrusion;
  double tolerance = BuildOptions{}.tolerance;
  bool nested = false;
  std::uint64_t seed = BuildOptions{}.seed;
  std::string quality{name(BuildOptions{}.quality)};
  std::string reducers;
  std::string optimizer{name(BuildOptions{}.optimizer)};
  double balance_excess = BuildOptions{}.balance_excess;
  std::optional<double> time_limit;
  std::string poses;  // a motion, or strains; empty: none
  double pose_threshold = KnownPoseOptions{}.pose_threshold;
  std::size_t max_poses = KnownPoseOptions{}.max_trees;
  unsigned threads = 0;
  bool json = false;
  bool report = false, weld = false;

  /// Whether a flat set is requested instead of a depth.
  bool flat() const { return spheres || max_protrusion; }
};

/// Rejects contradictions and impossible outputs, ahead of any reading.
void require_sense(const BuildArguments& o) {
  if (o.flat() && o.depth) {
    throw UsageError(
        fmt::format("{} and --depth contradict each other: leave out one; the tree becomes as deep as needed",
                    o.spheres ? "--spheres" : "--max-protrusion"));
  }
  if (o.max_protrusion && !(*o.max_protrusion > 0)) {
    throw UsageError(fmt::format("--max-protrusion {}: give a length above 0, in mesh units", *o.max_protrusion));
  }
  if (o.tolerance > 0 && extension(o.output) == ".morula") {
    throw UsageError(fmt::format(
        "{}: .morula holds trees that cover, and --tolerance makes spheres that do not: write a .json, .npz, "
        ".sph or .ply",
        o.output));
  }
  if (o.tolerance > 0 && (o.nested || parse_method(o.method) != Method::optimized)) {
    throw UsageError("--tolerance belongs to the method optimized, without --nested");
  }
  if (o.time_limit && !(*o.time_limit > 0)) {
    throw UsageError(fmt::format("--time-limit {}: give seconds above 0", *o.time_limit));
  }
  if (!o.poses.empty() && o.flat()) {
    throw UsageError(
        "--poses adds trees with levels, and --spheres and --max-protrusion make flat sets: leave out one");
  }
  if (!o.poses.empty() && extension(o.output) != ".morula") {
    throw UsageError(
        fmt::format("{}: only .morula files hold trees for known poses; name one, or leave out --poses", o.output));
  }
  if (!o.poses.empty() && !(o.pose_threshold > 1)) {
    throw UsageError(fmt::format("--pose-threshold {}: give a number above 1", o.pose_threshold));
  }
  if (extension(o.output) != ".ply") return require_tree_output(o.output);
  if (!o.flat()) {
    throw UsageError(fmt::format(
        "{}: .ply holds one set of balls, not a tree: add --spheres N or --max-protrusion LENGTH, or write a .morula",
        o.output));
  }
  require_output_place(o.output);
}

BuildOptions build_options(const BuildArguments& o) {
  return {.method = parse_method(o.method),
          .branching = o.branching,
          .depth = o.depth,
          .spheres = o.spheres,
          .max_protrusion = o.max_protrusion,
          .tolerance = o.tolerance,
          .nested = o.nested,
          .seed = o.seed,
          .reducers = parse_reducers(o.reducers),
          .optimizer = parse_optimizer(o.optimizer),
          .balance_excess = o.balance_excess,
          .quality = parse_quality(o.quality),
          .time_limit_seconds = o.time_limit,
          .stop = {},
          .progress = {}};
}

struct Seconds {
  double read, build, check, report, write;
};

/// written: the tree of the file, which has smaller spheres than the model if there is a tolerance.
Json json_report(const BuildArguments& o, const Mesh& mesh, const CoveredTree& model, const SphereTree& written,
                 const Certificate& certificate, const std::vector<LevelFigures>& figures,
                 const KnownPosesReport& poses, const Seconds& seconds, const Workers& workers) {
  Json json{{"mesh", o.mesh},
            {"vertices", mesh.vertex_count()},
            {"facets", mesh.facet_count()},
            {"mesh_hash", hash_text(model.report.mesh_hash)},
            {"tree", o.output},
            {"method", model.report.method},
            {"branching", model.report.branching},
            {"depth", model.report.depth},
            {"seed", model.report.seed},
            {"tree_hash", hash_text(tree_hash(written))},
            {"spheres", model.tree.leaf_count()}};
  if (o.nested) json["nested"] = model.tree.nested;
  if (o.spheres) json["spheres_asked"] = *o.spheres;
  if (o.tolerance > 0) json["within"] = o.tolerance;
  if (o.max_protrusion) json["max_protrusion_asked"] = *o.max_protrusion;
  if (model.report.protrusion_bound) json["protrusion_bound"] = *model.report.protrusion_bound;
  json.update(
      {{"levels", build_levels_json(written, model.report, figures)},
       {"early_leaves", model.report.early_leaves},
       {"leftover_patches", model.report.leftover_patches},
       {"patches", model.cover.patch_count()},
       {"most_patches_of_a_facet", model.report.most_patches_of_a_facet},
       {"notes", model.report.notes},
       {"complete", model.report.complete},
       {"covered", certificate.covered && o.tolerance == 0},
       {"worst_excess", certificate.worst_excess + o.tolerance},
       {"threads", workers.thread_count()},
       {"seconds",
        {{"read", seconds.read}, {"build", seconds.build}, {"check", seconds.check}, {"write", seconds.write}}}});
  if (!o.poses.empty()) {
    std::vector<std::string> names;
    for (const KnownPose& pose : model.poses) names.push_back(pose.name);
    json["poses"] = {{"source", o.poses}, {"trees", names}, {"trees_built", poses.trees_built}, {"worst", poses.worst}};
  }
  if (o.report) json["seconds"]["report"] = seconds.report;
  return json;
}

void print_report(const BuildArguments& o, const Mesh& mesh, const CoveredTree& model, const SphereTree& written,
                  const std::vector<LevelFigures>& figures, const KnownPosesReport& poses, const Seconds& s,
                  const Workers& workers) {
  fmt::print("{}\n\n{}\n", mesh_line(o.mesh, mesh), build_table(written, model.report, figures));
  if (o.flat()) {
    fmt::print("flat set      {}, sticking out by at most {}\n", counted(model.tree.leaf_count(), "sphere"),
               figure(model.report.protrusion_bound.value_or(0)));
  } else {
    fmt::print("early leaves  {}\n", model.report.early_leaves);
  }
  if (!o.poses.empty()) {
    std::vector<std::string> names;
    for (const KnownPose& pose : model.poses) names.push_back(pose.name);
    fmt::print("poses         {}{}{}; at worst {} times as loose as one built for the pose\n",
               counted(names.size(), "more tree"), names.empty() ? "" : ": ", fmt::join(names, ", "),
               figure(poses.worst));
  }
  const std::string patches = counted(model.cover.patch_count(), "patch", "patches");
  if (o.tolerance > 0) {
    fmt::print("covers        within {}: every corner of {} is that near to its spheres, at every level\n",
               figure(o.tolerance), patches);
  } else {
    fmt::print("covers        yes: every corner of {} lies in its spheres, at every level\n", patches);
  }
  fmt::print("patches       at most {} of one facet\n", model.report.most_patches_of_a_facet);
  if (o.nested) fmt::print("nested        yes: every sphere contains its children's\n");
  fmt::print("seconds       read {}, build {}, check {}, {}write {} ({})\n", seconds(s.read), seconds(s.build),
             seconds(s.check), o.report ? fmt::format("report {}, ", seconds(s.report)) : "", seconds(s.write),
             counted(workers.thread_count(), "thread"));
  for (const std::string& note : model.report.notes) fmt::print("note          {}\n", note);
  fmt::print("written       {}\n", o.output);
}

constexpr const char* strains = "strains";

// The motion of poses; it is opened ahead of the build, so that a wrong name or a motion of another mesh is reported at
// once.
std::optional<Motion> open_motion(const BuildArguments& o, const LoadedMesh& loaded) {
  if (o.poses.empty() || o.poses == strains) return std::nullopt;
  if (!std::filesystem::exists(o.poses) && !nearest_name(o.poses, {strains}).empty())
    throw UsageError(fmt::format("--poses {}: there is no such motion; did you mean {}?", o.poses, strains));
  Motion motion(o.poses, loaded.mesh, {.weld = loaded.merged()});
  motion.frame(0);
  return motion;
}

// The candidates; without a motion, poses of strains.
std::vector<NamedPose> candidate_poses(const std::optional<Motion>& motion, const Mesh& mesh) {
  if (!motion) return principal_strains(mesh);
  std::vector<NamedPose> poses;
  for (std::size_t i = 0; i < motion->frame_count(); ++i) poses.push_back({motion->frame_name(i), motion->frame(i)});
  return poses;
}

KnownPosesReport add_poses(const BuildArguments& o, const Mesh& mesh, const std::optional<Motion>& motion,
                           CoveredTree& model, const Interrupt& interrupt, Workers& workers) {
  if (o.poses.empty()) return {};
  Progress progress("trees for known poses");
  KnownPoseOptions options{.method = parse_method(o.method),
                           .quality = parse_quality(o.quality),
                           .seed = o.seed,
                           .pose_threshold = o.pose_threshold,
                           .max_trees = o.max_poses,
                           .stop = interrupt.token(),
                           .progress = {}};
  const std::vector<NamedPose> poses = candidate_poses(motion, mesh);
  options.progress = [&](std::size_t count, double worst) {
    const auto share = static_cast<double>(count) / static_cast<double>(poses.size());
    progress.update(share, fmt::format("{}: at worst {} times as loose", counted(count, "tree"), figure(worst)));
  };
  return add_known_poses(mesh, model, poses, options, workers);
}

/// Throws BuildStopped on Ctrl-C, before anything is written.
int build_unless_stopped(const BuildArguments& o, const Interrupt& interrupt) {
  BuildOptions options = build_options(o);
  Workers workers = make_workers(o.threads);

  toolbox::Stopwatch watch;
  Seconds seconds{};
  const LoadedMesh loaded = load_mesh(o.mesh, o.weld);
  const Mesh& mesh = loaded.mesh;
  const std::optional<Motion> motion = open_motion(o, loaded);
  seconds.read = watch.lap();
  options.stop = interrupt.token();
  CoveredTree model = [&] {
    Progress progress(fmt::format("building {}", o.method));
    const int depth = o.depth ? *o.depth : automatic_depth(mesh, o.branching);
    options.progress = [&, depth](const BuildProgress& now) {
      const std::string last = o.flat() ? "" : fmt::format(" of {}", depth);
      progress.update(now.share,
                      fmt::format("building {}, level {}{}{}", o.method, now.level, last, time_left(now.seconds_left)));
    };
    return build(mesh, options, workers);
  }();
  const KnownPosesReport poses = add_poses(o, mesh, motion, model, interrupt, workers);
  seconds.build = watch.lap();
  const Certificate certificate = certify(model.cover, mesh.positions, model.tree.spheres, workers);
  const std::vector<std::string> faults = validate(mesh, model);
  seconds.check = watch.lap();
  if (!faults.empty()) {
    return complain(exit_check_failed, "the tree of {} is broken: {}; nothing was written, please report it", o.mesh,
                    faults.front());
  }
  // Spheres that cover within the tolerance, which the certificate of the tree proves.
  const SphereTree written = reduced(model.tree, o.tolerance);
  std::vector<LevelFigures> figures;
  if (o.report) figures = measure_levels(mesh, written, interrupt.token(), workers);
  seconds.report = watch.lap();
  if (interrupt.requested()) throw BuildStopped();
  if (extension(o.output) == ".ply") {
    write_balls(o.output, level_set_spheres(written, written.level_count() - 1));
  } else if (o.tolerance > 0) {
    write_tree(o.output, written);
  } else {
    write_tree(o.output, model);
  }
  note_written(o.output);
  seconds.write = watch.lap();

  if (o.json) {
    print_json(json_report(o, mesh, model, written, certificate, figures, poses, seconds, workers));
  } else {
    print_report(o, mesh, model, written, figures, poses, seconds, workers);
  }
  return model.report.complete ? exit_done : exit_check_failed;
}

int build_command(const BuildArguments& o) {
  require_sense(o);
  require_not_input(o.output, {o.mesh, o.poses});
  const Interrupt interrupt;
  try {
    return build_unless_stopped(o, interrupt);
  } catch (const BuildStopped&) {
    return say_interrupted(interrupt.exit_code(), "; nothing was written");
  }
}

/// "auto" is nothing. `text` is that or a whole number of 64 bits.
std::optional<int> parse_depth(const std::string& text) {
  if (text == "auto") return std::nullopt;
  using Int = std::numeric_limits<int>;
  return static_cast<int>(std::clamp<std::int64_t>(std::stoll(text), Int::min(), Int::max()));
}

}  // namespace

void add_build(CLI::App& app, Run& run) {
  auto o = std::make_shared<BuildArguments>();
  CLI::App* command = add_command(app, "build", "Build a sphere tree that covers a mesh at every level");
  add_option(*command, "MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "-o,--output", o->output,
             "Tree file: .morula (with its cover), .sph, .json or .npz; for a flat set also .ply")
      ->type_name("TREE")
      ->required();
  add_weld(*command, o->weld, "MESH");
  add_option(*command, "--method", o->method, fmt::format("{}", fmt::join(method_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--branching", o->branching,
             fmt::format("Largest number of children of a node, 2 to {}", max_branching))
      ->type_name("N")
      ->transform(whole_number(2, max_branching))
      ->capture_default_str();
  add_option(*command, "--depth", o->depth_text,
             "Levels below the root, 0 to 8, or auto: at most a quarter as many leaves as facets, and at most 512")
      ->type_name("N")
      ->transform(CLI::Validator([check = whole_number(0, max_depth)](
                                     std::string& text) { return text == "auto" ? std::string() : check(text); },
                                 ""))
      ->default_str("auto");
  add_option(*command, "--spheres", o->spheres,
             "Instead of a depth: one flat set of at most N spheres, the leaves, as tight as the method can make it")
      ->type_name("N")
      ->transform(whole_number(1));
  add_option(*command, "--max-protrusion", o->max_protrusion,
             "Instead of a depth: protrusion of at most LENGTH, mesh units, with as few spheres as possible")
      ->type_name("LENGTH")
      ->transform(real_number());
  add_option(
      *command, "--tolerance", o->tolerance,
      "Cover within LENGTH only, mesh units: every point of the surface is proven to be that near to a sphere of "
      "each level; not for .morula")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e30));
  add_flag(*command, "--nested", o->nested, "Every sphere contains its children's; levels above the leaves get looser");
  add_option(*command, "--seed", o->seed, "Seed of all random choices; equal seeds give equal trees")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_option(*command, "--quality", o->quality,
             fmt::format("Quality of the method optimized: {}", fmt::join(quality_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--reducers", o->reducers,
             fmt::format("For medial: of merge,burst,expand; for combined: of {}. Each node uses the best",
                         fmt::join(reduction_names(), ",")))
      ->type_name("LIST");
  add_option(*command, "--optimizer", o->optimizer, fmt::format("{}", fmt::join(optimizer_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--balance-excess", o->balance_excess,
             "For the optimizer balance: share by which the protrusion of the worst sphere may increase")
      ->type_name("SHARE")
      ->transform(real_number(0))
      ->capture_default_str();
  add_option(*command, "--time-limit", o->time_limit,
             "Limit of the build time; undivided nodes then stay leaves, and the exit code is 1. Not reproducible")
      ->type_name("S")
      ->transform(real_number());
  add_option(
      *command, "--poses", o->poses,
      "Add trees for poses of a motion (as `morula update` takes them), or of \"strains\": stretched to twice its "
      "size along each axis")
      ->type_name("MOTION");
  add_option(*command, "--pose-threshold", o->pose_threshold,
             "Largest looseness of a pose, relative to a tree built for it; adds trees until all --poses meet it")
      ->type_name("X")
      ->transform(real_number())
      ->capture_default_str();
  add_option(*command, "--max-poses", o->max_poses, "Largest number of trees that --poses adds")
      ->type_name("N")
      ->transform(whole_number(1, 64))
      ->capture_default_str();
  add_flag(*command, "--report", o->report, "Also measure looseness (160 voxels) and protrusion of every level");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula build liver.obj -o liver.morula --method grid --branching 8 --depth 3");
  on_use(*command, [o, &run] {
    o->depth = parse_depth(o->depth_text);
    run = [o] { return build_command(*o); };
  });
}

}  // namespace morula::cli
