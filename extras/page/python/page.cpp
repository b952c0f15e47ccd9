// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page: one self-contained HTML file that shows bodies and their spheres in motion.
#include <algorithm>
#include <array>
#include <memory>
#include <morula/morula.hpp>
#include <morula/page/page.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// A scene, and the motion that it is of: the page numbers them.
struct HeldPageScene {
  std::shared_ptr<PageMotion> motion;
  PageScene scene;

  void visit(References& references) const { references(motion); }
};

std::vector<Rule> rules_of(const std::vector<std::string>& names) {
  std::vector<Rule> rules;
  for (const std::string& rule : names) rules.push_back(choice<Rule>(rule, "rules", rule_from_name, all_rules()));
  return rules;
}

std::vector<Vec3> copy_of_frame(const Positions& from) {
  std::vector<Vec3> positions(from.view().size());
  for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = from.view()[v];
  return positions;
}

/// (frames, vertices, 3), copied.
std::vector<std::vector<Vec3>> frames_of(nb::handle given) {
  const Positions frames = Positions::frames(given, "frames");
  std::vector<std::vector<Vec3>> all;
  for (std::size_t i = 0; i < frames.frame_count(); ++i) all.push_back(copy_of_frame(Positions(frames, i)));
  return all;
}

/// The same, or (vertices, 3): one.
std::vector<std::vector<Vec3>> frame_or_frames_of(nb::handle given) {
  if (nb::hasattr(given, "ndim") && nb::cast<int>(nb::object(given.attr("ndim"))) == 2)
    return {copy_of_frame(Positions(given, "frames"))};
  return frames_of(given);
}

/// (frames, nodes, 4).
std::vector<std::vector<Sphere>> sphere_frames_of(nb::handle given, std::size_t nodes) {
  std::vector<std::size_t> shape;
  const std::vector<double> rows = numbers_of(given, "spheres", {-1, static_cast<std::int64_t>(nodes), 4}, shape);
  std::vector<std::vector<Sphere>> all(shape[0], std::vector<Sphere>(nodes));
  for (std::size_t i = 0; i < shape[0] * nodes; ++i)
    all[i / nodes][i % nodes] = {{rows[4 * i], rows[4 * i + 1], rows[4 * i + 2]}, rows[4 * i + 3]};
  return all;
}

void require_rest(const PageMotion& motion, const MeshView& rest) {
  if (!std::equal(motion.facets.begin(), motion.facets.end(), rest.facets.begin(), rest.facets.end()) ||
      motion.frames.front().size() != rest.vertex_count())
    throw std::invalid_argument("rest: another mesh than the motion's");
}

PageJoints::Joint::Kind kind_of(std::string_view text) {
  using Kind = PageJoints::Joint::Kind;
  return choice<Kind>(text, "kind", {{"fixed", Kind::fixed}, {"turns", Kind::turns}, {"slides", Kind::slides}});
}

