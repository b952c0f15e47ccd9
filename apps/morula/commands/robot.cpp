// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula robot: a robot's description to spheres for every link, in the files that others read.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cstdlib>
#include <memory>
#include <morula/io/mesh_file.hpp>
#include <morula/io/tree_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/robot/output.hpp>
#include <morula/robot/robot_tree.hpp>

#include "commands/robot_report.hpp"
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

constexpr std::size_t default_spheres = 16, most_samples = 20'000;
constexpr const char *robot_tree_file = "robot.morula", *robot_mesh_file = "robot.ply";

struct RobotArguments {
  std::string robot, output;
  std::optional<std::size_t> spheres, total;
  std::string max_protrusion;  // a length, or a share as "1%"
  std::vector<std::string> links, left_out, refit, package_paths, tools, formats, tree_kinds;
  std::string keep, srdf;
  double padding = 0, min_radius = 0, max_radius = 0, density = robot::FitOptions{}.density;
  std::string geometry = "collision";
  std::string method{name(robot::FitOptions{}.method)}, quality;  // empty: fast, where the method has a choice
  std::size_t samples = robot::SelfCollisionOptions{}.samples;
  std::size_t seed = 1;
  bool all_formats = false, trees = false, json = false;  // trees: as --tree link
  unsigned threads = 0;
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const robot::OutputFormat& format : robot::output_formats()) names.emplace_back(format.name);
  return names;
}

std::vector<const robot::OutputFormat*> chosen_formats(const RobotArguments& o) {
  std::vector<const robot::OutputFormat*> chosen;
  for (const std::string& name : o.formats) check_name("format", name, format_names());
  const std::vector<std::string> usual{"json", "csv", "curobo", "urdf", "srdf"};
  const std::vector<std::string>& wanted = o.formats.empty() ? usual : o.formats;
  for (const robot::OutputFormat& format : robot::output_formats()) {
    if (o.all_formats || std::find(wanted.begin(), wanted.end(), format.name) != wanted.end())
      chosen.push_back(&format);
  }
  return chosen;
}

/// A number above 0 at the end of an option, else UsageError.
double number_in(const std::string& option, const std::string& text, std::string_view number) {
  double value = 0;
  const std::from_chars_result read = std::from_chars(number.data(), number.data() + number.size(), value);
  if (read.ec != std::errc() || read.ptr != number.data() + number.size() || !(value > 0 && value < 1e30)) {
    throw UsageError(
        fmt::format("{} {}: give a length above 0, as 0.005, or a share of each link's size, as 1%", option, text));
  }
  return value;
}

Quality quality_of(const RobotArguments& o) {
  if (!o.quality.empty()) return parse_quality(o.quality);
  return parse_method(o.method) == Method::morula ? robot::FitOptions{}.quality : Quality::standard;
}

robot::FitOptions fit_options(const RobotArguments& o, const robot::Robot& robot) {
  robot::FitOptions fit{.total = o.total.value_or(0),
                        .padding = o.padding,
                        .min_radius = o.min_radius,
                        .max_radius = o.max_radius,
                        .visual = o.geometry == "visual",
                        .method = parse_method(o.method),
                        .quality = quality_of(o),
                        .seed = o.seed,
                        .density = o.density,
                        .stop = {},
                        .progress = {}};
  if (!o.max_protrusion.empty()) {
    const std::string& text = o.max_protrusion;
    if (text.back() == '%') {
      fit.max_protrusion_share =
          number_in("--max-protrusion", text, std::string_view(text).substr(0, text.size() - 1)) / 100;
    } else {
      fit.max_protrusion = number_in("--max-protrusion", text, text);
    }
  }
  fit.spheres = o.spheres.value_or(o.max_protrusion.empty() ? default_spheres : 0);
  std::vector<std::string> names;
  for (const robot::Link& link : robot.links) names.push_back(link.name);
  for (const std::string& text : o.links) {
    const std::size_t at = text.rfind('=');
    const std::string_view number =
        at == std::string::npos ? std::string_view() : std::string_view(text).substr(at + 1);
    std::size_t count = 0;
    const std::from_chars_result read = std::from_chars(number.data(), number.data() + number.size(), count);
    if (number.empty() || read.ec != std::errc() || read.ptr != number.data() + number.size() || count == 0) {
      throw UsageError(fmt::format("--link {}: give a link and how many spheres, as --link gripper=32", text));
    }
    check_name("link", text.substr(0, at), names);
    fit.link_spheres[text.substr(0, at)] = count;
  }
  for (const std::string& name : o.left_out) {
    check_name("link", name, names);
    fit.left_out.insert(name);
  }
  for (const std::string& name : o.tools) check_name("link", name, names);
  if (!o.keep.empty()) {
    for (const std::string& name : o.refit) check_name("link", name, names);
    for (auto& [name, spheres] : robot::read_robot_spheres(o.keep)) {
      if (robot.find_link(name) == robot::none) {
        throw FileError(fmt::format("{}: holds spheres of link {}, which {} does not have", o.keep, name, o.robot));
      }
      if (std::find(o.refit.begin(), o.refit.end(), name) == o.refit.end()) fit.kept[name] = std::move(spheres);
    }
  }
  return fit;
}

