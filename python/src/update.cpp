// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies whose spheres follow their vertices.
#include <cstring>
#include <morula/morula.hpp>
#include <morula/update/rule_levels.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// The spheres of one frame of a body, for as long as that frame lasts.
struct SpheresView {
  nb::object owner;
  const Posed* posed;
  std::uint64_t frame;

  bool is_current() const { return posed->frame() == frame; }
  const PosedTree& pose() const {
    if (!is_current()) {
      throw std::runtime_error(
          "spheres of an older frame: the body has been updated since; take body.spheres again, or "
          "keep a copy (body.copy_spheres())");
    }
    return posed->pose();
  }
};

using LocalRows = nb::ndarray<nb::numpy, const float, nb::shape<-1, 4>>;

LocalRows memory_of(const SpheresView& view, nb::handle owner) {
  const auto spheres = view.pose().spheres;
  return LocalRows(reinterpret_cast<const float*>(spheres.data()), {spheres.size(), 4}, owner);
}

nb::object copy_of(nb::handle self) {
  return nb::cast(memory_of(nb::cast<const SpheresView&>(self), self)).attr("copy")();
}

void bind_view(nb::module_& m) {
  nb::class_<SpheresView>(
      m, "SpheresView",
      "The spheres of one frame, (nodes, 4) float32: x, y, z about the body's origin, and radius. Reads "
      "as an array and gives copies; once the body has moved on, reading it is a RuntimeError.")
      .def_prop_ro("frame", [](const SpheresView& self) { return self.frame; })
      .def_prop_ro("is_current", &SpheresView::is_current, "False when the body has moved on.")
      .def_prop_ro(
          "origin", [](const SpheresView& self) { return self.pose().origin; }, "Add it to the centres: mesh units.")
      .def_prop_ro("shape",
                   [](const SpheresView& self) { return std::make_tuple(self.posed->pose().spheres.size(), 4); })
      .def_prop_ro(
          "memory", [](nb::handle self) { return memory_of(nb::cast<const SpheresView&>(self), self); },
          "The body's own memory, without a copy: the next update writes over it, and nothing warns.")
      .def(
          "__array__",
          [](nb::handle self, nb::handle dtype, nb::handle copy) -> nb::object {
            if (copy.ptr() == Py_False && dtype.is_none())
              return nb::cast(memory_of(nb::cast<const SpheresView&>(self), self));
            nb::object array = copy_of(self);
            return dtype.is_none() ? array : array.attr("astype")(dtype);
          },
          nb::arg("dtype") = nb::none(), nb::arg("copy") = nb::none(),
          nb::sig("def __array__(self, dtype: typing.Any = None, copy: bool | None = None) -> "
                  "numpy.typing.NDArray[typing.Any]"))
      .def(
          "__getitem__", [](nb::handle self, nb::handle index) -> nb::object { return copy_of(self)[index]; },
          nb::arg("index"), nb::sig("def __getitem__(self, index: typing.Any, /) -> typing.Any"))
      .def("__len__", [](const SpheresView& self) { return self.posed->pose().spheres.size(); })
      .def("__repr__", [](const SpheresView& self) {
        return "<morula.SpheresView: frame " + std::to_string(self.frame) +
               (self.is_current() ? ">" : ", no longer current>");
      });
}

