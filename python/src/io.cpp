// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Files: meshes, trees, spheres of frames, motions, modes, skins, balls.
#include <morula/morula.hpp>

#include "calls.hpp"
#include "geometry/polygon.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "motion.hpp"
#include "records.hpp"
#include "text.hpp"

namespace morula::python {

namespace {

Copy<double, -1, -1, 3, 4> array_of(const BoneFrames& frames) {
  const auto flat = own_transforms(frames.transforms);
  auto [values, owner] = kept(std::vector<double>(flat.data(), flat.data() + flat.size()));
  return {values->data(), {frames.frame_count(), frames.bone_count, 3, 4}, owner};
}

using Path = FilePath;

struct SpheresOfFrames {
  SphereTree tree;
  std::vector<Sphere> spheres;
  std::size_t frame_count = 0;
};

}  // namespace

void bind_io(nb::module_& m) {
  m.def("readable_mesh_extensions", &readable_mesh_extensions, doc::readable_mesh_extensions);
  m.def(
      "read_mesh",
      [](const Path& path) {
        MeshInfo info;
        auto mesh = std::make_shared<Mesh>(without_gil([&] { return read_mesh(path, info); }));
        const std::string name = static_cast<const std::filesystem::path&>(path).string();
        for (const std::string& note : info.notes)
          if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", python_text(name + ": " + note).ptr()) != 0)
            throw nb::python_error();
        return mesh;
      },
      nb::arg("path"),
      (std::string(doc::read_mesh) + " Parts of the file that are not in the mesh give a UserWarning.").c_str());
  m.def(
      "read_welded_mesh",
      [](const Path& path) {
        MeshInfo info;
        MeshWeld weld;
        Mesh mesh = without_gil([&] { return read_mesh(path, info, weld); });
        return std::make_tuple(std::move(mesh), std::move(weld));
      },
      nb::arg("path"), doc::read_mesh_3);
  m.def(
      "_cut_polygons",
      [](nb::handle points, std::uint32_t sides, nb::handle corners) {
        auto mesh = std::make_shared<Mesh>();
        mesh->positions = points_of(points, "points");
        const std::vector<std::uint32_t> indices = indices_of(corners, "corners");
        if (sides < 3 || indices.size() % sides != 0)
          throw std::invalid_argument("corners: a multiple of the sides, 3 or more, is needed");
        for (const std::uint32_t v : indices)
          if (v >= mesh->vertex_count()) throw std::invalid_argument("corners: there is no point " + std::to_string(v));
        mesh->facets.resize(indices.size() / sides * (sides - 2));
        detail::PolygonCutter cutter;
        for (std::size_t i = 0; i < indices.size() / sides; ++i) {
          if (i % 65536 == 65535) check_signals();
          cutter.cut(mesh->positions, std::span(indices).subspan(i * sides, sides),
                     std::span(mesh->facets).subspan(i * (sides - 2), sides - 2));
        }
        return mesh;
      },
      nb::arg("points"), nb::arg("sides"), nb::arg("corners"),
      "Polygons with a given number of sides, corner by corner, as facets of a mesh: the same number of facets for "
      "each, one polygon after another.");
  m.def(
      "write_mesh",
      [](const Path& path, MeshGiven given, nb::handle at) {
        const auto mesh = mesh_of(given);
        if (at.is_none()) return without_gil([&] { write_mesh(path, *mesh); });
        const Positions positions(at, "positions");
        require_rows(positions.view().size(), mesh->vertex_count(), "positions", 3, "the mesh's vertices");
        without_gil([&] { write_mesh(path, {positions.view(), mesh->facets}); });
      },
      nb::arg("path"), nb::arg("mesh"), nb::arg("positions") = nb::none(),
      nb::sig("def write_mesh(path: str | os.PathLike[str], mesh: morula.typing.MeshLike, "
              "positions: morula.typing.FloatArray | None = None) -> None"),
      doc::write_mesh);

  nb::class_<TreeFile>(m, "TreeFile", only_returned(), doc::TreeFile)
      .def_prop_ro("tree", [](const TreeFile& f) { return f.tree; })
      .def_prop_ro(
          "cover", [](const TreeFile& f) { return f.cover; }, doc::TreeFile_cover)
      .def_prop_ro(
          "report", [](const TreeFile& f) { return f.report; }, doc::TreeFile_report)
      .def_prop_ro(
          "poses", [](const TreeFile& f) { return f.poses; }, doc::TreeFile_poses);
  m.def(
      "read_tree",
      [](const Path& path, Vec3 sph_origin) { return without_gil([&] { return read_tree(path, {sph_origin}); }); },
      nb::arg("path"), nb::arg("sph_origin") = Vec3{},
      with_arguments(doc::read_tree, {{"sph_origin", doc::ReadTreeOptions_sph_origin}}).c_str());
  m.def(
      "read_covered_tree",
      [](const Path& path, MeshGiven given, Vec3 sph_origin, Threads* workers) {
        const auto mesh = mesh_of(given);
        return without_gil([&] {
          return std::make_shared<CoveredTree>(read_covered_tree(path, *mesh, {sph_origin}, CallWorkers(workers)));
        });
      },
      nb::arg("path"), nb::arg("mesh"), nb::arg("sph_origin") = Vec3{}, nb::arg("workers") = nb::none(),
      doc::read_covered_tree);
  m.def(
      "write_tree", [](const Path& path, const CoveredTree& model) { without_gil([&] { write_tree(path, model); }); },
      nb::arg("path"), nb::arg("model"), doc::write_tree);
  m.def(
      "write_tree", [](const Path& path, const SphereTree& tree) { without_gil([&] { write_tree(path, tree); }); },
      nb::arg("path"), nb::arg("tree"), doc::write_tree_2);

  nb::class_<SpheresOfFrames>(m, "SphereFrames", only_returned(),
                              "The spheres of all frames of a motion, and their tree.")
      .def_prop_ro(
          "tree", [](const SpheresOfFrames& f) { return f.tree; }, "The tree of the first frame.")
      .def_prop_ro(
          "spheres",
          [](nb::handle self) {
            const auto& f = nb::cast<const SpheresOfFrames&>(self);
            return View<double, -1, -1, 4>(reinterpret_cast<const double*>(f.spheres.data()),
                                           {f.frame_count, f.tree.node_count(), 4}, self);
          },
          "(frames, nodes, 4) float64, mesh units.")
      .def("__len__", [](const SpheresOfFrames& f) { return f.frame_count; });
  m.def(
      "read_sphere_frames",
      [](const Path& path) {
        return without_gil([&] {
          const SphereFrames file(path);
          SpheresOfFrames all;
          all.frame_count = file.frame_count();
          SignalCheck check;
          for (std::size_t i = 0; i < all.frame_count; ++i) {
            SphereTree frame = file.frame(i);
            all.spheres.insert(all.spheres.end(), frame.spheres.begin(), frame.spheres.end());
            if (i == 0) all.tree = std::move(frame);
            check();
          }
          return all;
        });
      },
      nb::arg("path"), doc::SphereFrames);
  m.def(
      "write_sphere_frames",
      [](const Path& path, const SphereTree& tree, ArrayGiven given) {
        std::vector<std::size_t> shape;
        const std::vector<double> numbers =
            numbers_of(given.object, "spheres", {-1, static_cast<std::int64_t>(tree.node_count()), 4}, shape);
        without_gil([&] {
          SphereFramesWriter writer(path, tree, shape[0]);
          const auto* spheres = reinterpret_cast<const Sphere*>(numbers.data());
          for (std::size_t i = 0; i < shape[0]; ++i) writer.write({spheres + i * shape[1], shape[1]});
          writer.finish();
        });
      },
      nb::arg("path"), nb::arg("tree"), nb::arg("spheres"), doc::SphereFramesWriter);

  m.def(
      "read_motion",
      [](const Path& path, MeshGiven given, double frames_per_second, std::size_t animation) {
        const auto mesh = mesh_of(given);
        std::size_t frame_count = 0;
        auto [values, owner] = kept(without_gil([&] {
          const Motion motion(path, *mesh, {frames_per_second, animation});
          frame_count = motion.frame_count();
          std::vector<Vec3> all;
          SignalCheck check;
          all.reserve(frame_count * mesh->vertex_count());
          for (std::size_t i = 0; i < frame_count; ++i) {
            const std::vector<Vec3> frame = motion.frame(i);
            all.insert(all.end(), frame.begin(), frame.end());
            check();
          }
          return all;
        }));
        return Copy<double, -1, -1, 3>(reinterpret_cast<double*>(values->data()),
                                       {frame_count, mesh->vertex_count(), 3}, owner);
      },
      nb::arg("path"), nb::arg("mesh"), nb::kw_only(), nb::arg("frames_per_second") = 30.0, nb::arg("animation") = 0,
      (std::string("All frames, (frames, vertices, 3) float64. ") + doc::Motion_Motion).c_str());
  m.def(
      "write_motion",
      [](const Path& path, MeshGiven given, PositionsGiven rows, const std::string& extension) {
        const auto mesh = mesh_of(given);
        const Positions frames = Positions::frames(rows.object, "frames");
        require_rows(frames.view().size(), mesh->vertex_count(), "frames", 3, "the mesh's vertices, in every frame");
        std::vector<Positions> each;
        for (std::size_t i = 0; i < frames.frame_count(); ++i) each.emplace_back(frames, i);
        without_gil([&] {
          MotionWriter writer(path, *mesh, each.size(), extension);
          std::vector<Vec3> positions(mesh->vertex_count());
          for (const Positions& frame : each) {
            for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = frame.view()[v];
            writer.write(positions);
          }
          writer.finish();
        });
      },
      nb::arg("path"), nb::arg("mesh"), nb::arg("frames"), nb::arg("extension") = ".obj",
      doc::MotionWriter_MotionWriter);

  m.def(
      "read_modes",
      [](const Path& path, MeshGiven given, const MeshWeld* weld) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return weld != nullptr ? read_modes(path, *mesh, *weld) : read_modes(path, *mesh); });
      },
      nb::arg("path"), nb::arg("mesh"), nb::arg("weld").none() = nb::none(),
      (std::string(doc::read_modes) + "\n\nweld: the weld of the mesh. " + doc::read_modes_2).c_str());
  m.def(
      "write_modes", [](const Path& path, const Modes& modes) { without_gil([&] { write_modes(path, modes); }); },
      nb::arg("path"), nb::arg("modes"), doc::write_modes);
  m.def(
      "read_coordinates",
      [](const Path& path, std::size_t mode_count) {
        ModalCoordinates read = without_gil([&] { return read_coordinates(path, mode_count); });
        const std::size_t frames = read.frame_count();
        auto [values, owner] = kept(std::move(read.coordinates));
        return Copy<double, -1, -1>(values->data(), {frames, mode_count}, owner);
      },
      nb::arg("path"), nb::arg("mode_count"), doc::read_coordinates);
  m.def(
      "read_skin",
      [](const Path& path, MeshGiven given, const MeshWeld* weld) {
        const auto mesh = mesh_of(given);
        return without_gil([&] { return weld != nullptr ? read_skin(path, *mesh, *weld) : read_skin(path, *mesh); });
      },
      nb::arg("path"), nb::arg("mesh"), nb::arg("weld").none() = nb::none(),
      (std::string(doc::read_skin) + "\n\nweld: the weld of the mesh. " + doc::read_skin_2).c_str());
  m.def(
      "write_skin", [](const Path& path, const Skin& skin) { without_gil([&] { write_skin(path, skin); }); },
      nb::arg("path"), nb::arg("skin"), doc::write_skin);
  m.def(
      "read_bone_frames",
      [](const Path& path, std::size_t bone_count, double frames_per_second, std::size_t animation) {
        const BoneFrames read = without_gil([&] {
          return read_bone_frames(path, bone_count, {frames_per_second, animation});
        });
        return array_of(read);
      },
      nb::arg("path"), nb::arg("bone_count"), nb::kw_only(), nb::arg("frames_per_second") = 30.0,
      nb::arg("animation") = 0, doc::read_bone_frames);
  m.def(
      "read_bone_frames",
      [](const Path& path, std::size_t bone_count, std::size_t mode_count, double frames_per_second,
         std::size_t animation) {
        BoneFrames read = without_gil([&] {
          return read_bone_frames(path, bone_count, mode_count, {frames_per_second, animation});
        });
        const std::size_t frames = read.frame_count();
        auto transforms = array_of(read);
        auto [values, owner] = kept(std::move(read.morphs.coordinates));
        return std::make_pair(std::move(transforms), Copy<double, -1, -1>(values->data(), {frames, mode_count}, owner));
      },
      nb::arg("path"), nb::arg("bone_count"), nb::arg("mode_count"), nb::kw_only(), nb::arg("frames_per_second") = 30.0,
      nb::arg("animation") = 0,
      (std::string(doc::read_bone_frames_2) +
       "\n\nReturns transforms (frames, bones, 3, 4) and coordinates (frames, modes).")
          .c_str());
  m.def(
      "read_balls", [](const Path& path) { return own_spheres(without_gil([&] { return read_balls(path); })); },
      nb::arg("path"), doc::read_balls);
  m.def(
      "write_balls",
      [](const Path& path, ArrayGiven given) {
        const std::vector<Sphere> balls = spheres_of(given.object, "balls");
        without_gil([&] { write_balls(path, balls); });
      },
      nb::arg("path"), nb::arg("balls"), doc::write_balls);
}

}  // namespace morula::python
