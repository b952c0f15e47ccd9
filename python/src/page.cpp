// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The page: one self-contained HTML file that shows a body and its spheres in motion.
#ifdef MORULA_PYTHON_PAGE
#include <morula/page/page.hpp>
#endif
#include <morula/morula.hpp>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

#ifdef MORULA_PYTHON_PAGE

void bind_page(nb::module_& m) {
  m.def("has_page", &has_page, doc::has_page);
  m.def("why_no_page", &why_no_page, doc::why_no_page);
  m.def(
      "page_html",
      [](MeshGiven given, const CoveredTree& built, nb::handle frames_given, const std::vector<std::string>& rules,
         const std::string& title, bool measured, Threads* workers) {
        const auto mesh = mesh_of(given);
        std::vector<Rule> each;
        for (const std::string& rule : rules) each.push_back(choice<Rule>(rule, "rules", rule_from_name, all_rules()));
        PageMotion motion{"body", "rest", mesh->facets, {}, {}};
        if (frames_given.is_none()) {
          motion.frames.push_back(mesh->positions);
          motion.frame_names.push_back("rest");
        } else {
          const Positions frames = Positions::frames(frames_given, "frames");
          if (frames.view().size() != mesh->vertex_count())
            throw std::invalid_argument("frames: one row per vertex of the mesh is needed");
          motion.name = "motion";
          for (std::size_t i = 0; i < frames.frame_count(); ++i) {
            const Positions one(frames, i);
            std::vector<Vec3>& positions = motion.frames.emplace_back(mesh->vertex_count());
            for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = one.view()[v];
            motion.frame_names.push_back("frame " + std::to_string(i));
          }
        }
        return without_gil([&] {
          PageContent content;
          content.title = title;
          content.motions.push_back(std::move(motion));
          content.scenes.push_back(follow_motion(content.motions[0], *mesh, built, built.report.method, each, measured,
                                                 CallWorkers(workers)));
          return make_page(content);
        });
      },
      nb::arg("mesh"), nb::arg("built"), nb::arg("frames") = nb::none(), nb::kw_only(),
      nb::arg("rules") = std::vector<std::string>{"exact"}, nb::arg("title") = "Morula", nb::arg("measured") = false,
      nb::arg("workers") = nb::none(),
      nb::sig("def page_html(mesh: morula.typing.MeshLike, built: CoveredTree, frames: morula.typing.FloatArray | None "
              "= None, *, "
              "rules: collections.abc.Sequence[str] = ['exact'], title: str = 'Morula', measured: bool = False, "
              "workers: Workers | None = None) -> str"),
      doc::make_page);
}

#else

void bind_page(nb::module_& m) {
  m.def(
      "has_page", [] { return false; }, doc::has_page);
  m.def(
      "why_no_page", [] { return std::string("the package was built without the page (MORULA_STUDY)"); },
      doc::why_no_page);
}

#endif

}  // namespace morula::python
