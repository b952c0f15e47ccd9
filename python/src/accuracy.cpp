// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Measurements: looseness, coverage, protrusion, level by level.
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

VoxelGrid grid_of(int resolution, std::optional<double> voxel_edge) {
  VoxelGrid grid;
  grid.resolution = resolution;
  if (voxel_edge) {
    grid.kind = VoxelGrid::Kind::fixed;
    grid.voxel_edge = *voxel_edge;
  }
  return grid;
}

/// The mesh of a call: at rest, or with other positions, which are not copied.
struct Posture {
  BorrowedMesh mesh;
  std::vector<Positions> positions;

  Posture(const MeshGiven& given, nb::handle at) : mesh(mesh_of(given)) {
    if (at.is_none()) return;
    positions.emplace_back(at, "positions");
    require_rows(positions[0].view().size(), mesh->vertex_count(), "positions", 3, "the mesh's vertices");
  }
  MeshView view() const { return positions.empty() ? *mesh : MeshView(positions[0].view(), mesh->facets); }
};

constexpr const char* grid_text =
    "voxels along the longest side of the box of the spheres; with voxel_edge, mesh units, a fixed lattice instead";

/// Binds measure() and similar functions, for a tree or for spheres: `read` converts the argument, `measure` measures
/// without the GIL.
template <class Given, class Read, class Measure>
void bind_measure(nb::module_& m, const char* name, const char* subject, const char* subject_type, const char* result,
                  const char* text, const Read& read, const Measure& measure) {
  const std::string signature =
      std::string("def ") + name + "(mesh: morula.typing.MeshLike, " + subject + ": " + subject_type +
      ", positions: morula.typing.FloatArray | None = None, *, resolution: int = 192, voxel_edge: float | None = None, "
      "with_protrusion: bool = True, protrusion_tolerance: float = 0.01, with_sampled_fit: bool = False, "
      "open_by_winding: bool = False, workers: Workers | None = None) -> " +
      result;
  m.def(
      name,
      [read, measure](MeshGiven given, Given subject_given, nb::handle positions, int resolution,
                      std::optional<double> voxel_edge, bool with_protrusion, double protrusion_tolerance,
                      bool with_sampled_fit, bool open_by_winding, Threads* workers) {
        const MeasureOptions options{grid_of(resolution, voxel_edge), with_protrusion, protrusion_tolerance,
                                     with_sampled_fit, open_by_winding};
        const Posture posture(given, positions);
        const auto measured = read(subject_given);
        return without_gil([&] { return measure(posture.view(), measured, options, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::arg(subject), nb::arg("positions") = nb::none(), nb::kw_only(), nb::arg("resolution") = 192,
      nb::arg("voxel_edge") = nb::none(), nb::arg("with_protrusion") = true, nb::arg("protrusion_tolerance") = 1e-2,
      nb::arg("with_sampled_fit") = false, nb::arg("open_by_winding") = false, nb::arg("workers") = nb::none(),
      nb::sig(signature.c_str()),
      with_arguments(text, {{"positions", "(vertices, 3): positions of the mesh; None: at rest"},
                            {"resolution", grid_text},
                            {"with_protrusion", "measure protrusion as well"},
                            {"protrusion_tolerance", doc::MeasureOptions_protrusion_tolerance},
                            {"with_sampled_fit", doc::MeasureOptions_with_sampled_fit},
                            {"open_by_winding", doc::MeasureOptions_open_by_winding}})
          .c_str());
}

struct HeldMeter {
  LoosenessMeter meter;
  std::size_t vertex_count;

  Positions positions_of(const PositionsGiven& given) const {
    Positions positions(given.object, "positions");
    require_rows(positions.view().size(), vertex_count, "positions", 3, "the mesh's vertices");
    return positions;
  }
};

/// measure() or measure_open() of a meter.
void bind_meter_measure(nb::class_<HeldMeter>& type, const char* name, decltype(&LoosenessMeter::measure) measure,
                        const char* text) {
  type.def(
      name,
      [measure](const HeldMeter& self, PositionsGiven given, ArrayGiven rows, int resolution,
                std::optional<double> voxel_edge, Threads* workers) {
        const Positions positions = self.positions_of(given);
        const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
        const VoxelGrid grid = grid_of(resolution, voxel_edge);
        return without_gil(
            [&] { return (self.meter.*measure)(positions.view(), spheres, grid, CallWorkers(workers)); });
      },
      nb::arg("positions"), nb::arg("spheres"), nb::kw_only(), nb::arg("resolution") = 192,
      nb::arg("voxel_edge") = nb::none(), nb::arg("workers") = nb::none(),
      with_arguments(text, {{"resolution", grid_text}}).c_str());
}

void bind_meter(nb::module_& m) {
  nb::class_<HeldMeter> type(m, "LoosenessMeter", doc::LoosenessMeter);
  type.def(
      "__init__",
      [](HeldMeter* self, MeshGiven given) {
        const auto mesh = mesh_of(given);
        LoosenessMeter made = without_gil([&] { return LoosenessMeter(*mesh); });
        new (self) HeldMeter{std::move(made), mesh->vertex_count()};
      },
      nb::arg("mesh"), doc::LoosenessMeter_LoosenessMeter);
  bind_meter_measure(type, "measure", &LoosenessMeter::measure, doc::LoosenessMeter_measure);
  bind_meter_measure(type, "measure_open", &LoosenessMeter::measure_open, doc::LoosenessMeter_measure_open);
  type.def_prop_ro(
      "has_volume", [](const HeldMeter& self) { return self.meter.has_volume(); }, doc::LoosenessMeter_has_volume);
}

}  // namespace

void bind_accuracy(nb::module_& m) {
  Record<Looseness>(m, "Looseness", "The volume of the spheres' union outside the object.")
      .field("looseness", &Looseness::looseness, doc::Looseness_looseness)
      .field("missed_volume", &Looseness::missed_volume, doc::Looseness_missed_volume)
      .field("outside_volume", &Looseness::outside_volume, doc::Looseness_outside_volume)
      .field("object_volume", &Looseness::object_volume, doc::Looseness_object_volume)
      .field("union_volume", &Looseness::union_volume, doc::Looseness_union_volume)
      .field("voxels", &Looseness::voxels, doc::Looseness_voxels)
      .field("voxel_edge", &Looseness::voxel_edge)
      .property(
          "range",
          [](const Looseness& l) -> std::optional<std::pair<double, double>> {
            if (!l.range) return std::nullopt;
            return std::make_pair(l.range->low, l.range->high);
          },
          doc::Looseness_Range);
  Record<Coverage>(m, "Coverage", "The uncovered part of the surface: its area, and its distance from the spheres.")
      .field("covered", &Coverage::covered, doc::Coverage_covered)
      .field("uncovered_area", &Coverage::uncovered_area, doc::Coverage_uncovered_area)
      .field("uncovered_distance", &Coverage::uncovered_distance, doc::Coverage_uncovered_distance)
      .field("uncovered_distance_upper", &Coverage::uncovered_distance_upper, doc::Coverage_uncovered_distance_upper)
      .field("tolerance", &Coverage::tolerance, doc::Coverage_tolerance)
      .field("worst_facet", &Coverage::worst_facet, doc::Coverage_worst_facet);
  Record<Protrusion>(m, "Protrusion", "The protrusion of spheres out of the object.")
      .field("worst", &Protrusion::worst, doc::Protrusion_worst)
      .field("mean", &Protrusion::mean);
  Record<SampledFit>(m, "SampledFit", doc::SampledFit)
      .field("coverage", &SampledFit::coverage, doc::SampledFit_coverage)
      .field("protrusion", &SampledFit::protrusion, doc::SampledFit_protrusion)
      .field("protrusion_mean", &SampledFit::protrusion_mean, doc::SampledFit_protrusion_mean)
      .field("protrusion_p95", &SampledFit::protrusion_p95, doc::SampledFit_protrusion_p95)
      .field("protrusion_max", &SampledFit::protrusion_max)
      .field("volume_ratio", &SampledFit::volume_ratio, doc::SampledFit_volume_ratio)
      .field("surface_gap_mean", &SampledFit::surface_gap_mean, doc::SampledFit_surface_gap_mean)
      .field("surface_gap_p95", &SampledFit::surface_gap_p95)
      .field("surface_gap_max", &SampledFit::surface_gap_max);
  Record<LevelMeasure>(m, "LevelMeasure", "The measurements of one level set.")
      .field("level", &LevelMeasure::level)
      .field("spheres", &LevelMeasure::spheres, doc::LevelMeasure_spheres)
      .field("looseness", &LevelMeasure::looseness)
      .field("coverage", &LevelMeasure::coverage)
      .field("protrusion", &LevelMeasure::protrusion, doc::LevelMeasure_protrusion)
      .field("sampled", &LevelMeasure::sampled, doc::LevelMeasure_sampled);

  bind_measure<nb::object>(
      m, "measure", "tree", "SphereTree | CoveredTree", "list[LevelMeasure]", doc::measure,
      [](const nb::object& given) {
        if (nb::isinstance<CoveredTree>(given)) return nb::cast<const CoveredTree&>(given).tree;
        if (!nb::isinstance<SphereTree>(given)) reject_type(given, "tree", "a SphereTree or a CoveredTree");
        return nb::cast<const SphereTree&>(given);
      },
      [](const MeshView& mesh, const SphereTree& tree, const MeasureOptions& options, Workers& workers) {
        return measure(mesh, tree, options, workers);
      });
  bind_measure<ArrayGiven>(
      m, "measure_spheres", "spheres", "morula.typing.FloatArray", "LevelMeasure", doc::measure_spheres,
      [](ArrayGiven rows) { return spheres_of(rows.object, "spheres"); },
      [](const MeshView& mesh, const std::vector<Sphere>& spheres, const MeasureOptions& options, Workers& workers) {
        return measure_spheres(mesh, spheres, options, workers);
      });
  m.def(
      "looseness",
      [](MeshGiven given, ArrayGiven rows, nb::handle positions, int resolution, std::optional<double> voxel_edge,
         Threads* workers) {
        const Posture posture(given, positions);
        const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
        const VoxelGrid grid = grid_of(resolution, voxel_edge);
        return without_gil([&] { return looseness(posture.view(), spheres, grid, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::arg("spheres"), nb::arg("positions") = nb::none(), nb::kw_only(),
      nb::arg("resolution") = 192, nb::arg("voxel_edge") = nb::none(), nb::arg("workers") = nb::none(),
      nb::sig("def looseness(mesh: morula.typing.MeshLike, spheres: morula.typing.FloatArray, "
              "positions: morula.typing.FloatArray | None = None, *, resolution: int = 192, voxel_edge: float | None = "
              "None, workers: Workers | None = None) -> Looseness"),
      with_arguments(doc::looseness, {{"resolution", grid_text}}).c_str());
  m.def(
      "coverage",
      [](MeshGiven given, ArrayGiven rows, nb::handle positions, Threads* workers) {
        const Posture posture(given, positions);
        const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
        return without_gil([&] { return coverage(posture.view(), spheres, CallWorkers(workers)); });
      },
      nb::arg("mesh"), nb::arg("spheres"), nb::arg("positions") = nb::none(), nb::kw_only(),
      nb::arg("workers") = nb::none(),
      nb::sig("def coverage(mesh: morula.typing.MeshLike, spheres: morula.typing.FloatArray, "
              "positions: morula.typing.FloatArray | None = None, *, workers: Workers | None = None) -> Coverage"),
      doc::coverage);
  bind_meter(m);
  nb::class_<FitSampler>(m, "FitSampler", doc::FitSampler)
      .def(
          "__init__",
          [](FitSampler* self, MeshGiven given, std::size_t interior, std::size_t surface, std::size_t of_a_sphere,
             std::uint64_t seed, Threads* workers) {
            const auto mesh = mesh_of(given);
            FitSampler made = without_gil([&] {
              return FitSampler(*mesh, {interior, surface, of_a_sphere, seed}, CallWorkers(workers));
            });
            new (self) FitSampler(std::move(made));
          },
          nb::arg("mesh"), nb::kw_only(), nb::arg("interior") = 10000, nb::arg("surface") = 5000,
          nb::arg("of_a_sphere") = 200, nb::arg("seed") = 1, nb::arg("workers") = nb::none(),
          with_arguments(doc::FitSampler_FitSampler, {{"interior", doc::SampleCounts_interior}}).c_str())
      .def(
          "measure",
          [](const FitSampler& self, ArrayGiven rows, Threads* workers) {
            const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
            return without_gil([&] { return self.measure(spheres, CallWorkers(workers)); });
          },
          nb::arg("spheres"), nb::arg("workers") = nb::none(), doc::FitSampler_measure);
  Record<BallProtrusion>(m, "BallProtrusion", "The protrusion of one ball out of the object, between bounds.")
      .field("lower", &BallProtrusion::lower, doc::BallProtrusion_lower)
      .field("upper", &BallProtrusion::upper, doc::BallProtrusion_upper);
  m.def(
      "ball_protrusion",
      [](const SignedDistance& object, Sphere ball, double tolerance) {
        return without_gil([&] { return protrusion(object, ball, tolerance); });
      },
      nb::arg("object"), nb::arg("ball"), nb::arg("tolerance") = 1e-3,
      (std::string("The protrusion of one ball out of the object: protrusion() of C++ for one ball. ") +
       doc::protrusion)
          .c_str());
  m.def(
      "protrusion",
      [](const SignedDistance& object, ArrayGiven rows, double tolerance, Threads* workers) {
        const std::vector<Sphere> spheres = spheres_of(rows.object, "spheres");
        return without_gil([&] { return protrusion(object, spheres, tolerance, CallWorkers(workers)); });
      },
      nb::arg("object"), nb::arg("spheres"), nb::arg("tolerance") = 1e-2, nb::arg("workers") = nb::none(),
      (std::string("The proven protrusion of spheres out of the object. ") + doc::protrusion_2).c_str());
}

}  // namespace morula::python
