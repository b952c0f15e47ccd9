// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula measure: how loose the levels of a tree are, and whether they cover, for one mesh or frame by frame.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/accuracy/measure.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <toolbox/csv.hpp>

#include "commands/measure_table.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/plots.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct MeasureArguments {
  std::string mesh;
  std::string trees;
  std::string motion;
  std::string grid = "level";
  int resolution = VoxelGrid{}.resolution;
  double voxel_edge = 0;
  bool no_protrusion = false;
  bool curobo = false, weld = false;
  std::string sph_origin = "none";
  std::string csv;
  std::string plot;
  unsigned threads = 0;
  bool json = false;
};

MeasureOptions measure_options(const MeasureArguments& o, const Mesh& rest) {
  check_name("grid", o.grid, {"level", "fixed"});
  if (o.voxel_edge > 0 && o.grid != "fixed") throw UsageError("--voxel-edge belongs to --grid fixed: add it");
  MeasureOptions options;
  options.with_protrusion = !o.no_protrusion;
  options.with_sampled_fit = o.curobo;
  options.open_by_winding = true;
  options.grid.resolution = o.resolution;
  if (o.grid == "fixed") {
    options.grid.kind = VoxelGrid::Kind::fixed;
    options.grid.voxel_edge = o.voxel_edge > 0 ? o.voxel_edge : bounding_box(rest).diagonal() / o.resolution;
  }
  return options;
}

/// The input in the place of a tree: a tree file, a folder of them, an archive of frames, or balls without a tree.
class MeasuredFiles {
 public:
  explicit MeasuredFiles(const std::string& path) : path_(path), kind_(file_kind(path)) {
    if (kind_ == FileKind::sphere_frames) {
      archive_.emplace(path);
    } else if (kind_ == FileKind::folder) {
      files_ = trees_in(path);
    } else if (kind_ == FileKind::motion) {
      throw UsageError(fmt::format("{}: holds positions, not spheres; give it with --motion", path));
    } else if (!std::filesystem::exists(path)) {
      throw UsageError(fmt::format("{}: there is no such file or folder; check the name, or where you are", path));
    } else {
      files_ = {path};
    }
  }

  std::size_t count() const { return archive_ ? archive_->frame_count() : files_.size(); }
  bool are_several() const { return kind_ == FileKind::folder || (archive_ && count() > 1); }
  std::string name(std::size_t i) const {
    return archive_ ? fmt::format("{} frame {}", path_, i) : files_[i].generic_string();  // the same on every system
  }
  /// note: of a tree that was built for another mesh.
  std::vector<LevelMeasure> measure(std::size_t i, const Mesh& mesh, const ReadTreeOptions& reading, bool note_other,
                                    const MeasureOptions& options, Workers& workers) const {
    if (kind_ == FileKind::balls) {
      const std::vector<Sphere> balls = read_balls(path_);
      if (balls.empty()) throw UsageError(fmt::format("{}: holds no balls to measure", path_));
      return {measure_spheres(mesh, balls, options, workers)};
    }
    if (archive_) return morula::measure(mesh, archive_->frame(i), options, workers);
    const TreeFile file = read_tree(files_[i], reading);
    if (note_other && file.cover && file.report.mesh_hash != mesh_hash(mesh)) {
      note("{} was built for another mesh than this one; measured as it is", path_);
    }
    return morula::measure(mesh, file.tree, options, workers);
  }

 private:
  std::string path_;
  FileKind kind_;
  std::vector<std::filesystem::path> files_;
  std::optional<SphereFrames> archive_;
};

std::vector<MeasuredFrame> measure_frames(const MeasureArguments& o, const LoadedMesh& loaded,
                                          const MeasureOptions& options, Workers& workers) {
  const Mesh& rest = loaded.mesh;
  const ReadTreeOptions reading = parse_sph_origin(o.sph_origin, &rest);
  const MeasuredFiles trees(o.trees);
  std::optional<Motion> motion;
  if (!o.motion.empty()) motion.emplace(o.motion, rest, MotionOptions{.weld = loaded.merged()});
  if (!motion && trees.are_several()) {
    throw UsageError(fmt::format("{} holds {}: give their positions with --motion, or name one of them", o.trees,
                                 counted(trees.count(), "tree")));
  }
  if (motion && motion->frame_count() != trees.count()) {
    throw UsageError(fmt::format("{} in {} but {} in {}: one tree per frame is needed",
                                 counted(motion->frame_count(), "frame"), o.motion, counted(trees.count(), "tree"),
                                 o.trees));
  }
  Progress progress("measuring");
  std::vector<MeasuredFrame> frames;
  Mesh mesh = rest;
  for (std::size_t i = 0; i < trees.count(); ++i) {
    progress.update(static_cast<double>(i) / static_cast<double>(trees.count()));
    if (motion) mesh.positions = motion->frame(i);
    frames.push_back({motion ? motion->frame_name(i) : o.mesh, trees.name(i),
                      trees.measure(i, mesh, reading, !motion, options, workers)});
  }
  return frames;
}