void require_sense(const RobotArguments& o) {
  check_name("geometry", o.geometry, {"collision", "visual"});
  for (const std::string& kind : o.tree_kinds) check_name("tree", kind, {"link", "robot"});
  if (o.total && o.spheres)
    throw UsageError("--spheres and --total contradict each other: leave out one; --link stays");
  if (o.total && !o.max_protrusion.empty()) {
    throw UsageError("--total and --max-protrusion contradict each other: leave out one");
  }
  if (o.keep.empty() != o.refit.empty()) {
    throw UsageError("--keep and --refit belong together: --keep DIR/spheres.json --refit LINK");
  }
  if (o.max_radius > 0 && o.max_radius < o.min_radius) throw UsageError("--max-radius is below --min-radius");
  require_folder_place(o.output);
}

/// Where packages are: what the user says, then where ROS says.
std::vector<fs::path> package_paths(const RobotArguments& o) {
  std::vector<fs::path> paths(o.package_paths.begin(), o.package_paths.end());
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path))
      throw UsageError(fmt::format("--package-path {}: there is no such folder", path.string()));
  }
  const auto add = [&](const char* variable, const char* below) {
    const char* value = std::getenv(variable);
    std::string_view rest = value == nullptr ? "" : value;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      if (end > 0) paths.push_back(fs::path(rest.substr(0, end)) / below);
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  };
  add("ROS_PACKAGE_PATH", "");
  add("AMENT_PREFIX_PATH", "share");
  return paths;
}

bool wants_tree(const RobotArguments& o, std::string_view kind) {
  return (o.trees && kind == "link") || std::find(o.tree_kinds.begin(), o.tree_kinds.end(), kind) != o.tree_kinds.end();
}

std::string tree_name(const robot::Robot& robot, std::size_t link) {
  std::string name = robot.links[link].name;
  for (char& c : name) {
    if (c == '/' || c == '\\' || c == '.') c = '_';
  }
  return name;
}

