// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files of other programs, and what there is to read and write: ParaView, glTF, SOFA; tables of formats; folders of
// frames.
#include <morula/io/files.hpp>
#include <morula/io/paraview_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/morula.hpp>
#include <set>

#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// Numbers for every point or facet, by name: floats as they are, integers and truth values as whole numbers of 32
/// bits.
std::vector<VtpArray> arrays_of(nb::handle given, const char* name) {
  std::vector<VtpArray> all;
  if (given.is_none()) return all;
  if (!PyDict_Check(given.ptr()))
    throw nb::type_error(
        (std::string(name) + ": " + describe(given) + ", but None or a dict of arrays is needed").c_str());
  const nb::object numpy = nb::module_::import_("numpy");
  for (const auto& item : nb::borrow<nb::dict>(given)) {
    VtpArray array;
    array.name = value_of<std::string>(item.first, "arrays", "a dict of arrays by name");
    const std::string argument = std::string(name) + "['" + array.name + "']";
    const nb::object values = numpy.attr("asarray")(item.second);
    const auto kind = nb::cast<std::string>(nb::object(values.attr("dtype").attr("kind")));
    const auto axes = nb::cast<std::size_t>(nb::object(values.attr("ndim")));
    if (axes < 1 || axes > 2 || (kind != "f" && kind != "i" && kind != "u" && kind != "b"))
      throw std::invalid_argument(argument + ": " + describe(values) +
                                  ", but numbers, shape (n,) or (n, components), are needed");
    array.whole = kind != "f";
    if (array.whole) {
      const nb::object wide = values.attr("astype")("int64");
      const bool fits = nb::cast<std::size_t>(nb::object(wide.attr("size"))) == 0 ||
                        (nb::cast<std::int64_t>(nb::object(wide.attr("min")())) >= INT32_MIN &&
                         nb::cast<std::int64_t>(nb::object(wide.attr("max")())) <= INT32_MAX);
      if (!fits)
        throw std::invalid_argument(argument + ": whole numbers are written with 32 bits: give " + argument +
                                    ".astype(float)");
    }
    std::vector<std::size_t> shape;
    array.values = numbers_of(nb::object(values.attr("astype")("float64")), argument.c_str(),
                              axes == 1 ? std::vector<std::int64_t>{-1} : std::vector<std::int64_t>{-1, -1}, shape);
    if (axes == 2) array.components = shape[1];
    all.push_back(std::move(array));
  }
  return all;
}

void bind_pictures(nb::module_& m) {
  m.def(
      "write_vtp",
      [](const FilePath& path, ArrayGiven points, nb::handle facets, nb::handle point_arrays, nb::handle facet_arrays) {
        VtpData data;
        data.points = points_of(points.object, "points");
        if (!facets.is_none()) data.facets = facets_of(facets, "facets");
        data.point_arrays = arrays_of(point_arrays, "point_arrays");
        data.facet_arrays = arrays_of(facet_arrays, "facet_arrays");
        without_gil([&] { write_vtp(path, data); });
      },
      nb::arg("path"), nb::arg("points"), nb::arg("facets") = nb::none(), nb::kw_only(),
      nb::arg("point_arrays") = nb::none(), nb::arg("facet_arrays") = nb::none(),
      nb::sig("def write_vtp(path: str | os.PathLike[str], points: morula.typing.FloatArray, "
              "facets: morula.typing.Array | None = None, *, "
              "point_arrays: dict[str, morula.typing.Array] | None = None, "
              "facet_arrays: dict[str, morula.typing.Array] | None = None) -> None"),
      with_arguments(
          doc::write_vtp,
          {{"points", "(n, 3)"},
           {"facets", doc::VtpData_facets},
           {"point_arrays", "one or more numbers for every point, by name; integers are written as 32-bit integers"},
           {"facet_arrays", "the same for every facet"}})
          .c_str());
  m.def(
      "write_pvd",
      [](const FilePath& path, const std::vector<std::pair<double, std::string>>& entries) {
        std::vector<PvdEntry> all;
        for (const auto& [time, file] : entries) all.push_back({time, file});
        without_gil([&] { write_pvd(path, all); });
      },
      nb::arg("path"), nb::arg("entries"),
      with_arguments(doc::write_pvd, {{"entries", "pairs of a time and a file, relative to the folder of the .pvd"}})
          .c_str());
  m.def(
      "write_gltf_spheres",
      [](const FilePath& path, ArrayGiven given, double frames_per_second) {
        std::vector<std::size_t> shape;
        const std::vector<double> numbers = numbers_of(given.object, "frames", {-1, -1, 4}, shape);
        const auto* spheres = reinterpret_cast<const Sphere*>(numbers.data());
        std::vector<std::vector<Sphere>> frames;
        for (std::size_t i = 0; i < shape[0]; ++i)
          frames.emplace_back(spheres + i * shape[1], spheres + (i + 1) * shape[1]);
        without_gil([&] { write_gltf_spheres(path, frames, frames_per_second); });
      },
      nb::arg("path"), nb::arg("frames"), nb::arg("frames_per_second") = 30.0,
      with_arguments(doc::write_gltf_spheres, {{"frames", "(frames, spheres, 4)"}}).c_str());
  m.def(
      "write_sofa_spheres",
      [](const FilePath& path, ArrayGiven given) {
        const std::vector<Sphere> spheres = spheres_of(given.object, "spheres");
        without_gil([&] { write_sofa_spheres(path, spheres); });
      },
      nb::arg("path"), nb::arg("spheres"), doc::write_sofa_spheres);
}

}  // namespace

