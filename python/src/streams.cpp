// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions and frames of spheres on disk, one frame at a time.
#include <memory>
#include <morula/io/motion_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/morula.hpp>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

namespace {

/// A writer whose file appears when the block that it is used in ends, and not at all when that raises.
template <class Writer>
struct HeldWriter {
  std::unique_ptr<Writer> writer;  // none once finished or given up
  std::size_t count;               // of vertices or nodes
  std::mutex mutex;

  HeldWriter(std::unique_ptr<Writer>&& made, std::size_t rows) : writer(std::move(made)), count(rows) {}

  template <class F>
  void use(const F& f) {
    without_gil([&] {
      const std::scoped_lock lock(mutex);
      if (!writer) throw std::invalid_argument("the writer has finished, or was given up");
      f(*writer);
    });
  }
  void finish() {
    use([&](Writer& open) {
      open.finish();
      writer.reset();
    });
  }
  void leave(bool is_raising) {
    without_gil([&] {
      const std::scoped_lock lock(mutex);
      const std::unique_ptr<Writer> open = std::move(writer);
      if (open && !is_raising) open->finish();
    });
  }
};

template <class Held>
void bind_writer(nb::class_<Held>& type, const char* finish_text) {
  type.def("finish", &Held::finish, finish_text)
      .def(
          "__enter__", [](nb::handle self) { return nb::borrow(self); }, nb::sig("def __enter__(self) -> typing.Self"))
      .def(
          "__exit__", [](Held& self, nb::handle kind, nb::handle, nb::handle) { self.leave(!kind.is_none()); },
          nb::arg("kind").none(), nb::arg("value").none(), nb::arg("traceback").none(),
          nb::sig("def __exit__(self, kind: object, value: object, traceback: object) -> None"),
          "Calls finish(); writes nothing if the block has raised.");
}

using HeldMotionWriter = HeldWriter<MotionWriter>;
using HeldSpheresWriter = HeldWriter<SphereFramesWriter>;

}  // namespace

void bind_streams(nb::module_& m) {
  nb::class_<Motion>(m, "Motion", doc::Motion)
      .def(
          "__init__",
          [](Motion* self, const FilePath& path, MeshGiven given, double frames_per_second, std::size_t animation,
             const MeshWeld* weld) {
            const auto mesh = mesh_of(given);
            Motion made = without_gil([&] { return Motion(path, *mesh, {frames_per_second, animation, weld}); });
            new (self) Motion(std::move(made));
          },
          nb::arg("path"), nb::arg("mesh"), nb::kw_only(), nb::arg("frames_per_second") = 30.0,
          nb::arg("animation") = 0, nb::arg("weld").none() = nb::none(),
          with_arguments(doc::Motion_Motion, {{"frames_per_second", doc::MotionOptions_frames_per_second},
                                              {"animation", doc::MotionOptions_animation},
                                              {"weld", doc::MotionOptions_weld}})
              .c_str())
      .def("__len__", &Motion::frame_count)
      .def(
          "__getitem__",
          [](const Motion& self, std::ptrdiff_t index) {
            const auto count = static_cast<std::ptrdiff_t>(self.frame_count());
            if (index < -count || index >= count) throw nb::index_error("no such frame");
            return own_points(
                without_gil([&] { return self.frame(static_cast<std::size_t>(index < 0 ? index + count : index)); }));
          },
          nb::arg("index"), (std::string("(vertices, 3) float64, read on access. ") + doc::Motion_frame).c_str())
      .def(
          "frame_name",
          [](const Motion& self, std::size_t index) {
            if (index >= self.frame_count()) throw nb::index_error("no such frame");
            return self.frame_name(index);
          },
          nb::arg("index"), doc::Motion_frame_name)
      .def("__repr__", [](const Motion& self) {
        return "<morula.Motion: " + std::to_string(self.frame_count()) +
               (self.frame_count() == 1 ? " frame>" : " frames>");
      });
  nb::class_<HeldMotionWriter> motion(m, "MotionWriter", doc::MotionWriter);
  motion
      .def(
          "__init__",
          [](HeldMotionWriter* self, const FilePath& path, MeshGiven given, std::size_t frame_count,
             const std::string& extension) {
            const auto mesh = mesh_of(given);
            auto made =
                without_gil([&] { return std::make_unique<MotionWriter>(path, *mesh, frame_count, extension); });
            new (self) HeldMotionWriter(std::move(made), mesh->vertex_count());
          },
          nb::arg("path"), nb::arg("mesh"), nb::arg("frame_count"), nb::arg("extension") = ".obj",
          doc::MotionWriter_MotionWriter)
      .def(
          "write",
          [](HeldMotionWriter& self, PositionsGiven given) {
            const Positions positions(given.object, "positions");
            require_rows(positions.view().size(), self.count, "positions", 3, "the mesh's vertices");
            self.use([&](MotionWriter& writer) {
              std::vector<Vec3> rows(self.count);
              for (std::size_t v = 0; v < rows.size(); ++v) rows[v] = positions.view()[v];
              writer.write(rows);
            });
          },
          nb::arg("positions"), "Writes the next frame, (vertices, 3).");
  bind_writer(motion, doc::MotionWriter_finish);
  nb::class_<HeldSpheresWriter> spheres(m, "SphereFramesWriter", doc::SphereFramesWriter);
  spheres
      .def(
          "__init__",
          [](HeldSpheresWriter* self, const FilePath& path, const SphereTree& tree, std::size_t frame_count) {
            auto made = without_gil([&] { return std::make_unique<SphereFramesWriter>(path, tree, frame_count); });
            new (self) HeldSpheresWriter(std::move(made), tree.node_count());
          },
          nb::arg("path"), nb::arg("tree"), nb::arg("frame_count"), doc::SphereFramesWriter_SphereFramesWriter)
      .def(
          "write",
          [](HeldSpheresWriter& self, ArrayGiven given) {
            const std::vector<Sphere> rows = spheres_of(given.object, "spheres");
            require_rows(rows.size(), self.count, "spheres", 4, "the tree's nodes");
            self.use([&](SphereFramesWriter& writer) { writer.write(rows); });
          },
          nb::arg("spheres"), doc::SphereFramesWriter_write);
  bind_writer(spheres, doc::SphereFramesWriter_finish);
}

}  // namespace morula::python
