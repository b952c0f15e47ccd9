// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The submodule robot: robots as files describe them, spheres of their links, and what these meet.
#include "robots.hpp"

#include <stdexcept>
#include <string>

#include "holders.hpp"
#include "planning.hpp"

namespace morula::python {

std::optional<std::size_t> index_or_none(std::size_t index) {
  if (index == robot::none) return std::nullopt;
  return index;
}

std::vector<RigidTransform> poses_of(nb::handle given, const char* name) {
  std::vector<RigidTransform> poses;
  if (PyList_Check(given.ptr()) || PyTuple_Check(given.ptr())) {
    for (nb::handle pose : nb::borrow<nb::object>(given)) {
      if (!nb::isinstance<RigidTransform>(pose))
        throw nb::type_error(
            (std::string(name) + ": " + describe(pose) + ", but RigidTransform objects are needed").c_str());
      poses.push_back(nb::cast<RigidTransform>(pose));
    }
    return poses;
  }
  std::vector<std::size_t> shape;
  const std::vector<double> numbers = numbers_of(given, name, {-1, -1, 4}, shape);
  if (shape[1] != 3 && shape[1] != 4)
    throw std::invalid_argument(std::string(name) + ": " + describe(given) +
                                ", but RigidTransform objects or shape (links, 4, 4) is needed");
  for (std::size_t i = 0; i < shape[0]; ++i) {
    RigidTransform pose;
    for (int row = 0; row < 3; ++row) {
      const double* r = &numbers[(i * shape[1] + static_cast<std::size_t>(row)) * 4];
      pose.rows[static_cast<std::size_t>(row)] = {r[0], r[1], r[2]};
      pose.translation[row] = r[3];
    }
    poses.push_back(pose);
  }
  return poses;
}

std::vector<double> values_of(const ArrayGiven& given, const char* name) {
  const nb::handle object = given.object;
  if (PyList_Check(object.ptr()) || PyTuple_Check(object.ptr())) {
    std::vector<double> values(nb::len(object));
    if (!read_numbers(object, values.data(), static_cast<Py_ssize_t>(values.size())))
      throw nb::type_error((std::string(name) + ": a sequence with something else than numbers").c_str());
    return values;
  }
  std::vector<std::size_t> shape;
  return numbers_of(given.object, name, {-1}, shape);
}

robot::RoundShapes round_of(std::string_view text, const char* name) {
  return choice<robot::RoundShapes>(text, name,
                                    {{"around", robot::RoundShapes::around}, {"inside", robot::RoundShapes::inside}});
}

#ifdef MORULA_PYTHON_ROBOT_PAGE
void bind_robot_page(nb::module_& m);
#endif

void bind_robot_extra(nb::module_& m) {
  nb::module_ robots = m.def_submodule("robot", "Robots: reads URDF, MJCF and SDF, and fits spheres to their links.");
  bind_robot_description(robots);
  bind_robot_files(robots);
  bind_robot_fit(robots);
  bind_robot_trees(robots);
  bind_robot_self_collision(robots);
  bind_robot_self_fit(robots);
  bind_robot_output(robots);
  bind_sphere_robot(robots);
  bind_robot_world(robots);
  bind_robot_configurations(robots);
#ifdef MORULA_PYTHON_ROBOT_PAGE
  bind_robot_page(robots);
#endif
}

}  // namespace morula::python