void bind_page_joints(nb::module_& m) {
  using Joint = PageJoints::Joint;
  using Part = PageJoints::Part;
  Record<Part> part(m, "PagePart", "Vertices and spheres of a page's body that move as one rigid part.", MadeBy::calls);
  part.field("name", &Part::name)
      .field("vertex_begin", &Part::vertex_begin)
      .field("vertex_end", &Part::vertex_end)
      .field("protrusion", &Part::protrusion, doc::PageJoints_Part_protrusion);
  part.python().def(
      "__init__",
      [](Part* self, const std::string& name, std::size_t begin, std::size_t end, std::optional<double> protrusion) {
        new (self) Part{name, begin, end, protrusion};
      },
      nb::arg("name"), nb::arg("vertex_begin") = 0, nb::arg("vertex_end") = 0, nb::arg("protrusion") = nb::none(),
      with_arguments("Vertices [vertex_begin, vertex_end).", {{"protrusion", doc::PageJoints_Part_protrusion}})
          .c_str());
  Record<Joint> joint(m, "PageJoint", "A joint between two parts of a page's body, which the reader can move.",
                      MadeBy::calls);
  joint.field("name", &Joint::name)
      .property(
          "kind",
          [](const Joint& j) -> std::string {
            return j.kind == Joint::Kind::fixed ? "fixed" : j.kind == Joint::Kind::turns ? "turns" : "slides";
          },
          "fixed, turns or slides")
      .field("parent", &Joint::parent, doc::PageJoints_Joint_parent)
      .field("child", &Joint::child, doc::PageJoints_Joint_parent)
      .field("origin", &Joint::origin, doc::PageJoints_Joint_origin)
      .field("axis", &Joint::axis, doc::PageJoints_Joint_axis)
      .field("lower", &Joint::lower, doc::PageJoints_Joint_lower)
      .field("upper", &Joint::upper, doc::PageJoints_Joint_lower)
      .field("rest", &Joint::rest, doc::PageJoints_Joint_rest)
      .field("leader", &Joint::leader, doc::PageJoints_Joint_leader)
      .field("factor", &Joint::factor)
      .field("offset", &Joint::offset);
  joint.python().def(
      "__init__",
      [](Joint* self, const std::string& name, std::string_view kind, std::size_t parent, std::size_t child,
         const RigidTransform& origin, Vec3 axis, double lower, double upper, double rest,
         std::optional<std::size_t> leader, double factor, double offset) {
        new (self) Joint{name, kind_of(kind), parent, child, origin, axis, lower, upper, rest, leader, factor, offset};
      },
      nb::arg("name"), nb::arg("kind"), nb::arg("parent"), nb::arg("child"), nb::kw_only(),
      nb::arg("origin") = RigidTransform{}, nb::arg("axis") = Vec3{0, 0, 1}, nb::arg("lower") = 0.0,
      nb::arg("upper") = 0.0, nb::arg("rest") = 0.0, nb::arg("leader") = nb::none(), nb::arg("factor") = 1.0,
      nb::arg("offset") = 0.0,
      with_arguments("Joins two parts, given by their numbers.", {{"kind", "fixed, turns or slides"},
                                                                  {"origin", doc::PageJoints_Joint_origin},
                                                                  {"axis", doc::PageJoints_Joint_axis},
                                                                  {"lower", doc::PageJoints_Joint_lower},
                                                                  {"rest", doc::PageJoints_Joint_rest},
                                                                  {"leader", doc::PageJoints_Joint_leader}})
          .c_str());
  Record<PageJoints> joints(m, "PageJoints", doc::PageJoints, MadeBy::calls);
  joints.field("parts", &PageJoints::parts)
      .field("joints", &PageJoints::joints, doc::PageJoints_joints)
      .field("ignored", &PageJoints::ignored, doc::PageJoints_ignored);
  joints.python().def(
      "__init__",
      [](PageJoints* self, const std::vector<Part>& parts, const std::vector<Joint>& all,
         const std::vector<std::array<std::size_t, 2>>& ignored) {
        new (self) PageJoints{parts, all, ignored};
      },
      nb::arg("parts"), nb::arg("joints"), nb::arg("ignored") = std::vector<std::array<std::size_t, 2>>{},
      nb::sig("def __init__(self, parts: collections.abc.Sequence[PagePart], joints: "
              "collections.abc.Sequence[PageJoint], ignored: collections.abc.Sequence[collections.abc.Sequence[int]] "
              "= []) -> None"),
      with_arguments("Parts and the joints between them.",
                     {{"joints", doc::PageJoints_joints}, {"ignored", doc::PageJoints_ignored}})
          .c_str());
}

