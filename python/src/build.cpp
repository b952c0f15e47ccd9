// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Building trees, with progress and Ctrl-C.
#include <morula/morula.hpp>

#include "building.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

constexpr const char* build_text = R"(

mesh: a morula.Mesh, trimesh.Trimesh, meshio.Mesh or (positions, facets). The build releases the GIL, and Ctrl-C ends
it with KeyboardInterrupt.)";

}  // namespace

void bind_build(nb::module_& m) {
  m.def(
      "all_methods", [] { return names_of(all_methods()); }, "Names of the generators.");
  m.def(
      "all_reductions", [] { return names_of(all_reductions()); }, doc::Reduction);
  m.def(
      "all_optimizers", [] { return names_of(all_optimizers()); }, "Names of the optimizers.");
  m.def(
      "all_qualities", [] { return names_of(all_qualities()); }, doc::Quality);
  m.def("automatic_depth", nb::overload_cast<std::size_t, int>(&automatic_depth), nb::arg("facet_count"),
        nb::arg("branching") = 8, doc::automatic_depth);
  m.def(
      "automatic_depth",
      [](MeshGiven given, int branching) {
        const auto mesh = mesh_of(given);
        return automatic_depth(*mesh, branching);
      },
      nb::arg("mesh"), nb::arg("branching") = 8, doc::automatic_depth_2);

  Record<BuildProgress>(m, "BuildProgress", doc::BuildProgress)
      .field("share", &BuildProgress::share, doc::BuildProgress_share)
      .field("level", &BuildProgress::level, doc::BuildProgress_level)
      .field("seconds_left", &BuildProgress::seconds_left, doc::BuildProgress_seconds_left);

  m.def(
      "build",
      [](MeshGiven given, MethodName method, int branching, std::optional<int> depth,
         std::optional<std::size_t> spheres, std::optional<double> max_protrusion, double tolerance, bool nested,
         std::uint64_t seed, const std::vector<std::string>& reducers, OptimizerName optimizer, double balance_excess,
         QualityName quality, std::optional<double> time_limit_seconds, nb::object progress, Threads* workers) {
        BuildOptions options;
        options.method = method_of(method);
        options.branching = branching;
        options.depth = depth;
        options.spheres = spheres;
        options.max_protrusion = max_protrusion;
        options.tolerance = tolerance;
        options.nested = nested;
        options.seed = seed;
        for (const std::string& reducer : reducers) {
          options.reducers.push_back(choice<Reduction>(reducer, "reducers", reduction_from_name, all_reductions()));
        }
        options.optimizer = choice<Optimizer>(optimizer, "optimizer", optimizer_from_name, all_optimizers());
        options.balance_excess = balance_excess;
        options.quality = quality_of(quality);
        options.time_limit_seconds = time_limit_seconds;
        options.progress = progress_of(progress);
        const auto mesh = mesh_of(given);
        return without_gil([&] { return std::make_shared<CoveredTree>(build(*mesh, options, CallWorkers(workers))); });
      },
      nb::arg("mesh"), nb::kw_only(), nb::arg("method") = "optimized", nb::arg("branching") = 8,
      nb::arg("depth") = nb::none(), nb::arg("spheres") = nb::none(), nb::arg("max_protrusion") = nb::none(),
      nb::arg("tolerance") = 0.0, nb::arg("nested") = false, nb::arg("seed") = 1,
      nb::arg("reducers") = std::vector<std::string>{}, nb::arg("optimizer") = "none", nb::arg("balance_excess") = 0.0,
      nb::arg("quality") = "default", nb::arg("time_limit_seconds") = nb::none(),
      nb::arg("progress").none().sig("None") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig(
          "def build(mesh: morula.typing.MeshLike, *, method: morula.typing.Method = 'optimized', branching: int = 8, "
          "depth: int | None = None, spheres: int | None = None, max_protrusion: float | None = None, tolerance: float "
          "= 0.0, nested: bool "
          "= False, "
          "seed: int = 1, reducers: collections.abc.Sequence[morula.typing.Reduction] = [], optimizer: "
          "morula.typing.Optimizer = 'none', "
          "balance_excess: float = 0.0, quality: morula.typing.Quality = 'default', time_limit_seconds: float | "
          "None = None, "
          "progress: collections.abc.Callable[[BuildProgress], object] | None = None, "
          "workers: Workers | None = None) -> CoveredTree"),
      (with_arguments(doc::build,
                      {{"method", "octree, grid, hubbard, spawn, medial, combined or optimized: all_methods()"},
                       {"branching", doc::BuildOptions_branching},
                       {"depth", doc::BuildOptions_depth},
                       {"spheres", doc::BuildOptions_spheres},
                       {"max_protrusion", doc::BuildOptions_max_protrusion},
                       {"tolerance", doc::BuildOptions_tolerance},
                       {"nested", doc::BuildOptions_nested},
                       {"seed", doc::BuildOptions_seed},
                       {"reducers", doc::BuildOptions_reducers},
                       {"optimizer", doc::BuildOptions_optimizer},
                       {"balance_excess", doc::BuildOptions_balance_excess},
                       {"quality", doc::BuildOptions_quality},
                       {"time_limit_seconds", doc::BuildOptions_time_limit_seconds},
                       {"progress", "called with a BuildProgress at intervals; an exception of it ends the build"},
                       {"workers", "threads; None: one per processor"}}) +
       build_text)
          .c_str());

  m.def(
      "principal_strains",
      [](MeshGiven given, double max_stretch) {
        nb::list poses;
        for (NamedPose& pose : principal_strains(*mesh_of(given), max_stretch)) {
          poses.append(nb::make_tuple(pose.name, own_points(std::move(pose.positions))));
        }
        return poses;
      },
      nb::arg("mesh"), nb::arg("max_stretch") = 2.0,
      nb::sig("def principal_strains(mesh: morula.typing.MeshLike, max_stretch: float = 2.0) -> "
              "list[tuple[str, numpy.typing.NDArray[numpy.float64]]]"),
      doc::principal_strains);
  Record<KnownPosesReport>(m, "KnownPosesReport", "What add_known_poses() did.")
      .field("trees_built", &KnownPosesReport::trees_built, doc::KnownPosesReport_trees_built)
      .field("added", &KnownPosesReport::added)
      .field("worst", &KnownPosesReport::worst, doc::KnownPosesReport_worst);
  m.def(
      "with_known_poses",
      [](MeshGiven given, const CoveredTree& model, nb::iterable poses, MethodName method, QualityName quality,
         std::uint64_t seed, double pose_threshold, std::size_t max_trees, Threads* workers) {
        KnownPoseOptions options;
        options.method = method_of(method);
        options.quality = quality_of(quality);
        options.seed = seed;
        options.pose_threshold = pose_threshold;
        options.max_trees = max_trees;
        options.progress = [check = SignalCheck()](std::size_t, double) mutable { check(); };
        const auto mesh = mesh_of(given);
        std::vector<NamedPose> named;
        for (nb::handle pose : poses) {
          auto [name, positions] = value_of<std::pair<std::string, nb::object>>(
              pose, "poses", "a list of pairs of a name and positions (vertices, 3)");
          named.push_back({std::move(name), points_of(positions, "poses")});
        }
        auto copy = std::make_shared<CoveredTree>(model);
        const KnownPosesReport report =
            without_gil([&] { return add_known_poses(*mesh, *copy, named, options, CallWorkers(workers)); });
        return std::make_pair(copy, report);
      },
      nb::arg("mesh"), nb::arg("model"), nb::arg("poses"), nb::kw_only(), nb::arg("method") = "optimized",
      nb::arg("quality") = "default", nb::arg("seed") = 1, nb::arg("pose_threshold") = 1.2, nb::arg("max_trees") = 24,
      nb::arg("workers") = nb::none(),
      nb::sig("def with_known_poses(mesh: morula.typing.MeshLike, model: CoveredTree, "
              "poses: collections.abc.Iterable[tuple[str, morula.typing.FloatArray]], *, method: morula.typing.Method "
              "= 'optimized', "
              "quality: morula.typing.Quality = 'default', seed: int = 1, pose_threshold: float = 1.2, max_trees: int "
              "= 24, "
              "workers: Workers | None = None) -> tuple[CoveredTree, KnownPosesReport]"),
      (std::string("A copy of the model with known poses, pairs of name and positions (vertices, 3). ") +
       doc::add_known_poses)
          .c_str());
}

}  // namespace morula::python
