// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <morula/io/mesh_file.hpp>
#include <platform/files.hpp>

#include "page.hpp"
#include "platform/decimal.hpp"
#include "shared/command.hpp"
#include "shared/files.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_pair_samples = 100'000'000;

std::vector<std::string> output_format_names() {
  std::vector<std::string> names;
  for (const robot::OutputFormat& format : robot::output_formats()) names.emplace_back(format.name);
  return names;
}

/// A number above 0 at the end of an option, else UsageError.
double length_or_share(const std::string& option, const std::string& text, std::string_view number) {
  double value = 0;
  const std::from_chars_result read = platform::read_number(number.data(), number.data() + number.size(), value);
  if (read.ec != std::errc() || read.ptr != number.data() + number.size() || !(value > 0 && value < 1e30)) {
    throw UsageError(
        fmt::format("{} {}: give a length above 0, as 0.005, or a share of each link's size, as 1%", option, text));
  }
  return value;
}

/// "LINK=X,Y,Z,D": what has x X + y Y + z Z ≥ D is kept of the link.
std::pair<std::string, robot::ClipPlane> clip_plane(const std::string& text, const std::vector<std::string>& links) {
  const std::size_t at = text.rfind('=');
  std::vector<double> numbers;
  std::string_view rest = at == std::string::npos ? std::string_view() : std::string_view(text).substr(at + 1);
  for (bool more = !rest.empty(); more;) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    double value = 0;
    const std::from_chars_result read = platform::read_number(rest.data(), rest.data() + end, value);
    if (end == 0 || read.ec != std::errc() || read.ptr != rest.data() + end || !(std::abs(value) < 1e30)) {
      numbers.clear();
      break;
    }
    numbers.push_back(value);
    more = end < rest.size();
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  const Vec3 normal = numbers.size() == 4 ? Vec3{numbers[0], numbers[1], numbers[2]} : Vec3{};
  if (!(length(normal) > 0)) {
    throw UsageError(fmt::format(
        "--clip {}: give LINK=X,Y,Z,D, which keeps what has x X + y Y + z Z >= D, as --clip base=0,0,1,0.02", text));
  }
  check_name("link", text.substr(0, at), links);
  return {text.substr(0, at), {normalized(normal), numbers[3] / length(normal)}};
}

void add_repeatable(CLI::App& command, const std::string& option, std::vector<std::string>& values,
                    const std::string& type, const std::string& what) {
  add_option(command, option, values, what)->type_name(type)->allow_extra_args(false);
}

}  // namespace

std::vector<const robot::OutputFormat*> chosen_formats(const RobotArguments& o) {
  std::vector<const robot::OutputFormat*> chosen;
  for (const std::string& name : o.formats) check_name("format", name, output_format_names());
  const std::vector<std::string> usual{"json", "csv", "curobo", "urdf", "srdf"};
  const std::vector<std::string>& wanted = o.formats.empty() ? usual : o.formats;
  for (const robot::OutputFormat& format : robot::output_formats()) {
    if (o.all_formats || std::find(wanted.begin(), wanted.end(), format.name) != wanted.end())
      chosen.push_back(&format);
  }
  return chosen;
}

robot::FitOptions fit_options(const RobotArguments& o, const robot::Robot& robot) {
  robot::FitOptions fit{.spheres = o.spheres,
                        .max_total = o.max_total,
                        .tolerance = o.tolerance,
                        .max_uncovered = o.max_uncovered,
                        .padding = o.padding,
                        .min_radius = o.min_radius,
                        .max_radius = o.max_radius,
                        .visual = o.geometry == "visual",
                        .method = parse_method(o.method),
                        .seed = o.seed,
                        .density = o.density.value_or(robot::FitOptions{}.density),
                        .stop = {},
                        .progress = {}};
  if (!o.quality.empty()) fit.quality = parse_quality(o.quality);
  if (!o.max_protrusion.empty()) {
    const std::string& text = o.max_protrusion;
    if (text.back() == '%') {
      fit.max_protrusion_share =
          length_or_share("--max-protrusion", text, std::string_view(text).substr(0, text.size() - 1)) / 100;
    } else {
      fit.max_protrusion = length_or_share("--max-protrusion", text, text);
    }
  }
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
  for (const std::string& name : o.skip) {
    check_name("link", name, names);
    fit.skip.insert(name);
  }
  for (const std::string& name : o.tools) check_name("link", name, names);
  for (const std::string& text : o.clips) {
    const auto [name, plane] = clip_plane(text, names);
    const robot::Link& link = robot.links[robot.find_link(name)];
    if ((fit.visual ? link.visual : link.collision).empty())
      throw UsageError(fmt::format("--clip {}: link {} has no {} shapes", text, name, o.geometry));
    fit.clip[name].push_back(plane);
  }
  fit.clip_margin = o.clip_margin;
  fit.inner = o.inner;
  if (!o.keep.empty()) {
    for (const std::string& name : o.refit) check_name("link", name, names);
    for (auto& [name, spheres] : robot::read_robot_spheres(o.keep)) {
      if (robot.find_link(name) == robot::none) {
        throw FileError(fmt::format("{}: holds spheres of link {}, which {} does not have", o.keep, name, o.robot));
      }
      if (std::find(o.refit.begin(), o.refit.end(), name) == o.refit.end())
        fit.fixed_spheres[name] = std::move(spheres);
    }
  }
  return fit;
}

