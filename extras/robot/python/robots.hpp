// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The submodule robot: its parts, and what their functions take.
#pragma once

#include <cstddef>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/robot/fit.hpp>
#include <morula/robot/robot.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "arrays.hpp"
#include "module.hpp"

namespace morula::python {

/// None where there is none.
std::optional<std::size_t> index_or_none(std::size_t index);
/// (n, 3, 4) or (n, 4, 4), or a sequence of RigidTransform.
std::vector<RigidTransform> poses_of(nb::handle given, const char* name);
/// An array of one axis, or a list or tuple of numbers.
std::vector<double> values_of(const ArrayGiven& given, const char* name = "values");
/// around or inside.
robot::RoundShapes round_of(std::string_view text, const char* name);

void bind_robot_description(nb::module_& m);
void bind_robot_files(nb::module_& m);
void bind_robot_fit(nb::module_& m);
void bind_robot_output(nb::module_& m);
void bind_robot_self_collision(nb::module_& m);
void bind_robot_self_fit(nb::module_& m);
void bind_robot_trees(nb::module_& m);
void bind_sphere_robot(nb::module_& m);

}  // namespace morula::python
