// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions: generated deformations, modes and skins.
#include "motion.hpp"

#include <morula/morula.hpp>

#include "choices.hpp"
#include "holders.hpp"
#include "module.hpp"
#include "records.hpp"

namespace morula::python {

Modes modes_of(nb::handle given, const char* name) {
  if (nb::isinstance<Modes>(given)) return nb::cast<Modes>(given);
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, -1, 3}, shape);
  Modes modes{shape[1], shape[0], {}};
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    modes.displacements.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
  return modes;
}

Skin skin_of(nb::handle given, const char* name) {
  if (nb::isinstance<Skin>(given)) return nb::cast<Skin>(given);
  std::vector<std::size_t> shape;
  const std::vector<double> weights = numbers_of(given, name, {-1, -1}, shape);
  Skin skin;
  skin.bone_count = shape[1];
  skin.begin.push_back(0);
  for (std::size_t vertex = 0; vertex < shape[0]; ++vertex) {
    for (std::size_t bone = 0; bone < shape[1]; ++bone) {
      const double weight = weights[vertex * shape[1] + bone];
      if (weight == 0) continue;
      skin.bones.push_back(static_cast<std::uint32_t>(bone));
      skin.weights.push_back(weight);
    }
    skin.begin.push_back(static_cast<std::uint32_t>(skin.bones.size()));
  }
  return skin;
}

AffineTransform transform_of(const double* rows) {
  AffineTransform t;
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) t.columns[static_cast<std::size_t>(k)][row] = rows[4 * row + k];
    t.translation[row] = rows[4 * row + 3];
  }
  return t;
}

std::vector<AffineTransform> transforms_of(nb::handle given, const char* name) {
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, -1, 4}, shape);
  if (shape[1] != 3 && shape[1] != 4) {
    throw std::invalid_argument(std::string(name) + ": " + describe(given) +
                                ", but shape (bones, 3, 4) or (bones, 4, 4) is needed");
  }
  std::vector<AffineTransform> transforms;
  for (std::size_t bone = 0; bone < shape[0]; ++bone) transforms.push_back(transform_of(&numbers[bone * shape[1] * 4]));
  return transforms;
}

std::vector<AffineTransform> frames_of_transforms(nb::handle given, const char* name, std::size_t bone_count) {
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, -1, -1, 4}, shape);
  if (shape[1] != bone_count || (shape[2] != 3 && shape[2] != 4)) {
    const std::string bones = std::to_string(bone_count);
    throw std::invalid_argument(std::string(name) + ": " + describe(given) + ", but shape (frames, " + bones +
                                ", 3, 4) or (frames, " + bones + ", 4, 4) is needed");
  }
  std::vector<AffineTransform> transforms;
  for (std::size_t k = 0; k < shape[0] * shape[1]; ++k) transforms.push_back(transform_of(&numbers[k * shape[2] * 4]));
  return transforms;
}

Copy<double, -1, 3, 4> own_transforms(std::span<const AffineTransform> transforms) {
  std::vector<double> numbers;
  for (const AffineTransform& t : transforms) {
    for (int row = 0; row < 3; ++row) {
      for (std::size_t k = 0; k < 3; ++k) numbers.push_back(t.columns[k][row]);
      numbers.push_back(t.translation[row]);
    }
  }
  auto [values, owner] = kept(std::move(numbers));
  return Copy<double, -1, 3, 4>(values->data(), {transforms.size(), 3, 4}, owner);
}