/// The same members of everything that has spheres of the moment.
template <class Holder>
void bind_pose(nb::class_<Holder>& type) {
  type.def_prop_ro(
          "spheres",
          [](nb::handle self) {
            const Holder& holder = nb::cast<const Holder&>(self);
            return SpheresView{nb::borrow(self), &holder, holder.frame()};
          },
          "The current spheres about the origin, (nodes, 4) float32; reading them after the next update is an error.")
      .def_prop_ro(
          "origin", [](const Holder& self) { return self.pose().origin; }, doc::PosedTree_origin)
      .def_prop_ro(
          "frame", [](const Holder& self) { return self.frame(); }, doc::Body_frame)
      .def_prop_ro(
          "is_current", [](const Holder& self) { return self.pose().current; }, doc::Body_is_current)
      .def_prop_ro(
          "covers", [](const Holder& self) { return self.pose().covers; }, doc::PosedTree_covers)
      .def_prop_ro(
          "nested", [](const Holder& self) { return self.pose().nested; }, doc::PosedTree_nested)
      .def(
          "copy_spheres",
          [](const Holder& self) {
            return own_spheres(without_gil([&] {
              const std::shared_lock lock(self.mutex);
              const PosedTree& pose = self.pose();
              std::vector<Sphere> spheres(pose.spheres.size());
              for (std::uint32_t node = 0; node < spheres.size(); ++node) spheres[node] = pose.sphere(node);
              return spheres;
            }));
          },
          "The current spheres in mesh coordinates, (nodes, 4) float64: a copy.")
      .def(
          "sphere",
          [](const Holder& self, std::uint32_t node) {
            if (node >= self.pose().spheres.size()) throw nb::index_error("node");
            return self.pose().sphere(node);
          },
          nb::arg("node"), doc::PosedTree_sphere)
      .def_prop_ro(
          "tree", [](const Holder& self) { return *self.pose().tree; }, "The tree at rest: a copy.")
      .def("__len__", [](const Holder& self) { return self.pose().spheres.size(); });
}

std::vector<VertexRange> ranges_of(nb::handle given) {
  std::vector<VertexRange> ranges;
  for (nb::handle range : nb::borrow<nb::object>(given)) {
    ranges.push_back({nb::cast<std::uint32_t>(nb::object(range[0])), nb::cast<std::uint32_t>(nb::object(range[1]))});
  }
  return ranges;
}

UpdateOptions options_of(nb::handle rules, bool conservative, std::string_view approach1_weights,
                         std::string_view approach1_inner_center, std::string_view approach2_inner_boxes,
                         std::string_view wrapped_center, double distance_floor, std::string_view modal_bound,
                         nb::handle modes, nb::handle skin) {
  using O = RuleOptions;
  UpdateOptions options;
  options.rules.clear();
  const auto add = [&](nb::handle rule) {
    options.rules.push_back(choice<Rule>(nb::cast<std::string_view>(rule), "rules", rule_from_name, all_rules()));
  };
  if (PyUnicode_Check(rules.ptr())) {
    add(rules);
  } else {
    for (nb::handle rule : nb::borrow<nb::object>(rules)) add(rule);
  }
  options.conservative = conservative;
  options.details.approach1_weights = choice<O::Weights>(approach1_weights, "approach1_weights",
                                                         {{"uniform", O::Weights::uniform},
                                                          {"inverse_distance", O::Weights::inverse_distance},
                                                          {"area", O::Weights::area}});
  options.details.approach1_inner_center = choice<O::InnerCenter>(
      approach1_inner_center, "approach1_inner_center",
      {{"children", O::InnerCenter::children}, {"linked_vertices", O::InnerCenter::linked_vertices}});
  options.details.approach2_inner_boxes = choice<O::InnerBoxes>(
      approach2_inner_boxes, "approach2_inner_boxes",
      {{"child_spheres", O::InnerBoxes::child_spheres}, {"child_centers", O::InnerBoxes::child_centers}});
  options.details.wrapped_center =
      choice<O::WrappedCenter>(wrapped_center, "wrapped_center",
                               {{"children", O::WrappedCenter::children}, {"smallest", O::WrappedCenter::smallest}});
  options.details.distance_floor = distance_floor;
  options.details.modal_bound = choice<O::ModalBound>(
      modal_bound, "modal_bound", {{"gradient", O::ModalBound::gradient}, {"shift", O::ModalBound::shift}});
  if (!modes.is_none()) options.modes = modes_of(modes, "modes");
  if (!skin.is_none()) options.skin = skin_of(skin, "skin");
  return options;
}

