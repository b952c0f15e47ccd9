// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/collide/layers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <morula/io/whole_output.hpp>
#include <morula/surface/layer_patches.hpp>
#include <optional>
#include <toolbox/stopwatch.hpp>

#include "commands/collide/moving_surface.hpp"
#include "commands/collide/patch_report.hpp"
#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/extension.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"

namespace morula::cli {
namespace {

/// Pairs of facets of one surface this many thicknesses apart at rest are left out: twice leaves room for bending.
constexpr double rest_thicknesses = 2;

/// b: null for a with itself.
PatchReport layers_of_frames(MovingSurface& a, MovingSurface* b, double thickness, Workers& workers) {
  LayerPatchOptions options{.thickness = thickness};
  if (b == nullptr) options.filter.rest_distance = rest_thicknesses * thickness;
  LayerPatchQuery query(std::move(options));
  PatchReport report;
  const std::size_t count = std::max(a.frame_count(), b ? b->frame_count() : 1);
  Progress progress("colliding");
  for (std::size_t frame = 0; frame < count; ++frame) {
    progress.update(static_cast<double>(frame) / static_cast<double>(count));
    a.move_to(frame, workers);
    if (b) b->move_to(frame, workers);
    toolbox::Stopwatch watch;
    const SurfaceQueryStatus status = b ? query.run(a.tree(), b->tree(), workers) : query.run(a.tree(), workers);
    const double microseconds = 1e6 * watch.lap();
    if (!status) throw UsageError(message(status));
    report.add(a.frame_name(frame), (b ? b : &a)->frame_name(frame), query, microseconds);
  }
  return report;
}

}  // namespace

int collide_layers(const LayerRun& run) {
  if (!(run.thickness > 0)) throw UsageError(fmt::format("--thickness {} is not a length above 0", run.thickness));
  if (!std::isfinite(rest_thicknesses * run.thickness))
    throw UsageError(fmt::format("--thickness {} is too large", run.thickness));
  if (!run.output.empty()) {
    if (extension(run.output) != ".csv")
      throw UsageError(fmt::format("-o {}: patches are written as .csv", run.output));
    require_output_place(run.output);
    require_not_input(run.output, {run.a.mesh, run.a.motion, run.b.mesh, run.b.motion});
  }
  Workers workers = make_workers(run.threads);
  MovingSurface a(run.a);
  std::optional<MovingSurface> b;
  if (!run.b.mesh.empty()) b.emplace(run.b);
  if (!b) note_duplicate_vertices(run.a.mesh, a.tree().duplicate_vertices(), run.a.weld);
  const PatchReport report = layers_of_frames(a, b ? &*b : nullptr, run.thickness, workers);
  if (!run.output.empty()) {
    write_whole(run.output, report.rows);
    note_written(run.output);
  }
  if (run.json) {
    Json json{{"a", a.name()},
              {"b", (b ? *b : a).name()},
              {"thickness", run.thickness},
              {"threads", workers.thread_count()},
              {"frames", report.frames}};
    if (!b) json["rest_distance"] = rest_thicknesses * run.thickness;
    print_json(json);
    return exit_done;
  }
  fmt::print("{}", report.text());
  if (!run.output.empty()) fmt::print("written   {}\n", run.output);
  return exit_done;
}

}  // namespace morula::cli