namespace {

/// Attributes with the arguments of the constructor, and the printed form.
template <class Kind, class Member>
void bind_number(nb::class_<Kind>& type, const char* name, Member Kind::*member) {
  type.def_prop_ro(
      name, [member](const Kind& self) -> Member { return self.*member; }, nb::rv_policy::automatic);
}
template <class Kind>
void bind_deformation(nb::class_<Kind>& type) {
  if constexpr (requires(const Kind& kind) { kind.axis; }) {
    type.def_prop_ro(
        "axis",
        [](const Kind& self) {
          for (const auto& [text, axis] : axis_choices)
            if (axis == self.axis) return text;
          return "automatic";
        },
        "x, y, z or automatic.");
  }
  if constexpr (requires(const Kind& kind) { kind.degrees; }) bind_number(type, "degrees", &Kind::degrees);
  type.def("__repr__", [](const Kind& self) { return "<morula: " + describe(Deformation(self)) + ">"; });
}

void bind_deformations(nb::module_& m) {
  nb::class_<Stretch> stretch(m, "Stretch", doc::Stretch);
  stretch.def(
      "__init__",
      [](Stretch* self, double factor, double shrink, AxisName axis) {
        new (self) Stretch{factor, shrink, choice<Axis>(axis, "axis", axis_choices)};
      },
      nb::arg("factor") = 2.0, nb::arg("shrink") = 0.5, nb::arg("axis") = "automatic");
  nb::class_<Twist> twist(m, "Twist", doc::Twist);
  twist.def(
      "__init__",
      [](Twist* self, double degrees, AxisName axis) {
        new (self) Twist{degrees, choice<Axis>(axis, "axis", axis_choices)};
      },
      nb::arg("degrees") = 180.0, nb::arg("axis") = "automatic");
  nb::class_<Bend> bend(m, "Bend", doc::Bend);
  bend.def(
      "__init__",
      [](Bend* self, double degrees, AxisName axis) {
        new (self) Bend{degrees, choice<Axis>(axis, "axis", axis_choices)};
      },
      nb::arg("degrees") = 90.0, nb::arg("axis") = "automatic");
  nb::class_<Poke> poke(m, "Poke", doc::Poke);
  poke.def(
      "__init__",
      [](Poke* self, Vec3 center, Vec3 push, double radius) {
        new (self) Poke{center, push, radius};
      },
      nb::arg("center") = Vec3{0.5, 0.5, 1.0}, nb::arg("push") = Vec3{0.0, 0.0, -0.15}, nb::arg("radius") = 0.3);
  nb::class_<Noise> noise(m, "Noise", doc::Noise);
  noise.def(
      "__init__",
      [](Noise* self, double amplitude, double wavelength, std::uint64_t seed) {
        new (self) Noise{amplitude, wavelength, seed};
      },
      nb::arg("amplitude") = 0.05, nb::arg("wavelength") = 0.25, nb::arg("seed") = 1);
  nb::class_<Rotate> rotate(m, "Rotate", doc::Rotate);
  rotate.def(
      "__init__",
      [](Rotate* self, double degrees, AxisName axis) {
        new (self) Rotate{degrees, choice<Axis>(axis, "axis", axis_choices)};
      },
      nb::arg("degrees") = 90.0, nb::arg("axis") = "automatic");
  bind_number(stretch, "factor", &Stretch::factor);
  bind_number(stretch, "shrink", &Stretch::shrink);
  bind_number(poke, "center", &Poke::center);
  bind_number(poke, "push", &Poke::push);
  bind_number(poke, "radius", &Poke::radius);
  bind_number(noise, "amplitude", &Noise::amplitude);
  bind_number(noise, "wavelength", &Noise::wavelength);
  bind_number(noise, "seed", &Noise::seed);
  bind_deformation(stretch);
  bind_deformation(twist);
  bind_deformation(bend);
  bind_deformation(poke);
  bind_deformation(noise);
  bind_deformation(rotate);
}

Deformations deformations_of(nb::args given) {
  Deformations all;
  for (nb::handle d : given) {
    if (nb::isinstance<Stretch>(d))
      all.emplace_back(nb::cast<Stretch>(d));
    else if (nb::isinstance<Twist>(d))
      all.emplace_back(nb::cast<Twist>(d));
    else if (nb::isinstance<Bend>(d))
      all.emplace_back(nb::cast<Bend>(d));
    else if (nb::isinstance<Poke>(d))
      all.emplace_back(nb::cast<Poke>(d));
    else if (nb::isinstance<Noise>(d))
      all.emplace_back(nb::cast<Noise>(d));
    else if (nb::isinstance<Rotate>(d))
      all.emplace_back(nb::cast<Rotate>(d));
    else
      throw nb::type_error(
          ("deformations: " + describe(d) + ", but Stretch, Twist, Bend, Poke, Noise or Rotate is needed").c_str());
  }
  return all;
}

void bind_modes(nb::module_& m) {
  nb::class_<Modes>(m, "Modes", doc::Modes)
      .def(
          "__init__",
          [](Modes* self, ArrayGiven displacements) {
            new (self) Modes(modes_of(displacements.object, "displacements"));
          },
          nb::arg("displacements"), "displacements: (modes, vertices, 3), copied.")
      .def_ro("vertex_count", &Modes::vertex_count, doc::Modes_vertex_count)
      .def_ro("mode_count", &Modes::mode_count)
      .def_prop_ro(
          "displacements",
          [](nb::handle self) {
            const Modes& modes = nb::cast<const Modes&>(self);
            return View<double, -1, -1, 3>(reinterpret_cast<const double*>(modes.displacements.data()),
                                           {modes.mode_count, modes.vertex_count, 3}, self);
          },
          "(modes, vertices, 3) float64, read-only; no copy.")
      .def(
          "__reduce__",
          [](nb::handle self) { return nb::make_tuple(self.type(), nb::make_tuple(self.attr("displacements"))); },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const Modes& self) {
        return "<morula.Modes: " + std::to_string(self.mode_count) + " modes of " + std::to_string(self.vertex_count) +
               " vertices>";
      });
  nb::class_<Skin>(m, "Skin", doc::Skin)
      .def(
          "__init__", [](Skin* self, ArrayGiven weights) { new (self) Skin(skin_of(weights.object, "weights")); },
          nb::arg("weights"), "weights: (vertices, bones), rows that add up to 1; zeros are dropped.")
      .def_ro("bone_count", &Skin::bone_count)
      .def_prop_ro("vertex_count", &Skin::vertex_count)
      .def_prop_ro(
          "begin", [](nb::handle self) { return indices(nb::cast<Skin&>(self).begin, self); }, doc::Skin_begin)
      .def_prop_ro(
          "bones", [](nb::handle self) { return indices(nb::cast<Skin&>(self).bones, self); }, doc::Skin_bones)
      .def_prop_ro(
          "weights", [](nb::handle self) { return numbers(nb::cast<Skin&>(self).weights, self); }, doc::Skin_weights)
      .def("__repr__", [](const Skin& self) {
        return "<morula.Skin: " + std::to_string(self.bone_count) + " bones, " + std::to_string(self.vertex_count()) +
               " vertices>";
      });
  m.def(
      "skin_labels", [](const Skin& skin) { return own_indices(skin_labels(skin)); }, nb::arg("skin"),
      doc::skin_labels);
  m.def(
      "skin_of_vertices",
      [](const Skin& skin, ArrayGiven vertices) {
        return skin_of_vertices(skin, indices_of(vertices.object, "vertices"));
      },
      nb::arg("skin"), nb::arg("vertices"), doc::skin_of_vertices);
  m.def(
      "sample_modes",
      [](ArrayGiven rest, std::size_t mode_count) { return sample_modes(points_of(rest.object, "rest"), mode_count); },
      nb::arg("rest"), nb::arg("mode_count") = 4, doc::sample_modes);
  m.def(
      "sample_coordinates",
      [](std::size_t mode_count, std::size_t frame_count) {
        auto [values, owner] = kept(sample_coordinates(mode_count, frame_count));
        return Copy<double, -1, -1>(values->data(), {frame_count, mode_count}, owner);
      },
      nb::arg("mode_count"), nb::arg("frame_count"), doc::sample_coordinates);
  m.def(
      "sample_skin", [](ArrayGiven rest) { return sample_skin(points_of(rest.object, "rest")); }, nb::arg("rest"),
      doc::sample_skin);
  m.def(
      "sample_bones",
      [](ArrayGiven rest, std::size_t frame_count) {
        const std::vector<AffineTransform> frames = sample_bones(points_of(rest.object, "rest"), frame_count);
        auto flat = own_transforms(frames);
        const std::size_t bones = frame_count == 0 ? 0 : frames.size() / frame_count;
        auto [values, owner] = kept(std::vector<double>(flat.data(), flat.data() + flat.size()));
        return Copy<double, -1, -1, 3, 4>(values->data(), {frame_count, bones, 3, 4}, owner);
      },
      nb::arg("rest"), nb::arg("frame_count"), doc::sample_bones);
  m.def(
      "move_by_modes",
      [](const Modes& modes, ArrayGiven rest, ArrayGiven coordinates) {
        const std::vector<Vec3> at = points_of(rest.object, "rest");
        std::vector<std::size_t> shape;
        const std::vector<double> q =
            numbers_of(coordinates.object, "coordinates", {static_cast<std::int64_t>(modes.mode_count)}, shape);
        require_rows(at.size(), modes.vertex_count, "rest", 3, "the modes' vertices");
        std::vector<Vec3> positions(at.size());
        move_by_modes(modes, at, q, positions);
        return own_points(std::move(positions));
      },
      nb::arg("modes"), nb::arg("rest"), nb::arg("coordinates"), doc::move_by_modes);
  m.def(
      "move_by_skin",
      [](const Skin& skin, ArrayGiven rest, ArrayGiven transforms) {
        const std::vector<Vec3> at = points_of(rest.object, "rest");
        const std::vector<AffineTransform> bones = transforms_of(transforms.object, "transforms");
        require_rows(at.size(), skin.vertex_count(), "rest", 3, "the skin's vertices");
        require_rows(bones.size(), skin.bone_count, "transforms", 0, "the skin's bones");
        std::vector<Vec3> positions(at.size());
        move_by_skin(skin, at, bones, positions);
        return own_points(std::move(positions));
      },
      nb::arg("skin"), nb::arg("rest"), nb::arg("transforms"), doc::move_by_skin);
}

}  // namespace