/// Updates `self` and keeps what it borrows. Throws ValueError for what is refused.
template <class Update>
UpdateStatus updated(PosedBody& self, std::vector<Positions>&& borrowed, Threads* workers, const Update& update) {
  UpdateStatus status;
  {
    const nb::gil_scoped_release released;
    CallWorkers call(workers);
    const std::unique_lock lock(self.mutex);
    status = update(*self.owned, static_cast<Workers&>(call));
    // What was refused changes nothing: the positions of the frame before are still borrowed.
    if (status) std::swap(self.last, borrowed);
  }
  require(status);
  return status;
}

/// All frames in one call: spheres in mesh coordinates, frame after frame.
template <class Frame>
View<double, -1, -1, 4> follow(PosedBody& self, std::size_t frame_count, Threads* workers, const Frame& update_to) {
  const std::size_t node_count = self.pose().spheres.size();
  std::vector<Sphere> spheres;
  std::size_t at = 0;
  const UpdateStatus status = without_gil([&] {
    CallWorkers call(workers);
    const std::unique_lock lock(self.mutex);
    SignalCheck check;
    spheres.resize(frame_count * node_count);
    UpdateStatus last;
    for (; at < frame_count; ++at) {
      last = update_to(*self.owned, at, static_cast<Workers&>(call));
      if (!last) return last;
      const PosedTree& pose = self.pose();
      for (std::uint32_t node = 0; node < node_count; ++node) spheres[at * node_count + node] = pose.sphere(node);
      check();
    }
    return last;
  });
  if (!status) throw std::invalid_argument("frame " + std::to_string(at) + ": " + message(status));
  auto [values, owner] = kept(std::move(spheres));
  return View<double, -1, -1, 4>(reinterpret_cast<const double*>(values->data()), {frame_count, node_count, 4}, owner);
}

