// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula collide: where two bodies touch, frame by frame.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/io/whole_output.hpp>

#include "commands/collide/bodies.hpp"
#include "commands/collide/features.hpp"
#include "commands/collide/layers.hpp"
#include "commands/collide/patches.hpp"
#include "commands/collide/report.hpp"
#include "commands/collide/scene.hpp"
#include "platform/decimal.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/plots.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

struct CollideArguments {
  SideFiles a{.letter = 'a'}, b{.letter = 'b'};
  std::string rule = "exact";
  std::string sph_origin = "none";
  bool find_crossings = false;
  bool find_patches = false;
  std::optional<double> thickness;
  bool carry = false;
  std::string budget;
  std::string priority = "overlap";
  std::optional<std::uint32_t> level;
  double margin = 0;
  std::string scene;
  std::vector<std::string> roots;
  bool with_self = false;
  std::optional<double> within;
  std::string output;
  std::string page;
  std::string plot;
  unsigned threads = 0;
  bool json = false;
};

/// "5000" pair tests, or a time such as "200us" or "1.5ms".
Budget parse_budget(const std::string& text) {
  if (text.empty()) return {};
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = platform::read_number(text.data(), end, value);
  const std::string_view unit(rest, static_cast<std::size_t>(end - rest));
  if (error == std::errc() && value >= 0 && value < 1e15) {
    const auto nanoseconds = [](double n) { return std::chrono::nanoseconds(static_cast<std::int64_t>(n)); };
    if (unit.empty() && value == std::floor(value)) return static_cast<std::int64_t>(value);
    if (unit == "ns") return nanoseconds(value);
    if (unit == "us") return nanoseconds(1e3 * value);
    // Some centuries still fit into 64 bits of nanoseconds.
    if (unit == "ms" && value < 1e12) return nanoseconds(1e6 * value);
    if (unit == "s" && value < 1e9) return nanoseconds(1e9 * value);
  }
  throw UsageError(
      fmt::format("--budget '{}' is neither a number of pair tests such as 5000 nor a time such as 200us", text));
}

CollideOptions query_options(const CollideArguments& o) {
  check_name("priority", o.priority, {"overlap", "level"});
  CollideOptions options{.level = o.level, .margin = o.margin, .budget = parse_budget(o.budget), .surfaces = true};
  options.priority = o.priority == "level" ? Priority::level : Priority::overlap;
  return options;
}

/// Reports an option that the library rejects by its name on the command line.
ContactQuery make_query(const CollideArguments& o) {
  if (!(o.margin >= 0) || !std::isfinite(o.margin)) {
    throw UsageError(fmt::format("--margin {} is not a length of 0 or more", o.margin));
  }
  return ContactQuery(query_options(o));
}

void require_good(const Status& status) {
  if (!status) throw UsageError(message(status));
}

CollidedFrame collide_frame(const CollideArguments& o, Side& a, Side& b, std::size_t frame, ContactQuery& query,
                            CrossingQuery& crossed, Workers& workers) {
  a.move_to(frame, workers);
  b.move_to(frame, workers);
  CollidedFrame result{.name_a = a.frame_name(frame), .name_b = b.frame_name(frame)};
  // The first call of all makes memory: its cost is not that of a frame.
  if (frame == 0) require_good(query.start(workers));
  toolbox::Stopwatch watch;
  const ContactStatus status = o.carry && frame > 0 ? query.carry(workers) : query.start(workers);
  result.microseconds = 1e6 * watch.lap();
  require_good(status);
  const Contacts& found = query.contacts();
  result.contacts = found.contacts;
  result.surfaces = found.surfaces;
  result.finished = found.finished;
  result.pair_tests = found.pair_tests;
  result.achieved_level = found.achieved_level.front();
  if (o.find_crossings) {
    require_good(crossed.run(a.collider(), b.collider()));
    result.crossings_microseconds = 1e6 * watch.lap();
    result.crossings.assign(crossed.pairs().begin(), crossed.pairs().end());
  }
  return result;
}

/// The given options that need two bodies, for rejections; empty if there is none.
std::string given_of_two(const CollideArguments& o) {
  const std::vector<std::pair<const char*, bool>> all{
      {"--carry", o.carry}, {"--priority", o.priority != "overlap"}, {"--plot", !o.plot.empty()}};
  for (const auto& [name, given] : all)
    if (given) return name;
  return {};
}