void require_sense(const RobotArguments& o) {
  check_name("geometry", o.geometry, {"collision", "visual"});
  for (const std::string& kind : o.tree_kinds) check_name("tree", kind, {"link", "robot"});
  if (o.max_total && o.spheres)
    throw UsageError("--spheres and --total contradict each other: leave out one; --link stays");
  if (o.max_total && !o.max_protrusion.empty()) {
    throw UsageError("--total and --max-protrusion contradict each other: leave out one");
  }
  if (o.self_collision && (!o.max_protrusion.empty() || o.max_radius)) {
    throw UsageError("--self-collision contradicts --max-protrusion and --max-radius: it divides a number of spheres");
  }
  if (o.max_uncovered && (o.tolerance == 0 || !o.max_protrusion.empty() || o.self_collision)) {
    throw UsageError(
        "--max-uncovered belongs to --tolerance, and contradicts --max-protrusion and --self-collision: it places "
        "spheres for the share alone");
  }
  if (o.keep.empty() && !o.refit.empty()) throw UsageError("--refit belongs to --keep DIR/spheres.json: add it");
  for (const std::string& argument : o.xacro_arguments) {
    if (argument.find(":=") == std::string::npos || argument.starts_with(":=") || argument.starts_with("-"))
      throw UsageError(fmt::format("--xacro-arg {}: give NAME:=VALUE, as prefix:=left_", argument));
  }
  if (o.clip_margin && o.clips.empty()) throw UsageError("--clip-margin belongs to --clip LINK=X,Y,Z,D: add it");
  if (o.max_radius && *o.max_radius < o.min_radius) throw UsageError("--max-radius is below --min-radius");
  if (o.page) require_robot_page();
  require_folder_place(o.output);
}

std::vector<fs::path> package_paths(const RobotArguments& o) {
  std::vector<fs::path> paths(o.package_paths.begin(), o.package_paths.end());
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path))
      throw UsageError(fmt::format("--package-path {}: there is no such folder", path.string()));
  }
  const auto add = [&](const char* variable, const char* below) {
    for (const fs::path& folder : platform::listed_folders(variable)) paths.push_back(folder / below);
  };
  add("ROS_PACKAGE_PATH", "");
  add("AMENT_PREFIX_PATH", "share");
  return paths;
}

bool writes_tree(const RobotArguments& o, std::string_view kind) {
  return (o.trees && kind == "link") || std::find(o.tree_kinds.begin(), o.tree_kinds.end(), kind) != o.tree_kinds.end();
}