void bind_body(nb::module_& m) {
  Record<UpdateStatus>(m, "UpdateStatus", "The work that an update did: the same on every run.")
      .field("nodes_updated", &UpdateStatus::nodes_updated)
      .field("vertices_read", &UpdateStatus::vertices_read, doc::UpdateStatus_vertices_read)
      .field("cut_points_moved", &UpdateStatus::cut_points_moved)
      .field("points_tested", &UpdateStatus::points_tested, doc::UpdateStatus_points_tested);
  Record<BindReport>(m, "BindReport", doc::BindReport)
      .field("void_spheres", &BindReport::void_spheres, doc::BindReport_void_spheres)
      .field("unlinked_spheres", &BindReport::unlinked_spheres, doc::BindReport_unlinked_spheres)
      .field("degenerate_anchors", &BindReport::degenerate_anchors, doc::BindReport_degenerate_anchors)
      .field("carried_centers", &BindReport::carried_centers, doc::BindReport_carried_centers)
      .field("corners_owned", &BindReport::corners_owned, doc::BindReport_corners_owned);
  Record<RuleTraits>(m, "RuleTraits", doc::RuleTraits)
      .property("name", [](const RuleTraits& t) { return std::string(t.name); })
      .property("follows",
                [](const RuleTraits& t) {
                  return t.follows == RuleTraits::Follows::positions ? "positions"
                         : t.follows == RuleTraits::Follows::modes   ? "modes"
                                                                     : "bones";
                })
      .field("covers", &RuleTraits::covers, doc::RuleTraits_covers);
  m.def(
      "all_rules",
      [] {
        std::vector<std::string> names;
        for (const Rule rule : all_rules()) names.emplace_back(name(rule));
        return names;
      },
      "Names of the update rules.");
  m.def(
      "position_rules",
      [] {
        std::vector<std::string> names;
        for (const Rule rule : position_rules()) names.emplace_back(name(rule));
        return names;
      },
      doc::position_rules);
  m.def(
      "rule_table", [] { return std::vector<RuleTraits>(rule_table.begin(), rule_table.end()); },
      "What is known of each rule.");

  nb::class_<PosedBody> body(m, "Body", doc::Body);
  bind_pose(body);
  body.def(
          "__init__",
          [](PosedBody* self, MeshGiven given, std::shared_ptr<CoveredTree> built, nb::object rules, bool conservative,
             std::string_view approach1_weights, std::string_view approach1_inner_center,
             std::string_view approach2_inner_boxes, std::string_view wrapped_center, double distance_floor,
             std::string_view modal_bound, nb::object modes, nb::object skin, Threads* workers) {
            UpdateOptions options =
                options_of(rules, conservative, approach1_weights, approach1_inner_center, approach2_inner_boxes,
                           wrapped_center, distance_floor, modal_bound, modes, skin);
            auto mesh = mesh_of(given);
            auto owned = without_gil([&] {
              return std::make_unique<Body>(*mesh, std::shared_ptr<const CoveredTree>(built), std::move(options),
                                            CallWorkers(workers));
            });
            new (self) PosedBody();
            self->mesh = std::move(mesh);
            self->owned = std::move(owned);
          },
          nb::arg("mesh"), nb::arg("built"), nb::kw_only(), nb::arg("rules") = "exact", nb::arg("conservative") = false,
          nb::arg("approach1_weights") = "uniform", nb::arg("approach1_inner_center") = "children",
          nb::arg("approach2_inner_boxes") = "child_spheres", nb::arg("wrapped_center") = "children",
          nb::arg("distance_floor") = 0.0, nb::arg("modal_bound") = "gradient", nb::arg("modes") = nb::none(),
          nb::arg("skin") = nb::none(), nb::arg("workers") = nb::none(),
          nb::sig("def __init__(self, mesh: morula.typing.MeshLike, built: CoveredTree, *, "
                  "rules: str | collections.abc.Sequence[str] = 'exact', conservative: bool = False, "
                  "approach1_weights: str = 'uniform', approach1_inner_center: str = 'children', "
                  "approach2_inner_boxes: str = 'child_spheres', wrapped_center: str = 'children', distance_floor: "
                  "float = 0.0, "
                  "modal_bound: str = 'gradient', modes: Modes | morula.typing.FloatArray | None = None, "
                  "skin: Skin | morula.typing.FloatArray | None = None, workers: Workers | None = None) -> None"),
          with_arguments(doc::Body_Body, {{"rules", doc::UpdateOptions},
                                          {"conservative", doc::UpdateOptions_conservative},
                                          {"modes", "Modes, or an array (modes, vertices, 3), for update_modal()"},
                                          {"skin", "Skin, or weights (vertices, bones), for update_skinned()"}})
              .c_str())
      .def(
          "update",
          [](PosedBody& self, PositionsGiven given, nb::handle changed, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            const PositionView view = positions[0].view();
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
           "\n\npositions: (vertices, 3) float32 or float64, mesh units; not copied where the numbers of a vertex lie "
           "together. What is refused raises ValueError. The array is kept until the next update, since queries that "
           "look "
           "at facets read it then.\n\nchanged: ranges [begin, end) of vertices. " +
           doc::Body_update_2)
              .c_str())
      .def(
          "follow",
          [](PosedBody& self, PositionsGiven given, Threads* workers) {
            const Positions frames = Positions::frames(given.object, "frames");
            std::vector<Positions> one;
            for (std::size_t i = 0; i < frames.frame_count(); ++i) one.emplace_back(frames, i);
            auto spheres = follow(self, one.size(), workers,
                                  [&](Body& body, std::size_t i, Workers& w) { return body.update(one[i].view(), w); });
            if (!one.empty()) {
              // The last frame stays borrowed, as by update().
              std::vector<Positions> last;
              last.push_back(std::move(one.back()));
              without_gil([&] {
                const std::unique_lock lock(self.mutex);
                std::swap(self.last, last);
              });
            }
            return spheres;
          },
          nb::arg("frames"), nb::arg("workers") = nb::none(),
          nb::sig("def follow(self, frames: morula.typing.FloatArray, workers: Workers | None = None) -> "
                  "numpy.typing.NDArray[numpy.float64]"),
          "A whole motion in one call. frames: (frames, vertices, 3) float32 or float64, not copied. Returns the "
          "spheres of "
          "every frame, (frames, nodes, 4) float64 in mesh coordinates. The body stays in the last frame. ValueError "
          "names "
          "the frame that is refused.")
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
            return follow(self, shape[0], workers, [&](Body& body, std::size_t i, Workers& w) {
              return body.update_modal(std::span(all).subspan(i * shape[1], shape[1]), w);
            });
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
          nb::arg("coordinates"), nb::arg("level"), nb::arg("workers") = nb::none(), doc::Body_update_modal_lazily)
      .def(
          "reach",
          [](PosedBody& self, std::uint32_t node) {
            if (node >= self.pose().spheres.size()) throw nb::index_error("node");
            return without_gil([&] {
              const std::unique_lock lock(self.mutex);
              return self.owned->reach(node);
            });
          },
          nb::arg("node"), doc::Body_reach)
      .def(
          "is_reached",
          [](const PosedBody& self, std::uint32_t node) {
            if (node >= self.pose().spheres.size()) throw nb::index_error("node");
            return self.owned->is_reached(node);
          },
          nb::arg("node"), doc::Body_is_reached)
      .def_prop_ro(
          "is_complete", [](const PosedBody& self) { return self.owned->is_complete(); }, doc::Body_is_complete)
      .def(
          "modal_sphere",
          [](const PosedBody& self, std::uint32_t node, ArrayGiven given) {
            if (node >= self.pose().spheres.size()) throw nb::index_error("node");
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
            if (positions.view().size() != self.owned->vertex_count()) {
              throw std::invalid_argument("positions: " + std::to_string(positions.view().size()) +
                                          " rows, but the body has " + std::to_string(self.owned->vertex_count()) +
                                          " vertices");
            }
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
            if (positions.size() != self.owned->vertex_count()) {
              throw std::invalid_argument("positions: " + std::to_string(positions.size()) +
                                          " rows, but the body has " + std::to_string(self.owned->vertex_count()) +
                                          " vertices");
            }
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
          "One per level from the root; the last one serves all deeper levels.")
      .def_prop_ro(
          "bind_report", [](const PosedBody& self) { return self.owned->bind_report(); }, doc::BindReport)
      .def_prop_ro(
          "ownership", [](const PosedBody& self) { return self.owned->ownership(); }, doc::Body_ownership)
      .def_prop_ro("vertex_count", [](const PosedBody& self) { return self.owned->vertex_count(); })
      .def(
          "__copy__",
          [](const PosedBody& self) {
            auto copy = std::make_shared<PosedBody>();
            copy->mesh = self.mesh;
            copy->owned = std::make_unique<Body>(*self.owned);
            return copy;
          },
          doc::Body)
      .def("__repr__", [](const PosedBody& self) {
        return "<morula.Body: " + std::to_string(self.owned->vertex_count()) + " vertices, " +
               std::to_string(self.pose().spheres.size()) + " nodes, " +
               describe_rules(self.owned->options().rules, self.owned->rest_tree().level_count()) + ", frame " +
               std::to_string(self.owned->frame()) + ">";
      });
}