/// No file that is written may be one that is read: asked before the work begins.
void require_inputs_stay(const RobotArguments& o, const robot::Robot& robot,
                         const std::vector<const robot::OutputFormat*>& formats) {
  std::vector<fs::path> inputs{o.robot, o.keep, o.srdf};
  inputs.insert(inputs.end(), robot.included.begin(), robot.included.end());
  for (const robot::Link& link : robot.links) {
    for (const auto* shapes : {&link.collision, &link.visual}) {
      for (const robot::Shape& shape : *shapes) inputs.push_back(shape.file);
    }
  }
  // The names do not depend on the spheres.
  const robot::OutputOptions output{.folder = o.output, .tool_frames = o.tools};
  for (const robot::OutputFormat* format : formats) {
    for (const robot::OutputFile& file : format->write({robot, {}, {}, output})) {
      require_not_input(fs::path(o.output) / file.name, inputs);
    }
  }
  if (wants_tree(o, "robot")) require_not_input(fs::path(o.output) / robot_mesh_file, inputs);
  for (std::size_t link = 0; wants_tree(o, "link") && link < robot.links.size(); ++link) {
    require_not_input(fs::path(o.output) / "trees" / (tree_name(robot, link) + ".ply"), inputs);
  }
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
  Stopwatch watch;
  const robot::Robot robot =
      robot::read_robot(o.robot, {.package_paths = package_paths(o), .visual = o.geometry == "visual"});
  robot::FitOptions fit = fit_options(o, robot);
  require_inputs_stay(o, robot, formats);
  std::vector<std::array<std::string, 2>> given = robot.ignored;
  if (!o.srdf.empty()) {
    for (auto& pair : robot::read_ignored_pairs(o.srdf)) given.push_back(std::move(pair));
  }
  const double read_seconds = watch.lap();

  fit.stop = interrupt.token();
  const robot::RobotSpheres spheres = [&] {
    Progress progress("fitting spheres");
    fit.progress = [&](double share, const std::string& link) {
      progress.update(share, fmt::format("fitted {}", link));
    };
    return robot::fit_spheres(robot, fit, workers);
  }();
  if (spheres.links.empty()) {
    throw FileError(fmt::format("{}: no link has {} shapes; try --geometry {}", o.robot, o.geometry,
                                o.geometry == "visual" ? "collision" : "visual"));
  }
  const double fit_seconds = watch.lap();
  const robot::SelfCollision self_collision =
      robot::find_ignored(robot, spheres, {.samples = o.samples, .seed = o.seed, .given = std::move(given)}, workers);
  const double pairs_seconds = watch.lap();
  if (interrupt.requested()) throw BuildStopped();

  robot::OutputOptions output{
      .folder = o.output, .tool_frames = o.tools, .srdf = {}, .seed = o.seed, .density = o.density};
  if (!o.srdf.empty()) output.srdf = o.srdf;
  const robot::Description description{robot, spheres, self_collision, output};
  std::vector<std::string> written;
  WholeFolder folder(o.output, WholeFolder::Mode::merge);
  for (const robot::OutputFormat* format : formats) {
    for (const robot::OutputFile& file : format->write(description)) {
      // Formats may share a file.
      if (std::find(written.begin(), written.end(), file.name) != written.end()) continue;
      fs::create_directories((folder.path() / file.name).parent_path());
      write_whole(folder.path() / file.name, file.bytes);
      written.push_back(file.name);
    }
  }
  if (wants_tree(o, "link")) write_trees(folder.path(), robot, spheres);
  if (wants_tree(o, "robot")) {
    const robot::RobotTree tree = robot::tree_of(robot, spheres, robot::rest_values(robot), workers);
    write_tree(folder.path() / robot_tree_file, tree.built);
    write_mesh(folder.path() / robot_mesh_file, tree.mesh);
    written.insert(written.end(), {robot_tree_file, robot_mesh_file});
  }
  folder.commit();
  note_written(o.output);
  const double write_seconds = watch.lap();

  std::vector<std::string> notes = robot.notes;
  for (const robot::LinkSpheres& link : spheres.links) notes.insert(notes.end(), link.notes.begin(), link.notes.end());
  if (o.tools.empty())
    notes.push_back(fmt::format("the tool is taken to be {}; --tool LINK says otherwise", robot::guess_tool(robot)));
  const int exit_code = spheres.covered() ? exit_done : exit_check_failed;
  if (o.json) {
    print_json({{"robot", robot.name},
                {"file", o.robot},
                {"output", o.output},
                {"files", written},
                {"spheres", spheres.sphere_count()},
                {"covered", spheres.covered()},
                {"links", robot_links_json(robot, spheres)},
                {"self_collision", ignored_json(robot, self_collision)},
                {"notes", notes},
                {"threads", workers.thread_count()},
                {"seconds",
                 {{"read", read_seconds}, {"fit", fit_seconds}, {"pairs", pairs_seconds}, {"write", write_seconds}}}});
    return exit_code;
  }
  fmt::print("{}: {}, {}, {} that move by themselves\n\n", robot.name, counted(robot.links.size(), "link"),
             counted(robot.joints.size(), "joint"), robot.own.size());
  fmt::print("{}\n", robot_table(robot, spheres));
  fmt::print("covers   {}\n", spheres.covered()
                                  ? "yes: every point of every link is in a sphere, with the numbers of the files"
                                  : "no: a link is bare where its gap is above 0");
  fmt::print("ignored  {}\n", ignored_text(self_collision));
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

void add_list(CLI::App& command, const std::string& option, std::vector<std::string>& values, const std::string& type,
              const std::string& what) {
  add_option(command, option, values, what)->type_name(type)->allow_extra_args(false);
}

}  // namespace