void bind_page_motion(nb::module_& m) {
  nb::class_<PageMotion>(m, "PageMotion", doc::PageMotion)
      .def(
          "__init__",
          [](PageMotion* self, ArrayGiven facets, PositionsGiven frames, const std::string& body,
             const std::string& name, std::optional<std::vector<std::string>> frame_names,
             std::optional<PageJoints> joints) {
            PageMotion motion{body,
                              name,
                              facets_of(facets.object, "facets"),
                              {},
                              frame_or_frames_of(frames.object),
                              std::move(joints)};
            if (motion.frames.empty()) throw std::invalid_argument("frames: at least one is needed");
            if (frame_names) {
              motion.frame_names = std::move(*frame_names);
            } else {
              for (std::size_t i = 0; i < motion.frames.size(); ++i)
                motion.frame_names.push_back("frame " + std::to_string(i));
            }
            new (self) PageMotion(std::move(motion));
          },
          nb::arg("facets"), nb::arg("frames"), nb::kw_only(), nb::arg("body") = "body", nb::arg("name") = "motion",
          nb::arg("frame_names") = nb::none(), nb::arg("joints") = nb::none(),
          nb::sig("def __init__(self, facets: morula.typing.Array, frames: morula.typing.FloatArray, *, body: str = "
                  "'body', name: str = 'motion', frame_names: collections.abc.Sequence[str] | None = None, joints: "
                  "PageJoints | None = None) -> None"),
          with_arguments(
              "Copies facets and frames, (vertices, 3) or (frames, vertices, 3).",
              {{"body", doc::PageMotion_body}, {"name", doc::PageMotion_name}, {"joints", doc::PageMotion_joints}})
              .c_str())
      .def_ro("body", &PageMotion::body, doc::PageMotion_body)
      .def_ro("name", &PageMotion::name, doc::PageMotion_name)
      .def_ro("frame_names", &PageMotion::frame_names)
      .def_ro("joints", &PageMotion::joints, doc::PageMotion_joints)
      .def("__len__", [](const PageMotion& self) { return self.frames.size(); })
      .def("__repr__", [](const PageMotion& self) {
        return "<morula.PageMotion: " + self.body + ", " + self.name + ", " + std::to_string(self.frames.size()) +
               (self.frames.size() == 1 ? " frame>" : " frames>");
      });
  Record<PageContact> contact(m, "PageContact", doc::PageContact, MadeBy::calls);
  contact.field("point", &PageContact::point, doc::PageContact_point)
      .field("normal", &PageContact::normal, doc::PageContact_normal)
      .field("depth", &PageContact::depth, doc::PageContact_depth);
  contact.python().def(
      "__init__",
      [](PageContact* self, Vec3 point, Vec3 normal, double depth) {
        new (self) PageContact{point, normal, depth};
      },
      nb::arg("point"), nb::arg("normal"), nb::arg("depth") = 0.0);
}

