// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies that rebuild their tree for the current pose, and how loose a body has become.
#include <memory>
#include <morula/morula.hpp>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "building.hpp"
#include "choices.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "posed.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

struct HeldEstimator {
  LoosenessEstimator estimator;
  std::size_t vertex_count;
  std::mutex mutex;
};

}  // namespace

void bind_rebuilt_body(nb::module_& m) {
  Record<RebuildReport>(m, "RebuildReport", doc::RebuildReport)
      .field("checks", &RebuildReport::checks, doc::RebuildReport_checks)
      .field("started", &RebuildReport::started, doc::RebuildReport_started)
      .field("finished", &RebuildReport::finished, doc::RebuildReport_finished)
      .field("stopped", &RebuildReport::stopped, doc::RebuildReport_stopped)
      .field("failed", &RebuildReport::failed, doc::RebuildReport_failed)
      .field("swapped", &RebuildReport::swapped, doc::RebuildReport_swapped)
      .field("refused", &RebuildReport::refused, doc::RebuildReport_refused)
      .field("returned_home", &RebuildReport::returned_home, doc::RebuildReport_returned_home)
      .field("pose_switches", &RebuildReport::pose_switches, doc::RebuildReport_pose_switches)
      .field("candidates_evaluated", &RebuildReport::candidates_evaluated, doc::RebuildReport_candidates_evaluated)
      .field("rebuild_seconds", &RebuildReport::rebuild_seconds, doc::RebuildReport_rebuild_seconds)
      .field("rebuild_frames", &RebuildReport::rebuild_frames, doc::RebuildReport_rebuild_frames)
      .field("failure", &RebuildReport::failure)
      .field("looseness", &RebuildReport::looseness)
      .field("looseness_at_build", &RebuildReport::looseness_at_build);
  Record<RebuildStatus>(m, "RebuildStatus", "The result of an update of a rebuilding body.")
      .field("update", &RebuildStatus::update, doc::RebuildStatus_update)
      .field("swapped", &RebuildStatus::swapped, doc::RebuildStatus_swapped);

  nb::class_<PosedRebuilt> body(m, "RebuiltBody", collected<PosedRebuilt>(), doc::RebuiltBody);
  bind_pose(body);
  body.def(
          "__init__",
          [](PosedRebuilt* self, MeshGiven given, const CoveredTree& model, MethodName method, QualityName quality,
             QualityName rest_quality, double rebuild_threshold, int check_every, std::optional<int> rebuild_every,
             double min_improvement, bool look_ahead, double processor_share, RebuildEffortName effort,
             RebuildThreadName thread, Threads* workers) {
            RebuildOptions options;
            options.method = method_of(method);
            options.quality = quality_of(quality);
            options.rest_quality = quality_of(rest_quality, "rest_quality");
            options.rebuild_threshold = rebuild_threshold;
            options.check_every = check_every;
            options.rebuild_every = rebuild_every;
            options.min_improvement = min_improvement;
            options.look_ahead = look_ahead;
            options.processor_share = processor_share;
            options.effort = choice<RebuildEffort>(effort, "effort", rebuild_effort_choices);
            options.thread = choice<RebuildThread>(thread, "thread", rebuild_thread_choices);
            auto mesh = kept_mesh_of(given);
            auto owned =
                without_gil([&] { return std::make_unique<RebuiltBody>(*mesh, model, options, CallWorkers(workers)); });
            new (self) PosedRebuilt();
            self->mesh = std::move(mesh);
            self->owned = std::move(owned);
          },
          nb::arg("mesh"), nb::arg("model"), nb::kw_only(), nb::arg("method") = "optimized",
          nb::arg("quality") = "draft", nb::arg("rest_quality") = "fast", nb::arg("rebuild_threshold") = 1.25,
          nb::arg("check_every") = 4, nb::arg("rebuild_every") = nb::none(), nb::arg("min_improvement") = 0.05,
          nb::arg("look_ahead") = true, nb::arg("processor_share") = 1.0, nb::arg("effort") = "standard",
          nb::arg("thread") = "background", nb::arg("workers") = nb::none(),
          with_arguments(doc::RebuiltBody_RebuiltBody, {{"quality", doc::RebuildOptions_quality},
                                                        {"rest_quality", doc::RebuildOptions_rest_quality},
                                                        {"rebuild_threshold", doc::RebuildOptions_rebuild_threshold},
                                                        {"check_every", doc::RebuildOptions_check_every},
                                                        {"rebuild_every", doc::RebuildOptions_rebuild_every},
                                                        {"min_improvement", doc::RebuildOptions_min_improvement},
                                                        {"look_ahead", doc::RebuildOptions_look_ahead},
                                                        {"processor_share", doc::RebuildOptions_processor_share},
                                                        {"effort", doc::RebuildOptions_effort},
                                                        {"thread", "background, caller or none"}})
              .c_str())
      .def(
          "update",
          [](PosedRebuilt& self, PositionsGiven given, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            const PositionView view = positions[0].view();
            require_rows(view.size(), self.mesh->vertex_count(), "positions", 3, "the body's vertices");
            return updated(self, std::move(positions), workers,
                           [&](RebuiltBody& body, Workers& w) { return body.update(view, w); });
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::RebuiltBody_update)
      .def_prop_ro(
          "tree_version", [](const PosedRebuilt& self) { return self.owned->tree_version(); },
          doc::RebuiltBody_tree_version)
      .def_prop_ro("is_home", [](const PosedRebuilt& self) { return self.owned->is_home(); })
      .def_prop_ro("is_rebuilding", [](const PosedRebuilt& self) { return self.owned->is_rebuilding(); })
      .def_prop_ro(
          "report", [](const PosedRebuilt& self) { return self.owned->report(); }, doc::RebuildReport)
      .def(
          "current_tree", [](const PosedRebuilt& self) { return self.owned->body().current_tree(); },
          doc::Body_current_tree)
      .def_prop_ro(
          "cover", [](const PosedRebuilt& self) { return self.owned->body().cover(); }, "The present cover: a copy.")
      .def(
          "hash", [](const PosedRebuilt& self) { return self.owned->body().hash(); }, doc::Body_hash)
      .def("__repr__", [](const PosedRebuilt& self) {
        return "<morula.RebuiltBody: " + std::to_string(self.sphere_state().spheres.size()) + " nodes, tree version " +
               std::to_string(self.owned->tree_version()) + ">";
      });
}

void bind_looseness_estimate(nb::module_& m) {
  nb::class_<HeldEstimator>(m, "LoosenessEstimator", doc::LoosenessEstimator)
      .def(
          "__init__",
          [](HeldEstimator* self, MeshGiven given, std::size_t sample_count) {
            const auto rest = mesh_of(given, "rest");
            LoosenessEstimator made = without_gil([&] { return LoosenessEstimator(*rest, sample_count); });
            new (self) HeldEstimator{std::move(made), rest->vertex_count(), {}};
          },
          nb::arg("rest"), nb::arg("sample_count") = LoosenessEstimator::default_samples,
          doc::LoosenessEstimator_LoosenessEstimator)
      .def(
          "estimate",
          [](HeldEstimator& self, const PosedBody& body, PositionsGiven given) {
            const Positions positions(given.object, "positions");
            require_rows(positions.view().size(), self.vertex_count, "positions", 3, "the estimator's vertices");
            require_rows(body.owned->vertex_count(), self.vertex_count, "body", 3, "the estimator's vertices");
            return own_numbers(without_gil([&] {
              const std::scoped_lock lock(self.mutex);
              const std::shared_lock reading(body.mutex);
              std::vector<double> looseness(body.owned->rest_tree().level_count());
              self.estimator.pose(positions.view());
              self.estimator.estimate(*body.owned, looseness);
              return looseness;
            }));
          },
          nb::arg("body"), nb::arg("positions"),
          "Looseness of every level set of a body, from the root; in object volumes. The root's value is exact if the "
          "root contains the object. positions: those of the body's last update, finite. The same bits in every run. "
          "Cost: linear in facets (the volume) and samples.")
      .def_prop_ro(
          "has_volume", [](const HeldEstimator& self) { return self.estimator.has_volume(); },
          doc::LoosenessEstimator_has_volume);
  m.def(
      "estimate_looseness",
      [](const PosedBody& body, PositionsGiven given) {
        const Positions positions(given.object, "positions");
        return own_numbers(without_gil([&] {
          const std::shared_lock lock(body.mutex);
          return estimate_looseness(*body.mesh, *body.owned, positions.view());
        }));
      },
      nb::arg("body"), nb::arg("positions"), doc::estimate_looseness);
}

}  // namespace morula::python