void bind_rebuilt(nb::module_& m) {
  Record<RebuildReport>(m, "RebuildReport", doc::RebuildReport)
      .field("checks", &RebuildReport::checks, doc::RebuildReport_checks)
      .field("started", &RebuildReport::started, doc::RebuildReport_started)
      .field("finished", &RebuildReport::finished, doc::RebuildReport_finished)
      .field("stopped", &RebuildReport::stopped, doc::RebuildReport_stopped)
      .field("failed", &RebuildReport::failed, doc::RebuildReport_failed)
      .field("swapped", &RebuildReport::swapped, doc::RebuildReport_swapped)
      .field("refused", &RebuildReport::refused, doc::RebuildReport_refused)
      .field("returned_home", &RebuildReport::returned_home, doc::RebuildReport_returned_home)
      .field("recalled", &RebuildReport::recalled, doc::RebuildReport_recalled)
      .field("rebuild_seconds", &RebuildReport::rebuild_seconds, doc::RebuildReport_rebuild_seconds)
      .field("rebuild_frames", &RebuildReport::rebuild_frames, doc::RebuildReport_rebuild_frames)
      .field("failure", &RebuildReport::failure)
      .field("looseness", &RebuildReport::looseness)
      .field("looseness_at_build", &RebuildReport::looseness_at_build);
  Record<RebuildStatus>(m, "RebuildStatus", "What an update of a rebuilding body did.")
      .field("update", &RebuildStatus::update, doc::RebuildStatus_update)
      .field("swapped", &RebuildStatus::swapped, doc::RebuildStatus_swapped);

  nb::class_<PosedRebuilt> body(m, "RebuiltBody", doc::RebuiltBody);
  bind_pose(body);
  body.def(
          "__init__",
          [](PosedRebuilt* self, MeshGiven given, const CoveredTree& built, std::string_view method,
             std::string_view quality, std::string_view still_quality, std::uint64_t seed, double looser_by,
             int check_every, int rebuild_every, double gain, int look_ahead_frames, double processor_share,
             std::string_view thread, std::size_t sample_count, Threads* workers) {
            RebuildOptions options;
            options.method = choice<Method>(method, "method", method_from_name, all_methods());
            options.quality = choice<Quality>(quality, "quality", quality_from_name, all_qualities());
            options.still_quality = choice<Quality>(still_quality, "still_quality", quality_from_name, all_qualities());
            options.seed = seed;
            options.looser_by = looser_by;
            options.check_every = check_every;
            options.rebuild_every = rebuild_every;
            options.gain = gain;
            options.look_ahead_frames = look_ahead_frames;
            options.processor_share = processor_share;
            options.thread = choice<RebuildThread>(thread, "thread",
                                                   {{"background", RebuildThread::background},
                                                    {"caller", RebuildThread::caller},
                                                    {"none", RebuildThread::none}});
            options.sample_count = sample_count;
            auto mesh = mesh_of(given);
            auto owned =
                without_gil([&] { return std::make_unique<RebuiltBody>(*mesh, built, options, CallWorkers(workers)); });
            new (self) PosedRebuilt();
            self->mesh = std::move(mesh);
            self->owned = std::move(owned);
          },
          nb::arg("mesh"), nb::arg("built"), nb::kw_only(), nb::arg("method") = "morula", nb::arg("quality") = "draft",
          nb::arg("still_quality") = "fast", nb::arg("seed") = 1, nb::arg("looser_by") = 1.25,
          nb::arg("check_every") = 4, nb::arg("rebuild_every") = 0, nb::arg("gain") = 0.05,
          nb::arg("look_ahead_frames") = 1, nb::arg("processor_share") = 1.0, nb::arg("thread") = "background",
          nb::arg("sample_count") = LoosenessEstimator::default_samples, nb::arg("workers") = nb::none(),
          with_arguments(doc::RebuiltBody_RebuiltBody, {{"quality", doc::RebuildOptions_quality},
                                                        {"still_quality", doc::RebuildOptions_still_quality},
                                                        {"looser_by", doc::RebuildOptions_looser_by},
                                                        {"check_every", doc::RebuildOptions_check_every},
                                                        {"rebuild_every", doc::RebuildOptions_rebuild_every},
                                                        {"gain", doc::RebuildOptions_gain},
                                                        {"look_ahead_frames", doc::RebuildOptions_look_ahead_frames},
                                                        {"processor_share", doc::RebuildOptions_processor_share},
                                                        {"thread", "background, caller or none"}})
              .c_str())
      .def(
          "update",
          [](PosedRebuilt& self, PositionsGiven given, Threads* workers) {
            std::vector<Positions> positions;
            positions.emplace_back(given.object, "positions");
            RebuildStatus status;
            {
              const nb::gil_scoped_release released;
              CallWorkers call(workers);
              const std::unique_lock lock(self.mutex);
              status = self.owned->update(positions[0].view(), call);
              if (status) std::swap(self.last, positions);
            }
            require(status.update);
            return status;
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::RebuiltBody_update)
      .def_prop_ro(
          "epoch", [](const PosedRebuilt& self) { return self.owned->epoch(); }, doc::RebuiltBody_epoch)
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
        return "<morula.RebuiltBody: " + std::to_string(self.pose().spheres.size()) + " nodes, epoch " +
               std::to_string(self.owned->epoch()) + ">";
      });
}

