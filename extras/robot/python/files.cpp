// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots from files, their surfaces, and where their links are.
#include <filesystem>
#include <memory>
#include <morula/morula.hpp>
#include <morula/robot/fit.hpp>
#include <morula/robot/robot.hpp>
#include <set>
#include <string>
#include <vector>

#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_files(nb::module_& m) {
  using robot::Robot;
  using robot::Shape;
  m.def(
      "read_robot",
      [](const FilePath& path, const std::vector<std::filesystem::path>& package_paths, bool visual,
         const std::set<std::string>& skip, const std::string& xacro, const std::vector<std::string>& xacro_arguments) {
        return without_gil([&] {
          return robot::read_robot(path, {package_paths, visual, skip, xacro, xacro_arguments});
        });
      },
      nb::arg("path"), nb::kw_only(), nb::arg("package_paths") = std::vector<std::filesystem::path>{},
      nb::arg("visual") = false, nb::arg("skip") = std::set<std::string>{}, nb::arg("xacro") = "",
      nb::arg("xacro_arguments") = std::vector<std::string>{},
      nb::sig("def read_robot(path: str | os.PathLike[str], *, "
              "package_paths: collections.abc.Sequence[str | os.PathLike[str]] = [], visual: bool = False, "
              "skip: set[str] = set(), xacro: str = '', xacro_arguments: collections.abc.Sequence[str] = []) -> Robot"),
      with_arguments(doc::read_robot, {{"package_paths", doc::ReadOptions_package_paths},
                                       {"visual", doc::ReadOptions_visual},
                                       {"skip", doc::ReadOptions_skip},
                                       {"xacro", doc::ReadOptions_xacro},
                                       {"xacro_arguments", doc::ReadOptions_xacro_arguments}})
          .c_str());
  m.def(
      "find_mesh",
      [](const std::string& name, const FilePath& robot_file, const std::vector<std::filesystem::path>& package_paths,
         int line) { return robot::find_mesh(name, robot_file, package_paths, line); },
      nb::arg("name"), nb::arg("robot_file"), nb::arg("package_paths") = std::vector<std::filesystem::path>{},
      nb::arg("line") = 0,
      nb::sig("def find_mesh(name: str, robot_file: str | os.PathLike[str], "
              "package_paths: collections.abc.Sequence[str | os.PathLike[str]] = [], line: int = 0) -> pathlib.Path"),
      doc::find_mesh);
  Record<robot::LinkSurface>(m, "LinkSurface", doc::LinkSurface)
      .field("mesh", &robot::LinkSurface::mesh)
      .property("spheres",
                [](nb::handle self) { return sphere_rows(nb::cast<robot::LinkSurface&>(self).spheres, self); });
  m.def(
      "surface_of",
      [](const FilePath& robot_file, const std::vector<Shape>& shapes, std::string_view round) {
        const robot::RoundShapes which = round_of(round, "round");
        return without_gil([&] { return robot::surface_of(robot_file, shapes, which); });
      },
      nb::arg("robot_file"), nb::arg("shapes"), nb::arg("round") = "around",
      with_arguments(doc::LinkSurface, {{"round",
                                         "around or inside: polyhedra contain the round shapes, or lie inside them. "
                                         "OSError for meshes that cannot be read"}})
          .c_str());
  m.def(
      "link_poses", [](const Robot& robot, ArrayGiven values) { return robot::link_poses(robot, values_of(values)); },
      nb::arg("robot"), nb::arg("values"), doc::link_poses);
  m.def(
      "rest_values", [](const Robot& robot) { return own_numbers(robot::rest_values(robot)); }, nb::arg("robot"),
      doc::rest_values);
  m.def(
      "read_collada",
      [](const FilePath& path, const std::string& part) {
        return std::make_shared<Mesh>(without_gil([&] { return robot::read_collada(path, part); }));
      },
      nb::arg("path"), nb::arg("part") = "", doc::read_collada);
}

}  // namespace morula::python
