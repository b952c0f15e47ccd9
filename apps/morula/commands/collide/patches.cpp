// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/patches.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/io/whole_output.hpp>
#include <optional>
#include <toolbox/stopwatch.hpp>

#include "commands/collide/patch_report.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

void require_closed(const Side& side) {
  const MeshReport report = inspect(side.mesh());
  std::string fault;
  if (!report.closed) {
    fault = fmt::format(
        "open ({}): morula repair merges equal vertices, and with --cap N closes holes; --thickness takes open "
        "surfaces",
        why_open(report));
  } else if (!report.oriented) {
    fault = fmt::format("not oriented ({}): morula repair turns its facets",
                        counted(report.misoriented_edges, "misoriented edge"));
  } else if (report.volume < 0) {
    fault = fmt::format("inside out (volume {}): morula repair turns its facets", figure(report.volume));
  }
  if (!fault.empty()) throw UsageError(fmt::format("--patches needs closed bodies, but {} is {}", side.name(), fault));
}

/// b: a itself for patches of one body. view: null without a page. uncertified: counts frames.
PatchReport patches_of_frames(Side& a, Side& b, CollideView* view, std::size_t& uncertified, Workers& workers) {
  PatchReport report;
  CrossingQuery crossed;
  const bool is_one = &a == &b;
  ContactPatchQuery query = is_one ? ContactPatchQuery(a.collider()) : ContactPatchQuery(a.collider(), b.collider());
  const std::size_t count = std::max(a.frame_count(), b.frame_count());
  Progress progress("colliding");
  for (std::size_t frame = 0; frame < count; ++frame) {
    progress.update(static_cast<double>(frame) / static_cast<double>(count));
    a.move_to(frame, workers);
    if (!is_one) b.move_to(frame, workers);
    toolbox::Stopwatch watch;
    const Status status = query.run();
    const double microseconds = 1e6 * watch.lap();
    if (status.code == Status::Code::inside_out) {
      const Side& side = status.body == 0 ? a : b;
      throw UsageError(
          fmt::format("{}: {} is inside out where it meets the other body: morula repair turns facets of a "
                      "mesh, and a motion must not mirror it",
                      side.frame_name(frame), side.name()));
    }
    if (!status) throw UsageError(message(status));
    report.add(a.frame_name(frame), b.frame_name(frame), query, microseconds, {{"certified", query.certified()}});
    uncertified += query.certified() ? 0 : 1;
    if (view == nullptr) continue;
    // Of one body, facets that share a vertex would be among the pairs.
    if (is_one) {
      view->end_frame_with_patches(a.frame_name(frame), query.patches(), {});
      continue;
    }
    if (const Status crossings = crossed.run(a.collider(), b.collider()); !crossings)
      throw UsageError(message(crossings));
    view->end_frame_with_patches(a.frame_name(frame) + ", " + b.frame_name(frame), query.patches(), crossed.pairs());
  }
  return report;
}

}  // namespace

int collide_patches(const PatchRun& run) {
  const std::vector<Rule> rules = parse_rules(run.rule);
  require_position_rules(rules);
  if (!run.output.empty()) {
    if (extension(run.output) != ".csv")
      throw UsageError(fmt::format("-o {}: patches are written as .csv", run.output));
    require_output_place(run.output);
    require_not_input(run.output, {run.a.mesh, run.a.tree, run.a.motion, run.b.mesh, run.b.tree, run.b.motion});
  }
  if (!run.page.empty())
    collide_views().require(run.page, {run.a.mesh, run.a.tree, run.a.motion, run.b.mesh, run.b.tree, run.b.motion});
  Workers workers = make_workers(run.threads);
  Side a(run.a, run.sph_origin, workers);
  std::optional<Side> other;
  if (!run.b.mesh.empty()) other.emplace(run.b, run.sph_origin, workers);
  Side& b = other ? *other : a;
  require_closed(a);
  if (other) require_closed(b);
  a.prepare(rules, workers);
  if (other) b.prepare(rules, workers);
  std::unique_ptr<CollideView> view;
  if (!run.page.empty() && other)
    view = collide_views().make(a.stem() + " and " + b.stem(), {&a.collider(), &b.collider()}, run.rule);
  if (!run.page.empty() && !other) view = collide_views().make(a.stem(), {&a.collider()}, run.rule);
  std::size_t uncertified = 0;
  const PatchReport report = patches_of_frames(a, b, view.get(), uncertified, workers);
  if (!run.output.empty()) {
    write_whole(run.output, report.rows);
    note_written(run.output);
  }
  if (view) {
    write_whole(run.page, view->text());
    note_written(run.page);
  }
  if (run.json) {
    print_json({{"a", a.name()},
                {"b", b.name()},
                {"rule", run.rule},
                {"threads", workers.thread_count()},
                {"frames", report.frames}});
    return exit_done;
  }
  fmt::print("{}", report.text());
  if (uncertified > 0)
    fmt::print("note      patches may be missing in {}: spheres of the rule {} do not cover\n",
               counted(uncertified, "frame"), run.rule);
  fmt::print("{}", built_tree_note(a.tree_was_built(), other && b.tree_was_built()));
  for (const std::string& file : {run.output, run.page})
    if (!file.empty()) fmt::print("written   {}\n", file);
  return exit_done;
}

}  // namespace morula::cli