void print_text(const MeasureArguments& o, const Mesh& rest, const std::vector<MeasuredFrame>& frames) {
  const std::vector<LevelMeasure> worst = worst_of(frames);
  fmt::print("{}\n\n{}\n", mesh_line(o.mesh, rest), measure_table(frames, worst, !o.no_protrusion));
  fmt::print("{}\n", cover_sentence(worst));
  const MeshReport report = inspect(rest);
  const bool no_looseness =
      std::any_of(worst.begin(), worst.end(), [](const LevelMeasure& level) { return !level.looseness.looseness; });
  if (std::any_of(worst.begin(), worst.end(), [](const LevelMeasure& level) { return level.looseness.range; })) {
    std::vector<std::string> ranges;
    for (const LevelMeasure& level : worst) {
      if (const auto& range = level.looseness.range)
        ranges.push_back(fmt::format("level {} {} to {}", level.level, figure(range->low), figure(range->high)));
    }
    fmt::print("{}: inside is where it winds around a point more than half a turn, and looseness is uncertain:\n{}.\n",
               why_no_inside(report), fmt::join(ranges, "; "));
  }
  if (no_looseness) {
    fmt::print("n/a: {}, so inside and outside are not defined; uncovered area and distance do not need them.\n",
               why_no_inside(report));
  } else if (!o.no_protrusion && !report.has_volume()) {
    fmt::print("n/a: {}, so protrusion cannot be answered.\n", why_no_inside(report));
  }
  fmt::print(
      "Looseness and missed (inside in no sphere: trees cover the surface) are shares of the object's volume;\n"
      "{} in mesh units (diagonal {}).\n",
      o.no_protrusion ? "uncovered distance is" : "uncovered distance and protrusion (worst, mean) are",
      figure(report.box.diagonal()));
  if (o.curobo) {
    fmt::print(
        "\ncuRobo's figures, from samples\n{}Covered: share of the interior; outside: share of the spheres' surfaces, "
        "and how far that is\nfrom the object; uncovered: distance of the surface from the spheres; volumes: the "
        "spheres' over the "
        "object's.\n",
        sampled_table(frames));
  }
}

std::string csv_text(const std::vector<MeasuredFrame>& frames, bool with_sampled) {
  std::string text =
      "frame,tree,level,spheres,looseness,missed_volume,uncovered_area,uncovered_distance,uncovered_distance_upper,"
      "covered,protrusion_worst,"
      "protrusion_mean,voxel_edge";
  if (with_sampled) {
    text +=
        ",curobo_coverage,curobo_protrusion,curobo_protrusion_dist_mean,curobo_protrusion_dist_p95,"
        "curobo_protrusion_dist_max,curobo_surface_gap_mean,curobo_surface_gap_p95,curobo_max_uncovered_gap,"
        "curobo_volume_ratio";
  }
  text += '\n';
  const auto digits = [](const std::optional<double>& value) { return value ? exact_digits(*value) : std::string(); };
  for (const MeasuredFrame& frame : frames) {
    for (const LevelMeasure& l : frame.levels) {
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}", toolbox::csv_cell(frame.name),
                      toolbox::csv_cell(frame.tree), l.level, l.spheres, digits(l.looseness.looseness),
                      digits(l.looseness.missed_volume), exact_digits(l.coverage.uncovered_area),
                      exact_digits(l.coverage.uncovered_distance), exact_digits(l.coverage.uncovered_distance_upper),
                      l.coverage.covered ? "yes" : "no", l.protrusion ? exact_digits(l.protrusion->worst) : "",
                      l.protrusion ? exact_digits(l.protrusion->mean) : "", exact_digits(l.looseness.voxel_edge));
      if (l.sampled) {
        const SampledFit& s = *l.sampled;
        for (const std::optional<double>& value :
             {s.coverage, s.protrusion, s.protrusion_mean, s.protrusion_p95, s.protrusion_max,
              std::optional(s.surface_gap_mean), std::optional(s.surface_gap_p95), std::optional(s.surface_gap_max),
              s.volume_ratio}) {
          text += ',' + digits(value);
        }
      }
      text += '\n';
    }
  }
  return text;
}

