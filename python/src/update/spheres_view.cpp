// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The spheres of one frame, as an array.
#include <morula/morula.hpp>
#include <tuple>

#include "module.hpp"
#include "posed.hpp"

namespace morula::python {

namespace {

using LocalRows = nb::ndarray<nb::numpy, const float, nb::shape<-1, 4>>;

LocalRows memory_of(const SpheresView& view, nb::handle owner) {
  const auto spheres = view.sphere_state().spheres;
  return LocalRows(reinterpret_cast<const float*>(spheres.data()), {spheres.size(), 4}, owner);
}

nb::object copy_of(nb::handle self) {
  return nb::cast(memory_of(nb::cast<const SpheresView&>(self), self)).attr("copy")();
}

}  // namespace

void bind_spheres_view(nb::module_& m) {
  nb::class_<SpheresView>(
      m, "SpheresView", collected_and_only_returned<SpheresView>(),
      "The spheres of one frame, (nodes, 4) float32: x, y, z about the body's origin, and radius. It reads as an array "
      "and gives copies; after the next update of the body, reading it raises RuntimeError.")
      .def_prop_ro("frame", [](const SpheresView& self) { return self.frame; })
      .def_prop_ro("is_current", &SpheresView::is_current, "False if the body has moved on.")
      .def_prop_ro(
          "origin", [](const SpheresView& self) { return self.sphere_state().origin; },
          "Offset of the centers, mesh units.")
      .def_prop_ro(
          "shape",
          [](const SpheresView& self) { return std::make_tuple(self.posed->sphere_state().spheres.size(), 4); })
      .def_prop_ro(
          "memory", [](nb::handle self) { return memory_of(nb::cast<const SpheresView&>(self), self); },
          "The body's own memory, without a copy: the next update overwrites it without a warning.")
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
          "__dlpack__", [](nb::handle self, nb::kwargs options) { return copy_of(self).attr("__dlpack__")(**options); },
          nb::arg("options"),
          nb::sig(
              "def __dlpack__(self, *, stream: object = None, max_version: tuple[int, int] | None = None, dl_device: "
              "tuple[int, int] | None = None, copy: bool | None = None) -> typing.Any"),
          "A DLPack capsule of a copy, which the consumer may write to.")
      .def(
          "__dlpack_device__", [](nb::handle) { return std::make_tuple(static_cast<int>(nb::device::cpu::value), 0); },
          "The processor's memory.")
      .def(
          "__getitem__", [](nb::handle self, nb::handle index) -> nb::object { return copy_of(self)[index]; },
          nb::arg("index"), nb::sig("def __getitem__(self, index: typing.Any, /) -> typing.Any"))
      .def("__len__", [](const SpheresView& self) { return self.posed->sphere_state().spheres.size(); })
      .def("__repr__", [](const SpheresView& self) {
        return "<morula.SpheresView: frame " + std::to_string(self.frame) +
               (self.is_current() ? ">" : ", no longer current>");
      });
}

}  // namespace morula::python
