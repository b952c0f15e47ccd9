// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula clump: a mesh to a few overlapping spheres with mass and inertia, for discrete element codes.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <morula/grains/clump.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/whole_output.hpp>
#include <toolbox/stopwatch.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/interrupt.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

const std::size_t default_spheres = ClumpOptions{}.spheres;
constexpr std::size_t most_spheres = 100'000, most_candidates = 1'000'000;

struct ClumpArguments {
  std::string mesh, output, format;
  std::string kind{name(ClumpOptions{}.kind)};
  std::optional<std::size_t> spheres;
  std::optional<double> max_protrusion, max_radius;
  double tolerance = ClumpOptions{}.tolerance, min_radius = 0, density = ClumpOptions{}.density;
  std::string method{name(ClumpOptions{}.method)}, quality{name(ClumpOptions{}.quality)};
  std::size_t candidates = ClumpOptions{}.candidates;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool json = false;
};

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const ClumpFormat& format : clump_formats()) names.emplace_back(format.name);
  return names;
}

/// By name, else by the extension of the output.
const ClumpFormat& chosen_format(const ClumpArguments& o) {
  const std::string ending = extension(o.output);
  if (!o.format.empty()) check_name("format", o.format, format_names());
  for (const ClumpFormat& format : clump_formats()) {
    if (o.format.empty() ? !ending.empty() && format.extension == ending : format.name == o.format) return format;
  }
  throw UsageError(fmt::format("{}: the extension does not say the format: add --format, one of {}", o.output,
                               fmt::join(format_names(), ", ")));
}

ClumpOptions clump_options(const ClumpArguments& o) {
  check_name("kind", o.kind, {"cover", "inner"});
  const bool inner = o.kind == "inner";
  if (inner && o.max_protrusion) {
    throw UsageError("--max-protrusion belongs to covers: inner spheres stick out nowhere");
  }
  if (o.tolerance > 0 && (inner || parse_method(o.method) != Method::optimized)) {
    throw UsageError("--tolerance belongs to covers of the method optimized");
  }
  if (o.max_radius && *o.max_radius < o.min_radius) throw UsageError("--max-radius is below --min-radius");
  return {.kind = inner ? ClumpKind::inner : ClumpKind::cover,
          .spheres = o.spheres.value_or(o.max_protrusion ? 0 : default_spheres),
          .max_protrusion = o.max_protrusion,
          .tolerance = o.tolerance,
          .min_radius = o.min_radius,
          .max_radius = o.max_radius,
          .density = o.density,
          .method = parse_method(o.method),
          .quality = parse_quality(o.quality),
          .candidates = o.candidates,
          .seed = o.seed,
          .stop = {},
          .progress = {}};
}

Json vector_json(const Vec3& v) {
  return {v.x, v.y, v.z};
}

Json clump_json(const Clump& clump) {
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json inertia = Json::array(), axes = Json::array();
  for (const double entry : clump.solid.inertia) inertia.push_back(clump.density * entry);
  for (const Vec3& axis : clump.principal.rows) axes.push_back(vector_json(axis));
  double smallest = clump.spheres.front().radius, largest = smallest;
  for (const Sphere& s : clump.spheres) {
    smallest = std::min(smallest, s.radius);
    largest = std::max(largest, s.radius);
  }
  return {{"kind", name(clump.kind)},
          {"spheres", clump.spheres.size()},
          {"proven", clump.proven},
          {"within", clump.kind == ClumpKind::cover ? Json(clump.within) : Json(nullptr)},
          {"uncovered_distance", clump.uncovered_distance},
          {"protrusion", clump.protrusion_max},
          {"radius", {{"smallest", smallest}, {"largest", largest}}},
          {"object_volume", or_null(clump.object_volume)},
          {"missed_volume", or_null(clump.missed_volume)},
          {"outside_volume", or_null(clump.outside_volume)},
          {"union_volume", clump.solid.volume},
          {"union_change", clump.solid_change},
          {"density", clump.density},
          {"mass", clump.mass()},
          {"center_of_mass", vector_json(clump.solid.center)},
          {"inertia", inertia},
          {"principal_axes", axes},
          {"principal_moments", vector_json(clump.density * clump.principal_inertia)}};
}

std::string promise(const Clump& clump) {
  if (clump.kind == ClumpKind::inner) {
    return clump.proven ? "yes: no sphere reaches out of the mesh" : "no: a sphere reaches out of the mesh";
  }
  if (clump.proven && clump.within > 0) {
    return fmt::format("within {}: every point of the surface is that near to a sphere", figure(clump.within));
  }
  return clump.proven ? "yes: every point of the surface is in a sphere"
                      : fmt::format("no: surface lies {} outside", figure(clump.uncovered_distance));
}