int run_scene(const CollideArguments& o) {
  for (const SideFiles* side : {&o.a, &o.b})
    if (!(side->mesh + side->tree + side->motion + side->translate + side->rotate).empty())
      throw UsageError(fmt::format("--scene {}: bodies, motions and places are named in it; leave out {}", o.scene,
                                   side->mesh.empty() ? "their options" : side->mesh));
  if (o.a.weld)
    throw UsageError(
        fmt::format("--scene {}: --weld is for two bodies; name welded meshes, which morula convert makes", o.scene));
  if (o.find_patches) throw UsageError(fmt::format("--scene {}: --patches is for two bodies; leave it out", o.scene));
  if (o.thickness) throw UsageError(fmt::format("--scene {}: --thickness is for one or two surfaces", o.scene));
  if (o.with_self || o.within)
    throw UsageError(fmt::format("--scene {}: --self and --within are for one or two bodies", o.scene));
  if (const std::string given = given_of_two(o); !given.empty())
    throw UsageError(fmt::format("--scene {}: {} is for two bodies; leave it out", o.scene, given));
  require_position_rules(parse_rules(o.rule));
  if (!(o.margin >= 0)) throw UsageError(fmt::format("--margin {} is not a length of 0 or more", o.margin));
  return collide_scene({.file = o.scene,
                        .roots = {o.roots.begin(), o.roots.end()},
                        .options = {.level = o.level,
                                    .margin = o.margin,
                                    .budget = parse_budget(o.budget),
                                    .surfaces = !o.find_crossings,
                                    .find_crossings = o.find_crossings},
                        .rule = o.rule,
                        .sph_origin = o.sph_origin,
                        .budget = o.budget,
                        .output = o.output,
                        .page = o.page,
                        .threads = o.threads,
                        .json = o.json});
}

/// The last given option of those for contacts of the spheres of two bodies; empty without any.
std::string given_of_spheres(const CollideArguments& o) {
  std::string given = given_of_two(o);
  if (!o.budget.empty()) given = "--budget";
  if (o.level) given = "--level";
  if (o.margin != 0) given = "--margin";
  return given;
}

int run_features(const CollideArguments& o) {
  const char* const option = o.within ? "--within" : "--self";
  if (o.b.mesh.empty() && !o.with_self)
    throw UsageError("--within with one body is about the body itself: add --self, or name the other body");
  if (o.b.mesh.empty() && !(o.b.tree + o.b.motion + o.b.translate + o.b.rotate).empty())
    throw UsageError("there is no body B: name it, or leave out its options");
  std::string given = given_of_spheres(o);
  if (!(o.a.tree + o.b.tree).empty()) given = o.a.tree.empty() ? "--tree-b" : "--tree-a";
  if (!given.empty())
    throw UsageError(fmt::format("{} is for contacts of spheres: leave it out with {}", given, option));
  if (o.within && !(*o.within >= 0))
    throw UsageError(fmt::format("--within {} is not a length of 0 or more", *o.within));
  return collide_features({.a = o.a,
                           .b = o.b,
                           .with_self = o.with_self,
                           .within = o.within,
                           .output = o.output,
                           .threads = o.threads,
                           .json = o.json});
}

int run_layers(const CollideArguments& o) {
  const std::vector<std::pair<const char*, bool>> all{{"--tree-a", !o.a.tree.empty()},
                                                      {"--tree-b", !o.b.tree.empty()},
                                                      {"--rule", o.rule != "exact"},
                                                      {"--sph-origin", o.sph_origin != "none"},
                                                      {"--page", !o.page.empty()}};
  for (const auto& [name, given] : all)
    if (given) throw UsageError(fmt::format("{} is for spheres: leave it out with --thickness", name));
  return collide_layers(
      {.a = o.a, .b = o.b, .thickness = *o.thickness, .output = o.output, .threads = o.threads, .json = o.json});
}

int run_patches(const CollideArguments& o) {
  std::string given = given_of_spheres(o);
  if (o.find_crossings) given = "--crossings";
  if (o.within) given = "--within";
  if (o.with_self && !o.b.mesh.empty())
    throw UsageError("--self with --patches is for one body: leave out --self, or the other body");
  if (o.b.mesh.empty() && !(o.b.tree + o.b.motion + o.b.translate + o.b.rotate).empty())
    throw UsageError("there is no body B: name it, or leave out its options");
  if (!given.empty()) throw UsageError(fmt::format("{} shows no patches: leave it out with --patches", given));
  if (o.thickness) return run_layers(o);
  return collide_patches({.a = o.a,
                          .b = o.b,
                          .rule = o.rule,
                          .sph_origin = o.sph_origin,
                          .output = o.output,
                          .page = o.page,
                          .threads = o.threads,
                          .json = o.json});
}