/// Nor may it be a file of the folders that are read.
void require_csv_not_input(const MeasureArguments& o) {
  std::vector<std::filesystem::path> inputs{o.mesh, o.trees, o.motion};
  for (const std::string& folder : {o.trees, o.motion}) {
    if (file_kind(folder) != FileKind::folder) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      // Files other than the frames may lie next to them.
      if (file_kind(entry.path()) != FileKind::unknown) inputs.push_back(entry.path());
    }
  }
  require_not_input(o.csv, inputs);
}

int measure_command(const MeasureArguments& o) {
  require_plot_output(o.plot, {o.mesh, o.trees, o.motion});
  if (!o.csv.empty()) {
    require_output_place(o.csv);
    require_csv_not_input(o);
  }
  Workers workers = make_workers(o.threads);
  const LoadedMesh loaded = load_mesh(o.mesh, o.weld);
  const Mesh& rest = loaded.mesh;
  const MeasureOptions options = measure_options(o, rest);
  const std::vector<MeasuredFrame> frames = measure_frames(o, loaded, options, workers);
  if (!o.csv.empty()) {
    write_whole(o.csv, csv_text(frames, o.curobo));
    note_written(o.csv);
  }
  write_plot(o.plot, measure_plot(fmt::format("{}: looseness and uncovered area", o.mesh), frames));
  if (!o.json) {
    print_text(o, rest, frames);
    return exit_done;
  }
  Json grid{{"kind", o.grid}};
  if (o.grid == "fixed") {
    grid["voxel_edge"] = options.grid.voxel_edge;
  } else {
    grid["resolution"] = options.grid.resolution;
  }
  print_json({{"mesh", o.mesh}, {"grid", grid}, {"frames", frames_json(frames)}});
  return exit_done;
}

}  // namespace

void add_measure(CLI::App& app, Run& run) {
  auto o = std::make_shared<MeasureArguments>();
  CLI::App* command = add_command(app, "measure", "Measure looseness, cover and protrusion of every level");
  add_option(*command, "MESH", o->mesh, "Mesh at rest: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "TREE", o->trees,
             "Tree file, or balls (.ply); with --motion a folder of trees, or the .npz of update, one per frame")
      ->required()
      ->type_name("");
  add_option(*command, "--motion", o->motion, fmt::format("Positions of the trees: {}", motion_kinds()))
      ->type_name("MOTION");
  add_weld(*command, o->weld, "MESH");
  add_option(*command, "--grid", o->grid,
             "Voxels for looseness: level (fill the box of the level, as in the paper) or fixed (one lattice for "
             "all frames and levels)")
      ->type_name("KIND")
      ->capture_default_str();
  add_option(*command, "--resolution", o->resolution,
             "Voxels along the longest side of the level's box (level) or the rest diagonal (fixed)")
      ->type_name("N")
      ->transform(whole_number(8, 4096))
      ->capture_default_str();
  add_option(*command, "--voxel-edge", o->voxel_edge,
             "Edge of a fixed voxel in mesh units; default: diagonal / resolution")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_flag(*command, "--no-protrusion", o->no_protrusion, "Skip protrusion, the slowest figure");
  add_flag(*command, "--curobo", o->curobo,
           "Also measure cuRobo's figures for spheres, from samples: docs/reference/measure.md");
  add_sph_origin(*command, o->sph_origin);
  add_option(*command, "--csv", o->csv, "Write every figure of every frame and level, with all digits")
      ->type_name("FILE");
  add_plot(*command, o->plot, "looseness and uncovered area over the frames, or over the levels of one");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "A tree without a cover is measured as it is: the answer says whether it covers, and the exit code is 0.\n"
             "Example:\n"
             "  morula measure liver.obj liver.morula\n"
             "  morula measure liver.obj spheres/ --motion motion/ --grid fixed --csv liver.csv");
  on_use(*command, [o, &run] { run = [o] { return measure_command(*o); }; });
}

}  // namespace morula::cli
