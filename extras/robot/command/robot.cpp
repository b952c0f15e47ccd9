// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula robot: a robot's description to spheres for every link, in the files that others read.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/robot/output.hpp>
#include <morula/robot/robot_tree.hpp>

#include "options.hpp"
#include "page.hpp"
#include "report.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char *robot_tree_file = "robot.morula", *robot_mesh_file = "robot.ply", *inner_folder = "inner",
                     *page_file = "robot.html";

/// proven: the spheres cover within the requested tolerance.
std::string cover_text(const robot::RobotSpheres& spheres, bool proven) {
  if (spheres.covered()) return "yes: every point of every link is in a sphere, with the numbers of the files";
  if (!proven) return "no: a link is uncovered where its uncovered distance is above 0";
  return fmt::format(
      "within {}: every point of every link is that near to a sphere, proven for the numbers of the files; {:.3g} % of "
      "the surface is in no sphere",
      figure(spheres.within()), 100 * spheres.uncovered_share());
}

std::string tree_name(const robot::Robot& robot, std::size_t link) {
  std::string name = robot.links[link].name;
  for (char& c : name) {
    if (c == '/' || c == '\\' || c == '.') c = '_';
  }
  return name;
}

/// In all formats, each file once: formats may share one.
std::vector<robot::OutputFile> files_of(const robot::Description& description,
                                        const std::vector<const robot::OutputFormat*>& formats) {
  std::vector<robot::OutputFile> files;
  for (const robot::OutputFormat* format : formats) {
    for (robot::OutputFile& file : format->write(description)) {
      const auto same = [&](const robot::OutputFile& other) { return other.name == file.name; };
      if (std::none_of(files.begin(), files.end(), same)) files.push_back(std::move(file));
    }
  }
  return files;
}

/// The same with the inner spheres, in a folder of their own. Figures are of those that cover, and spheres.json has
/// both.
std::vector<robot::OutputFile> inner_files_of(const robot::Description& d,
                                              const std::vector<const robot::OutputFormat*>& formats) {
  robot::OutputOptions options = d.options;
  options.folder = options.folder / inner_folder;
  options.inner = true;
  const robot::RobotSpheres spheres = d.spheres.with_inner_spheres();
  std::vector<robot::OutputFile> files;
  for (robot::OutputFile& file : files_of({d.robot, spheres, d.self_collision, options}, formats)) {
    if (file.name == "spheres.json" || file.name == "links.csv") continue;
    files.push_back({fmt::format("{}/{}", inner_folder, file.name), std::move(file.bytes)});
  }
  return files;
}

/// Throws UsageError when an output would replace an input. Called before the work begins.
void require_inputs_stay(const RobotArguments& o, const robot::Robot& robot,
                         const std::vector<const robot::OutputFormat*>& formats) {
  std::vector<fs::path> inputs{o.robot, o.keep, o.srdf};
  inputs.insert(inputs.end(), robot.included.begin(), robot.included.end());
  for (const std::string& argument : o.xacro_arguments) inputs.push_back(argument.substr(argument.find(":=") + 2));
  for (const robot::Link& link : robot.links) {
    for (const auto* shapes : {&link.collision, &link.visual}) {
      for (const robot::Shape& shape : *shapes) inputs.push_back(shape.file);
    }
  }
  // The names do not depend on the spheres.
  const robot::OutputOptions output{.folder = o.output, .tool_frames = o.tools};
  for (const robot::OutputFile& file : files_of({robot, {}, {}, output}, formats)) {
    require_not_input(fs::path(o.output) / file.name, inputs);
    if (o.inner > 0) require_not_input(fs::path(o.output) / inner_folder / file.name, inputs);
  }
  if (o.page) require_not_input(fs::path(o.output) / page_file, inputs);
  if (writes_tree(o, "robot")) require_not_input(fs::path(o.output) / robot_mesh_file, inputs);
  for (std::size_t link = 0; writes_tree(o, "link") && link < robot.links.size(); ++link) {
    require_not_input(fs::path(o.output) / "trees" / (tree_name(robot, link) + ".ply"), inputs);
  }
}

/// Names of files in the output's folder that another run wrote and this one leaves: they may have other spheres.
std::vector<std::string> files_left(const robot::Description& description, const std::vector<std::string>& written) {
  std::vector<const robot::OutputFormat*> all;
  for (const robot::OutputFormat& format : robot::output_formats()) all.push_back(&format);
  std::vector<std::string> names{page_file, robot_tree_file, robot_mesh_file};
  for (const robot::OutputFile& file : files_of({description.robot, {}, {}, description.options}, all))
    names.push_back(file.name);
  std::erase_if(names, [&](const std::string& name) {
    std::error_code error;
    return std::find(written.begin(), written.end(), name) != written.end() ||
           !fs::is_regular_file(description.options.folder / name, error);
  });
  return names;
}

