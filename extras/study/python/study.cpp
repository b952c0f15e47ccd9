// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The study, as the command makes it; and parts of it, for those who spread it over many machines.
#include <atomic>
#include <morula/parallel/threads.hpp>
#include <morula/study/study.hpp>
#include <optional>
#include <shared/command.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "study_plan.hpp"

namespace morula::python {

namespace {

/// An object of Python's that functions keep and threads without the GIL give up.
std::shared_ptr<nb::object> kept_object(nb::handle given) {
  return {new nb::object(nb::borrow(given)), [](nb::object* object) {
            const nb::gil_scoped_acquire gil;
            delete object;
          }};
}

/// The object of a rule in Python: it has follow(positions), which returns the spheres of all nodes.
class PythonFollower {
 public:
  PythonFollower(const nb::object& make, const Mesh& mesh, const CoveredTree& model) : tree_(model.tree) {
    const nb::gil_scoped_acquire gil;
    object_ = kept_object(make(nb::cast(Mesh(mesh)), nb::cast(CoveredTree(model))));
  }
  SphereTree follow(const std::vector<Vec3>& positions) {
    const nb::gil_scoped_acquire gil;
    tree_.spheres = spheres_of(object_->attr("follow")(own_points(std::vector<Vec3>(positions))), "follow()");
    tree_.nested = false;
    return tree_;
  }

 private:
  SphereTree tree_;
  std::shared_ptr<nb::object> object_;
};

/// A list of (name, version, callable).
std::vector<study::FollowRule> own_rules(nb::handle given) {
  std::vector<study::FollowRule> rules;
  for (const nb::handle item : given) {
    const auto [name, version, make] = nb::cast<std::tuple<std::string, std::string, nb::object>>(item);
    rules.emplace_back(study::own_rule(
        name,
        [make = kept_object(make)](const Mesh& mesh, const CoveredTree& model) {
          return PythonFollower(*make, mesh, model);
        },
        version));
  }
  return rules;
}

/// A list of (name, version, callable).
std::vector<std::shared_ptr<const study::OwnGenerator>> own_generators(nb::handle given) {
  std::vector<std::shared_ptr<const study::OwnGenerator>> generators;
  for (const nb::handle item : given) {
    const auto [name, version, build] = nb::cast<std::tuple<std::string, std::string, nb::object>>(item);
    generators.push_back(study::own_generator(
        name,
        [build = kept_object(build)](const Mesh& mesh) -> CoveredTree {
          const nb::gil_scoped_acquire gil;
          const nb::object made = (*build)(nb::cast(Mesh(mesh)));
          if (nb::isinstance<SphereTree>(made))
            return cover(mesh, nb::cast<const SphereTree&>(made), {}, serial_workers());
          if (!nb::isinstance<CoveredTree>(made))
            reject_type(made, "generator() has returned", "a CoveredTree or a SphereTree");
          return nb::cast<const CoveredTree&>(made);
        },
        version));
  }
  return generators;
}

/// A list of (name, frames).
std::vector<study::RecordedMotion> own_motions(nb::handle given) {
  std::vector<study::RecordedMotion> motions;
  for (const nb::handle item : given) {
    const auto [name, array] = nb::cast<std::tuple<std::string, nb::object>>(item);
    const Positions frames = Positions::frames(array, "motions");
    study::RecordedMotion& motion = motions.emplace_back(study::RecordedMotion{.name = name, .frames = {}});
    for (std::size_t i = 0; i < frames.frame_count(); ++i)
      motion.frames.push_back(Positions(frames, i).view().to_vector());
  }
  return motions;
}

/// A list of (name, unit, version, callable).
std::vector<study::OwnMetric> own_metrics(nb::handle given) {
  std::vector<study::OwnMetric> metrics;
  for (const nb::handle item : given) {
    const auto [name, unit, version, value] =
        nb::cast<std::tuple<std::string, std::string, std::string, nb::object>>(item);
    metrics.push_back(
        {name, unit,
         [value = kept_object(value)](const Mesh& mesh, std::span<const Sphere> spheres, std::size_t level) {
           const nb::gil_scoped_acquire gil;
           const nb::object result =
               (*value)(nb::cast(Mesh(mesh)), own_spheres({spheres.begin(), spheres.end()}), level);
           return returned<double>(result, "metric", "a number");
         },
         version});
  }
  return metrics;
}

/// A dict of the options of the command, by their names.
cli::StudyOptions study_options(const nb::dict& bodies, const nb::dict& given) {
  cli::StudyOptions options;
  for (auto [name, body] : bodies) {
    const auto text = value_of<std::string>(name, "bodies", "a dict of meshes by name");
    options.bodies.push_back({text, *kept_mesh_of(MeshGiven{{body}}, text.c_str())});
  }
  for (const auto& item : given) {
    const auto name = value_of<std::string>(item.first, "options", "a dict of options by name");
    const nb::handle value = item.second;
    if (name == "own_rules") {
      options.own_rules = own_rules(value);
      continue;
    }
    if (name == "own_generators") {
      options.own_generators = own_generators(value);
      continue;
    }
    if (name == "own_motions") {
      options.own_motions = own_motions(value);
      continue;
    }
    if (name == "metrics") {
      options.metrics = own_metrics(value);
      continue;
    }
    const auto read = [&](auto& member) {
      if (!nb::try_cast(value, member))
        throw nb::type_error((name + ": " + nb::cast<std::string>(nb::repr(value)) + " is of another type").c_str());
      return true;
    };
    const bool known = (name == "meshes" && read(options.meshes)) || (name == "samples" && read(options.samples)) ||
                       (name == "motions" && read(options.motions)) || (name == "methods" && read(options.methods)) ||
                       (name == "rules" && read(options.rules)) || (name == "mixes" && read(options.mixes)) ||
                       (name == "trees" && read(options.trees)) || (name == "sph_origin" && read(options.sph_origin)) ||
                       (name == "frames" && read(options.frames)) ||
                       (name == "resolution" && read(options.resolution)) ||
                       (name == "branching" && read(options.branching)) || (name == "depth" && read(options.depth)) ||
                       (name == "seed" && read(options.seed)) || (name == "seeds" && read(options.seeds)) ||
                       (name == "unit" && read(options.unit)) || (name == "quick" && read(options.quick)) ||
                       (name == "formats" && read(options.formats)) || (name == "variants" && read(options.variants)) ||
                       (name == "paper_amounts" && read(options.paper_amounts));
    if (!known) throw nb::type_error(("there is no option '" + name + "'").c_str());
  }
  return options;
}

/// Tells Python, and looks whether Ctrl-C was pressed; what is raised stops the study and comes out of it.
class Report {
 public:
  explicit Report(nb::handle progress) : progress_(progress) {}
  study::Progress progress() {
    return [this](double share, const std::string& what) { call(share, what); };
  }
  morula::StopToken token() { return stop_.get_token(); }
  bool stopped() { return stop_.stop_requested(); }
  void rethrow() const {
    if (raised_) std::rethrow_exception(raised_);
  }

