// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Casters: plain values in Python. Points are tuples of three floats, spheres of four; objects that need a
// name in messages (meshes, arrays, budgets) come as they are; the function that has the name converts them.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/set.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <morula/geometry/sphere.hpp>

namespace morula::python {

namespace nb = nanobind;

/// An argument that is looked at by name.
struct Given {
  nb::handle object;
};
struct MeshGiven : Given {};
struct PositionsGiven : Given {};
struct ArrayGiven : Given {};
struct BudgetGiven : Given {};
struct ColliderGiven : Given {};
struct ShapeGiven : Given {};
struct ObstacleGiven : Given {};
struct TransformGiven : Given {};

/// An argument that is one of a few names.
struct Chosen {
  std::string_view text;
  operator std::string_view() const { return text; }
};
struct MethodName : Chosen {};
struct QualityName : Chosen {};
struct OptimizerName : Chosen {};
struct AxisName : Chosen {};
struct SignMethodName : Chosen {};
struct PriorityName : Chosen {};
struct ClumpFormatName : Chosen {};
struct RebuildEffortName : Chosen {};
struct RebuildThreadName : Chosen {};

/// A path: text, or what os.PathLike says.
struct FilePath {
  std::filesystem::path path;
  operator const std::filesystem::path&() const { return path; }
};

/// Reads `count` numbers of a sequence or an array of one axis. False when it is something else.
inline bool read_numbers(nb::handle from, double* numbers, Py_ssize_t count) noexcept {
  if (!PySequence_Check(from.ptr()) || PyUnicode_Check(from.ptr()) || PySequence_Size(from.ptr()) != count) {
    PyErr_Clear();
    return false;
  }
  for (Py_ssize_t i = 0; i < count; ++i) {
    PyObject* item = PySequence_GetItem(from.ptr(), i);
    if (!item) {
      PyErr_Clear();
      return false;
    }
    numbers[i] = PyFloat_AsDouble(item);
    Py_DECREF(item);
    if (numbers[i] == -1.0 && PyErr_Occurred()) {
      PyErr_Clear();
      return false;
    }
  }
  return true;
}

inline nb::handle tuple_of(const double* numbers, Py_ssize_t count) noexcept {
  PyObject* tuple = PyTuple_New(count);
  for (Py_ssize_t i = 0; tuple && i < count; ++i) PyTuple_SetItem(tuple, i, PyFloat_FromDouble(numbers[i]));
  return tuple;
}

}  // namespace morula::python

namespace nanobind::detail {

// Any object is taken: the function says what is wrong with it, by its name.
#define MORULA_GIVEN(Type, TypeName)                                        \
  template <>                                                               \
  struct type_caster<morula::python::Type> {                                \
    NB_TYPE_CASTER(morula::python::Type, const_name(TypeName))              \
    bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept { \
      value.object = source;                                                \
      return true;                                                          \
    }                                                                       \
  };
MORULA_GIVEN(MeshGiven, "morula.typing.MeshLike")
MORULA_GIVEN(PositionsGiven, "morula.typing.FloatArray")
MORULA_GIVEN(ArrayGiven, "morula.typing.Array")
MORULA_GIVEN(BudgetGiven, "morula.typing.Budget")
MORULA_GIVEN(ColliderGiven, "morula.typing.ColliderLike")
MORULA_GIVEN(ShapeGiven, "morula.typing.Shape")
MORULA_GIVEN(ObstacleGiven, "morula.typing.Obstacle")
MORULA_GIVEN(TransformGiven, "morula.typing.Transform")
#undef MORULA_GIVEN

#define MORULA_CHOSEN(Type, TypeName)                                                     \
  template <>                                                                             \
  struct type_caster<morula::python::Type> {                                              \
    NB_TYPE_CASTER(morula::python::Type, const_name(TypeName))                            \
    bool from_python(handle source, std::uint8_t flags, cleanup_list* cleanup) noexcept { \
      make_caster<std::string_view> caster;                                               \
      if (!caster.from_python(source, flags, cleanup)) return false;                      \
      value.text = caster.operator cast_t<std::string_view>();                            \
      return true;                                                                        \
    }                                                                                     \
  };
MORULA_CHOSEN(MethodName, "morula.typing.Method")
MORULA_CHOSEN(QualityName, "morula.typing.Quality")
MORULA_CHOSEN(OptimizerName, "morula.typing.Optimizer")
MORULA_CHOSEN(AxisName, "morula.typing.Axis")
MORULA_CHOSEN(SignMethodName, "morula.typing.SignMethod")
MORULA_CHOSEN(PriorityName, "morula.typing.Priority")
MORULA_CHOSEN(ClumpFormatName, "morula.typing.ClumpFormatName")
MORULA_CHOSEN(RebuildEffortName, "morula.typing.RebuildEffort")
MORULA_CHOSEN(RebuildThreadName, "morula.typing.RebuildThread")
#undef MORULA_CHOSEN

template <>
struct type_caster<morula::python::FilePath> {
  NB_TYPE_CASTER(morula::python::FilePath, const_name("str | os.PathLike[str]"))
  bool from_python(handle source, std::uint8_t flags, cleanup_list* cleanup) noexcept {
    make_caster<std::filesystem::path> caster;
    if (!caster.from_python(source, flags, cleanup)) return false;
    value.path = caster.operator cast_t<std::filesystem::path>();
    return true;
  }
};

template <>
struct type_caster<morula::Vec3> {
  NB_TYPE_CASTER(morula::Vec3, io_name("morula.typing.Vector", "tuple[float, float, float]"))
  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    double numbers[3];
    if (!morula::python::read_numbers(source, numbers, 3)) return false;
    value = {numbers[0], numbers[1], numbers[2]};
    return true;
  }
  static handle from_cpp(const morula::Vec3& v, rv_policy, cleanup_list*) noexcept {
    const double numbers[]{v.x, v.y, v.z};
    return morula::python::tuple_of(numbers, 3);
  }
};

template <>
struct type_caster<morula::Sphere> {
  NB_TYPE_CASTER(morula::Sphere, io_name("morula.typing.Vector", "tuple[float, float, float, float]"))
  bool from_python(handle source, std::uint8_t, cleanup_list*) noexcept {
    double numbers[4];
    if (!morula::python::read_numbers(source, numbers, 4)) return false;
    value = {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
    return true;
  }
  static handle from_cpp(const morula::Sphere& s, rv_policy, cleanup_list*) noexcept {
    const double numbers[]{s.center.x, s.center.y, s.center.z, s.radius};
    return morula::python::tuple_of(numbers, 4);
  }
};

}  // namespace nanobind::detail