int clump_unless_stopped(const ClumpArguments& o, const Interrupt& interrupt) {
  const ClumpFormat& format = chosen_format(o);
  ClumpOptions options = clump_options(o);
  require_output_place(o.output);
  require_not_input(o.output, {o.mesh});
  Workers workers = make_workers(o.threads);
  toolbox::Stopwatch watch;
  const Mesh mesh = load_mesh(o.mesh);
  const double read_seconds = watch.lap();
  options.stop = interrupt.token();
  const Clump clump = [&] {
    Progress progress("fitting spheres");
    options.progress = [&](const BuildProgress& now) { progress.update(now.share, "fitted spheres"); };
    return fit_clump(mesh, options, workers);
  }();
  const double fit_seconds = watch.lap();
  if (interrupt.requested()) throw BuildStopped();
  write_whole(o.output, format.text(clump, std::filesystem::path(o.mesh).stem().string()));
  note_written(o.output);

  const int exit_code = clump.proven ? exit_done : exit_check_failed;
  if (o.json) {
    Json json{{"mesh", o.mesh}, {"output", o.output}, {"format", format.name}};
    json.update(clump_json(clump));
    json["notes"] = clump.notes;
    json["threads"] = workers.thread_count();
    json["seconds"] = {{"read", read_seconds}, {"fit", fit_seconds}};
    print_json(json);
    return exit_code;
  }
  fmt::print("{}\n\n", mesh_line(o.mesh, mesh));
  const Json figures = clump_json(clump);
  fmt::print("spheres  {}, radii {} to {}\n", clump.spheres.size(), figure(figures["radius"]["smallest"].get<double>()),
             figure(figures["radius"]["largest"].get<double>()));
  fmt::print("{}   {}\n", clump.kind == ClumpKind::inner ? "inside" : "covers", promise(clump));
  if (clump.kind == ClumpKind::cover) fmt::print("sticking out  at most {}\n", figure(clump.protrusion_max));
  fmt::print("volume   {} of the spheres' union", figure(clump.solid.volume));
  if (clump.object_volume) {
    fmt::print(", {} of the mesh; {} outside it, {} of it in no sphere", figure(*clump.object_volume),
               figure(*clump.outside_volume), figure(*clump.missed_volume));
  }
  fmt::print("\nmass     {} at density {}\n", exact_digits(clump.mass()), exact_digits(clump.density));
  const Vec3& c = clump.solid.center;
  fmt::print("center   {} {} {}\n", exact_digits(c.x), exact_digits(c.y), exact_digits(c.z));
  const Vec3 moments = clump.density * clump.principal_inertia;
  fmt::print("moments  {} {} {} along principal axes\n", exact_digits(moments.x), exact_digits(moments.y),
             exact_digits(moments.z));
  fmt::print("axes     {}\n", format.axes);
  fmt::print("seconds  read {}, fit {} ({})\n", seconds(read_seconds), seconds(fit_seconds),
             counted(workers.thread_count(), "thread"));
  for (const std::string& note : clump.notes) fmt::print("note     {}\n", note);
  fmt::print("written  {} for {}\n", o.output, format.program);
  return exit_code;
}

int clump_command(const ClumpArguments& o) {
  const Interrupt interrupt;
  try {
    return clump_unless_stopped(o, interrupt);
  } catch (const BuildStopped&) {
    return say_interrupted(interrupt.exit_code(), "; nothing was written");
  }
}

}  // namespace

static void add_clump(CLI::App& app, Run& run) {
  auto o = std::make_shared<ClumpArguments>();
  CLI::App* command =
      add_command(app, "clump", "Stand for a grain by a few overlapping spheres, for discrete element codes");
  add_option(*command, "MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "-o,--output", o->output, "Clump file; .clu is Kratos', .csv Chrono's, .json has all figures")
      ->type_name("FILE")
      ->required();
  add_option(*command, "--format", o->format, fmt::format("{}", fmt::join(format_names(), ", ")))->type_name("NAME");
  add_option(*command, "--kind", o->kind, "cover (the grain inside the spheres), inner (the spheres inside the grain)")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--spheres", o->spheres, fmt::format("Largest number of spheres; default: {}", default_spheres))
      ->type_name("N")
      ->transform(whole_number(1, most_spheres));
  add_option(*command, "--max-protrusion", o->max_protrusion,
             "Protrusion of at most LENGTH, mesh units, with as few spheres as possible")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_option(*command, "--tolerance", o->tolerance,
             "Cover within LENGTH only, mesh units: every point of the surface is proven to be that near to a sphere; "
             "spheres are thinner for it")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e30));
  add_option(*command, "--min-radius", o->min_radius,
             "Smallest radius: smaller spheres of a cover are enlarged, smaller inner ones are dropped")
      ->type_name("LENGTH")
      ->transform(real_number(0, 1e30));
  add_option(*command, "--max-radius", o->max_radius, "Largest radius: a cover uses as many spheres as this requires")
      ->type_name("LENGTH")
      ->transform(number_above_zero());
  add_option(*command, "--density", o->density, "Mass per mesh unit cubed")
      ->type_name("X")
      ->transform(number_above_zero())
      ->capture_default_str();
  add_option(*command, "--method", o->method, "Method of a cover, as in morula build")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--quality", o->quality,
             fmt::format("Quality of the method optimized: {}", fmt::join(quality_names(), ", ")))
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--candidates", o->candidates, "Number of inner balls to select from")
      ->type_name("N")
      ->transform(whole_number(1, most_candidates))
      ->capture_default_str();
  add_option(*command, "--seed", o->seed, "Seed of random choices; equal seeds give equal files")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command,
             "Example:\n"
             "  morula clump stone.obj -o stone.clu --spheres 12 --density 2650\n"
             "  morula clump stone.obj -o stone.txt --format liggghts --kind inner");
  on_use(*command, [o, &run] { run = [o] { return clump_command(*o); }; });
}

Extension grains_extension() {
  Extension extension;
  extension.commands = {add_clump};
  extension.format_command = "clump";
  extension.format_names = format_names();
  return extension;
}

}  // namespace morula::cli