void write_trees(const fs::path& folder, const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  fs::create_directories(folder / "trees");
  for (const robot::LinkSpheres& link : spheres.links) {
    if (link.tree == nullptr) continue;
    const std::string file = tree_name(robot, link.link);
    write_tree(folder / "trees" / (file + ".morula"), *link.tree);
    write_mesh(folder / "trees" / (file + ".ply"), link.surface.mesh);
  }
}

int robot_unless_stopped(const RobotArguments& o, const Interrupt& interrupt) {
  const std::vector<const robot::OutputFormat*> formats = chosen_formats(o);
  Workers workers = make_workers(o.threads);
  toolbox::Stopwatch watch;
  const robot::Robot robot = robot::read_robot(o.robot, {.package_paths = package_paths(o),
                                                         .visual = o.geometry == "visual",
                                                         .skip = {o.skip.begin(), o.skip.end()},
                                                         .xacro = o.xacro,
                                                         .xacro_arguments = o.xacro_arguments});
  robot::FitOptions fit = fit_options(o, robot);
  require_inputs_stay(o, robot, formats);
  std::vector<std::array<std::string, 2>> given = robot.ignored;
  if (!o.srdf.empty()) {
    for (auto& pair : robot::read_ignored_pairs(o.srdf)) given.push_back(std::move(pair));
  }
  const double read_seconds = watch.lap();

  fit.stop = interrupt.token();
  robot::SelfFit placed;
  const robot::RobotSpheres spheres = [&] {
    Progress progress("fitting spheres");
    fit.progress = [&](double share, const std::string& link) {
      progress.update(share, fmt::format("fitted {}", link));
    };
    if (!o.self_collision) return robot::fit_spheres(robot, fit, workers);
    placed = robot::fit_for_self_collision(robot, fit, {.given = given}, workers);
    return placed.spheres;
  }();
  if (spheres.links.empty()) {
    std::vector<std::string> left_out = robot.notes;
    left_out.insert(left_out.end(), spheres.notes.begin(), spheres.notes.end());
    const bool is_visual = o.geometry == "visual";
    const bool has_others = std::any_of(robot.links.begin(), robot.links.end(), [&](const robot::Link& link) {
      return !(is_visual ? link.collision : link.visual).empty();
    });
    const char* other = is_visual ? "collision" : "visual";
    throw FileError(fmt::format(
        "{}: no link has {} shapes{}{}", o.robot, o.geometry,
        left_out.empty() ? "" : fmt::format(" ({})", fmt::join(left_out, "; ")),
        has_others ? fmt::format("; try --geometry {}", other) : fmt::format(", and none has {} shapes", other)));
  }
  std::vector<ToleranceRow> rows;
  for (const double tolerance : o.tolerances) {
    robot::FitOptions other = fit;
    other.tolerance = tolerance;
    if (tolerance == 0) other.max_uncovered.reset();
    other.inner = 0;
    other.progress = {};
    rows.push_back(tolerance_row(tolerance, robot::fit_spheres(robot, other, workers)));
  }
  const double fit_seconds = watch.lap();
  const robot::SelfCollision self_collision = [&] {
    Progress progress("testing pairs of links");
    return robot::find_ignored(robot, spheres,
                               {.samples = o.samples,
                                .seed = o.seed,
                                .given = std::move(given),
                                .stop = interrupt.token(),
                                .progress = [&](double share) { progress.update(share); }},
                               workers);
  }();
  const double pairs_seconds = watch.lap();

  robot::OutputOptions output{.folder = o.output,
                              .tool_frames = o.tools,
                              .srdf = {},
                              .seed = o.seed,
                              .density = fit.density,
                              .fill_masses = o.density.has_value()};
  if (!o.srdf.empty()) output.srdf = o.srdf;
  const robot::Description description{robot, spheres, self_collision, output};
  std::vector<std::string> written;
  WholeFolder folder(o.output, WholeFolder::Mode::merge);
  const auto write = [&](const std::vector<robot::OutputFile>& files) {
    for (const robot::OutputFile& file : files) {
      fs::create_directories((folder.path() / file.name).parent_path());
      write_whole(folder.path() / file.name, file.bytes);
      written.push_back(file.name);
    }
  };
  write(files_of(description, formats));
  if (o.inner > 0) write(inner_files_of(description, formats));
  if (writes_tree(o, "link")) write_trees(folder.path(), robot, spheres);
  if (writes_tree(o, "robot")) {
    const robot::RobotTree tree = robot::tree_of(robot, spheres, robot::rest_values(robot), workers);
    write_tree(folder.path() / robot_tree_file, tree.model);
    write_mesh(folder.path() / robot_mesh_file, tree.mesh);
    written.insert(written.end(), {robot_tree_file, robot_mesh_file});
  }
  if (o.page) write({{page_file, robot_page_text(robot, spheres, self_collision)}});
  folder.commit();
  note_written(o.output);
  const double write_seconds = watch.lap();

  std::vector<std::string> notes = robot.notes;
  notes.insert(notes.end(), spheres.notes.begin(), spheres.notes.end());
  for (const robot::LinkSpheres& link : spheres.links) notes.insert(notes.end(), link.notes.begin(), link.notes.end());
  notes.insert(notes.end(), self_collision.notes.begin(), self_collision.notes.end());
  if (const std::vector<std::string> left = files_left(description, written); !left.empty())
    notes.push_back(fmt::format("{}: of an earlier run, and not written again: {}", o.output, fmt::join(left, " ")));
  if (o.tools.empty())
    notes.push_back(fmt::format("the tool is taken to be {}; --tool LINK says otherwise", robot::guess_tool(robot)));
  const bool proven = spheres.covered() || (o.tolerance > 0 && spheres.within() <= o.tolerance);
  const int exit_code = proven ? exit_done : exit_check_failed;
  if (o.json) {
    Json report{{"robot", robot.name},
                {"tolerances", tolerances_json(rows)},
                {"file", o.robot},
                {"output", o.output},
                {"files", written},
                {"spheres", spheres.sphere_count()},
                {"covered", spheres.covered()},
                {"within", spheres.within()},
                {"uncovered_share", spheres.uncovered_share()},
                {"inner_spheres", spheres.inner_count()},
                {"links", robot_links_json(robot, spheres)},
                {"self_collision", ignored_json(robot, self_collision)},
                {"notes", notes},
                {"threads", workers.thread_count()},
                {"seconds",
                 {{"read", read_seconds}, {"fit", fit_seconds}, {"pairs", pairs_seconds}, {"write", write_seconds}}}};
    if (o.self_collision) report["false_collisions"] = self_fit_json(robot, placed);
    print_json(report);
    return exit_code;
  }
  fmt::print("{}: {}, {}, {} that move by themselves\n\n", robot.name, counted(robot.links.size(), "link"),
             counted(robot.joints.size(), "joint"), robot.independent_joints.size());
  fmt::print("{}\n", robot_table(robot, spheres));
  fmt::print("covers   {}{}\n", cover_text(spheres, proven),
             o.clips.empty() ? "" : "; what clip planes cut off is left out");
  if (!rows.empty()) fmt::print("\n{}\n", tolerance_table(rows));
  for (const std::string& line : clip_lines(robot, spheres)) fmt::print("clipped  {}\n", line);
  if (o.inner > 0) fmt::print("inside   {}\n", inner_text(spheres));
  fmt::print("ignored  {}\n", ignored_text(self_collision));
  if (o.self_collision) {
    for (const std::string& line : self_fit_lines(robot, placed)) fmt::print("false    {}\n", line);
  }
  fmt::print("seconds  read {}, fit {}, pairs {}, write {} ({})\n", seconds(read_seconds), seconds(fit_seconds),
             seconds(pairs_seconds), seconds(write_seconds), counted(workers.thread_count(), "thread"));
  for (const std::string& note : notes) fmt::print("note     {}\n", note);
  fmt::print("written  {}: {}\n", o.output, fmt::join(written, " "));
  return exit_code;
}

int robot_command(const RobotArguments& o) {
  require_sense(o);
  const Interrupt interrupt;
  try {
    return robot_unless_stopped(o, interrupt);
  } catch (const BuildStopped&) {
    return say_interrupted(interrupt.exit_code(), "; nothing was written");
  }
}

}  // namespace

void add_robot(CLI::App& app, Run& run) {
  auto o = std::make_shared<RobotArguments>();
  CLI::App* command =
      add_command(app, "robot", "Cover every link of a robot with spheres, for planners and simulators");
  add_robot_options(*command, *o);
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula robot panda.urdf -o panda --spheres 32 --all-formats");
  on_use(*command, [o, &run] { run = [o] { return robot_command(*o); }; });
}

}  // namespace morula::cli
