// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres of a robot, as other programs read them.
#include <filesystem>
#include <morula/morula.hpp>
#include <morula/robot/output.hpp>
#include <string>
#include <vector>

#include "calls.hpp"
#include "holders.hpp"
#include "records.hpp"
#include "robots.hpp"

namespace morula::python {

void bind_robot_output(nb::module_& m) {
  using robot::OutputFormat;
  nb::class_<OutputFormat>(m, "OutputFormat", only_returned(),
                           "A file format for a robot's spheres, of another program.")
      .def_prop_ro("name", [](const OutputFormat& f) { return std::string(f.name); })
      .def_prop_ro("files", [](const OutputFormat& f) { return std::string(f.files); })
      .def_prop_ro(
          "reader", [](const OutputFormat& f) { return std::string(f.reader); }, doc::OutputFormat_reader)
      .def(
          "write",
          [](const OutputFormat& format, const robot::Robot& robot, const robot::RobotSpheres& spheres,
             const robot::SelfCollision* ignored, const FilePath& folder, const std::vector<std::string>& tool_frames,
             const std::optional<std::filesystem::path>& srdf, std::uint64_t seed, double density, bool fill_masses,
             bool inner) {
            robot::OutputOptions options;
            options.folder = folder.path;
            options.tool_frames = tool_frames;
            options.srdf = srdf;
            options.seed = seed;
            options.density = density;
            options.fill_masses = fill_masses;
            options.inner = inner;
            const robot::SelfCollision none;
            const auto files = without_gil([&] {
              return format.write({robot, spheres, ignored ? *ignored : none, options});
            });
            nb::dict all;
            for (const robot::OutputFile& file : files)
              all[nb::str(file.name.c_str(), file.name.size())] = nb::bytes(file.bytes.data(), file.bytes.size());
            return all;
          },
          nb::arg("robot"), nb::arg("spheres"), nb::arg("self_collision") = nb::none(), nb::kw_only(),
          nb::arg("folder"), nb::arg("tool_frames") = std::vector<std::string>{}, nb::arg("srdf") = nb::none(),
          nb::arg("seed") = 1, nb::arg("density") = 1000.0, nb::arg("fill_masses") = false, nb::arg("inner") = false,
          nb::sig(
              "def write(self, robot: Robot, spheres: RobotSpheres, self_collision: SelfCollision | None = None, *, "
              "folder: str | os.PathLike[str], tool_frames: collections.abc.Sequence[str] = [], "
              "srdf: str | os.PathLike[str] | None = None, seed: int = 1, density: float = 1000.0, "
              "fill_masses: bool = False, inner: bool = False) -> dict[str, bytes]"),
          with_arguments("The files, by their names in the folder, as bytes; writes nothing.",
                         {{"folder", doc::OutputOptions_folder},
                          {"tool_frames", doc::OutputOptions_tool_frames},
                          {"srdf", doc::OutputOptions_srdf},
                          {"seed", doc::OutputOptions_seed},
                          {"density", doc::OutputOptions_density},
                          {"fill_masses", doc::OutputOptions_fill_masses},
                          {"inner", doc::OutputOptions_inner}})
              .c_str())
      .def("__repr__",
           [](const OutputFormat& f) { return "<morula.robot.OutputFormat: " + std::string(f.name) + ">"; });
  m.def(
      "output_formats",
      [] {
        const auto all = robot::output_formats();
        return std::vector<OutputFormat>(all.begin(), all.end());
      },
      doc::output_formats);
  m.def(
      "output_format",
      [](std::string_view name) -> std::optional<OutputFormat> {
        const OutputFormat* found = robot::output_format(name);
        if (!found) return std::nullopt;
        return *found;
      },
      nb::arg("name"), "A format by its name; None if there is none.");
  m.def("guess_tool", &robot::guess_tool, nb::arg("robot"), doc::guess_tool);
  m.def(
      "read_robot_spheres",
      [](const FilePath& path) {
        auto read = without_gil([&] { return robot::read_robot_spheres(path); });
        nb::dict all;
        for (auto& [link, spheres] : read) all[nb::str(link.c_str(), link.size())] = own_spheres(std::move(spheres));
        return all;
      },
      nb::arg("path"),
      nb::sig("def read_robot_spheres(path: str | os.PathLike[str]) -> "
              "dict[str, numpy.typing.NDArray[numpy.float64]]"),
      doc::read_robot_spheres);
}

}  // namespace morula::python