void add_robot(CLI::App& app, Run& run) {
  auto o = std::make_shared<RobotArguments>();
  CLI::App* command =
      add_command(app, "robot", "Cover every link of a robot with spheres, for planners and simulators");
  add_option(*command, "ROBOT", o->robot, "Description: URDF, MuJoCo's XML or SDF")->required()->type_name("");
  add_option(*command, "-o,--output", o->output, "Folder for the files")->type_name("DIR")->required();
  add_option(*command, "--spheres", o->spheres,
             fmt::format("Most spheres of a link; {} where nothing else is said", default_spheres))
      ->type_name("N")
      ->transform(whole_number(1, 100'000));
  add_option(*command, "--total", o->total, "Most spheres of the robot, shared by where they help most")
      ->type_name("N")
      ->transform(whole_number(1, 1'000'000));
  add_option(*command, "--max-protrusion", o->max_protrusion,
             "As few spheres as needed for each to stick out by at most LENGTH, or by a share of each link's size: 1%")
      ->type_name("LENGTH");
  add_list(*command, "--link", o->links, "LINK=N",
           "Most spheres of one link; may be repeated, as all that names links");
  add_list(*command, "--leave-out", o->left_out, "LINK", "No spheres for this link");
  add_option(*command, "--padding", o->padding, "Added to every radius")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(*command, "--min-radius", o->min_radius, "Smaller spheres are enlarged")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(*command, "--max-radius", o->max_radius, "As many spheres as it takes for none to be larger")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(*command, "--geometry", o->geometry, "Shapes to cover: collision or visual")
      ->type_name("NAME")
      ->capture_default_str();
  add_list(*command, "--package-path", o->package_paths, "DIR",
           "Folder that holds packages (package://); ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are asked next");
  add_option(*command, "--srdf", o->srdf, "SRDF whose ignored pairs are kept, and to which the new one adds")
      ->type_name("FILE");
  add_option(*command, "--samples", o->samples, "Configurations to look for links that never meet; 0: none")
      ->type_name("N")
      ->transform(whole_number(0, most_samples))
      ->capture_default_str();
  add_list(*command, "--tool", o->tools, "LINK", "Tool frame; otherwise the end of the longest chain");
  add_list(*command, "--format", o->formats, "NAME",
           fmt::format("File to write, of {}; json, csv, curobo, urdf and srdf where none is named",
                       fmt::join(format_names(), ", ")));
  add_flag(*command, "--all-formats", o->all_formats, "Write all of these");
  add_flag(*command, "--trees", o->trees, "Write every link's sphere tree and surface, too");
  add_list(*command, "--tree", o->tree_kinds, "NAME",
           "link: as --trees; robot: one tree and one surface of the whole robot, with its joints at rest");
  add_option(*command, "--keep", o->keep,
             "Earlier spheres.json, whose links keep their spheres but for those of --refit")
      ->type_name("FILE");
  add_list(*command, "--refit", o->refit, "LINK", "With --keep: fit this link anew");
  add_option(*command, "--method", o->method, fmt::format("{}", fmt::join(method_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--quality", o->quality, fmt::format("For morula: {}", fmt::join(quality_names(), ", ")))
      ->type_name("NAME")
      ->default_str("fast");
  add_option(*command, "--density", o->density, "Of links without a mass, for the masses of the report")
      ->type_name("X")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_option(*command, "--seed", o->seed, "Of every random choice; equal seeds give equal files")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula robot panda.urdf -o panda --spheres 32 --all-formats");
  on_use(*command, [o, &run] { run = [o] { return robot_command(*o); }; });
}

}  // namespace morula::cli