 private:
  void call(double share, const std::string& what) {
    if (raised_) return;
    const nb::gil_scoped_acquire gil;
    try {
      // Signals are seen by the main thread of Python alone; others' progress goes on.
      check_signals();
      if (!progress_.is_none()) progress_(share, what);
    } catch (...) {
      raised_ = std::current_exception();
      stop_.request_stop();
    }
  }

  nb::handle progress_;
  morula::StopSource stop_;
  std::exception_ptr raised_;
};

template <class F>
auto stoppable(Report& report, const F& f) {
  try {
    return without_gil(f);
  } catch (const study::Stopped&) {
    report.rethrow();
    throw;
  }
}

study::Plan plan_of(const cli::StudyOptions& options) {
  try {
    return without_gil([&] { return cli::make_study_plan(options); });
  } catch (const cli::UsageError& error) {
    throw std::invalid_argument(error.what());
  }
}

}  // namespace

void bind_study_extra(nb::module_& m) {
  m.def(
      "study_files",
      [](nb::dict bodies, nb::dict options, std::optional<FilePath> output, nb::object progress, Threads* workers) {
        const cli::StudyOptions chosen = study_options(bodies, options);
        const study::Plan plan = plan_of(chosen);
        const std::vector<study::FigureFormat> formats = cli::figure_formats(chosen.formats);
        Report report(progress);
        auto [json, cells, faults] = stoppable(report, [&] {
          CallWorkers call(workers);
          std::optional<study::Cache> cache;
          if (output) cache.emplace(output->path / "cells");
          const study::Study made =
              study::make_study(plan, call, {cache ? &*cache : nullptr, report.token(), report.progress()});
          if (output)
            cli::write_study_folder(made, output->path, formats, call, report.progress(),
                                    [&] { return report.stopped(); });
          return std::make_tuple(study::study_json(made), study::cells_csv(made.plan, made.result),
                                 study::faults(made.plan, made.result));
        });
        report.rethrow();
        return nb::make_tuple(json, cells, faults);
      },
      nb::arg("bodies"), nb::arg("options"), nb::arg("output").none() = nb::none(), nb::arg("progress") = nb::none(),
      nb::arg("workers") = nb::none(),
      nb::sig(
          "def study_files(bodies: dict[str, Mesh], options: dict[str, typing.Any], output: str | os.PathLike[str] "
          "| None = None, progress: collections.abc.Callable[[float, str], object] | None = None, workers: Workers | "
          "None = None) -> tuple[str, str, list[str]]"),
      "The basis of morula.study(): study.json, the cells as CSV, and faults to report.");
  m.def(
      "study_shard",
      [](nb::dict bodies, nb::dict options, std::size_t number, std::size_t count, FilePath cells) {
        const study::Plan plan = plan_of(study_options(bodies, options));
        Report report{nb::none()};
        const std::size_t computed = stoppable(report, [&] {
          const study::Cache cache(cells.path);
          study::RunOptions run{.cache = &cache, .stop = report.token(), .progress = report.progress()};
          run.shard = {number, count};
          return study::run(plan, serial_workers(), run).cell_count();
        });
        report.rethrow();
        return computed;
      },
      nb::arg("bodies"), nb::arg("options"), nb::arg("number"), nb::arg("count"), nb::arg("cells"),
      nb::sig(
          "def study_shard(bodies: dict[str, Mesh], options: dict[str, typing.Any], number: int, count: int, cells: "
          "str | os.PathLike[str]) -> int"),
      "Computes part `number` of `count` parts, and stores it in the folder of finished cells, from which the whole "
      "study reads it. Returns its number of cells.");
}

}  // namespace morula::python