void bind_posed(nb::module_& m) {
  nb::class_<PosedRows> posed(m, "PosedSpheres", doc::PosedSpheres);
  bind_pose(posed);
  posed
      .def(
          "__init__",
          [](PosedRows* self, const SphereTree& tree, bool covers) {
            auto owned = std::make_unique<PosedSpheres>(tree, covers);
            new (self) PosedRows();
            self->owned = std::move(owned);
          },
          nb::arg("tree"), nb::arg("covers") = false, doc::PosedSpheres_PosedSpheres)
      .def(
          "set",
          [](PosedRows& self, ArrayGiven given) {
            const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
            const std::unique_lock lock(self.mutex);
            self.owned->set(spheres);
          },
          nb::arg("spheres"), doc::PosedSpheres_set);
}

struct HeldDops {
  KDopTree tree;
  mutable std::shared_mutex mutex;

  explicit HeldDops(KDopTree&& made) : tree(std::move(made)) {}

  /// (nodes, k / 2): a copy.
  View<float, -1, -1> bounds(std::span<const float> (KDopTree::*side)(std::uint32_t) const) const {
    auto [values, owner] = kept(without_gil([&] {
      const std::shared_lock lock(mutex);
      std::vector<float> all;
      for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
        const std::span<const float> own = (tree.*side)(node);
        all.insert(all.end(), own.begin(), own.end());
      }
      return all;
    }));
    return View<float, -1, -1>(values->data(), {tree.node_count(), static_cast<std::size_t>(tree.k() / 2)}, owner);
  }
};