int collide_command(const CollideArguments& o) {
  if (!o.scene.empty()) return run_scene(o);
  if (o.a.mesh.empty()) throw UsageError("name two meshes, or give --scene FILE");
  if (o.thickness && !o.find_patches) throw UsageError("--thickness is for patches: add --patches");
  if ((o.with_self || o.within) && !o.find_patches) return run_features(o);
  if (o.b.mesh.empty() && !o.with_self)
    throw UsageError(fmt::format("{} is one body: name another one, or add --self", o.a.mesh));
  if (o.find_patches) return run_patches(o);
  const std::vector<Rule> rules = parse_rules(o.rule);
  require_position_rules(rules);
  ContactQuery query = make_query(o);
  const std::string format = extension(o.output);
  if (!o.output.empty()) {
    if (format != ".csv") throw UsageError(fmt::format("-o {}: contacts are written as .csv", o.output));
    require_output_place(o.output);
    require_not_input(o.output, {o.a.mesh, o.a.tree, o.a.motion, o.b.mesh, o.b.tree, o.b.motion});
  }
  require_plot_output(o.plot, {o.a.mesh, o.a.tree, o.a.motion, o.b.mesh, o.b.tree, o.b.motion});
  if (!o.page.empty())
    collide_views().require(o.page, {o.a.mesh, o.a.tree, o.a.motion, o.b.mesh, o.b.tree, o.b.motion});
  Workers workers = make_workers(o.threads);
  Side a(o.a, o.sph_origin, workers), b(o.b, o.sph_origin, workers);
  a.prepare(rules, workers);
  b.prepare(rules, workers);
  if (o.level) {
    const std::size_t levels = std::max(a.collider().tree().level_count(), b.collider().tree().level_count());
    if (*o.level >= levels)
      throw UsageError(fmt::format("--level {}: the trees have levels 0 to {}", *o.level, levels - 1));
  }
  query.add(a.collider(), b.collider());

  CrossingQuery crossed;
  std::vector<CollidedFrame> frames;
  std::unique_ptr<CollideView> view;
  if (!o.page.empty())
    view = collide_views().make(a.stem() + " and " + b.stem(), {&a.collider(), &b.collider()}, o.rule);
  const std::size_t count = std::max(a.frame_count(), b.frame_count());
  {
    Progress progress("colliding");
    for (std::size_t frame = 0; frame < count; ++frame) {
      progress.update(static_cast<double>(frame) / static_cast<double>(count));
      frames.push_back(collide_frame(o, a, b, frame, query, crossed, workers));
      if (view) {
        const CollidedFrame& found = frames.back();
        view->mark(found.contacts, found.surfaces);
        view->end_frame(found.name_a + ", " + found.name_b);
      }
    }
  }
  if (!o.output.empty()) {
    write_whole(o.output, o.find_crossings ? crossings_csv(frames) : contacts_csv(frames));
    note_written(o.output);
  }
  if (view) {
    write_whole(o.page, view->text());
    note_written(o.page);
  }
  const CollideRun run{.mesh_a = a.name(),
                       .mesh_b = b.name(),
                       .rule = o.rule,
                       .budget = o.budget,
                       .output = o.output,
                       .page = o.page,
                       .find_crossings = o.find_crossings,
                       .built_a = a.tree_was_built(),
                       .built_b = b.tree_was_built(),
                       .threads = workers.thread_count()};
  write_plot(o.plot, collide_plot(run, frames));
  if (o.json) {
    print_json(collide_json(run, frames));
  } else {
    fmt::print("{}", collide_text(run, frames));
  }
  return exit_done;
}

