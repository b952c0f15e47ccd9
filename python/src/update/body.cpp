// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies whose spheres follow their vertices, modes or bones.
#include <morula/morula.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "choices.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"
#include "posed.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

std::vector<VertexRange> ranges_of(nb::handle given) {
  std::vector<VertexRange> ranges;
  constexpr const char* wanted = "a list of pairs (begin, end) of vertices";
  if (!nb::hasattr(given, "__iter__")) reject_type(given, "changed", wanted);
  for (nb::handle range : nb::borrow<nb::object>(given)) {
    const auto [begin, end] = value_of<std::pair<std::uint32_t, std::uint32_t>>(range, "changed", wanted);
    ranges.push_back({begin, end});
  }
  return ranges;
}

UpdateOptions options_of(nb::handle rules, bool conservative, std::string_view approach1_weights,
                         std::string_view approach1_inner_center, std::string_view approach2_inner_boxes,
                         std::string_view wrapped_center, double distance_floor, std::string_view modal_bound,
                         nb::handle modes, nb::handle skin, double skinned_measured, nb::handle training) {
  using O = RuleOptions;
  UpdateOptions options;
  options.rules.clear();
  const auto add = [&](nb::handle rule) {
    options.rules.push_back(choice<Rule>(value_of<std::string_view>(rule, "rules", "the name of a rule"), "rules",
                                         rule_from_name, all_rules()));
  };
  if (PyUnicode_Check(rules.ptr())) {
    add(rules);
  } else {
    if (!nb::hasattr(rules, "__iter__")) reject_type(rules, "rules", "the name of a rule, or a list of names,");
    for (nb::handle rule : nb::borrow<nb::object>(rules)) add(rule);
  }
  options.conservative = conservative;
  options.details.approach1_weights = choice<O::Weights>(approach1_weights, "approach1_weights", weight_choices);
  options.details.approach1_inner_center =
      choice<O::InnerCenter>(approach1_inner_center, "approach1_inner_center", inner_center_choices);
  options.details.approach2_inner_boxes =
      choice<O::InnerBoxes>(approach2_inner_boxes, "approach2_inner_boxes", inner_box_choices);
  options.details.wrapped_center = choice<O::WrappedCenter>(wrapped_center, "wrapped_center", wrapped_center_choices);
  options.details.distance_floor = distance_floor;
  options.details.modal_bound = choice<O::ModalBound>(modal_bound, "modal_bound", modal_bound_choices);
  if (!modes.is_none()) options.modes = modes_of(modes, "modes");
  if (!skin.is_none()) options.skin = skin_of(skin, "skin");
  options.details.skinned_measured = skinned_measured;
  if (!training.is_none()) options.training = frames_of_transforms(training, "training", options.skin.bone_count);
  return options;
}

/// A pointer that keeps nothing: the holder of the body keeps the tree, where the collector sees it, and every copy of
/// the body has such a holder.
std::shared_ptr<const CoveredTree> borrowed_tree(const std::shared_ptr<const CoveredTree>& model) {
  return {std::shared_ptr<const CoveredTree>(), model.get()};
}

std::shared_ptr<PosedBody> copied(const PosedBody& self) {
  auto copy = std::make_shared<PosedBody>();
  copy->mesh = again(self.mesh);
  copy->model = again(self.model);
  without_gil([&] {
    const std::shared_lock lock(self.mutex);
    copy->owned = std::make_unique<Body>(*self.owned);
    for (const Positions& positions : self.last) copy->last.emplace_back(positions, 0);
  });
  return copy;
}

/// All frames in one call: spheres in mesh coordinates, frame after frame. However it ends, by the last frame, by one
/// that is rejected or by Ctrl-C, keep(frame) is called for the frame that the body is in then, if any.
template <class Frame, class Keep>
Copy<double, -1, -1, 4> follow(PosedBody& self, std::size_t frame_count, Threads* workers, const Frame& update_to,
                               const Keep& keep) {
  const std::size_t node_count = self.sphere_state().spheres.size();
  std::vector<Sphere> spheres;
  std::size_t at = 0;
  const UpdateStatus status = without_gil([&] {
    CallWorkers call(workers);
    const std::unique_lock lock(self.mutex);
    SignalCheck check;
    spheres.reserve(frame_count * node_count);
    UpdateStatus last;
    std::optional<std::size_t> reached;
    try {
      for (; at < frame_count; ++at) {
        last = update_to(*self.owned, at, static_cast<Workers&>(call));
        if (!last) break;
        reached = at;
        const SphereState& pose = self.sphere_state();
        for (std::uint32_t node = 0; node < node_count; ++node) spheres.push_back(pose.sphere(node));
        check();
      }
    } catch (...) {
      if (reached) keep(*reached);
      throw;
    }
    if (reached) keep(*reached);
    return last;
  });
  if (!status) throw std::invalid_argument("frame " + std::to_string(at) + ": " + message(status));
  auto [values, owner] = kept(std::move(spheres));
  return Copy<double, -1, -1, 4>(reinterpret_cast<double*>(values->data()), {frame_count, node_count, 4}, owner);
}