void bind_others(nb::module_& m) {
  nb::class_<HeldDops>(m, "KDopTree", doc::KDopTree)
      .def(
          "__init__",
          [](HeldDops* self, MeshGiven given, const CoveredTree& built, int k, Threads* workers) {
            const auto mesh = mesh_of(given);
            new (self) HeldDops(without_gil([&] { return KDopTree(*mesh, built, k, CallWorkers(workers)); }));
          },
          nb::arg("mesh"), nb::arg("built"), nb::arg("k"), nb::arg("workers") = nb::none(), doc::KDopTree_KDopTree)
      .def(
          "update",
          [](HeldDops& self, PositionsGiven given, Threads* workers) {
            const Positions positions(given.object, "positions");
            const UpdateStatus status = without_gil([&] {
              CallWorkers call(workers);
              const std::unique_lock lock(self.mutex);
              return self.tree.update(positions.view(), call);
            });
            require(status);
            return status;
          },
          nb::arg("positions"), nb::arg("workers") = nb::none(), doc::KDopTree_update)
      .def_prop_ro("k", [](const HeldDops& self) { return self.tree.k(); })
      .def_prop_ro("node_count", [](const HeldDops& self) { return self.tree.node_count(); })
      .def_prop_ro(
          "directions",
          [](const HeldDops& self) {
            return own_points({self.tree.directions().begin(), self.tree.directions().end()});
          },
          nb::rv_policy::automatic, doc::KDopTree_directions)
      .def_prop_ro(
          "lower", [](const HeldDops& self) { return self.bounds(&KDopTree::lower); }, nb::rv_policy::automatic,
          doc::KDopTree_lower)
      .def_prop_ro(
          "upper", [](const HeldDops& self) { return self.bounds(&KDopTree::upper); }, nb::rv_policy::automatic,
          doc::KDopTree_lower)
      .def_prop_ro("origin", [](const HeldDops& self) { return self.tree.origin(); })
      .def(
          "hash", [](const HeldDops& self) { return self.tree.hash(); }, doc::KDopTree_hash);

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

}  // namespace

void bind_update(nb::module_& m) {
  bind_view(m);
  bind_body(m);
  bind_rebuilt(m);
  bind_posed(m);
  bind_others(m);
}

}  // namespace morula::python