void bind_files(nb::module_& m) {
  Record<FileFormat>(m, "FileFormat", "The file formats: a row per extension and purpose.")
      .field("extension", &FileFormat::extension, doc::FileFormat_extension)
      .field("program", &FileFormat::program, doc::FileFormat_program)
      .field("is_read", &FileFormat::is_read)
      .field("is_written", &FileFormat::is_written)
      .field("purpose", &FileFormat::purpose, doc::FileFormat_purpose);
  m.def("file_formats", &file_formats,
        "One row for every extension and purpose; read_mesh and write_mesh accept the rows for meshes.");
  m.def("writable_mesh_list", &writable_mesh_list, doc::writable_mesh_list);
  m.def(
      "frame_files",
      [](const FilePath& folder, std::string_view pattern, const std::set<std::string>& extensions) {
        std::vector<std::string> files;
        for (const auto& file : frame_files(folder, pattern, extensions)) files.push_back(file.string());
        return files;
      },
      nb::arg("folder"), nb::arg("pattern") = "*", nb::arg("extensions") = std::set<std::string>{".obj"},
      doc::frame_files);
  m.def(
      "is_ball_file", [](const FilePath& path) { return is_ball_file(path); }, nb::arg("path"), doc::is_ball_file);
  m.def(
      "holds_spheres", [](const FilePath& path) { return holds_spheres(path); }, nb::arg("path"), doc::holds_spheres);
  m.def(
      "write_coordinates",
      [](const FilePath& path, ArrayGiven given) {
        std::vector<std::size_t> shape;
        ModalCoordinates coordinates;
        coordinates.coordinates = numbers_of(given.object, "coordinates", {-1, -1}, shape);
        coordinates.mode_count = shape[1];
        without_gil([&] { write_coordinates(path, coordinates); });
      },
      nb::arg("path"), nb::arg("coordinates"),
      with_arguments("Writes coordinates that read_coordinates() reads back to the bit.",
                     {{"coordinates", "(frames, modes)"}})
          .c_str());
  m.def(
      "write_bone_frames",
      [](const FilePath& path, ArrayGiven given) {
        std::vector<std::size_t> shape;
        std::vector<double> numbers = numbers_of(given.object, "transforms", {-1, -1, -1, 4}, shape);
        if (shape[2] != 3 && shape[2] != 4)
          throw std::invalid_argument("transforms: " + describe(given.object) +
                                      ", but shape (frames, bones, 3, 4) or (frames, bones, 4, 4) is needed");
        BoneFrames frames;
        frames.bone_count = shape[1];
        const std::size_t each = shape[2] * 4;
        for (std::size_t i = 0; i < numbers.size(); i += each) frames.transforms.push_back(transform_of(&numbers[i]));
        without_gil([&] { write_bone_frames(path, frames); });
      },
      nb::arg("path"), nb::arg("transforms"),
      with_arguments("Writes transforms that read_bone_frames() reads back to the bit.",
                     {{"transforms", "(frames, bones, 3, 4) or (frames, bones, 4, 4): matrices that act on columns"}})
          .c_str());
  m.def(
      "_write_whole",
      [](const FilePath& path, const std::string& text) { without_gil([&] { write_whole(path, text); }); },
      nb::arg("path"), nb::arg("text"), "Writes a file of UTF-8. The write is atomic.");
  bind_pictures(m);
}

}  // namespace morula::python
