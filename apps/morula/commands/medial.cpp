// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// morula medial: the balls that fit inside a mesh.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/medial/medial_balls.hpp>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/options.hpp"
#include "shared/progress.hpp"
#include "shared/report.hpp"

namespace morula::cli {
namespace {

struct MedialArguments {
  std::string mesh;
  std::string output;
  std::string kind = "shrinking";
  std::size_t samples = 2000;
  std::uint64_t seed = 1;
  unsigned threads = 0;
  bool json = false;
};

constexpr std::size_t most_samples = 10'000'000;

MedialBalls medial_balls(const MedialArguments& o, const Mesh& mesh, Workers& workers) {
  const SignedDistance shape(mesh, workers);
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  for (const SurfacePoint& sample : sample_surface(mesh, o.samples, o.seed)) {
    points.push_back(sample.point);
    // Outward also of a mesh that is inside out.
    normals.push_back(shape.orientation() * normalized(area_vector(mesh.corners(sample.facet))));
  }
  if (o.kind == "voronoi") return voronoi_balls(shape, points);
  return shrinking_balls(shape, points, normals, workers);
}

int medial_command(const MedialArguments& o) {
  check_name("kind", o.kind, {"shrinking", "voronoi"});
  if (extension(o.output) != ".ply") throw UsageError(fmt::format("{}: balls are written as .ply", o.output));
  require_output_place(o.output);
  require_not_input(o.output, {o.mesh});
  Workers workers = make_workers(o.threads);

  toolbox::Stopwatch watch;
  const Mesh mesh = load_mesh(o.mesh);
  const double read_seconds = watch.lap();
  const MedialBalls medial = medial_balls(o, mesh, workers);
  const double balls_seconds = watch.lap();
  write_balls(o.output, medial.balls);
  note_written(o.output);
  const double write_seconds = watch.lap();

  std::vector<double> radii;
  for (const Sphere& ball : medial.balls) radii.push_back(ball.radius);
  std::sort(radii.begin(), radii.end());
  const int exit_code = radii.empty() ? exit_check_failed : exit_done;
  if (o.json) {
    const auto or_null = [&](double value) { return radii.empty() ? Json(nullptr) : Json(value); };
    print_json({{"mesh", o.mesh},
                {"vertices", mesh.vertex_count()},
                {"facets", mesh.facet_count()},
                {"mesh_hash", hash_text(mesh_hash(mesh))},
                {"output", o.output},
                {"kind", o.kind},
                {"samples", o.samples},
                {"seed", o.seed},
                {"balls", medial.balls.size()},
                {"neighbors", medial.neighbors.size()},
                {"radius",
                 {{"smallest", or_null(radii.empty() ? 0 : radii.front())},
                  {"median", or_null(radii.empty() ? 0 : median(radii))},
                  {"largest", or_null(radii.empty() ? 0 : radii.back())}}},
                {"threads", workers.thread_count()},
                {"seconds", {{"read", read_seconds}, {"balls", balls_seconds}, {"write", write_seconds}}}});
    return exit_code;
  }
  fmt::print("{}\n\n", mesh_line(o.mesh, mesh));
  if (radii.empty()) {
    fmt::print("balls    none: nothing of the mesh is inside (morula info says why)\n");
  } else {
    fmt::print("balls    {} from {}\n", medial.balls.size(), counted(o.samples, "sample"));
    fmt::print("radius   smallest {}, median {}, largest {}\n", figure(radii.front()), figure(median(radii)),
               figure(radii.back()));
  }
  fmt::print("seconds  read {}, balls {}, write {} ({})\n", seconds(read_seconds), seconds(balls_seconds),
             seconds(write_seconds), counted(workers.thread_count(), "thread"));
  fmt::print("written  {}\n", o.output);
  return exit_code;
}

}  // namespace

void add_medial(CLI::App& app, Run& run) {
  auto o = std::make_shared<MedialArguments>();
  CLI::App* command = add_command(app, "medial", "Write the balls that fit inside a mesh");
  add_option(*command, "MESH", o->mesh, "Mesh file: " + readable_mesh_extensions())->required()->type_name("");
  add_option(*command, "-o,--output", o->output, "Ball file: .ply with x, y, z and radius per vertex")
      ->type_name("BALLS")
      ->required();
  add_option(*command, "--kind", o->kind, "shrinking (no surface inside), voronoi (no sample inside)")
      ->type_name("NAME")
      ->capture_default_str();
  add_option(*command, "--samples", o->samples, "Number of points on the surface")
      ->type_name("N")
      ->transform(whole_number(1, most_samples))
      ->capture_default_str();
  add_option(*command, "--seed", o->seed, "Seed of the points; equal seeds give equal balls")
      ->type_name("N")
      ->transform(whole_number())
      ->capture_default_str();
  add_threads(*command, o->threads);
  add_json(*command, o->json);
  set_footer(*command, "Example:\n  morula medial liver.obj -o balls.ply --samples 5000");
  on_use(*command, [o, &run] { run = [o] { return medial_command(*o); }; });
}

}  // namespace morula::cli