void bind_page_scene(nb::module_& m) {
  nb::class_<HeldPageScene>(m, "PageScene", collected<HeldPageScene>(), doc::PageScene)
      .def(
          "__init__",
          [](HeldPageScene* self, std::shared_ptr<PageMotion> motion, const SphereTree& tree, nb::handle spheres,
             const std::string& name, const std::string& label, bool inside, std::vector<std::uint32_t> parts) {
            PageScene scene{.motion = 0,
                            .tree = name,
                            .rule = label,
                            .rest = tree,
                            .frames = {tree.spheres},
                            .measured = {},
                            .empty_share = {},
                            .inside = inside,
                            .parts = std::move(parts)};
            if (!spheres.is_none()) scene.frames = sphere_frames_of(spheres, tree.node_count());
            new (self) HeldPageScene{std::move(motion), std::move(scene)};
          },
          nb::arg("motion"), nb::arg("tree"), nb::arg("spheres") = nb::none(), nb::kw_only(), nb::arg("name") = "tree",
          nb::arg("label") = "spheres as they are", nb::arg("inside") = false,
          nb::arg("parts") = std::vector<std::uint32_t>{},
          nb::sig("def __init__(self, motion: PageMotion, tree: SphereTree, spheres: morula.typing.FloatArray | None = "
                  "None, *, name: str = 'tree', label: str = 'spheres as they are', inside: bool = False, parts: "
                  "collections.abc.Sequence[int] = []) -> None"),
          with_arguments("Existing spheres, without updates and measurements.",
                         {{"tree", doc::PageScene_rest},
                          {"spheres", "(frames, nodes, 4), as Body.follow() returns them; None: those of the tree"},
                          {"name", doc::PageScene_tree},
                          {"label", "text in place of a rule"},
                          {"inside", doc::PageScene_inside},
                          {"parts", doc::PageScene_parts}})
              .c_str())
      .def_ro("motion", &HeldPageScene::motion)
      .def_prop_ro(
          "name", [](const HeldPageScene& self) { return self.scene.tree; }, doc::PageScene_tree)
      .def_prop_ro(
          "label", [](const HeldPageScene& self) { return self.scene.rule; }, "The rule, or the text in its place.")
      .def_prop_ro(
          "measured", [](const HeldPageScene& self) { return self.scene.measured; }, doc::PageScene_measured)
      .def_prop_rw(
          "contacts", [](const HeldPageScene& self) { return self.scene.contacts; },
          [](HeldPageScene& self, std::vector<std::vector<PageContact>> contacts) {
            self.scene.contacts = std::move(contacts);
          },
          nb::for_getter(nb::sig("def contacts(self) -> list[list[PageContact]]")),
          nb::for_setter(nb::sig("def contacts(self, contacts: "
                                 "collections.abc.Sequence[collections.abc.Sequence[PageContact]], /) -> None")),
          doc::PageScene_contacts)
      .def("__repr__", [](const HeldPageScene& self) {
        return "<morula.PageScene: " + self.scene.tree + ", " + self.scene.rule + ", " +
               std::to_string(self.scene.rest.node_count()) + " nodes, " + std::to_string(self.scene.frames.size()) +
               (self.scene.frames.size() == 1 ? " frame>" : " frames>");
      });
  m.def(
      "follow_motion",
      [](std::shared_ptr<PageMotion> motion, MeshGiven given, const CoveredTree& model, const std::string& name,
         const std::vector<std::string>& rules, bool measured, Threads* workers) {
        const auto rest = mesh_of(given, "rest");
        const std::vector<Rule> each = rules_of(rules);
        require_rest(*motion, *rest);
        PageScene scene = without_gil([&] {
          SignalCheck check;
          return follow_motion(*motion, *rest, model, name.empty() ? model.report.method : name, each, measured,
                               CallWorkers(workers), [&](double) { check(); });
        });
        return HeldPageScene{std::move(motion), std::move(scene)};
      },
      nb::arg("motion"), nb::arg("rest"), nb::arg("model"), nb::kw_only(), nb::arg("name") = "",
      nb::arg("rules") = std::vector<std::string>{"exact"}, nb::arg("measured") = false,
      nb::arg("workers") = nb::none(),
      nb::sig("def follow_motion(motion: PageMotion, rest: morula.typing.MeshLike, model: CoveredTree, *, name: str = "
              "'', rules: collections.abc.Sequence[morula.typing.Rule] = ['exact'], measured: bool = False, workers: "
              "Workers | None = "
              "None) -> PageScene"),
      with_arguments(doc::follow_motion, {{"name", "name of the tree; by default the method that built it"}}).c_str());
  m.def(
      "show_spheres",
      [](std::shared_ptr<PageMotion> motion, MeshGiven given, const SphereTree& tree, ArrayGiven spheres,
         const std::string& name, const std::string& label, bool measured, Threads* workers) {
        const auto rest = mesh_of(given, "rest");
        require_rest(*motion, *rest);
        auto frames = sphere_frames_of(spheres.object, tree.node_count());
        if (frames.size() != motion->frames.size())
          throw std::invalid_argument("spheres: " + std::to_string(frames.size()) + " frames, but the motion has " +
                                      std::to_string(motion->frames.size()));
        PageScene scene = without_gil([&] {
          SignalCheck check;
          const auto tree_of_frame = [&](std::size_t i) {
            SphereTree current = tree;
            current.spheres = std::move(frames[i]);
            return current;
          };
          return show_spheres(*motion, *rest, name, label, tree_of_frame, measured, CallWorkers(workers),
                              [&](double) { check(); });
        });
        return HeldPageScene{std::move(motion), std::move(scene)};
      },
      nb::arg("motion"), nb::arg("rest"), nb::arg("tree"), nb::arg("spheres"), nb::kw_only(), nb::arg("name") = "tree",
      nb::arg("label") = "spheres as they are", nb::arg("measured") = false, nb::arg("workers") = nb::none(),
      nb::sig("def show_spheres(motion: PageMotion, rest: morula.typing.MeshLike, tree: SphereTree, spheres: "
              "morula.typing.FloatArray, *, name: str = 'tree', label: str = 'spheres as they are', measured: bool = "
              "False, workers: Workers | None = None) -> PageScene"),
      "Existing spheres, (frames, nodes, 4) as Body.follow() returns them, without updates. name: name of the tree. "
      "label: text in place of a rule.");
  m.def(
      "make_page",
      [](const std::vector<HeldPageScene*>& scenes, const std::string& title, const std::string& study) {
        PageContent content;
        content.title = title;
        content.study = study;
        std::vector<const PageMotion*> known;
        for (const HeldPageScene* held : scenes) {
          auto at = std::find(known.begin(), known.end(), held->motion.get());
          if (at == known.end()) {
            content.motions.push_back(*held->motion);
            at = known.insert(known.end(), held->motion.get());
          }
          content.scenes.push_back(held->scene);
          content.scenes.back().motion = static_cast<std::size_t>(at - known.begin());
        }
        return without_gil([&] { return make_page(content); });
      },
      nb::arg("scenes"), nb::kw_only(), nb::arg("title") = "Morula", nb::arg("study") = "",
      nb::sig("def make_page(scenes: collections.abc.Sequence[PageScene], *, title: str = 'Morula', study: str = '') "
              "-> str"),
      with_arguments(doc::make_page, {{"scenes", doc::PageContent}, {"study", doc::PageContent_study}}).c_str());
}

}  // namespace