void add_side(CLI::App& command, SideFiles& side, const std::string& mesh_name) {
  const std::string x(1, side.letter);
  add_option(command, "--tree-" + x, side.tree,
             fmt::format("Tree of {}, or a flat set (.ply); default: a new tree in quality fast", mesh_name))
      ->type_name("FILE");
  add_option(command, "--motion-" + x, side.motion,
             fmt::format("Positions of {}: {}; it stays in its last frame", mesh_name, motion_kinds()))
      ->type_name("PATH");
  add_option(command, "--translate-" + x, side.translate,
             fmt::format("Translation of {}, in addition to its motion", mesh_name))
      ->type_name("X,Y,Z")
      ->take_last();
  add_option(command, "--rotate-" + x, side.rotate,
             fmt::format("Rotation of {} about an axis through the origin, applied first", mesh_name))
      ->type_name("X,Y,Z,DEGREES")
      ->take_last();
}

}  // namespace

void add_collide(CLI::App& app, Run& run) {
  auto o = std::make_shared<CollideArguments>();
  CLI::App* command = add_command(app, "collide", "Contacts of two bodies, frame by frame, within a budget");
  add_option(*command, "A", o->a.mesh, "Mesh at rest: " + readable_mesh_extensions())->type_name("");
  add_option(*command, "B", o->b.mesh, "The other mesh at rest")->type_name("");
  add_side(*command, o->a, "A");
  add_side(*command, o->b, "B");
  add_weld(*command, o->a.weld, "A and B");
  add_option(*command, "--scene", o->scene, "Many bodies instead of A and B: a JSON file, see docs/how-to/scene.md")
      ->type_name("FILE");
  add_option(*command, "--root", o->roots,
             "Folder besides the scene file's own that may contain the files that it names; may be repeated")
      ->type_name("DIR")
      ->allow_extra_args(false);
  add_flag(*command, "--self", o->with_self,
           "Facets of a body that cross each other, and facets of A and B that cross; no spheres. With --patches: the "
           "overlap of A with itself");
  add_option(*command, "--within", o->within,
             "Pairs of vertex and facet, edge and edge, at most this far apart; no spheres")
      ->type_name("LENGTH")
      ->transform(real_number());
  add_flag(*command, "--crossings", o->find_crossings, "Also list the pairs of facets that intersect");
  add_flag(*command, "--patches", o->find_patches,
           "Connected parts of the overlap of two closed bodies instead of contacts: volume, depth, normal, points");
  add_option(*command, "--thickness", o->thickness,
             "With --patches: parts where surfaces, open or closed, are nearer than this; no spheres. With --self, "
             "facets at most twice this far apart at rest do not count")
      ->type_name("LENGTH")
      ->transform(real_number());
  add_option(*command, "--budget", o->budget, "Limit per frame: pair tests, such as 5000, or time, such as 200us")
      ->type_name("N|TIME");
  add_option(*command, "--priority", o->priority, "Order of the search under a budget: overlap (default) or level")
      ->type_name("NAME");
  add_option(*command, "--level", o->level, "Level of both trees for the contacts; default: the leaves")
      ->type_name("N")
      ->transform(whole_number(0, max_depth));
  add_option(*command, "--margin", o->margin, "Largest gap of spheres that counts as a contact; default: 0")
      ->type_name("LENGTH")
      ->transform(real_number());
  add_flag(*command, "--carry", o->carry, "Start each frame from the result of the previous one");
  add_option(*command, "--rule", o->rule, "Update rule of the spheres; default: exact")->type_name("RULE");
  add_sph_origin(*command, o->sph_origin);
  add_option(*command, "-o,--output", o->output,
             "All contacts, with --crossings all pairs of facets, with --patches all patches, as FILE.csv")
      ->type_name("FILE");
  if (collide_views()) {
    add_option(*command, "--page", o->page,
               "All bodies, their spheres and contacts or patches in motion, as a page for a browser")
        ->type_name("PAGE");
  }
  add_plot(*command, o->plot, "contacts, their depth and pair tests over the frames");
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(
      *command,
      "Example:\n"
      "  morula collide liver.obj tool.obj --tree-a liver.morula --motion-a motion/ --translate-b 0.1,0,0.4 --budget "
      "200us\n"
      "  morula collide liver.obj tool.obj --crossings -o pairs.csv\n"
      "  morula collide liver.obj tool.obj --patches\n"
      "  morula collide liver.obj --motion-a motion/ --self --patches\n"
      "  morula collide cloth.obj ball.obj --patches --thickness 0.01\n"
      "  morula collide --scene room.json --budget 1ms\n"
      "  morula collide --scene room.json --page room.html");
  on_use(*command, [o, &run] {
    run = [o] {
      o->b.weld = o->a.weld;
      return collide_command(*o);
    };
  });
}

}  // namespace morula::cli