void bind_body_updates(nb::class_<PosedBody>& body) {
  body.def(
          "__init__",
          [](PosedBody* self, MeshGiven given, std::shared_ptr<CoveredTree> model, nb::object rules, bool conservative,
             std::string_view approach1_weights, std::string_view approach1_inner_center,
             std::string_view approach2_inner_boxes, std::string_view wrapped_center, double distance_floor,
             std::string_view modal_bound, nb::object modes, nb::object skin, double skinned_measured,
             nb::object training, Threads* workers) {
            UpdateOptions options =
                options_of(rules, conservative, approach1_weights, approach1_inner_center, approach2_inner_boxes,
                           wrapped_center, distance_floor, modal_bound, modes, skin, skinned_measured, training);
            auto mesh = kept_mesh_of(given);
            auto owned = without_gil([&] {
              return std::make_unique<Body>(*mesh, borrowed_tree(model), std::move(options), CallWorkers(workers));
            });
            new (self) PosedBody();
            self->mesh = std::move(mesh);
            self->model = std::move(model);
            self->owned = std::move(owned);
          },
          nb::arg("mesh"), nb::arg("model"), nb::kw_only(), nb::arg("rules") = "exact", nb::arg("conservative") = false,
          nb::arg("approach1_weights") = "uniform", nb::arg("approach1_inner_center") = "children",
          nb::arg("approach2_inner_boxes") = "child_spheres", nb::arg("wrapped_center") = "children",
          nb::arg("distance_floor") = 0.0, nb::arg("modal_bound") = "gradient", nb::arg("modes") = nb::none(),
          nb::arg("skin") = nb::none(), nb::arg("skinned_measured") = 0.0, nb::arg("training") = nb::none(),
          nb::arg("workers") = nb::none(),
          nb::sig("def __init__(self, mesh: morula.typing.MeshLike, model: CoveredTree, *, "
                  "rules: morula.typing.Rule | collections.abc.Sequence[morula.typing.Rule] = 'exact', conservative: "
                  "bool = False, "
                  "approach1_weights: morula.typing.Weights = 'uniform', approach1_inner_center: "
                  "morula.typing.InnerCenter = "
                  "'children', "
                  "approach2_inner_boxes: morula.typing.InnerBoxes = 'child_spheres', wrapped_center: "
                  "morula.typing.WrappedCenter = 'children', distance_floor: "
                  "float = 0.0, modal_bound: morula.typing.ModalBound = 'gradient', modes: Modes | "
                  "morula.typing.FloatArray | None = None, "
                  "skin: Skin | morula.typing.FloatArray | None = None, skinned_measured: float = 0.0, "
                  "training: morula.typing.FloatArray | None = None, workers: Workers | None = None) -> None"),
          with_arguments(doc::Body_Body,
                         {{"rules", doc::UpdateOptions},
                          {"conservative", doc::UpdateOptions_conservative},
                          {"modes", "Modes, or an array (modes, vertices, 3), for update_modal()"},
                          {"skin", "Skin, or weights (vertices, bones), for update_skinned()"},
                          {"skinned_measured", doc::RuleOptions_skinned_measured},
                          {"training", (std::string("Transforms (frames, bones, 3, 4) or (frames, bones, 4, 4). ") +
                                        doc::UpdateOptions_training)
                                           .c_str()}})
              .c_str())
      .def(
          "update",
          [](PosedBody& self, PositionsGiven given, nb::handle changed, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            const PositionView view = positions[0].view();
            require_rows(view.size(), self.owned->vertex_count(), "positions", 3, "the body's vertices");
            if (changed.is_none()) {
              return updated(self, std::move(positions), workers,
                             [&](Body& body, Workers& w) { return body.update(view, w); });
            }
            const std::vector<VertexRange> ranges = ranges_of(changed);
            return updated(self, std::move(positions), workers,
                           [&](Body& body, Workers& w) { return body.update(view, ranges, w); });
          },
          nb::arg("positions"), nb::arg("changed") = nb::none(), nb::arg("workers") = nb::none(),
          nb::sig("def update(self, positions: morula.typing.FloatArray, "
                  "changed: collections.abc.Iterable[tuple[int, int]] | None = None, workers: Workers | None = None) "
                  "-> UpdateStatus"),
          (std::string(doc::Body_update) +
           "\n\npositions: (vertices, 3) float32 or float64, mesh units; not copied if the numbers of a vertex are "
           "contiguous. Rejected positions raise ValueError. The array is kept until the next update, because queries "
           "on facets read it.\n\nchanged: ranges [begin, end) of vertices. " +
           doc::Body_update_2)
              .c_str())
      .def(
          "follow",
          [](PosedBody& self, PositionsGiven given, Threads* workers) {
            const Positions frames = Positions::frames(given.object, "frames");
            if (frames.frame_count() > 0)
              require_rows(frames.view().size(), self.owned->vertex_count(), "frames", 3,
                           "the body's vertices, in every frame");
            std::vector<Positions> one;
            for (std::size_t i = 0; i < frames.frame_count(); ++i) one.emplace_back(frames, i);
            // The frame that the body ends in stays borrowed, as by update(); earlier frames are released with the
            // GIL.
            std::vector<Positions> last;
            last.reserve(1);
            return follow(
                self, one.size(), workers,
                [&](Body& body, std::size_t i, Workers& w) { return body.update(one[i].view(), w); },
                [&](std::size_t i) {
                  last.push_back(std::move(one[i]));
                  std::swap(self.last, last);
                });
          },
          nb::arg("frames"), nb::arg("workers") = nb::none(),
          nb::sig("def follow(self, frames: morula.typing.FloatArray, workers: Workers | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "A whole motion in one call. frames: (frames, vertices, 3) float32 or float64, not copied. Returns the "
          "spheres of every frame, (frames, nodes, 4) float64 in mesh coordinates. The body stays in the last frame. "
          "ValueError names a rejected frame; the body then stays in the previous frame, and after Ctrl-C in the frame "
          "that it reached.")
      .def(
          "update_modal",
          [](PosedBody& self, ArrayGiven given, Threads* workers) {
            std::vector<std::size_t> shape;
            const std::vector<double> coordinates = numbers_of(given.object, "coordinates", {-1}, shape);
            return updated(self, {}, workers,
                           [&](Body& body, Workers& w) { return body.update_modal(coordinates, w); });
          },
          nb::arg("coordinates"), nb::arg("workers") = nb::none(), doc::Body_update_modal)
      .def(
          "follow_modal",
          [](PosedBody& self, ArrayGiven given, Threads* workers) {
            std::vector<std::size_t> shape;
            const std::vector<double> all = numbers_of(given.object, "coordinates", {-1, -1}, shape);
            return follow(
                self, shape[0], workers,
                [&](Body& body, std::size_t i, Workers& w) {
                  return body.update_modal(std::span(all).subspan(i * shape[1], shape[1]), w);
                },
                [](std::size_t) {});
          },
          nb::arg("coordinates"), nb::arg("workers") = nb::none(),
          "update_modal() for coordinates (frames, modes); the spheres of every frame, (frames, nodes, 4).")
      .def(
          "update_skinned",
          [](PosedBody& self, ArrayGiven given, Threads* workers) {
            const std::vector<AffineTransform> transforms = transforms_of(given.object, "transforms");
            return updated(self, {}, workers,
                           [&](Body& body, Workers& w) { return body.update_skinned(transforms, w); });
          },
          nb::arg("transforms"), nb::arg("workers") = nb::none(),
          (std::string(doc::Body_update_skinned) +
           "\n\ntransforms: (bones, 3, 4) or (bones, 4, 4), matrices that act on columns.")
              .c_str())
      .def(
          "update_lazily",
          [](PosedBody& self, PositionsGiven given, std::size_t level, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            const PositionView view = positions[0].view();
            require_rows(view.size(), self.owned->vertex_count(), "positions", 3, "the body's vertices");
            return updated(self, std::move(positions), workers,
                           [&](Body& body, Workers& w) { return body.update_lazily(view, level, w); });
          },
          nb::arg("positions"), nb::arg("level"), nb::arg("workers") = nb::none(), doc::Body_update_lazily)
      .def(
          "update_modal_lazily",
          [](PosedBody& self, ArrayGiven given, std::size_t level, Threads* workers) {
            std::vector<std::size_t> shape;
            const std::vector<double> coordinates = numbers_of(given.object, "coordinates", {-1}, shape);
            return updated(self, {}, workers,
                           [&](Body& body, Workers& w) { return body.update_modal_lazily(coordinates, level, w); });
          },
          nb::arg("coordinates"), nb::arg("level"), nb::arg("workers") = nb::none(), doc::Body_update_modal_lazily);
}

void bind_body_questions(nb::class_<PosedBody>& body) {
  body.def(
          "refresh_children",
          [](PosedBody& self, std::uint32_t node) {
            if (node >= self.sphere_state().spheres.size()) throw nb::index_error("node");
            return without_gil([&] {
              const std::unique_lock lock(self.mutex);
              return self.owned->refresh_children(node);
            });
          },
          nb::arg("node"), doc::Body_refresh_children)
      .def(
          "is_fresh",
          [](const PosedBody& self, std::uint32_t node) {
            if (node >= self.sphere_state().spheres.size()) throw nb::index_error("node");
            return self.owned->is_fresh(node);
          },
          nb::arg("node"), doc::Body_is_fresh)
      .def_prop_ro(
          "is_complete", [](const PosedBody& self) { return self.owned->is_complete(); }, doc::Body_is_complete)
      .def(
          "modal_sphere",
          [](const PosedBody& self, std::uint32_t node, ArrayGiven given) {
            if (node >= self.sphere_state().spheres.size()) throw nb::index_error("node");
            std::vector<std::size_t> shape;
            return self.owned->modal_sphere(node, numbers_of(given.object, "coordinates", {-1}, shape));
          },
          nb::arg("node"), nb::arg("coordinates"), doc::Body_modal_sphere)
      .def(
          "current_tree", [](const PosedBody& self) { return self.owned->current_tree(); }, doc::Body_current_tree)
      .def(
          "hash", [](const PosedBody& self) { return self.owned->hash(); }, doc::Body_hash)
      .def(
          "certify",
          [](const PosedBody& self, PositionsGiven given, Threads* workers) {
            const Positions positions(given.object, "positions");
            require_rows(positions.view().size(), self.owned->vertex_count(), "positions", 3, "the body's vertices");
            return without_gil([&] {
              CallWorkers call(workers);
              const std::shared_lock lock(self.mutex);
              std::vector<Sphere> spheres;
              self.owned->copy_spheres(spheres);
              return certify(self.owned->cover(), positions.view(), spheres, call);
            });
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::certify)
      .def_prop_ro(
          "any_promises_cover", [](const PosedBody& self) { return any_promises_cover(*self.owned); },
          doc::any_promises_cover)
      .def(
          "certify_promised_levels",
          [](const PosedBody& self, ArrayGiven given, Threads* workers) {
            const std::vector<Vec3> positions = points_of(given.object, "positions");
            require_rows(positions.size(), self.owned->vertex_count(), "positions", 3, "the body's vertices");
            return without_gil([&] {
              CallWorkers call(workers);
              const std::shared_lock lock(self.mutex);
              return certify_promised_levels(*self.owned, positions, call);
            });
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::certify_promised_levels)
      .def_prop_ro(
          "any_promises_nesting", [](const PosedBody& self) { return any_promises_nesting(*self.owned); },
          doc::any_promises_nesting)
      .def(
          "certify_promised_nesting",
          [](const PosedBody& self) {
            return without_gil([&] {
              const std::shared_lock lock(self.mutex);
              return certify_promised_nesting(*self.owned);
            });
          },
          doc::certify_promised_nesting)
      .def_prop_ro(
          "mesh", [](const PosedBody& self) { return std::const_pointer_cast<Mesh>(self.mesh); }, "The mesh at rest.")
      .def_prop_ro(
          "rest_tree", [](const PosedBody& self) { return self.owned->rest_tree(); }, "The tree at rest: a copy.")
      .def_prop_ro(
          "cover", [](const PosedBody& self) { return self.owned->cover(); }, "The cover: a copy.")
      .def_prop_ro(
          "rules",
          [](const PosedBody& self) {
            std::vector<std::string> names;
            for (const Rule rule : self.owned->options().rules) names.emplace_back(name(rule));
            return names;
          },
          "One rule per level from the root; the last rule serves all deeper levels.")
      .def_prop_ro(
          "bind_report", [](const PosedBody& self) { return self.owned->bind_report(); }, doc::BindReport)
      .def_prop_ro(
          "cover_id", [](const PosedBody& self) { return self.owned->cover_id(); }, doc::Body_cover_id)
      .def_prop_ro("vertex_count", [](const PosedBody& self) { return self.owned->vertex_count(); })
      .def(
          "__copy__", [](const PosedBody& self) { return copied(self); },
          "An independent body in the same frame. Both share the mesh, the tree and the positions of the frame, which "
          "neither changes.")
      .def(
          "__deepcopy__", [](const PosedBody& self, nb::handle) { return copied(self); }, nb::arg("memo"),
          nb::sig("def __deepcopy__(self, memo: object) -> Body"), "As __copy__().")
      .def("__repr__", [](const PosedBody& self) {
        return "<morula.Body: " + std::to_string(self.owned->vertex_count()) + " vertices, " +
               std::to_string(self.sphere_state().spheres.size()) + " nodes, " +
               describe_rules(self.owned->options().rules, self.owned->rest_tree().level_count()) + ", frame " +
               std::to_string(self.owned->frame()) + ">";
      });
}

}  // namespace

void bind_body(nb::module_& m) {
  nb::class_<PosedBody> body(m, "Body", collected<PosedBody>(), doc::Body);
  bind_pose(body);
  bind_body_updates(body);
  bind_body_questions(body);
}

}  // namespace morula::python