void bind_collide_page(nb::module_& m);

void bind_page_extra(nb::module_& m) {
  m.def("has_page", &has_page, doc::has_page);
  m.def("why_no_page", &why_no_page, doc::why_no_page);
  bind_page_joints(m);
  bind_page_motion(m);
  bind_page_scene(m);
  m.def(
      "page_html",
      [](MeshGiven given, const CoveredTree& model, nb::handle frames_given, const std::vector<std::string>& rules,
         const std::string& title, bool measured, Threads* workers) {
        const auto mesh = mesh_of(given);
        const std::vector<Rule> each = rules_of(rules);
        PageMotion motion{"body", "rest", {mesh->facets.begin(), mesh->facets.end()}, {}, {}};
        if (frames_given.is_none()) {
          motion.frames.push_back(mesh->positions.to_vector());
          motion.frame_names.push_back("rest");
        } else {
          motion.name = "motion";
          motion.frames = frames_of(frames_given);
          for (std::size_t i = 0; i < motion.frames.size(); ++i)
            motion.frame_names.push_back("frame " + std::to_string(i));
          if (!motion.frames.empty())
            require_rows(motion.frames.front().size(), mesh->vertex_count(), "frames", 3,
                         "the mesh's vertices, in every frame");
        }
        return without_gil([&] {
          PageContent content;
          content.title = title;
          content.motions.push_back(std::move(motion));
          content.scenes.push_back(follow_motion(content.motions[0], *mesh, model, model.report.method, each, measured,
                                                 CallWorkers(workers)));
          return make_page(content);
        });
      },
      nb::arg("mesh"), nb::arg("model"), nb::arg("frames") = nb::none(), nb::kw_only(),
      nb::arg("rules") = std::vector<std::string>{"exact"}, nb::arg("title") = "Morula", nb::arg("measured") = false,
      nb::arg("workers") = nb::none(),
      nb::sig("def page_html(mesh: morula.typing.MeshLike, model: CoveredTree, frames: morula.typing.FloatArray | None "
              "= None, *, rules: collections.abc.Sequence[morula.typing.Rule] = ['exact'], title: str = 'Morula', "
              "measured: bool = "
              "False, workers: Workers | None = None) -> str"),
      doc::make_page);
  bind_collide_page(m);
}

}  // namespace morula::python