void add_robot_options(CLI::App& command, RobotArguments& o) {
  add_option(command, "ROBOT", o.robot, "Description: URDF or xacro, MuJoCo's XML or SDF")->required()->type_name("");
  add_option(command, "-o,--output", o.output, "Folder for the files")->type_name("DIR")->required();
  add_option(command, "--spheres", o.spheres,
             "Largest number of spheres of each link; default: by the size of the link, 16 on average")
      ->type_name("N")
      ->transform(whole_number(1, 100'000));
  add_option(command, "--total,--max-total", o.max_total,
             "Largest number of spheres of the robot, placed where they help most")
      ->type_name("N")
      ->transform(whole_number(1, 1'000'000));
  add_flag(command, "--self-collision", o.self_collision,
           "Place the same number of spheres where links would falsely collide, and report how often they do");
  add_option(command, "--max-protrusion", o.max_protrusion,
             "Protrusion of at most LENGTH, or of a share of each link's size (1%), with as few spheres as possible")
      ->type_name("LENGTH");
  add_repeatable(command, "--link", o.links, "LINK=N",
                 "Largest number of spheres of this link; may be repeated, like all options that name links");
  add_repeatable(command, "--skip", o.skip, "LINK", "No spheres for this link");
  add_repeatable(command, "--clip", o.clips, "LINK=X,Y,Z,D",
                 "Leave out what lies beyond a plane: of the link, in its own axes, x X + y Y + z Z >= D is kept");
  add_option(command, "--clip-margin", o.clip_margin,
             "No sphere reaches beyond a clip plane; parts of the link within LENGTH of it need no cover")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_option(command, "--inner", o.inner, "Also at most N spheres inside each link, in files in inner/")
      ->type_name("N")
      ->transform(whole_number(1, 100'000));
  add_option(
      command, "--tolerance", o.tolerance,
      "Cover within LENGTH: spheres may leave surface uncovered up to this distance, proven, and are thinner for it")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(
      command, "--max-uncovered", o.max_uncovered,
      "With --tolerance: at most this share of the robot's surface in no sphere (0.3), with little outside volume")
      ->type_name("SHARE")
      ->transform(real_number(0, 1));
  add_option(command, "--tolerances", o.tolerances,
             "Also fit for each of these tolerances, for a table of the outside volume: 0,0.002,0.005,0.01")
      ->type_name("LENGTH,...")
      ->delimiter(',')
      ->transform(real_number(0, 1e9));
  add_option(command, "--padding", o.padding, "Length added to every radius")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(command, "--min-radius", o.min_radius, "Smallest radius; smaller spheres are enlarged")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e9));
  add_option(command, "--max-radius", o.max_radius, "Largest radius; links use as many spheres as this requires")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_option(command, "--geometry", o.geometry, "Shapes to cover: collision or visual")
      ->type_name("NAME")
      ->capture_default_str();
  add_repeatable(command, "--package-path", o.package_paths, "DIR",
                 "Folder that holds packages (package://); ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are searched next");
  add_option(command, "--xacro", o.xacro, "Program that expands xacro, a name on PATH or a path")
      ->type_name("PROGRAM")
      ->capture_default_str();
  add_repeatable(command, "--xacro-arg", o.xacro_arguments, "NAME:=VALUE", "Argument of a xacro file");
  add_option(command, "--srdf", o.srdf, "SRDF whose ignored pairs are kept, and which the new one extends")
      ->type_name("FILE");
  add_option(command, "--samples", o.samples,
             "Least number of configurations for links that never collide; 0: only proven pairs")
      ->type_name("N")
      ->transform(whole_number(0, most_pair_samples))
      ->capture_default_str();
  add_repeatable(command, "--tool", o.tools, "LINK", "Tool frame; otherwise the end of the longest chain");
  add_repeatable(command, "--format", o.formats, "NAME",
                 fmt::format("File to write, of {}; json, csv, curobo, urdf and srdf where none is named",
                             fmt::join(output_format_names(), ", ")));
  add_flag(command, "--all-formats", o.all_formats, "Write all of these");
  add_flag(command, "--trees", o.trees, "Also write every link's sphere tree and surface");
  add_repeatable(command, "--tree", o.tree_kinds, "NAME",
                 "link: like --trees; robot: one tree and one surface of the whole robot, with its joints at rest");
  if (has_robot_page())
    add_flag(command, "--page", o.page,
             "Also write robot.html: the robot and its spheres, with a slider for every joint");
  add_option(command, "--keep", o.keep,
             "Earlier spheres.json: its links keep their spheres, which are certified again, except those of --refit")
      ->type_name("FILE");
  add_repeatable(command, "--refit", o.refit, "LINK", "With --keep: fit this link again");
  add_option(command, "--method", o.method, fmt::format("{}", fmt::join(method_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(command, "--quality", o.quality,
             fmt::format("Quality of the method optimized: {}", fmt::join(quality_names(), ", ")))
      ->type_name("NAME")
      ->default_str("fast");
  add_option(
      command, "--density", o.density,
      fmt::format(
          "Density of links without a mass: {} in the report; if given, files of simulators also have these masses",
          robot::FitOptions{}.density))
      ->type_name("X")
      ->transform(number_above_zero());
  add_option(command, "--seed", o.seed, "Seed of all random choices; equal seeds give equal files")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
}

}  // namespace morula::cli