void bind_motion(nb::module_& m) {
  bind_deformations(m);
  m.def(
      "deform",
      [](MeshGiven given, nb::args deformations, double t) {
        const Deformations all = deformations_of(deformations);
        const auto mesh = mesh_of(given, "rest");
        return own_points(without_gil([&] { return deform(*mesh, all, t); }));
      },
      nb::arg("rest"), nb::arg("deformations"), nb::kw_only(), nb::arg("t") = 1.0,
      nb::sig("def deform(rest: morula.typing.MeshLike, *deformations: Stretch | Twist | Bend | Poke | Noise | Rotate, "
              "t: float = 1.0) -> numpy.typing.NDArray[numpy.float64]"),
      doc::deform);
  m.def(
      "deform_frames",
      [](MeshGiven given, nb::args deformations, std::size_t frame_count, bool and_back) {
        const Deformations all = deformations_of(deformations);
        const auto mesh = mesh_of(given, "rest");
        auto [values, owner] = kept(without_gil([&] {
          std::vector<Vec3> frames;
          SignalCheck check;
          for (const double t : frame_parameters(frame_count, and_back)) {
            const std::vector<Vec3> frame = deform(*mesh, all, t);
            frames.insert(frames.end(), frame.begin(), frame.end());
            check();
          }
          return frames;
        }));
        return Copy<double, -1, -1, 3>(reinterpret_cast<double*>(values->data()),
                                       {frame_count, mesh->vertex_count(), 3}, owner);
      },
      nb::arg("rest"), nb::arg("deformations"), nb::kw_only(), nb::arg("frame_count"), nb::arg("and_back") = true,
      nb::sig("def deform_frames(rest: morula.typing.MeshLike, *deformations: Stretch | Twist | Bend | Poke | Noise | "
              "Rotate, frame_count: int, and_back: bool = True) -> numpy.typing.NDArray[numpy.float64]"),
      "All frames of a motion out and back: (frames, vertices, 3) float64, equal to deform() at frame_parameters().");
  m.def(
      "frame_parameters",
      [](std::size_t count, bool and_back) { return own_numbers(frame_parameters(count, and_back)); },
      nb::arg("frame_count"), nb::arg("and_back") = true, doc::frame_parameters);
  bind_modes(m);
}

}  // namespace morula::python
